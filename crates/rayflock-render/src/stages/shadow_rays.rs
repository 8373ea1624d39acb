//! Rays between lights and the points they may light.
//!
//! Rays of a point or spot light are traced from the light, so that they share their origin;
//! those of a directional light share their direction. Both are what engines are best at. Rays
//! to sampled points of emitters share nothing and start at the surface, where neighbours in the
//! picture are close. Points that face away from the light get no ray.
//!
//! What points send back of a light is found sixteen at a time; emitters have a sample for each
//! point, and are asked one by one.
//!
//! Glass casts a full shadow, like anything else.

use glam::Vec3;
use rayflock_geom::simd::{LANES, Simd, SimdLevel, dispatch};
use rayflock_geom::{Column, RayBatch, RayOrder};
use rayflock_scene::LightKind;
use rayon::prelude::*;
use tracing::debug_span;

use crate::lights::emitters::{EmitterSample, Emitters};
use crate::lights::incident::Incident;
use crate::lights::sent_back::{SentBack, sent_back};
use crate::shading::scatter::reflected;
use crate::shading::turns::Chances;
use crate::wave::{Contribution, LitPoint, ShadedRun, ShadowWave};

/// Rays from a light start this far along, and end this far before the point, relative to the
/// distance: a lamp's own surface does not shade it, nor rounding the point.
const FROM_LIGHT: (f32, f32) = (1e-4, 1.0 - 4e-6);
/// Rays to a sampled point end this far before it, relative to the distance.
const TO_EMITTER: f32 = 1.0 - 1e-4;

/// What one batch of shadow rays asks about.
#[derive(Clone, Copy, Debug)]
pub(crate) enum ShadowTarget<'a> {
    /// A light of the scene.
    Light(&'a LightKind),
    /// Sample `sample_idx` on the emitters, one of `sample_count` that share the light.
    Emitters { emitters: &'a Emitters, sample_idx: u32, sample_count: u32 },
}

/// Fills `wave` with a ray for each point of `runs` that the light may light.
pub(crate) fn shadow_rays(target: ShadowTarget<'_>, runs: &mut [ShadedRun], wave: &mut ShadowWave) {
    let _span = debug_span!("shadow_rays").entered();
    runs.par_iter_mut().for_each(|run| {
        run.shadow.clear();
        run.lit.clear();
        match target {
            ShadowTarget::Light(light) => {
                dispatch!(SimdLevel::best().level(), simd => ask_light(simd, light, run));
            }
            ShadowTarget::Emitters { emitters, sample_idx, sample_count } => {
                ask_emitters(emitters, (sample_idx, sample_count), run);
            }
        }
    });
    wave.join(runs);
}

/// The rays of `wave` as a question to an engine.
pub(crate) fn shadow_batch<'a>(target: ShadowTarget<'_>, wave: &'a ShadowWave) -> RayBatch<'a> {
    let (origins, directions) = (Column::from(&wave.origins), Column::from(&wave.directions));
    let batch = match target {
        ShadowTarget::Light(
            LightKind::Point { position, .. } | LightKind::Spot { position, .. },
        ) => RayBatch::new(*position, directions)
            .and_then(|batch| batch.with_interval(FROM_LIGHT.0, FROM_LIGHT.1)),
        ShadowTarget::Light(LightKind::Directional { direction, .. }) => {
            RayBatch::new(origins, -*direction)
        }
        ShadowTarget::Emitters { .. } => RayBatch::new(origins, directions)
            .and_then(|batch| batch.with_interval(0.0, TO_EMITTER)),
    };
    let Ok(batch) = batch else { unreachable!("the columns of a shadow wave have one length") };
    batch.with_order(order_of(target))
}

/// How neighbours relate. Seen from a lamp, points that lie side by side in the picture may lie
/// anywhere: sorting by direction, which engines do with rays of no order, took 40 instead of 112
/// triangle tests a ray in museum5 at 400 x 300.
fn order_of(target: ShadowTarget<'_>) -> RayOrder {
    match target {
        ShadowTarget::Light(LightKind::Point { .. } | LightKind::Spot { .. }) => {
            RayOrder::Unordered
        }
        ShadowTarget::Light(LightKind::Directional { .. }) | ShadowTarget::Emitters { .. } => {
            RayOrder::Coherent
        }
    }
}

/// Adds a ray for each point of `run` that sends light of `light` back.
#[inline(always)]
fn ask_light<S: Simd>(simd: S, light: &LightKind, run: &mut ShadedRun) {
    let ShadedRun { points, shadow, lit, .. } = run;
    for points in points.chunks(LANES) {
        let SentBack { radiance, lit: mut lanes } = sent_back(simd, light, points);
        while lanes != 0 {
            let lane = lanes.trailing_zeros() as usize;
            lanes &= lanes - 1;
            let LitPoint { shadow_position, pixel_idx, .. } = points[lane];
            let radiance = Vec3::new(radiance[0][lane], radiance[1][lane], radiance[2][lane]);
            lit.push(Contribution { pixel_idx, radiance });
            match light {
                LightKind::Point { position, .. } | LightKind::Spot { position, .. } => {
                    shadow.directions.push(shadow_position - *position);
                }
                LightKind::Directional { .. } => shadow.origins.push(shadow_position),
            }
        }
    }
}

/// Adds a ray for each point of `run` that sends light of its sample back: `sample_idx`, one of
/// `sample_count` that share the light.
fn ask_emitters(emitters: &Emitters, (sample_idx, sample_count): (u32, u32), run: &mut ShadedRun) {
    let chances = run.chances.iter().copied().chain(std::iter::repeat(Chances::NONE));
    for (point, chances) in run.points.iter().zip(chances) {
        let random = point.seed.unit_cube(sample_idx);
        let Some(sample) = emitters.sample(point.shadow_position, random) else { continue };
        let share = chance_of_sample(point, &chances, &sample) / sample_count as f32;
        let LitPoint { diffuse, specular, shininess, normal, to_viewer, .. } = *point;
        let Incident { to_light, irradiance } = sample.incident;
        let sent_back = reflected(diffuse, specular, shininess, normal, to_viewer, to_light);
        let radiance = share * sent_back * irradiance;
        if radiance != Vec3::ZERO {
            run.lit.push(Contribution { pixel_idx: point.pixel_idx, radiance });
            run.shadow.origins.push(point.shadow_position);
            run.shadow.directions.push(sample.source - point.shadow_position);
        }
    }
}

/// What a sampled point counts for where the path may find the same light on its way: the balance
/// heuristic.
fn chance_of_sample(point: &LitPoint, chances: &Chances, sample: &EmitterSample) -> f32 {
    let LitPoint { normal, to_viewer, shininess, .. } = *point;
    let to_light = sample.incident.to_light;
    let by_path = chances.density(normal, to_viewer, shininess, to_light);
    1.0 / (1.0 + by_path / sample.density)
}
