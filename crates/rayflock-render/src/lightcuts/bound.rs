//! What a cluster of lights sends to a point: about, and at most.
//!
//! ```text
//!   intensities . cosine at the light . (diffuse . cosine at the point + specular) / pi / distance^2
//! ```
//!
//! each factor at its largest over the box around the lights and the cone of their normals. Of
//! distant lights, irradiance stands in place of all that depends on the distance.

use std::f32::consts::FRAC_1_PI;

use glam::Vec3;

use super::light_tree::LightCluster;
use crate::shading::luminance::luminance;
use crate::shading::scatter::reflected;
use crate::vpl::VirtualLights;

/// Covers the rounding of bounds and of what they bound.
const ROUNDING: f32 = 1.0 + 1e-4;

/// A point that is lit, with all that its radiance depends on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CutPoint {
    /// Off the surface by more than rounding.
    pub position: Vec3,
    /// Of unit length, on the side that is seen.
    pub normal: Vec3,
    /// Toward the viewer, of unit length.
    pub to_viewer: Vec3,
    /// Share of the irradiance that is scattered evenly.
    pub diffuse: Vec3,
    /// Strength of the highlight.
    pub specular: Vec3,
    /// Exponent of the highlight.
    pub shininess: f32,
}

/// Geometry terms (both cosines over the squared distance) above this count as this, so that no
/// light is too bright.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct GeometryBound(pub(super) f32);

/// The radiance from all lights of a cluster, were each where its representative is and nothing in
/// the way.
pub(super) fn estimate(
    lights: &VirtualLights,
    cluster: &LightCluster,
    point: &CutPoint,
    limit: GeometryBound,
) -> Vec3 {
    let light_idx = cluster.light_idx as usize;
    if lights.is_distant(light_idx) {
        return cluster.intensity * reflected_toward(point, lights.positions()[light_idx]);
    }
    let offset = lights.positions()[light_idx] - point.position;
    let to_light = offset.normalize_or_zero();
    let light = lights.get(light_idx);
    let cos_light = (light.evenness - light.normal.dot(to_light)).max(0.0);
    let sent = match lights.lobe(light_idx) {
        None => cluster.intensity * cos_light,
        Some(lobe) => {
            let all = light.intensity + lobe.highlight;
            let per_intensity = lights.intensity_toward(light_idx, -to_light) / all;
            let is_there = all.cmpgt(Vec3::ZERO);
            cluster.intensity * Vec3::select(is_there, per_intensity, Vec3::ZERO)
        }
    };
    let squared = offset.length_squared().max(f32::MIN_POSITIVE);
    let geometry = point.normal.dot(to_light).max(0.0) * cos_light / squared;
    let kept = if geometry > limit.0 { limit.0 / geometry } else { 1.0 };
    sent * reflected_toward(point, to_light) * (kept / squared)
}

fn reflected_toward(point: &CutPoint, to_light: Vec3) -> Vec3 {
    let CutPoint { normal, to_viewer, diffuse, specular, shininess, .. } = *point;
    reflected(diffuse, specular, shininess, normal, to_viewer, to_light)
}

/// The largest luminance that the lights of a cluster can send to the viewer in all.
pub(super) fn bound(
    lights: &VirtualLights,
    cluster: &LightCluster,
    point: &CutPoint,
    limit: GeometryBound,
) -> f32 {
    let light_idx = cluster.light_idx as usize;
    if lights.is_distant(light_idx) {
        return bound_of_distant(cluster, point);
    }
    let (low, high) = (cluster.bounds.min - point.position, cluster.bounds.max - point.position);
    let height = (point.normal * low).max(point.normal * high).element_sum();
    if height <= 0.0 {
        return 0.0;
    }
    let nearest_squared = low.max(-high).max(Vec3::ZERO).length_squared();
    let cos = (height / nearest_squared.sqrt()).min(1.0);
    let at_light = match cos_at_light(cluster, point.position) {
        // They shine into highlights as well.
        cos if cos > 0.0 && lights.lobe(light_idx).is_some() => 1.0,
        cos => cos,
    };
    let at_light = at_light / nearest_squared.max(f32::MIN_POSITIVE);
    let reflected = point.diffuse * (cos * at_light).min(limit.0) + point.specular * at_light;
    ROUNDING * FRAC_1_PI * luminance(cluster.intensity * reflected)
}

/// The same of distant lights, whose directions lie in the box of the cluster.
fn bound_of_distant(cluster: &LightCluster, point: &CutPoint) -> f32 {
    let (low, high) = (point.normal * cluster.bounds.min, point.normal * cluster.bounds.max);
    let cos = low.max(high).element_sum().min(1.0);
    if cos <= 0.0 {
        return 0.0;
    }
    let reflected = point.diffuse * cos + point.specular;
    ROUNDING * FRAC_1_PI * luminance(cluster.intensity * reflected)
}

/// The largest cosine between a normal of the cluster and the way from a light to `point`.
fn cos_at_light(cluster: &LightCluster, point: Vec3) -> f32 {
    let offset = point - cluster.bounds.center();
    let (distance, radius) = (offset.length(), 0.5 * cluster.bounds.size().length());
    if cluster.cos <= -1.0 || distance <= radius {
        return 1.0;
    }
    // The half angle of the cone of ways, added to that of the normals.
    let way_sin = radius / distance;
    let way_cos = (1.0 - way_sin * way_sin).max(0.0).sqrt();
    let cos = cluster.cos * way_cos - cluster.sin * way_sin;
    let sin = cluster.sin * way_cos + cluster.cos * way_sin;
    let along = cluster.axis.dot(offset) / distance;
    if sin < 0.0 || along >= cos {
        return 1.0;
    }
    let across = (1.0 - along * along).max(0.0).sqrt();
    (along * cos + across * sin + 1e-5).clamp(0.0, 1.0)
}
