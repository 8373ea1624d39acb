//! First stage: one ray through each pixel of a band of rows.
//!
//! A pinhole camera's rays share their origin, an orthographic camera's their direction. Rays
//! come in square tiles of [`TILE`] pixels a side, cropped at the right and the bottom, so that
//! neighbours in the array are neighbours in both directions of the picture; later bounces keep
//! that order.

use std::ops::Range;

use glam::{Vec2, Vec3};
use rayflock_geom::RayOrder;
use rayon::prelude::*;
use tracing::debug_span;

use crate::shading::sampling::{PathSeed, subpixel};
use crate::wave::{Path, Shared, Wave};
use crate::{Lens, View};

/// Pixels along the side of a tile.
pub(crate) const TILE: usize = 8;

/// Fills `wave` with a ray through each pixel of `rows`, at position `sample_idx` of the pixel's
/// samples, for a film of `width` times `height` pixels.
pub(crate) fn camera_rays(
    view: &View,
    (width, height): (usize, usize),
    rows: Range<usize>,
    sample_idx: u32,
    wave: &mut Wave,
) {
    let _span = debug_span!("camera_rays").entered();
    let count = width * rows.len();
    wave.clear(0);
    wave.order = RayOrder::Image { width, height: rows.len(), tile: TILE };
    wave.paths.resize(count, Path::NEW);
    let position = subpixel(sample_idx);
    let tile_row = (TILE * width).max(1);
    let lens = Lens::new(view, width, height);

    let per_ray = match lens {
        Lens::Pinhole { origin, .. } => {
            wave.shared = Shared::Origin(origin);
            &mut wave.directions
        }
        Lens::Parallel { direction, .. } => {
            wave.shared = Shared::Direction(direction);
            &mut wave.origins
        }
    };
    per_ray.resize(count, Vec3::ZERO);
    let tile_rows = per_ray.par_chunks_mut(tile_row).zip(wave.paths.par_chunks_mut(tile_row));
    tile_rows.enumerate().for_each(|(tile_y, (values, paths))| {
        let first = tile_y * TILE;
        let pixels = tiled_pixels(width, values.len() / width);
        for ((x, y), (value, path)) in pixels.zip(values.iter_mut().zip(paths)) {
            let (y_in_band, y_in_film) = (first + y, rows.start + first + y);
            *value = lens.value(Vec2::new(x as f32, y_in_film as f32) + position);
            path.pixel_idx = (y_in_band * width + x) as u32;
            path.seed = PathSeed::of_pixel(x, y_in_film);
        }
    });
}

/// The pixels of one row of tiles, tile by tile, `row_count` rows high.
fn tiled_pixels(width: usize, row_count: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..width).step_by(TILE).flat_map(move |left| {
        let columns = left..(left + TILE).min(width);
        (0..row_count).flat_map(move |y| columns.clone().map(move |x| (x, y)))
    })
}

#[cfg(test)]
mod tests {
    use glam::Affine3A;
    use rayflock_scene::Projection;

    use super::*;

    fn rays(projection: Projection, size: (usize, usize), rows: Range<usize>) -> Wave {
        let mut wave = Wave::default();
        camera_rays(&View::new(Affine3A::IDENTITY, projection), size, rows, 0, &mut wave);
        wave
    }

    /// Direction and origin of the ray through each pixel, by rows.
    fn by_pixel(wave: &Wave) -> Vec<(Vec3, Vec3)> {
        let mut rays = vec![(Vec3::ZERO, Vec3::ZERO); wave.len()];
        for (ray_idx, path) in wave.paths.iter().enumerate() {
            let ray = wave.batch().ray(ray_idx);
            rays[path.pixel_idx as usize] = (ray.direction, ray.origin);
        }
        rays
    }

    #[test]
    fn a_pinhole_looks_along_minus_z_with_y_up_and_x_right() {
        let vertical_fov = std::f32::consts::FRAC_PI_2;
        let wave = rays(Projection::Perspective { vertical_fov }, (5, 3), 0..3);
        let rays = by_pixel(&wave);
        assert!((rays[7].0 - Vec3::NEG_Z).length() < 1e-6);
        // Pixel centres lie a third of the picture's height apart; the plane at -1 is 2 high.
        let corner = Vec3::new(-4.0 / 3.0, 2.0 / 3.0, -1.0).normalize();
        assert!((rays[0].0 - corner).length() < 1e-6);
        assert_eq!(wave.batch().origin().uniform(), Some(Vec3::ZERO));
    }

    #[test]
    fn an_orthographic_camera_shares_its_direction() {
        let wave = rays(Projection::Orthographic { height: 6.0 }, (5, 3), 0..3);
        assert_eq!(wave.batch().direction().uniform(), Some(Vec3::NEG_Z));
        let rays = by_pixel(&wave);
        assert!((rays[0].1 - Vec3::new(-4.0, 2.0, 0.0)).length() < 1e-5);
    }

    #[test]
    fn every_pixel_has_its_ray_and_a_band_is_a_part_of_the_whole() {
        let projection = Projection::Perspective { vertical_fov: 0.8 };
        let whole = by_pixel(&rays(projection, (21, 19), 0..19));
        assert!(whole.iter().all(|(direction, _)| (direction.length() - 1.0).abs() < 1e-5));
        let band = by_pixel(&rays(projection, (21, 19), 8..19));
        assert_eq!(band, whole[8 * 21..]);
    }

    #[test]
    fn rays_come_in_tiles() {
        let wave = rays(Projection::Perspective { vertical_fov: 0.8 }, (20, 16), 0..16);
        assert_eq!(wave.paths[8].pixel_idx, 20);
        assert_eq!(wave.paths[TILE * TILE].pixel_idx, 8);
    }
}
