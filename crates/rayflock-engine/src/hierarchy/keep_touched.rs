//! Keeps the primitives that the rays of a cone may touch: of all, or of a list.

use rayflock_geom::SphereCone;
use rayflock_geom::simd::cone_sphere::{Reach, SphereBlock, touches};
use rayflock_geom::simd::{LANES, Simd, SimdBase, SimdMask, u32x16};

use super::candidates::Candidates;
use crate::TraceStats;
use crate::primitives::PrimitiveTable;

/// Fills `list` with what the cone touches of all primitives: first whole blocks of sixteen are
/// asked, then the primitives of those that are touched.
#[inline(always)]
pub(super) fn keep_of_all<S: Simd>(
    simd: S,
    table: &PrimitiveTable,
    cone: &SphereCone,
    reach: Reach,
    list: &mut Candidates,
    stats: &mut TraceStats,
) {
    list.clear(table.block_count() * LANES);
    let lane_numbers: [u32; LANES] = std::array::from_fn(|lane| lane as u32);
    let lane_numbers = u32x16::from_slice(simd, &lane_numbers);
    let mut tested_blocks = 0;
    for (group_idx, group) in table.block_bounds().iter().enumerate() {
        let (kept, _) = touches(simd, cone, reach, table.slack(), &group.load(simd));
        let mut kept = kept.to_bitmask();
        tested_blocks += 1 + u64::from(kept.count_ones());
        while kept != 0 {
            let block_idx = group_idx * LANES + kept.trailing_zeros() as usize;
            kept &= kept - 1;
            let spheres = table.bounds(block_idx).load(simd);
            let slots = lane_numbers + u32x16::splat(simd, (block_idx * LANES) as u32);
            let (kept, nearest) = touches(simd, cone, reach, table.slack(), &spheres);
            list.append(simd, &spheres, slots, nearest, kept);
        }
    }
    list.seal();
    stats.cone_tests += tested_blocks * LANES as u64;
    stats.pairs += list.len() as u64;
    stats.bytes += tested_blocks * size_of::<SphereBlock>() as u64 + list.written_bytes();
}

/// Fills `list` with what the cone touches of the candidates in `parent`.
#[inline(always)]
pub(super) fn keep_of_list<S: Simd>(
    simd: S,
    parent: &Candidates,
    cone: &SphereCone,
    reach: Reach,
    slack: f32,
    list: &mut Candidates,
    stats: &mut TraceStats,
) {
    list.clear(parent.len());
    for block_idx in 0..parent.block_count() {
        let (spheres, slots) = parent.load(simd, block_idx);
        let (kept, nearest) = touches(simd, cone, reach, slack, &spheres);
        list.append(simd, &spheres, slots, nearest, kept);
    }
    list.seal();
    stats.cone_tests += (parent.block_count() * LANES) as u64;
    stats.pairs += list.len() as u64;
    stats.bytes += parent.loaded_bytes() + list.written_bytes();
}
