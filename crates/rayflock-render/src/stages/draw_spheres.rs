//! The spheres that stand for geometry, drawn over a picture.

use glam::Vec3;
use rayflock_geom::simd::segment_spheres::SoftSphere;
use rayon::prelude::*;

use super::camera_rays::camera_rays;
use crate::wave::Wave;
use crate::{Film, View};

/// How far the picture is dimmed.
const DIMMED: f32 = 0.25;

/// How much of the light of the picture a sphere takes away at least, so that it can be seen.
const FAINTEST: f32 = 0.1;

/// Dims `film` and draws the nearest of `spheres` at each pixel, the middle as dense as it takes
/// light away and less dense toward the rim.
pub(crate) fn draw_spheres(spheres: &[SoftSphere], view: &View, film: &mut Film) {
    let (size, mut wave) = ((film.width(), film.height()), Wave::default());
    camera_rays(view, size, 0..size.1, 0, &mut wave);
    let batch = wave.batch();
    let drawn: Vec<(u32, Vec3, f32)> = (0..wave.len())
        .into_par_iter()
        .filter_map(|ray_idx| {
            let ray = batch.ray(ray_idx);
            let direction = ray.direction.normalize_or_zero();
            let hits = spheres.iter().enumerate().filter_map(|(sphere_idx, sphere)| {
                let near = entry(sphere, ray.origin, direction)?;
                Some((near, sphere_idx))
            });
            let (near, sphere_idx) = hits.min_by(|a, b| a.0.total_cmp(&b.0))?;
            let sphere = &spheres[sphere_idx];
            let shade = facing(sphere, ray.origin + near * direction, direction);
            let density = dimming(sphere, ray.origin, direction).max(FAINTEST);
            let pixel_idx = wave.paths[ray_idx].pixel_idx;
            Some((pixel_idx, color_of(sphere_idx) * (0.3 + 0.7 * shade), density))
        })
        .collect();
    film.pixels_mut().iter_mut().flatten().for_each(|channel| *channel *= DIMMED);
    for (pixel_idx, color, density) in drawn {
        let pixel = &mut film.pixels_mut()[pixel_idx as usize];
        *pixel = Vec3::from(*pixel).lerp(color, density).to_array();
    }
}

/// A vector in a space where the sphere is round.
fn rounded(sphere: &SoftSphere, vector: Vec3) -> Vec3 {
    let axis = sphere.flatness.normalize_or_zero();
    let times = (1.0 + sphere.flatness.length_squared()).sqrt();
    vector + (times - 1.0) * axis.dot(vector) * axis
}

/// Where along a ray the nearest point to the centre lies, and its squared distance, as lengths
/// count for the sphere.
fn nearest(sphere: &SoftSphere, origin: Vec3, direction: Vec3) -> (f32, f32, f32) {
    let (offset, way) = (rounded(sphere, sphere.center - origin), rounded(sphere, direction));
    let squared = way.length_squared();
    let along = offset.dot(way) / squared;
    (along, (offset - along * way).length_squared(), squared)
}

/// Where a ray with unit `direction` enters the sphere.
fn entry(sphere: &SoftSphere, origin: Vec3, direction: Vec3) -> Option<f32> {
    let (along, distance_squared, squared) = nearest(sphere, origin, direction);
    let half_squared = (sphere.outer * sphere.outer - distance_squared) / squared;
    let near = along - half_squared.max(0.0).sqrt();
    (half_squared > 0.0 && near > 0.0).then_some(near)
}

/// The share of light that is taken from a ray.
fn dimming(sphere: &SoftSphere, origin: Vec3, direction: Vec3) -> f32 {
    let (_, distance_squared, _) = nearest(sphere, origin, direction);
    let (inner, outer) = (sphere.inner * sphere.inner, sphere.outer * sphere.outer);
    let share = (outer - distance_squared) / (outer - inner).max(f32::MIN_POSITIVE);
    sphere.opacity * share.clamp(0.0, 1.0)
}

/// The cosine at which a ray with unit `direction` meets the sphere at `point`.
fn facing(sphere: &SoftSphere, point: Vec3, direction: Vec3) -> f32 {
    // Normals go the other way: flattening a sphere turns them toward the axis.
    let normal = rounded(sphere, rounded(sphere, point - sphere.center));
    -direction.dot(normal.normalize_or_zero())
}

/// A colour that neighbours in the list do not have.
fn color_of(sphere_idx: usize) -> Vec3 {
    /// The golden ratio's part of a turn brings each hue far from those before.
    const TURN: f32 = 0.618_034;
    let hue = 6.0 * (sphere_idx as f32 * TURN).fract();
    let channel = |shift: f32| ((((hue + shift) % 6.0) - 3.0).abs() - 1.0).clamp(0.05, 1.0);
    0.8 * Vec3::new(channel(0.0), channel(4.0), channel(2.0))
}

#[cfg(test)]
mod tests {
    use glam::Affine3A;
    use rayflock_scene::Projection;

    use super::*;

    #[test]
    fn spheres_are_where_they_are_and_discs_are_flat() {
        let round = SoftSphere {
            center: Vec3::new(0.0, 0.0, -4.0),
            inner: 0.9,
            outer: 1.0,
            opacity: 1.0,
            flatness: Vec3::ZERO,
        };
        let flat = SoftSphere { flatness: 7.0 * Vec3::Y, ..round };
        let view = View::new(Affine3A::IDENTITY, Projection::Orthographic { height: 4.0 });
        let drawn = |sphere: SoftSphere| {
            let mut film = Film::new(40, 40);
            film.pixels_mut().fill([1.0; 3]);
            draw_spheres(&[sphere], &view, &mut film);
            let is_drawn = |pixel: &&[f32; 3]| **pixel != [DIMMED; 3];
            film.pixels().iter().filter(is_drawn).count()
        };
        // Ten pixels a unit of length: pi r^2, and an eighth of that or so.
        let (round, flat) = (drawn(round), drawn(flat));
        assert!((300..330).contains(&round), "{round}");
        assert!((30..60).contains(&flat), "{flat}");
    }
}
