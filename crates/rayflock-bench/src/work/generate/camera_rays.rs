//! One ray through the middle of each pixel, in tiles of 4 x 4 pixels.

use rayflock::geom::RayOrder;
use rayflock::prelude::{Vec3, View};
use rayflock::scene::Projection;

use super::super::ray_set::{Rays, Values};

/// Pixels along the side of a tile.
const TILE: usize = 4;

/// The order of rays that stand for the pixels of an image.
pub(super) const fn image_order([width, height]: [usize; 2]) -> RayOrder {
    RayOrder::Image { width, height, tile: TILE }
}

/// The rays of a camera. Directions have unit length.
pub(super) fn camera_rays(view: &View, size: [usize; 2]) -> Rays {
    let axis = |v: Vec3| view.world_from_camera.transform_vector3(v);
    let eye = Vec3::from(view.world_from_camera.translation);
    let (right, up, ahead) = (axis(Vec3::X), axis(Vec3::Y), axis(Vec3::NEG_Z));
    let [width, height] = size.map(|pixels| pixels as f32);
    // Offset from the middle of the picture, in pictures' heights.
    let film = |[x, y]: [usize; 2]| {
        let (x, y) = (x as f32 + 0.5 - 0.5 * width, 0.5 * height - y as f32 - 0.5);
        (right * x + up * y) / height
    };
    let (origin, direction) = match view.projection {
        Projection::Perspective { vertical_fov } => {
            let film_height = 2.0 * (0.5 * vertical_fov).tan();
            let through = |pixel| (ahead + film(pixel) * film_height).normalize_or(ahead);
            (Values::Uniform(eye), tiled_pixels(size).map(through).collect())
        }
        Projection::Orthographic { height: film_height } => {
            let place = |pixel| eye + film(pixel) * film_height;
            (tiled_pixels(size).map(place).collect(), Values::Uniform(ahead.normalize_or(ahead)))
        }
    };
    Rays { origin, direction, t_max: Values::Uniform(f32::INFINITY), order: image_order(size) }
}

/// The pixels of an image, tile by tile; tiles are cut off at the right and the bottom.
fn tiled_pixels([width, height]: [usize; 2]) -> impl Iterator<Item = [usize; 2]> {
    let tiles = (0..height)
        .step_by(TILE)
        .flat_map(move |top| (0..width).step_by(TILE).map(move |left| [left, top]));
    tiles.flat_map(move |[left, top]| {
        let columns = left..(left + TILE).min(width);
        (top..(top + TILE).min(height)).flat_map(move |y| columns.clone().map(move |x| [x, y]))
    })
}

#[cfg(test)]
mod tests {
    use rayflock::prelude::Affine3A;

    use super::*;

    fn rays(projection: Projection, size: [usize; 2]) -> Vec<(Vec3, Vec3)> {
        let view = View::new(Affine3A::from_translation(Vec3::Y), projection);
        let rays = camera_rays(&view, size);
        let batch = rays.batch();
        (0..batch.len()).map(|idx| (batch.ray(idx).origin, batch.ray(idx).direction)).collect()
    }

    #[test]
    fn pixels_come_in_tiles_of_four_by_four_cut_off_at_the_ends() {
        let pixels: Vec<_> = tiled_pixels([10, 6]).collect();
        assert_eq!(pixels[..6], [[0, 0], [1, 0], [2, 0], [3, 0], [0, 1], [1, 1]]);
        assert_eq!(pixels[16], [4, 0]);
        assert_eq!(pixels[32..36], [[8, 0], [9, 0], [8, 1], [9, 1]]);
        assert_eq!(pixels[40], [0, 4]);
        let mut sorted = pixels.clone();
        sorted.sort_unstable();
        sorted.dedup();
        assert_eq!((pixels.len(), sorted.len()), (60, 60));
    }

    #[test]
    fn a_pinhole_looks_along_minus_z_with_y_up_and_x_right() {
        let vertical_fov = std::f32::consts::FRAC_PI_2;
        let rays = rays(Projection::Perspective { vertical_fov }, [8, 4]);
        // Middles of pixels lie half a unit apart on a film that is 2 high, 1 away.
        let expected = Vec3::new(-1.75, 0.75, -1.0).normalize();
        assert!(rays[0].1.abs_diff_eq(expected, 1e-6), "{:?}", rays[0]);
        assert!(rays[31].1.abs_diff_eq(Vec3::new(1.75, -0.75, -1.0).normalize(), 1e-6));
        assert!(rays.iter().all(|&(origin, _)| origin == Vec3::Y));
    }

    #[test]
    fn an_orthographic_camera_has_one_direction() {
        let rays = rays(Projection::Orthographic { height: 4.0 }, [4, 4]);
        assert!(rays.iter().all(|&(_, direction)| direction == -Vec3::Z));
        assert!(rays[0].0.abs_diff_eq(Vec3::new(-1.5, 2.5, 0.0), 1e-6));
        assert!(rays[15].0.abs_diff_eq(Vec3::new(1.5, -0.5, 0.0), 1e-6));
    }
}
