//! Brings the rays of a batch into slots: 64 consecutive ones are a tile.
//!
//! ```text
//!   Image       tiles of 8 x 8 pixels along a Morton curve, as their pixels are; cropped ones
//!               filled up
//!   otherwise   sorted by direction and origin
//! ```
//!
//! Long batches are traced in runs of slots, so that no buffer outgrows what WebGPU guarantees.

use rayflock_geom::{RayBatch, RayOrder, RayState};
use rayon::prelude::*;

use crate::layout::{DeviceHit, DeviceRay};
use crate::sort_rays::sort_rays;

/// Rays in a tile.
pub(crate) const TILE_RAYS: usize = 64;

/// Pixels along the side of a tile of an image.
const TILE_EDGE: usize = 8;

/// Rays that are on the device at a time.
pub(crate) const RUN_SLOTS: usize = 1 << 18;

/// Stands for a slot without a ray.
const NO_RAY: u32 = u32::MAX;

/// Which ray of a batch lies in which slot.
#[derive(Debug, Default)]
pub(crate) struct Slots {
    /// The ray of each slot, or [`NO_RAY`].
    ray_idx: Vec<u32>,
    /// What `ray_idx` was made for.
    made_for: Option<RayOrder>,
}

/// The rays of some consecutive slots, as the device gets them.
#[derive(Debug, Default)]
pub(crate) struct Run {
    first_slot: usize,
    /// A multiple of [`TILE_RAYS`].
    pub(crate) rays: Vec<DeviceRay>,
    /// What is known to be hit: at first, nothing before the end of each interval.
    pub(crate) hits: Vec<DeviceHit>,
    /// Rays that were NaN, infinite or had a zero direction.
    pub(crate) invalid_count: u64,
}

impl Slots {
    /// Assigns the rays of `batch`. An image of the same size as before is not arranged anew.
    pub(crate) fn assign(&mut self, batch: &RayBatch<'_>) {
        let order = match batch.order() {
            RayOrder::Image { width, height, .. }
                if width.checked_mul(height) == Some(batch.len()) =>
            {
                batch.order()
            }
            _ => RayOrder::Unordered,
        };
        if let RayOrder::Image { width, height, tile } = order {
            if self.made_for != Some(order) {
                self.ray_idx.clear();
                self.assign_image(Image { width, height, tile });
            }
        } else {
            sort_rays(batch, &mut self.ray_idx);
        }
        self.made_for = Some(order);
    }

    /// Number of slots, those without a ray included.
    pub(crate) fn len(&self) -> usize {
        self.ray_idx.len()
    }

    /// The ray of a slot.
    pub(crate) fn ray_idx(&self, slot: usize) -> Option<usize> {
        let idx = *self.ray_idx.get(slot)?;
        (idx != NO_RAY).then_some(idx as usize)
    }

    /// Bytes held.
    pub(crate) fn memory_usage(&self) -> usize {
        self.ray_idx.capacity() * size_of::<u32>()
    }

    fn assign_image(&mut self, image: Image) {
        let (columns, rows) = (image.width.div_ceil(TILE_EDGE), image.height.div_ceil(TILE_EDGE));
        let mut tiles: Vec<_> = (0..rows).flat_map(|y| (0..columns).map(move |x| (x, y))).collect();
        tiles.sort_by_cached_key(|&(x, y)| interleave(x) | (interleave(y) << 1));
        for (x, y) in tiles {
            for place in 0..TILE_RAYS {
                let [column, row] = place_in_tile(place);
                let pixel = (x * TILE_EDGE + column, y * TILE_EDGE + row);
                self.ray_idx.push(image.ray_at(pixel).map_or(NO_RAY, |idx| idx as u32));
            }
        }
    }
}

/// Column and row in a tile of 8 x 8: places follow a Morton curve.
pub(crate) const fn place_in_tile(place: usize) -> [usize; 2] {
    const fn every_other(bits: usize) -> usize {
        (bits & 1) | ((bits >> 1) & 2) | ((bits >> 2) & 4)
    }
    [every_other(place), every_other(place >> 1)]
}

/// The pixels of an image batch.
#[derive(Clone, Copy)]
struct Image {
    width: usize,
    height: usize,
    tile: usize,
}

impl Image {
    /// Where in the batch the ray of a pixel is.
    fn ray_at(&self, (x, y): (usize, usize)) -> Option<usize> {
        if x >= self.width || y >= self.height {
            return None;
        }
        // Row by row is one tile that holds all.
        let tile = if self.tile == 0 { self.width.max(self.height) } else { self.tile };
        let (left, top) = (x / tile * tile, y / tile * tile);
        let (tile_width, tile_height) = (tile.min(self.width - left), tile.min(self.height - top));
        Some(top * self.width + left * tile_height + (y - top) * tile_width + (x - left))
    }
}

