//! Sorts rays without an order so that neighbours are close in direction and origin.
//!
//! A key of at most 31 bits holds the direction on an octahedral map (coarse bits first), then the origin in
//! the batch's bounding box, both as Morton codes; what is uniform gets no bits.
//!
//! **Source.** N. Reis, V. Costa, J. Pereira, "Coherent Ray-Space Hierarchy via Ray Hashing and
//! Sorting", GRAPP 2017. **Departures.** The octahedral map instead of spherical angles.
//!
//! **Cost.** One parallel sort of eight bytes a ray.

use std::ops::Range;

use glam::{Vec2, Vec3};
use rayflock_geom::{Aabb, RayBatch};
use rayon::prelude::*;

/// Bits of the key for the direction where the origin varies too; half for each of its two
/// coordinates.
const DIRECTION_BITS: u32 = 10;

/// Rays that one task gives keys at least.
const RAYS_PER_TASK: usize = 4096;

/// Sorts rays, keeping its memory.
#[derive(Debug, Default)]
pub(super) struct RaySorter {
    keyed: Vec<u64>,
    order: Vec<u32>,
}

impl RaySorter {
    /// The positions of all rays of `batch`, in an order in which neighbours are close.
    pub(super) fn sort(&mut self, batch: &RayBatch<'_>) -> &[u32] {
        let bounds = origin_bounds(batch);
        let scale = bounds.size().map(|side| if side > 0.0 { 1.0 / side } else { 0.0 });
        let uniform_origin = batch.origin().uniform().is_some();
        let uniform_direction = batch.direction().uniform().is_some();
        let key = |ray_idx: usize| {
            let place = (batch.origin().get(ray_idx) - bounds.min) * scale;
            if uniform_direction {
                return morton3(place, 10);
            }
            let direction = octahedral(batch.direction().get(ray_idx));
            if uniform_origin {
                return morton2(direction, 15);
            }
            (morton2(direction, DIRECTION_BITS / 2) << 21) | morton3(place, 7)
        };
        let keyed = (0..batch.len()).into_par_iter().with_min_len(RAYS_PER_TASK);
        keyed
            .map(|ray_idx| (u64::from(key(ray_idx)) << 32) | ray_idx as u64)
            .collect_into_vec(&mut self.keyed);
        self.keyed.par_sort_unstable();
        let sorted = self.keyed.par_iter().with_min_len(RAYS_PER_TASK);
        sorted.map(|&keyed| keyed as u32).collect_into_vec(&mut self.order);
        &self.order
    }

    /// Bytes held.
    pub(super) fn memory_usage(&self) -> usize {
        8 * self.keyed.capacity() + 4 * self.order.capacity()
    }
}

/// The box around all origins.
fn origin_bounds(batch: &RayBatch<'_>) -> Aabb {
    let around = |rays: Range<usize>| Aabb::around(rays.map(|idx| batch.origin().get(idx)));
    if batch.origin().uniform().is_some() {
        return around(0..1);
    }
    let starts = (0..batch.len()).into_par_iter().step_by(RAYS_PER_TASK);
    let parts = starts.map(|start| around(start..(start + RAYS_PER_TASK).min(batch.len())));
    parts.reduce(|| Aabb::EMPTY, |a, b| a.union(&b))
}

/// A direction's place on the unit square: the octahedron unfolded. NaN for a direction without.
fn octahedral(direction: Vec3) -> Vec2 {
    let d = direction / direction.abs().max_element();
    let p = d.truncate() / (d.x.abs() + d.y.abs() + d.z.abs());
    let folded = if d.z >= 0.0 {
        p
    } else {
        (Vec2::ONE - Vec2::new(p.y.abs(), p.x.abs()))
            * Vec2::new(1.0_f32.copysign(p.x), 1.0_f32.copysign(p.y))
    };
    0.5 * folded + 0.5
}

/// The Morton code of a point in the unit square; NaN counts as 0.
fn morton2(point: Vec2, bits: u32) -> u32 {
    let [x, y] = point.to_array().map(|coordinate| quantise(coordinate, bits));
    (0..bits).fold(0, |code, bit| {
        code | (((x >> bit) & 1) << (2 * bit)) | (((y >> bit) & 1) << (2 * bit + 1))
    })
}

/// The Morton code of a point in the unit cube; NaN counts as 0.
fn morton3(point: Vec3, bits: u32) -> u32 {
    let [x, y, z] = point.to_array().map(|coordinate| quantise(coordinate, bits));
    (0..bits).fold(0, |code, bit| {
        let triple = ((x >> bit) & 1) | (((y >> bit) & 1) << 1) | (((z >> bit) & 1) << 2);
        code | (triple << (3 * bit))
    })
}

fn quantise(coordinate: f32, bits: u32) -> u32 {
    let cells = (1_u32 << bits) as f32;
    // The cast takes NaN to 0 and saturates.
    ((coordinate * cells) as u32).min((1 << bits) - 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbours_share_direction_cells() {
        let directions: Vec<_> = (0..64)
            .map(|i| if i % 2 == 0 { Vec3::new(1.0, 0.2, 0.1) } else { Vec3::new(-0.3, -1.0, 0.2) })
            .collect();
        let batch = RayBatch::new(Vec3::ZERO, &directions).unwrap();
        let mut sorter = RaySorter::default();
        let order = sorter.sort(&batch);
        let parity: Vec<_> = order.iter().map(|ray_idx| ray_idx % 2).collect();
        assert_eq!(parity.windows(2).filter(|pair| pair[0] != pair[1]).count(), 1);
    }

    #[test]
    fn rays_that_are_not_finite_have_a_key_too() {
        let directions = [Vec3::NAN, Vec3::ZERO, Vec3::INFINITY, Vec3::X];
        let origins = [Vec3::ZERO, Vec3::NAN, Vec3::INFINITY, Vec3::ONE];
        let batch = RayBatch::new(&origins[..], &directions[..]).unwrap();
        let mut order = RaySorter::default().sort(&batch).to_vec();
        order.sort_unstable();
        assert_eq!(order, [0, 1, 2, 3]);
    }
}
