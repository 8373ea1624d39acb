//! Makes the rays of each kind, most of them from what the camera sees.
//!
//! | Kind | Starts at | Goes to | Order hint |
//! |---|---|---|---|
//! | primary | the camera | the middle of each pixel | image in tiles |
//! | pointshadow | the light | what the camera sees, up to just before it | image in tiles |
//! | dirshadow | what the camera sees | the sun | image in tiles |
//! | mirror | what the camera sees | mirrored at the triangle | image in tiles |
//! | diffuse | what the camera sees | by the cosine | unordered |
//! | orthographic | a level square | straight down | image in tiles |
//! | suns | what the camera sees | each of sixteen suns, a batch each | image in tiles |
//! | lidar | the scanner | 64 rows all around | image by rows |
//! | ao | what the camera sees, eight a place | by the cosine, up to a reach | groups of eight |
//!
//! All images are stored in tiles of 4 x 4 pixels, as a renderer stores them that traces tiles.
//! Hints say what such a renderer knows: shadow and mirror rays are as much an image as the
//! pixels they come from; of diffuse rays, neighbours share a place but no direction, for which
//! there is no word.
//!
//! Rays of pixels that see nothing are there, but switched off by an empty interval. Surfaces
//! count as two-sided: their normal is the one on the side that is seen.

mod camera_rays;
mod surface_points;

use std::f32::consts::TAU;

use rayflock::engine::RayEngine;
use rayflock::geom::{Geometry, RayOrder};
use rayflock::prelude::Vec3;
use rayon::prelude::*;

use super::random::Random;
use super::ray_set::{RaySet, Rays, Values};
use super::{RayKind, Surroundings};
use camera_rays::{camera_rays, image_order};
use surface_points::{SurfacePoint, surface_points};

/// Directions of [`RayKind::Suns`].
const SUN_COUNT: usize = 16;
/// Rays a place of [`RayKind::Ao`].
const AO_GROUP: usize = 8;
/// Rows of [`RayKind::Lidar`].
const LIDAR_ROWS: usize = 64;
/// An interval from 0 to here is empty.
const SWITCHED_OFF: f32 = -1.0;
/// The cosine from the zenith down to which there are suns.
const LOWEST_SUN: f32 = 0.3;

/// The size in pixels of an image of `count` rays: the squarest of them, up to twice as wide as
/// high; where there is none, the nearest to a square of about as many.
pub fn image_size(count: usize) -> [usize; 2] {
    let side = (count as f64).sqrt();
    let widths = side.ceil().max(1.0) as usize..=(2.0 * side) as usize;
    let exact = widths.into_iter().find(|&width| count.is_multiple_of(width));
    if let Some(width) = exact.filter(|_| count > 0) {
        return [width, count / width];
    }
    let width = side.round().max(1.0);
    [width as usize, (count as f64 / width).round().max(1.0) as usize]
}

/// Makes the rays of `kind` for an image of `size` pixels: about as many rays as pixels. Of the
/// kinds with several rays a place the image is accordingly smaller.
///
/// `engine` must have committed `geometry`; it finds what the camera sees. Random directions
/// follow from `seed`.
pub fn generate(
    kind: RayKind,
    size: [usize; 2],
    surroundings: &Surroundings,
    geometry: &Geometry,
    engine: &mut dyn RayEngine,
    seed: u64,
) -> RaySet {
    let mut points = |size: [usize; 2]| surface_points(surroundings, size, geometry, engine);
    let parts = match kind {
        RayKind::Primary => vec![camera_rays(&surroundings.view, size)],
        RayKind::Orthographic => vec![camera_rays(&surroundings.from_above, size)],
        RayKind::Lidar => vec![lidar(surroundings, size[0] * size[1])],
        RayKind::PointShadow => vec![from_light(&points(size), size, surroundings)],
        RayKind::DirShadow => toward_suns(&points(size), size, &[surroundings.to_sun]),
        RayKind::Suns => {
            let size = image_size(size[0] * size[1] / SUN_COUNT);
            toward_suns(&points(size), size, &suns())
        }
        RayKind::Mirror => vec![mirrored(&points(size), size)],
        RayKind::Diffuse => vec![diffuse(&points(size), seed)],
        RayKind::Ao => {
            let size = image_size(size[0] * size[1] / AO_GROUP);
            vec![ambient(&points(size), surroundings.ao_reach, seed)]
        }
    };
    RaySet::new(kind, parts)
}

