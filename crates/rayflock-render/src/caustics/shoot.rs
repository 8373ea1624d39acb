//! Rays from lights, by mirrors and through glass, to the rough surfaces where they leave photons.

use glam::Vec3;
use rayflock_engine::RayEngine;
use rayflock_geom::{Hit, HitBuffer, Ray, RayOrder};
use rayflock_scene::{Falloff, LightKind};
use rayon::prelude::*;
use tracing::debug_span;

use super::Shooting;
use super::light_views::{LightView, light_views};
use super::photon_map::Photon;
use crate::Lens;
use crate::frame_shading::FrameShading;
use crate::shading::scatter::scatter;
use crate::shading::surface_point::surface_point;
use crate::stages::mirror_rays::mirror_ray;
use crate::stages::refraction_rays::refraction_ray;
use crate::stats::{FrameStats, Stage, StageStats, Stopwatch};
use crate::wave::{Path, Shared, Wave};

/// Rays that one task moves on.
const RUN: usize = 512;

/// Working memory, kept from frame to frame.
#[derive(Debug, Default)]
pub(super) struct ShootBuffers {
    wave: Wave,
    next: Wave,
    hits: HitBuffer,
    /// What the rays of some rows of a light's view carry.
    fluxes: Vec<Vec3>,
    runs: Vec<Run>,
}

/// What some rays leave at what they hit.
#[derive(Debug, Default)]
struct Run {
    next: Wave,
    photons: Vec<Photon>,
}

/// What is the same for all rays of some rows.
#[derive(Clone, Copy, Debug)]
struct Rows<'a> {
    frame: &'a FrameShading,
    conserves: bool,
    depth: u32,
    /// The texel that the first of the fluxes belongs to.
    first_texel: u32,
}

/// Leaves the photons of all lights, light by light, those of a window by texel.
pub(super) fn shoot(
    engine: &mut dyn RayEngine,
    shooting: &Shooting<'_>,
    buffers: &mut ShootBuffers,
    photons: &mut Vec<Photon>,
    stats: &mut FrameStats,
) {
    let _span = debug_span!("shoot_photons").entered();
    let turning = shooting.frame.turning_bounds();
    for light in shooting.lights {
        for view in light_views(light, &turning, shooting.bounds, shooting.settings.photons) {
            let first_photon = photons.len();
            let rows_at_once = (shooting.batch_rays / view.edge as usize).max(1) as u32;
            for first_row in (0..view.edge).step_by(rows_at_once as usize) {
                let rows = first_row..view.edge.min(first_row + rows_at_once);
                buffers.start(light, &view, rows);
                let first_texel = first_row * view.edge;
                let Shooting { frame, conserves, depth, .. } = *shooting;
                let rows = Rows { frame, conserves, depth, first_texel };
                let grows = matches!(light, LightKind::Point { falloff: Falloff::Constant, .. });
                buffers.follow(engine, &rows, (shooting.batch_rays, grows), photons, stats);
            }
            // As if all rows had been followed together.
            photons[first_photon..].par_sort_by_key(|photon| photon.texel);
        }
    }
}

impl ShootBuffers {
    /// Makes the wave the rays through some rows of texels, but for those that carry nothing.
    fn start(&mut self, light: &LightKind, view: &LightView, rows: std::ops::Range<u32>) {
        let Self { wave, fluxes, .. } = self;
        wave.clear(0);
        fluxes.clear();
        wave.order = RayOrder::Coherent;
        for y in rows {
            for x in 0..view.edge {
                let (origin, direction, flux) = view.texel(light, [x, y]);
                fluxes.push(flux);
                if flux == Vec3::ZERO || !flux.is_finite() {
                    continue;
                }
                match view.lens {
                    Lens::Pinhole { .. } => {
                        wave.shared = Shared::Origin(origin);
                        wave.directions.push(direction);
                    }
                    Lens::Parallel { .. } => {
                        wave.shared = Shared::Direction(direction);
                        wave.origins.push(origin);
                    }
                }
                wave.paths.push(Path { pixel_idx: y * view.edge + x, ..Path::NEW });
            }
        }
    }

