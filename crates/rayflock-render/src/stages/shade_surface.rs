//! Turns hits into light, lit points and further rays.
//!
//! What needs no shadow ray is ready here: emission, ambient light, and the background where a
//! ray hit nothing. The rest is left as points to be lit and as rays of the next bounce. Light is
//! absorbed along the ray first (Beer-Lambert); a ray that leaves a transmitting solid without
//! hitting its far side, because the mesh is open, is not absorbed.
//!
//! What hits mean in the world is found for sixteen rays at a time, what becomes of light ray by
//! ray.

use std::ops::Range;

use glam::Vec3;
use rayflock_geom::simd::{LANES, Simd, SimdLevel, dispatch};
use rayflock_geom::{HitBuffer, Ray};
use rayflock_scene::Background;
use tracing::debug_span;

use super::mirror_rays::mirror_ray;
use super::refraction_rays::refraction_ray;
use super::runs::begin_runs;
use crate::frame_shading::FrameShading;
use crate::lights::key_light::SKY_SHARE;
use crate::shading::background;
use crate::shading::scatter::{Scatter, scatter};
use crate::shading::surface_point::SurfacePoint;
use crate::shading::surface_points::SurfacePoints;
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
    begin_runs(wave, runs, |rays, run| {
        dispatch!(SimdLevel::best().level(), simd => {
            shade_rays(simd, surroundings, (wave, hits), rays, run);
        });
    });
}

#[inline(always)]
fn shade_rays<S: Simd>(
    simd: S,
    surroundings: &Surroundings<'_>,
    (wave, hits): (&Wave, &HitBuffer),
    rays: Range<usize>,
    run: &mut ShadedRun,
) {
    let batch = wave.batch();
    for start in rays.clone().step_by(LANES) {
        let block = start..rays.end.min(start + LANES);
        let points = SurfacePoints::new(simd, surroundings.frame, (&batch, hits), block.clone());
        for (lane, ray_idx) in block.enumerate() {
            let path = wave.paths[ray_idx];
            match &points.get(lane) {
                Some(point) => {
                    let hit = (point, hits.t[ray_idx]);
                    shade_point(surroundings, wave.bounce, hit, &batch.ray(ray_idx), path, run);
                }
                None => see_background(surroundings, batch.direction().get(ray_idx), &path, run),
            }
        }
    }
}

/// A ray that hit nothing.
fn see_background(
    surroundings: &Surroundings<'_>,
    direction: Vec3,
    path: &Path,
    run: &mut ShadedRun,
) {
    let sky = background::radiance(&surroundings.background, direction);
    let radiance = path.weight * sky;
    run.unshadowed.push(Contribution { pixel_idx: path.pixel_idx, radiance });
}

/// A ray that hit `point`, at a distance of `t`.
fn shade_point(
    surroundings: &Surroundings<'_>,
    bounce: u32,
    (point, t): (&SurfacePoint, f32),
    ray: &Ray,
    mut path: Path,
    run: &mut ShadedRun,
) {
    let frame = surroundings.frame;
    let length = ray.direction.length();
    if path.absorption != Vec3::ZERO {
        path.weight *= (-path.absorption * (t * length)).exp();
    }

    // What the surface itself sends out, and what it makes of ambient light.
    let material = frame.material(point.material);
    let base = frame.base_color(point);
    let mut scatter = scatter(material, point, base, ray.direction / length);
    let mut highlight = material.specular;
    if surroundings.indirect {
        scatter.conserve(&mut highlight, material.shininess);
    }
    let ambient = scatter.ambient * surroundings.ambient(point.normal);
    let radiance = path.weight * (material.emission + ambient);
    if radiance != Vec3::ZERO {
        run.unshadowed.push(Contribution { pixel_idx: path.pixel_idx, radiance });
    }

    // What lights may add, and where the path goes on.
    push_lit_point((&scatter, highlight, material.shininess), point, &path, ray, run);
    if bounce < surroundings.depth {
        mirror_ray(point, material, &scatter, &path, &mut run.mirror);
        refraction_ray(point, material, &scatter, &path, &mut run.refraction);
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
