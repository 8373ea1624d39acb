//! Triangles that wait until there are sixteen of them.

use rayflock_geom::simd::{LANES, Simd, SimdBase, SimdMask, f32x16, mask32x16, u32x16};

/// Up to 32 triangles in columns.
#[derive(Debug)]
pub(super) struct Staged {
    corners: [[[f32; 2 * LANES]; 3]; 3],
    /// Slots, ranks and masks.
    identity: [[u32; 2 * LANES]; 3],
    pub(super) len: usize,
}

/// Sixteen triangles: their corners; slots, ranks and masks.
pub(super) type Sixteen<S> = ([[f32x16<S>; 3]; 3], [u32x16<S>; 3]);

impl Staged {
    /// None yet.
    pub(super) const EMPTY: Self =
        Self { corners: [[[0.0; 2 * LANES]; 3]; 3], identity: [[0; 2 * LANES]; 3], len: 0 };

    /// Appends those of sixteen triangles that are `kept`; there must be room.
    #[inline(always)]
    pub(super) fn append<S: Simd>(
        &mut self,
        simd: S,
        (corners, identity): &Sixteen<S>,
        kept: mask32x16<S>,
    ) {
        let place = self.len..self.len + LANES;
        for (columns, corner) in self.corners.iter_mut().zip(corners) {
            for (column, &axis) in columns.iter_mut().zip(corner) {
                let kept = simd.compress_f32x16(axis, kept);
                kept.store_slice(&mut column[place.clone()]);
            }
        }
        for (column, &identity) in self.identity.iter_mut().zip(identity) {
            let kept = simd.compress_u32x16(identity, kept);
            kept.store_slice(&mut column[place.clone()]);
        }
        self.len += kept.to_bitmask().count_ones() as usize;
    }

    /// Takes out the first sixteen, or as many as there are.
    #[inline(always)]
    pub(super) fn take<S: Simd>(&mut self, simd: S) -> Sixteen<S> {
        let load = |column: &[f32; 2 * LANES]| f32x16::from_slice(simd, &column[..LANES]);
        let load_id = |column: &[u32; 2 * LANES]| u32x16::from_slice(simd, &column[..LANES]);
        let [a, b, c] = &self.corners;
        let corners = [
            [load(&a[0]), load(&a[1]), load(&a[2])],
            [load(&b[0]), load(&b[1]), load(&b[2])],
            [load(&c[0]), load(&c[1]), load(&c[2])],
        ];
        let [slots, ranks, masks] = &self.identity;
        let identity = [load_id(slots), load_id(ranks), load_id(masks)];
        for column in self.corners.as_flattened_mut() {
            column.copy_within(LANES.., 0);
        }
        for column in &mut self.identity {
            column.copy_within(LANES.., 0);
        }
        self.len = self.len.saturating_sub(LANES);
        (corners, identity)
    }
}