/// The lower half of the bits, each followed by a zero.
fn interleave(number: usize) -> u64 {
    let mut bits = number as u64 & 0xffff_ffff;
    for shift in [16, 8, 4, 2, 1] {
        let mask = u64::MAX / ((1 << shift) + 1);
        bits = (bits | (bits << shift)) & mask;
    }
    bits
}

impl Run {
    /// Takes the rays from `first_slot` on, at most [`RUN_SLOTS`]. `t_bound` tells beyond which
    /// hits are of no interest.
    pub(crate) fn fill(
        &mut self,
        batch: &RayBatch<'_>,
        slots: &Slots,
        first_slot: usize,
        t_bound: &(dyn Fn(usize) -> f32 + Sync),
    ) {
        self.first_slot = first_slot;
        let count = RUN_SLOTS.min(slots.len() - first_slot).next_multiple_of(TILE_RAYS);
        let take = |place: usize| match slots.ray_idx(first_slot + place) {
            Some(ray_idx) => take_ray(batch, ray_idx, place as u32, t_bound(ray_idx)),
            None => (DeviceRay::IDLE, 0),
        };
        self.rays.resize(count, DeviceRay::IDLE);
        let places = self.rays.par_iter_mut().enumerate().with_min_len(TILE_RAYS);
        let invalid = places.map(|(place, ray)| {
            let (taken, invalid) = take(place);
            *ray = DeviceRay { slot: place as u32, ..taken };
            invalid
        });
        self.invalid_count = invalid.sum();
        self.hits.clear();
        self.hits.extend(self.rays.iter().map(|ray| DeviceHit::none_before(ray.t_max)));
    }

    /// Bytes held.
    pub(crate) fn memory_usage(&self) -> usize {
        self.rays.capacity() * size_of::<DeviceRay>()
            + self.hits.capacity() * size_of::<DeviceHit>()
    }

    /// The places that hold a ray, with its position in the batch.
    pub(crate) fn ray_places<'a>(
        &'a self,
        slots: &'a Slots,
    ) -> impl Iterator<Item = (usize, usize)> + 'a {
        let slot_of = |place| slots.ray_idx(self.first_slot + place);
        (0..self.rays.len()).filter_map(move |place| Some((place, slot_of(place)?)))
    }
}

/// A ray for the device, which knows no infinity, and whether it counts as invalid.
fn take_ray(batch: &RayBatch<'_>, ray_idx: usize, slot: u32, t_bound: f32) -> (DeviceRay, u64) {
    let ray = batch.ray(ray_idx);
    let t_max = ray.t_max.min(t_bound).min(f32::MAX);
    let t_min = ray.t_min.max(f32::MIN);
    match ray.state() {
        RayState::Active if t_min <= t_max && ray.mask != 0 => {
            let (origin, direction) = (ray.origin.to_array(), ray.direction.to_array());
            let device_ray = DeviceRay {
                origin,
                t_min,
                direction,
                t_max,
                mask: ray.mask,
                slot,
                ..DeviceRay::IDLE
            };
            (device_ray, 0)
        }
        RayState::Active | RayState::Inactive => (DeviceRay::IDLE, 0),
        RayState::Invalid => (DeviceRay::IDLE, 1),
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    /// Each ray of an image lies in one slot, next to its neighbours.
    #[test]
    fn tiles_of_images_hold_each_ray_once() {
        for (width, height, tile) in [(20, 13, 0), (20, 13, 8), (9, 30, 4), (8, 8, 0), (1, 1, 3)] {
            let rays = vec![Vec3::X; width * height];
            let batch = RayBatch::new(Vec3::ZERO, &rays).unwrap();
            let mut slots = Slots::default();
            slots.assign(&batch.with_order(RayOrder::Image { width, height, tile }));
            let mut found: Vec<_> = (0..slots.len()).filter_map(|s| slots.ray_idx(s)).collect();
            found.sort_unstable();
            assert!(found.into_iter().eq(0..width * height), "{width} x {height}, {tile}");
        }
    }

    #[test]
    fn rows_and_tiles_of_an_image_tell_the_same_pixels_apart() {
        let image = Image { width: 10, height: 9, tile: 0 };
        assert_eq!(image.ray_at((3, 2)), Some(23));
        let tiled = Image { tile: 8, ..image };
        // The second tile of the first row of tiles is two pixels wide.
        assert_eq!(tiled.ray_at((8, 1)), Some(64 + 2));
        assert_eq!(tiled.ray_at((3, 8)), Some(80 + 3));
        assert_eq!(tiled.ray_at((10, 0)), None);
    }

    #[test]
    fn wrong_sizes_are_taken_for_rays_in_order() {
        let rays = [Vec3::X; 5];
        let batch = RayBatch::new(Vec3::ZERO, &rays[..]).unwrap();
        for order in
            [RayOrder::Image { width: usize::MAX, height: 2, tile: 0 }, RayOrder::Unordered]
        {
            let mut slots = Slots::default();
            slots.assign(&batch.with_order(order));
            assert_eq!((slots.len(), slots.ray_idx(4), slots.ray_idx(5)), (5, Some(4), None));
        }
    }
}
