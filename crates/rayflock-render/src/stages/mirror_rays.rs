//! Mirrored rays of the next bounce.

use glam::Vec3;
use rayflock_scene::Material;

use crate::shading::sampling::Turn;
use crate::shading::scatter::Scatter;
use crate::shading::surface_point::SurfacePoint;
use crate::wave::{Path, Wave};

/// A path whose weight is below this in every colour is not followed: even a light a hundred
/// times as bright as white paper would then add less than a twentieth to a pixel.
pub(crate) const MIN_WEIGHT: f32 = 1.0 / 2048.0;

/// Whether a path of this weight can still be seen.
pub(crate) fn is_worth_following(weight: Vec3) -> bool {
    weight.max_element() >= MIN_WEIGHT
}

/// Adds the ray that `path` takes when it is mirrored at `point`.
///
/// On the inside of a transmitting solid the path stays in that solid; elsewhere it stays in
/// whatever it was in.
#[inline]
pub(crate) fn mirror_ray(
    point: &SurfacePoint,
    material: &Material,
    scatter: &Scatter,
    path: &Path,
    wave: &mut Wave,
) {
    let weight = path.weight * scatter.mirror;
    if !is_worth_following(weight) {
        return;
    }
    let is_inside = !point.from_outside && material.transmission != Vec3::ZERO;
    let absorption = if is_inside { material.absorption } else { path.absorption };
    let seed = path.seed.after(Turn::Mirror);
    wave.push(point.above(), scatter.mirror_direction, Path { weight, absorption, seed, ..*path });
}