/// Rays around a scanner, row by row from the lowest.
fn lidar(surroundings: &Surroundings, count: usize) -> Rays {
    let columns = (count as f64 / LIDAR_ROWS as f64).round().max(1.0) as usize;
    let [low, high] = surroundings.lidar_elevation;
    let direction = |idx: usize| {
        let (row, column) = (idx / columns, idx % columns);
        let elevation = low + (high - low) * (row as f32 / (LIDAR_ROWS - 1) as f32);
        let (sin, cos) = (TAU * (column as f32 + 0.5) / columns as f32).sin_cos();
        Vec3::new(elevation.cos() * cos, elevation.sin(), elevation.cos() * sin)
    };
    Rays {
        origin: Values::Uniform(surroundings.lidar),
        direction: (0..LIDAR_ROWS * columns).map(direction).collect(),
        t_max: Values::Uniform(f32::INFINITY),
        order: RayOrder::Image { width: columns, height: LIDAR_ROWS, tile: 0 },
    }
}

/// Rays from the point light to just before each point.
fn from_light(points: &[SurfacePoint], size: [usize; 2], surroundings: &Surroundings) -> Rays {
    let light = surroundings.point_light;
    Rays {
        origin: Values::Uniform(light),
        direction: points.iter().map(|point| point.position - light).collect(),
        t_max: reach(points, surroundings.shadow_end),
        order: image_order(size),
    }
}

/// Rays from all points to each sun.
fn toward_suns(points: &[SurfacePoint], size: [usize; 2], suns: &[Vec3]) -> Vec<Rays> {
    let (origin, t_max) = (origins(points), reach(points, f32::INFINITY));
    let order = image_order(size);
    let rays = |&sun: &Vec3| Rays {
        origin: origin.clone(),
        direction: Values::Uniform(sun),
        t_max: t_max.clone(),
        order,
    };
    suns.iter().map(rays).collect()
}

/// Directions spread over the upper part of the sky: a spiral of golden angles.
fn suns() -> [Vec3; SUN_COUNT] {
    let golden = TAU * (2.0 - 1.618_034);
    std::array::from_fn(|idx| {
        let share = (idx as f32 + 0.5) / SUN_COUNT as f32;
        let (height, angle) = (1.0 + (LOWEST_SUN - 1.0) * share, golden * idx as f32);
        let radius = (1.0 - height * height).sqrt();
        Vec3::new(radius * angle.cos(), height, radius * angle.sin())
    })
}

fn mirrored(points: &[SurfacePoint], size: [usize; 2]) -> Rays {
    Rays {
        origin: origins(points),
        direction: points.iter().map(|point| point.incoming.reflect(point.normal)).collect(),
        t_max: reach(points, f32::INFINITY),
        order: image_order(size),
    }
}

fn diffuse(points: &[SurfacePoint], seed: u64) -> Rays {
    let direction =
        |(idx, point): (usize, &SurfacePoint)| Random::of_item(seed, idx).around(point.normal);
    let directions: Vec<Vec3> = points.par_iter().enumerate().map(direction).collect();
    Rays {
        origin: origins(points),
        direction: Values::PerRay(directions.into()),
        t_max: reach(points, f32::INFINITY),
        order: RayOrder::Unordered,
    }
}

/// Eight rays a point, one after the other.
fn ambient(points: &[SurfacePoint], ao_reach: f32, seed: u64) -> Rays {
    let groups: Vec<SurfacePoint> =
        points.iter().flat_map(|point| std::iter::repeat_n(*point, AO_GROUP)).collect();
    Rays {
        t_max: reach(&groups, ao_reach),
        order: RayOrder::Groups(AO_GROUP),
        ..diffuse(&groups, seed)
    }
}

fn origins(points: &[SurfacePoint]) -> Values<Vec3> {
    points.iter().map(|point| point.start).collect()
}

/// The end of each ray's interval; one value where all points are there.
fn reach(points: &[SurfacePoint], t_max: f32) -> Values<f32> {
    if points.iter().all(|point| point.is_there) {
        return Values::Uniform(t_max);
    }
    points.iter().map(|point| if point.is_there { t_max } else { SWITCHED_OFF }).collect()
}

#[cfg(test)]
mod tests;
