//! Arranges the rays of a batch into ray tiles of sixteen that are close in space.
//!
//! ```text
//!   Image       tiles of 4 x 4 pixels along a Morton curve     code = Morton code of the tile
//!   Coherent    sixteen consecutive rays                       code = number of the tile
//!   otherwise   sorted by direction and origin, then sixteen   code = number of the tile
//!               consecutive rays
//! ```
//!
//! Tiles whose codes agree but for the last two bits share a parent, and so on upward.

use std::sync::atomic::{AtomicU32, Ordering};

use rayflock_geom::simd::LANES;
use rayflock_geom::{Ray, RayBatch, RayOrder, RayState};
use rayon::prelude::*;
use tracing::debug_span;

use super::sort_rays::RaySorter;

/// Stands for a place in a tile without a ray.
pub(super) const NO_RAY: u32 = u32::MAX;

/// Rays whose places one task notes at least.
const RAYS_PER_TASK: usize = 4096;

/// Pixels along the side of an image tile.
pub(super) const TILE_SIDE: usize = 4;

/// The ray at a place, if there is one and it is active.
pub(super) fn active_ray(batch: &RayBatch<'_>, ray_idx: u32) -> Option<Ray> {
    let ray = (ray_idx != NO_RAY).then(|| batch.ray(ray_idx as usize))?;
    (ray.state() == RayState::Active).then_some(ray)
}

/// Which ray lies where.
#[derive(Debug, Default)]
pub(super) struct Arrangement {
    /// Positions in the batch, sixteen a tile; [`NO_RAY`] for places without a ray.
    pub(super) ray_idx: Vec<u32>,
    /// One a tile, strictly increasing.
    pub(super) codes: Vec<u32>,
    /// The place of each ray; empty where rays lie in the order of the batch.
    places: Vec<AtomicU32>,
    /// What the arrangement was made for, when it depends on nothing else.
    made_for: Option<(usize, RayOrder)>,
    sorter: RaySorter,
}

/// The pixels of an image batch and where its rays lie.
#[derive(Clone, Copy)]
pub(super) struct Image {
    pub(super) width: usize,
    pub(super) height: usize,
    pub(super) tile: usize,
}

impl Arrangement {
    /// Arranges the rays of `batch`. An image of the same size as before is not arranged anew.
    pub(super) fn assign(&mut self, batch: &RayBatch<'_>) {
        let _span = debug_span!("arrange").entered();
        let order = effective_order(batch);
        let key = (batch.len(), order);
        if self.made_for == Some(key) {
            return;
        }
        self.ray_idx.clear();
        self.codes.clear();
        self.places.clear();
        match order {
            RayOrder::Image { width, height, tile } => {
                self.arrange_image(Image { width, height, tile });
            }
            RayOrder::Coherent => self.arrange_in_order(0..batch.len() as u32),
            RayOrder::Groups(_) | RayOrder::Unordered => {
                let mut sorter = std::mem::take(&mut self.sorter);
                self.arrange_in_order(sorter.sort(batch).iter().copied());
                self.sorter = sorter;
            }
        }
        if order != RayOrder::Coherent {
            self.find_places(batch.len());
        }
        let depends_on_rays = matches!(order, RayOrder::Groups(_) | RayOrder::Unordered);
        self.made_for = (!depends_on_rays).then_some(key);
    }

    /// Where a ray of the batch lies.
    #[inline(always)]
    pub(super) fn place(&self, ray_idx: usize) -> usize {
        self.places.get(ray_idx).map_or(ray_idx, |place| place.load(Ordering::Relaxed) as usize)
    }

    /// Positions in the batch of a tile's rays.
    pub(super) fn tile(&self, tile_idx: usize) -> &[u32] {
        &self.ray_idx[tile_idx * LANES..(tile_idx + 1) * LANES]
    }

    /// Sixteen rays a tile, in the given order.
    fn arrange_in_order(&mut self, rays: impl Iterator<Item = u32>) {
        self.ray_idx.extend(rays);
        let tile_count = self.ray_idx.len().div_ceil(LANES);
        self.ray_idx.resize(tile_count * LANES, NO_RAY);
        self.codes.extend(0..tile_count as u32);
    }

    /// Inverts `ray_idx`: each ray has one place, so tasks never write the same entry.
    fn find_places(&mut self, ray_count: usize) {
        self.places.resize_with(ray_count, AtomicU32::default);
        let rays = self.ray_idx.par_iter().enumerate().with_min_len(RAYS_PER_TASK);
        rays.for_each(|(place, &ray_idx)| {
            if ray_idx != NO_RAY {
                self.places[ray_idx as usize].store(place as u32, Ordering::Relaxed);
            }
        });
    }

