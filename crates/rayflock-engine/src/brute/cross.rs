//! Crosses a chunk of rays with all primitives.

use rayflock_geom::simd::ray_triangle::{ShearedRay, intersect_block};
use rayflock_geom::simd::{LANES, Simd, SimdBase, mask32x16, u32x16};
use rayflock_geom::{Ray, RayBatch, RayState};

use crate::TraceStats;
use crate::packet::{Nearest, Question, TracePacket};
use crate::primitives::{PrimitiveTable, SPHERE_BYTES, TRIANGLE_BYTES};

/// Rays that meet a group of triangle blocks together.
pub(super) const CHUNK: usize = 64;

/// Triangle blocks in a group: 32 of 704 bytes leave half of a 48 KiB cache to the rays.
const BLOCKS_PER_GROUP: usize = 32;

/// Finds the nearest hits of the rays from `first_ray` on, one for each entry of `nearest`.
#[inline(always)]
pub(super) fn cross_chunk<S: Simd>(
    simd: S,
    table: &PrimitiveTable,
    batch: &RayBatch<'_>,
    first_ray: usize,
    question: Question,
    t_bound: &impl Fn(usize) -> f32,
    nearest: &mut [Nearest],
) -> TraceStats {
    let mut stats = TraceStats { rays: nearest.len() as u64, ..TraceStats::default() };
    nearest.fill(Nearest::NONE);
    let mut rays = [None; CHUNK];
    for (idx, place) in rays[..nearest.len()].iter_mut().enumerate() {
        let ray = batch.ray(first_ray + idx);
        match ray.state() {
            RayState::Active => {
                let t_max = ray.t_max.min(t_bound(first_ray + idx));
                *place = Some(Ray { t_max, ..ray });
            }
            RayState::Inactive => {}
            RayState::Invalid => stats.invalid_rays += 1,
        }
    }
    cross_triangles(simd, table, &rays, question, nearest, &mut stats);
    for (rays, nearest) in rays.chunks(LANES).zip(nearest.chunks_mut(LANES)) {
        cross_others(simd, table, rays, question, nearest, &mut stats);
    }
    // A ray meets whole blocks of triangles, a sphere sixteen rays.
    stats.bytes =
        stats.triangle_tests * TRIANGLE_BYTES + stats.sphere_tests / LANES as u64 * SPHERE_BYTES;
    stats
}

/// Each ray against all triangles, group by group.
#[inline(always)]
fn cross_triangles<S: Simd>(
    simd: S,
    table: &PrimitiveTable,
    rays: &[Option<Ray>],
    question: Question,
    nearest: &mut [Nearest],
    stats: &mut TraceStats,
) {
    let block_count = table.triangle_block_count();
    for first_block in (0..block_count).step_by(BLOCKS_PER_GROUP) {
        let group = first_block..(first_block + BLOCKS_PER_GROUP).min(block_count);
        for (ray, nearest) in rays.iter().zip(nearest.iter_mut()) {
            let Some(ray) = ray else { continue };
            let mut sheared = ShearedRay::new(ray);
            for block_idx in group.clone() {
                if question == Question::Occluded && !nearest.is_none() {
                    break;
                }
                sheared.t_max = ray.t_max.min(nearest.t);
                stats.triangle_tests += LANES as u64;
                test_block(simd, table, block_idx, &sheared, ray.mask, nearest);
            }
        }
    }
}

/// One ray against the sixteen triangles of a block.
#[inline(always)]
fn test_block<S: Simd>(
    simd: S,
    table: &PrimitiveTable,
    block_idx: usize,
    ray: &ShearedRay,
    ray_mask: u32,
    nearest: &mut Nearest,
) {
    let seen = u32x16::from_slice(simd, table.masks(block_idx)) & u32x16::splat(simd, ray_mask);
    let active: mask32x16<S> = !seen.simd_eq(u32x16::splat(simd, 0));
    let hits = intersect_block(simd, ray, table.triangle_block(block_idx), active);
    nearest.offer_lanes(&hits, table.ranks(block_idx));
}

/// Sixteen rays against all spheres and user primitives.
#[inline(always)]
fn cross_others<S: Simd>(
    simd: S,
    table: &PrimitiveTable,
    rays: &[Option<Ray>],
    question: Question,
    nearest: &mut [Nearest],
    stats: &mut TraceStats,
) {
    let mut packet = TracePacket::EMPTY;
    for (lane, (ray, nearest)) in rays.iter().zip(nearest.iter()).enumerate() {
        let answered = question == Question::Occluded && !nearest.is_none();
        if let (Some(ray), false) = (ray, answered) {
            packet.set(lane, ray, nearest.t);
        }
    }
    for slot in table.other_slots() {
        if packet.is_done() {
            break;
        }
        packet.test(simd, table, slot, question, stats);
    }
    for (lane, nearest) in nearest.iter_mut().enumerate() {
        nearest.offer(packet.nearest(lane));
    }
}
