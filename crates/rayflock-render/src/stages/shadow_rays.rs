//! Rays between lights and the points they may light.
//!
//! Rays of a point or spot light are traced from the light, so that they share their origin;
//! those of a directional light share their direction. Both are what engines are best at. Rays
//! to sampled points of emitters share nothing and start at the surface, where neighbours in the
//! picture are close. Points that face away from the light get no ray.
//!
//! Glass casts a full shadow, like anything else.

use glam::Vec3;
use rayflock_geom::{Column, RayBatch, RayOrder};
use rayflock_scene::LightKind;
use rayon::prelude::*;
use tracing::debug_span;

use crate::lights::emitters::{EmitterSample, Emitters};
use crate::lights::incident::{Incident, incident};
use crate::shading::scatter::reflected;
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
        for point in &run.points {
            push_ray(target, point, &mut run.shadow, &mut run.lit);
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

fn push_ray(
    target: ShadowTarget<'_>,
    point: &LitPoint,
    wave: &mut ShadowWave,
    lit: &mut Vec<Contribution>,
) {
    match target {
        ShadowTarget::Light(light) => {
            let Some(incident) = incident(light, point.shadow_position) else { return };
            if !push_contribution(point, &incident, 1.0, lit) {
                return;
            }
            match light {
                LightKind::Point { position, .. } | LightKind::Spot { position, .. } => {
                    wave.directions.push(point.shadow_position - *position);
                }
                LightKind::Directional { .. } => wave.origins.push(point.shadow_position),
            }
        }
        ShadowTarget::Emitters { emitters, sample_idx, sample_count } => {
            let random = point.seed.unit_cube(sample_idx);
            let Some(sample) = emitters.sample(point.shadow_position, random) else { return };
            let share = chance_of_sample(point, &sample) / sample_count as f32;
            if push_contribution(point, &sample.incident, share, lit) {
                wave.origins.push(point.shadow_position);
                wave.directions.push(sample.source - point.shadow_position);
            }
        }
    }
}

/// What a sampled point counts for where the path may find the same light on its way: the balance
/// heuristic.
fn chance_of_sample(point: &LitPoint, sample: &EmitterSample) -> f32 {
    let LitPoint { normal, to_viewer, shininess, .. } = *point;
    let to_light = sample.incident.to_light;
    let by_path = point.chances.density(normal, to_viewer, shininess, to_light);
    1.0 / (1.0 + by_path / sample.density)
}

/// Adds what the point sends back of `share` of the light; `false` where that is nothing.
fn push_contribution(
    point: &LitPoint,
    incident: &Incident,
    share: f32,
    lit: &mut Vec<Contribution>,
) -> bool {
    let LitPoint { diffuse, specular, shininess, normal, to_viewer, .. } = *point;
    let sent_back = reflected(diffuse, specular, shininess, normal, to_viewer, incident.to_light);
    let radiance = share * sent_back * incident.irradiance;
    if radiance == Vec3::ZERO {
        return false;
    }
    lit.push(Contribution { pixel_idx: point.pixel_idx, radiance });
    true
}
