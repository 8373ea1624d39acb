//! What walks start from: lights of the scene, surfaces that emit, the background.
//!
//! A source is chosen by the flux it sends into the scene; where and whither the walk starts is
//! chosen as the source shines. What comes from outside, a sun or the background, starts on a
//! disc beside the scene that is as wide as a sphere around it.

use std::f32::consts::{PI, TAU};

use glam::Vec3;
use rayflock_geom::Aabb;
use rayflock_scene::{Background, Falloff, LightKind};

use super::VirtualLight;
use crate::lights::emitters::Emitters;
use crate::lights::incident::incident;
use crate::lights::power::{LightChoice, flux};
use crate::shading::background;
use crate::shading::sampling::cosine_direction;

/// Where a walk starts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Start {
    pub(crate) origin: Vec3,
    /// Of unit length.
    pub(crate) direction: Vec3,
    /// The flux that the walk carries, over the probability of this start.
    pub(crate) flux: Vec3,
    /// Whether the flux grows with the square of the distance to the first hit, as that of a light
    /// whose irradiance does not fall.
    pub(crate) grows: bool,
}

/// Everything that walks may start from.
#[derive(Debug)]
pub(crate) struct Sources<'a> {
    lights: &'a [LightKind],
    emitters: &'a Emitters,
    background: Background,
    center: Vec3,
    radius: f32,
    /// Of the lights in their order, the emitters as one, and the background.
    choice: LightChoice,
}

impl<'a> Sources<'a> {
    /// The sources of a scene within `bounds`.
    pub(crate) fn new(
        lights: &'a [LightKind],
        emitters: &'a Emitters,
        background: Background,
        bounds: &Aabb,
    ) -> Self {
        let radius = 0.5 * bounds.size().length();
        let sky = mean_radiance(&background) * (4.0 * PI * PI * radius * radius);
        let fluxes = lights.iter().map(|light| flux(light, radius));
        let choice = LightChoice::new(fluxes.chain([emitters.flux(), sky]));
        Self { lights, emitters, background, center: bounds.center(), radius, choice }
    }

    /// The start that these numbers in `0..1` choose; `None` where nothing shines.
    pub(crate) fn start(&self, choice: f32, place: [f32; 3], random: [f32; 2]) -> Option<Start> {
        let (source_idx, chance, rest) = self.choice.choose(choice)?;
        let start = match self.lights.get(source_idx) {
            Some(light) => self.leave_light(light, random),
            None if source_idx == self.lights.len() => self.leave_emitters(rest, place, random),
            None => self.leave_sky([place[0], place[1]], random),
        }?;
        let flux = start.flux / chance;
        flux.is_finite().then_some(Start { flux, ..start })
    }

    fn leave_light(&self, light: &LightKind, random: [f32; 2]) -> Option<Start> {
        let (origin, direction, solid_angle) = match *light {
            LightKind::Directional { direction, irradiance } => {
                let direction = direction.normalize_or_zero();
                return (direction != Vec3::ZERO)
                    .then(|| self.enter(direction, irradiance, random));
            }
            LightKind::Point { position, .. } => (position, in_cone(Vec3::Y, -1.0, random), 2.0),
            LightKind::Spot { position, direction, cos_outer, .. } => {
                let axis = direction.normalize_or_zero();
                let cos = cos_outer.clamp(-1.0, 1.0);
                (position, in_cone(axis, cos, random), 1.0 - cos)
            }
        };
        // A surface at distance 1 gets as irradiance what the light sends as intensity.
        let intensity = incident(light, origin + direction)?.irradiance;
        let grows = matches!(light, LightKind::Point { falloff: Falloff::Constant, .. });
        Some(Start { origin, direction, flux: intensity * (TAU * solid_angle), grows })
    }

    fn leave_emitters(&self, choice: f32, place: [f32; 3], random: [f32; 2]) -> Option<Start> {
        let leaving = self.emitters.leaving(choice, place)?;
        let direction = cosine_direction(leaving.normal, random);
        Some(Start { origin: leaving.origin, direction, flux: leaving.flux, grows: false })
    }

    fn leave_sky(&self, whence: [f32; 2], random: [f32; 2]) -> Option<Start> {
        let direction = in_cone(Vec3::Y, -1.0, whence);
        let radiance = background::radiance(&self.background, -direction);
        Some(self.enter(direction, radiance * (4.0 * PI), random))
    }

    /// From a disc across `direction` that is as wide as the scene.
    fn enter(&self, direction: Vec3, irradiance: Vec3, random: [f32; 2]) -> Start {
        let (side, up) = direction.any_orthonormal_pair();
        let (sin, cos) = (TAU * random[1]).sin_cos();
        let on_disc = (side * cos + up * sin) * (random[0].sqrt() * self.radius);
        let origin = self.center - direction * (1.01 * self.radius) + on_disc;
        let flux = irradiance * (PI * self.radius * self.radius);
        Start { origin, direction, flux, grows: false }
    }

    /// The background as `count` lights far away, in directions spread evenly over the sphere.
    ///
    /// **Source**: R. Swinbank and R. J. Purser, *Fibonacci Grids*, QJRMS 132 (2006).
    pub(crate) fn sky_lights(&self, count: usize, lights: &mut Vec<VirtualLight>) {
        lights.clear();
        if mean_radiance(&self.background) == Vec3::ZERO {
            return;
        }
        let golden_turn = TAU * 0.618_034;
        for light_idx in 0..count {
            let height = 1.0 - (2.0 * light_idx as f32 + 1.0) / count as f32;
            let radius = (1.0 - height * height).max(0.0).sqrt();
            let (sin, cos) = (golden_turn * light_idx as f32).sin_cos();
            let to_light = Vec3::new(radius * cos, height, radius * sin);
            let radiance = background::radiance(&self.background, to_light);
            let share = 4.0 * PI / count as f32;
            lights.push(VirtualLight::distant(to_light, radiance * share));
        }
    }
}

fn mean_radiance(background: &Background) -> Vec3 {
    let faces = [Vec3::Y, Vec3::NEG_Y, Vec3::X, Vec3::X];
    faces.map(|direction| background::radiance(background, direction)).into_iter().sum::<Vec3>()
        / 4.0
}

/// A direction within the cone about unit `axis` whose half angle has this cosine, all alike.
fn in_cone(axis: Vec3, cos_outer: f32, random: [f32; 2]) -> Vec3 {
    let cos = 1.0 - random[0] * (1.0 - cos_outer);
    let sin = (1.0 - cos * cos).max(0.0).sqrt();
    let (side, up) = axis.any_orthonormal_pair();
    let (sin_turn, cos_turn) = (TAU * random[1]).sin_cos();
    (side * cos_turn + up * sin_turn) * sin + axis * cos
}
