//! Refracted rays of the next bounce.

use glam::Vec3;
use rayflock_scene::Material;

use super::mirror_rays::is_worth_following;
use crate::shading::sampling::Turn;
use crate::shading::scatter::Scatter;
use crate::shading::surface_point::SurfacePoint;
use crate::wave::{Path, Wave};

/// Adds the ray that `path` takes when it passes through the surface at `point`.
///
/// Whether it enters or leaves the solid is told by the side that was hit, so meshes of glass
/// must be closed and wound outward; solids inside solids are left into air.
#[inline]
pub(crate) fn refraction_ray(
    point: &SurfacePoint,
    material: &Material,
    scatter: &Scatter,
    path: &Path,
    wave: &mut Wave,
) {
    let weight = path.weight * scatter.transmission;
    if !is_worth_following(weight) {
        return;
    }
    let absorption = if point.from_outside { material.absorption } else { Vec3::ZERO };
    let path = Path { weight, absorption, seed: path.seed.after(Turn::Refraction), ..*path };
    wave.push(point.below(), scatter.refraction_direction, path);
}
