//! Brings rays into an order in which neighbours start and go alike.
//!
//! Origins lie in a grid of 64 cells along the longest side of the box around them, directions in 64
//! x 64 cells of an octahedral map; the bits of all five numbers, interleaved, are the key.
//!
//! **Source.** N. Reis, V. Costa, J. Pereira, "Coherent Ray-Space Hierarchy via Ray Hashing and
//! Sorting", GRAPP 2017: rays are hashed and sorted before a hierarchy is built over them. The map is
//! that of Z. Cigolle et al., JCGT 3(2), 2014.
//!
//! **Departures.** On the host, while rays are on their way to the device anyway; rays that are born
//! there are sorted there (`compute::ray_order`).

use glam::Vec3;
use rayflock_geom::{Aabb, Ray, RayBatch, RayState};
use rayon::prelude::*;

/// Cells along a side, as a power of two.
const BITS: u32 = 6;

/// The rays of a batch in their new order; rays that are not traced last.
pub(crate) fn sort_rays(batch: &RayBatch<'_>, sorted: &mut Vec<u32>) {
    let is_active = |ray: &Ray| ray.state() == RayState::Active;
    let active = (0..batch.len()).map(|idx| batch.ray(idx)).filter(is_active);
    let bounds = Aabb::around(active.map(|ray| ray.origin));
    let longest = bounds.size().max_element();
    let scale = if longest > 0.0 { (1 << BITS) as f32 / longest } else { 0.0 };
    let key = |idx: u32| {
        let ray = batch.ray(idx as usize);
        let key = if is_active(&ray) { key(&ray, bounds.min, scale) } else { u32::MAX };
        (key, idx)
    };
    let mut keyed: Vec<_> = (0..batch.len() as u32).into_par_iter().map(key).collect();
    keyed.par_sort_unstable();
    sorted.clear();
    sorted.extend(keyed.into_iter().map(|(_, idx)| idx));
}

fn key(ray: &Ray, low: Vec3, scale: f32) -> u32 {
    let largest = (1 << BITS) - 1;
    let cell = |place: f32| (place as u32).min(largest);
    let origin = scale * (ray.origin - low);
    let [across, along] = octahedral(ray.direction).map(|place| 0.5 * (place + 1.0));
    let side = (1 << BITS) as f32;
    let cells = [origin.x, origin.y, origin.z, side * across, side * along].map(cell);
    let mut key = 0;
    for bit in (0..BITS).rev() {
        for cell in cells {
            key = key << 1 | (cell >> bit & 1);
        }
    }
    key
}

/// The place of a direction on a square from -1 to 1.
pub(crate) fn octahedral(direction: Vec3) -> [f32; 2] {
    // Large and small directions are out of the range of sums.
    let scaled = direction / direction.abs().max_element();
    let flat = scaled / scaled.abs().element_sum();
    if flat.z >= 0.0 {
        return [flat.x, flat.y];
    }
    [(1.0 - flat.y.abs()).copysign(flat.x), (1.0 - flat.x.abs()).copysign(flat.y)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rays_that_start_and_go_alike_become_neighbours() {
        let places = [Vec3::ZERO, 9.0 * Vec3::X];
        let ways = [Vec3::Z, 1e30 * Vec3::X, Vec3::new(-1.0, -1.0, -0.5)];
        let all: Vec<_> = (0..60).map(|idx| (places[idx % 2], ways[idx % 3])).collect();
        let (origins, mut directions): (Vec<_>, Vec<_>) = all.iter().copied().unzip();
        directions[7] = Vec3::ZERO;
        let mut sorted = Vec::new();
        sort_rays(&RayBatch::new(&origins, &directions).unwrap(), &mut sorted);
        assert_eq!(sorted.last(), Some(&7), "what is not traced comes last");
        let changes = sorted[..59].windows(2).filter(|w| all[w[0] as usize] != all[w[1] as usize]);
        assert_eq!(changes.count(), 5);
        sorted.sort_unstable();
        assert!(sorted.into_iter().eq(0..60));
    }
}
