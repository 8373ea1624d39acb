//! Pictures of what lies behind light: normals, distances, rays.
//!
//! In place of light, each ray adds what is shown to its pixel; so samples are averaged as usual.

use glam::Vec3;
use rayflock_geom::HitBuffer;
use rayon::prelude::*;

use super::runs::{begin_runs, rays_of};
use crate::Shown;
use crate::frame_shading::FrameShading;
use crate::shading::surface_point::surface_point;
use crate::wave::{Contribution, ShadedRun, Wave};

/// Leaves what the rays of the camera show as `unshadowed` of `runs`, and no ray of a next
/// bounce; `diagonal` is that of the scene.
pub(crate) fn show_surface(
    (shown, diagonal): (Shown, f32),
    frame: &FrameShading,
    wave: &Wave,
    hits: &HitBuffer,
    runs: &mut Vec<ShadedRun>,
) {
    let batch = wave.batch();
    begin_runs(wave, runs, |rays, run| {
        for ray_idx in rays {
            let (ray, hit) = (batch.ray(ray_idx), hits.get(ray_idx));
            let radiance = match (shown, surface_point(frame, &ray, &hit)) {
                (Shown::Normals, Some(point)) => 0.5 * point.normal + 0.5,
                (Shown::Depth, Some(_)) => Vec3::splat(hit.t * ray.direction.length() / diagonal),
                (Shown::Depth, None) => Vec3::ONE,
                _ => Vec3::ZERO,
            };
            let pixel_idx = wave.paths[ray_idx].pixel_idx;
            run.unshadowed.push(Contribution { pixel_idx, radiance });
        }
    });
}

/// Makes what each ray of `wave` adds to its pixel its own cost.
pub(crate) fn count_rays(wave: &Wave, runs: &mut [ShadedRun]) {
    runs.par_iter_mut().enumerate().for_each(|(run_idx, run)| {
        run.unshadowed.clear();
        run.unshadowed
            .extend(wave.paths[rays_of(run_idx, wave)].iter().map(|path| cost(path.pixel_idx)));
    });
}

/// Makes what each shadow ray adds to its pixel its own cost.
pub(crate) fn count_shadow_rays(runs: &mut [ShadedRun]) {
    runs.par_iter_mut()
        .flat_map_iter(|run| &mut run.lit)
        .for_each(|lit| *lit = cost(lit.pixel_idx));
}

fn cost(pixel_idx: u32) -> Contribution {
    let radiance = Vec3::splat((Shown::COST_OF_WHITE as f32).recip());
    Contribution { pixel_idx, radiance }
}