    /// Follows the wave until nothing of it is left.
    fn follow(
        &mut self,
        engine: &mut dyn RayEngine,
        rows: &Rows<'_>,
        (limit, grows): (usize, bool),
        photons: &mut Vec<Photon>,
        stats: &mut FrameStats,
    ) {
        while self.wave.len() > 0 {
            self.next.clear(self.wave.bounce + 1);
            self.next.order = RayOrder::Unordered;
            for start in (0..self.wave.len()).step_by(limit) {
                let count = limit.min(self.wave.len() - start);
                self.trace(engine, start, count, stats);
                if grows && self.wave.bounce == 0 {
                    self.grow(rows, start);
                }
                self.step(rows, start, photons);
            }
            std::mem::swap(&mut self.wave, &mut self.next);
        }
    }

    fn trace(
        &mut self,
        engine: &mut dyn RayEngine,
        start: usize,
        count: usize,
        stats: &mut FrameStats,
    ) {
        let batch = self.wave.batch().slice(start, count);
        self.hits.reset(count);
        let stopwatch = Stopwatch::start();
        let trace = engine.closest_hit(&batch, &mut self.hits.as_hits());
        stats.add_traced(Stage::Indirect, StageStats { trace, seconds: stopwatch.seconds() });
        stats.rays.indirect += count as u64;
    }

    /// Has the fluxes of rays from `start` on grow with the distance to their first hit.
    fn grow(&mut self, rows: &Rows<'_>, start: usize) {
        for (path, t) in self.wave.paths[start..].iter().zip(&self.hits.t) {
            self.fluxes[(path.pixel_idx - rows.first_texel) as usize] *= t * t;
        }
    }

    /// Has the rays from `start` on leave photons, and turn.
    fn step(&mut self, rows: &Rows<'_>, start: usize, photons: &mut Vec<Photon>) {
        let Self { wave, next, hits, fluxes, runs } = self;
        let (batch, count) = (wave.batch(), hits.t.len());
        runs.resize_with(count.div_ceil(RUN).max(runs.len()), Run::default);
        let used = &mut runs[..count.div_ceil(RUN)];
        used.par_iter_mut().enumerate().for_each(|(run_idx, run)| {
            run.next.clear(wave.bounce + 1);
            run.photons.clear();
            for place in run_idx * RUN..count.min((run_idx + 1) * RUN) {
                let path = wave.paths[start + place];
                let flux = fluxes[(path.pixel_idx - rows.first_texel) as usize];
                let (ray, hit) = (batch.ray(start + place), hits.get(place));
                run.step(rows, wave.bounce, (&ray, &hit), path, flux);
            }
        });
        for run in used {
            next.origins.extend_from_slice(&run.next.origins);
            next.directions.extend_from_slice(&run.next.directions);
            next.paths.extend_from_slice(&run.next.paths);
            photons.extend_from_slice(&run.photons);
        }
    }

    /// Bytes held.
    pub(super) fn memory_usage(&self) -> usize {
        let of_run =
            |run: &Run| run.next.memory_usage() + run.photons.capacity() * size_of::<Photon>();
        self.wave.memory_usage()
            + self.next.memory_usage()
            + self.fluxes.capacity() * size_of::<Vec3>()
            + self.runs.iter().map(of_run).sum::<usize>()
    }
}

impl Run {
    fn step(
        &mut self,
        rows: &Rows<'_>,
        bounce: u32,
        (ray, hit): (&Ray, &Hit),
        mut path: Path,
        flux: Vec3,
    ) {
        let frame = rows.frame;
        let Some(point) = surface_point(frame, ray, hit) else { return };
        path.weight *= (-path.absorption * hit.t).exp();
        let material = frame.material(point.material);
        let base = frame.base_color(&point);
        let mut scatter = scatter(material, &point, base, ray.direction);
        if rows.conserves {
            scatter.conserve(&mut material.specular.clone(), material.shininess);
        }
        if bounce > 0 && scatter.diffuse != Vec3::ZERO {
            self.photons.push(Photon {
                position: point.shadow_position,
                texel: path.pixel_idx,
                flux: path.weight * flux,
                normal: point.normal,
                direction: ray.direction,
            });
        }
        if bounce < rows.depth {
            mirror_ray(&point, material, &scatter, &path, &mut self.next);
            refraction_ray(&point, material, &scatter, &path, &mut self.next);
        }
    }
}
