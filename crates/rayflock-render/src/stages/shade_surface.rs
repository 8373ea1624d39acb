//! Turns hits into light, lit points and further rays.
//!
//! What needs no shadow ray is ready here: emission, ambient light, and the background where a
//! ray hit nothing. The rest is left as points to be lit and as rays of the next bounce. Light is
//! absorbed along the ray first (Beer-Lambert); a ray that leaves a transmitting solid without
//! hitting its far side, because the mesh is open, is not absorbed.

use glam::Vec3;
use rayflock_geom::{HitBuffer, Ray, RayBatch};
use rayflock_scene::Background;
use tracing::debug_span;

use super::mirror_rays::mirror_ray;
use super::refraction_rays::refraction_ray;
use super::runs::begin_runs;
use crate::frame_shading::FrameShading;
use crate::lights::key_light::SKY_SHARE;
use crate::shading::background;
use crate::shading::scatter::{Scatter, scatter};
use crate::shading::surface_point::{SurfacePoint, surface_point};
use crate::wave::{Contribution, LitPoint, Path, ShadedRun, Wave};

/// What shading needs besides rays and hits.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Surroundings<'a> {
    /// The frame's objects, materials and lights.
    pub(crate) frame: &'a FrameShading,
    /// What rays that hit nothing see.
    pub(crate) background: Background,
    /// Whether the background lights surfaces, in place of lights that a scene does not have.
    pub(crate) sky_lights: bool,
    /// Whether light that was scattered before is traced, so that nothing stands for it.
    pub(crate) indirect: bool,
    /// Turns that a path may take.
    pub(crate) depth: u32,
}

impl Surroundings<'_> {
    /// The light from everywhere at a point with unit `normal`, as irradiance over pi.
    pub(crate) fn ambient(&self, normal: Vec3) -> Vec3 {
        if self.indirect {
            return Vec3::ZERO;
        }
        let sky = if self.sky_lights {
            SKY_SHARE * background::irradiance_over_pi(&self.background, normal)
        } else {
            Vec3::ZERO
        };
        self.frame.lights.ambient + sky
    }
}

/// Shades every ray of `wave`; `runs` holds the results in the order of the rays.
pub(crate) fn shade_surface(
    surroundings: &Surroundings<'_>,
    wave: &Wave,
    hits: &HitBuffer,
    runs: &mut Vec<ShadedRun>,
) {
    let _span = debug_span!("shade_surface").entered();
    let batch = wave.batch();
    begin_runs(wave, runs, |rays, run| {
        for ray_idx in rays {
            shade_ray(surroundings, wave, &batch, hits, ray_idx, run);
        }
    });
}

fn shade_ray(
    surroundings: &Surroundings<'_>,
    wave: &Wave,
    batch: &RayBatch<'_>,
    hits: &HitBuffer,
    ray_idx: usize,
    run: &mut ShadedRun,
) {
    let (ray, hit) = (batch.ray(ray_idx), hits.get(ray_idx));
    let mut path = wave.paths[ray_idx];
    let pixel_idx = path.pixel_idx;
    let frame = surroundings.frame;
    let Some(point) = surface_point(frame, &ray, &hit) else {
        let sky = background::radiance(&surroundings.background, ray.direction);
        run.unshadowed.push(Contribution { pixel_idx, radiance: path.weight * sky });
        return;
    };
    let length = ray.direction.length();
    if path.absorption != Vec3::ZERO {
        path.weight *= (-path.absorption * (hit.t * length)).exp();
    }

    // What the surface itself sends out, and what it makes of ambient light.
    let material = frame.material(point.material);
    let base = frame.base_color(&point);
    let mut scatter = scatter(material, &point, base, ray.direction / length);
    let mut highlight = material.specular;
    if surroundings.indirect {
        scatter.conserve(&mut highlight, material.shininess);
    }
    let ambient = scatter.ambient * surroundings.ambient(point.normal);
    let radiance = path.weight * (material.emission + ambient);
    if radiance != Vec3::ZERO {
        run.unshadowed.push(Contribution { pixel_idx, radiance });
    }

    // What lights may add, and where the path goes on.
    push_lit_point((&scatter, highlight, material.shininess), &point, &path, &ray, run);
    if wave.bounce < surroundings.depth {
        mirror_ray(&point, material, &scatter, &path, &mut run.mirror);
        refraction_ray(&point, material, &scatter, &path, &mut run.refraction);
    }
}

fn push_lit_point(
    (scatter, highlight, shininess): (&Scatter, Vec3, f32),
    point: &SurfacePoint,
    path: &Path,
    ray: &Ray,
    run: &mut ShadedRun,
) {
    let (diffuse, specular) = (path.weight * scatter.diffuse, path.weight * highlight);
    if diffuse == Vec3::ZERO && specular == Vec3::ZERO {
        return;
    }
    run.points.push(LitPoint {
        shadow_position: point.shadow_position,
        normal: point.normal,
        to_viewer: -ray.direction.normalize_or_zero(),
        diffuse,
        specular,
        shininess,
        pixel_idx: path.pixel_idx,
        seed: path.seed,
    });
}