    fn arrange_image(&mut self, image: Image) {
        let (columns, rows) = (image.width.div_ceil(TILE_SIDE), image.height.div_ceil(TILE_SIDE));
        let tiles = (0..rows).flat_map(|y| (0..columns).map(move |x| (x as u32, y as u32)));
        self.codes.extend(tiles.map(|(x, y)| spread_bits(x) | (spread_bits(y) << 1)));
        self.codes.sort_unstable();
        for &code in &self.codes {
            let (tile_x, tile_y) = (gather_bits(code) as usize, gather_bits(code >> 1) as usize);
            for lane in 0..LANES {
                let x = tile_x * TILE_SIDE + lane % TILE_SIDE;
                let y = tile_y * TILE_SIDE + lane / TILE_SIDE;
                self.ray_idx.push(image.ray_idx(x, y).unwrap_or(NO_RAY));
            }
        }
    }

    /// Bytes held.
    pub(super) fn memory_usage(&self) -> usize {
        4 * (self.ray_idx.capacity() + self.codes.capacity() + self.places.capacity())
            + self.sorter.memory_usage()
    }
}

/// The batch's hint, or `Coherent` where an image does not have as many pixels as there are
/// rays or a side is longer than 2^17.
fn effective_order(batch: &RayBatch<'_>) -> RayOrder {
    match batch.order() {
        RayOrder::Image { width, height, .. }
            if width.checked_mul(height) != Some(batch.len()) || width.max(height) > 1 << 17 =>
        {
            RayOrder::Coherent
        }
        order => order,
    }
}

impl Image {
    /// The pixels of a batch that is an image with several rows and columns.
    pub(super) fn of(batch: &RayBatch<'_>) -> Option<Self> {
        let RayOrder::Image { width, height, tile } = effective_order(batch) else { return None };
        (width > 1 && height > 1).then_some(Self { width, height, tile })
    }

    /// The ray of a pixel, or `None` outside the image.
    pub(super) fn ray_idx(self, x: usize, y: usize) -> Option<u32> {
        let Self { width, height, tile } = self;
        if x >= width || y >= height {
            return None;
        }
        if tile == 0 {
            return Some((y * width + x) as u32);
        }
        // Tiles at the right and lower border are cut off.
        let (left, top) = (x - x % tile, y - y % tile);
        let (tile_width, tile_height) = (tile.min(width - left), tile.min(height - top));
        let before = top * width + left * tile_height;
        Some((before + (y - top) * tile_width + (x - left)) as u32)
    }
}

/// Moves bit i of the lower half to bit 2i.
fn spread_bits(value: u32) -> u32 {
    let mut bits = value & 0xffff;
    bits = (bits | (bits << 8)) & 0x00ff_00ff;
    bits = (bits | (bits << 4)) & 0x0f0f_0f0f;
    bits = (bits | (bits << 2)) & 0x3333_3333;
    (bits | (bits << 1)) & 0x5555_5555
}

/// Moves bit 2i to bit i.
fn gather_bits(value: u32) -> u32 {
    let mut bits = value & 0x5555_5555;
    bits = (bits | (bits >> 1)) & 0x3333_3333;
    bits = (bits | (bits >> 2)) & 0x0f0f_0f0f;
    bits = (bits | (bits >> 4)) & 0x00ff_00ff;
    (bits | (bits >> 8)) & 0x0000_ffff
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    fn arrange(len: usize, order: RayOrder) -> Arrangement {
        let origins: Vec<_> =
            (0..len).map(|i| Vec3::new((i * 37 % 101) as f32, 0.0, 1.0)).collect();
        let batch = RayBatch::new(&origins, Vec3::Z).unwrap().with_order(order);
        let mut arrangement = Arrangement::default();
        arrangement.assign(&batch);
        arrangement
    }

    #[test]
    fn every_ray_has_exactly_one_place_under_any_hint() {
        let image = |width, height, tile| RayOrder::Image { width, height, tile };
        let hints = [
            image(30, 7, 0),
            image(30, 7, 8),
            image(7, 30, 5),
            image(210, 1, 4),
            image(9, 9, 0),
            image(usize::MAX, 2, 0),
            RayOrder::Coherent,
            RayOrder::Groups(0),
            RayOrder::Groups(7),
            RayOrder::Unordered,
        ];
        for hint in hints {
            let arrangement = arrange(210, hint);
            let mut places = arrangement.ray_idx.clone();
            places.retain(|&ray_idx| ray_idx != NO_RAY);
            places.sort_unstable();
            assert!(places.iter().copied().eq(0..210), "{hint:?}");
            assert_eq!(arrangement.ray_idx.len(), 16 * arrangement.codes.len());
            assert!(arrangement.codes.windows(2).all(|pair| pair[0] < pair[1]));
        }
    }

    #[test]
    fn image_tiles_are_four_by_four_pixels_whatever_the_storage() {
        for tile in [0, 4, 8] {
            let arrangement = arrange(16 * 8, RayOrder::Image { width: 16, height: 8, tile });
            let image = Image { width: 16, height: 8, tile };
            let second = &arrangement.ray_idx[16..32];
            let expected: Vec<_> =
                (0..16).map(|i| image.ray_idx(4 + i % 4, i / 4).unwrap()).collect();
            assert_eq!(second, expected, "storage tile {tile}");
        }
    }
}
