//! How much a light sends into a scene, to choose among lights by.
//!
//! With thousands of lights, a path asks only a few at a time: those that are chosen in
//! proportion to their power. All paths of a wave ask the same, so that shadow rays go on sharing
//! their origin.

use std::f32::consts::{PI, TAU};

use glam::Vec3;
use rayflock_scene::{Falloff, LightKind};

/// Lights that the points of one wave ask at most.
const ASKED: usize = 8;

/// The flux of a light into a scene within a sphere of this radius.
pub(crate) fn flux(light: &LightKind, radius: f32) -> Vec3 {
    match *light {
        LightKind::Point { intensity, falloff, .. } => {
            let all_around = 4.0 * PI * intensity;
            match falloff {
                Falloff::InverseSquare => all_around,
                Falloff::Constant => all_around * (radius * radius),
            }
        }
        LightKind::Directional { irradiance, .. } => irradiance * (PI * radius * radius),
        LightKind::Spot { intensity, cos_outer, .. } => {
            intensity * (TAU * (1.0 - cos_outer.clamp(-1.0, 1.0)))
        }
    }
}

/// How likely each light is chosen: by its flux.
#[derive(Clone, Debug, Default)]
pub(crate) struct LightChoice {
    /// Sums of the fluxes up to and including each light.
    cumulative: Vec<f32>,
}

impl LightChoice {
    /// For lights with these fluxes.
    pub(crate) fn new(fluxes: impl IntoIterator<Item = Vec3>) -> Self {
        let mut sum = 0.0;
        let cumulative = fluxes.into_iter().map(|flux| {
            let weight = flux.element_sum();
            sum += if weight.is_finite() { weight.max(0.0) } else { 0.0 };
            sum
        });
        Self { cumulative: cumulative.collect() }
    }

    /// The light that `random` in `0..1` chooses, how likely that was, and a new number in `0..1`;
    /// `None` where there is no light.
    pub(crate) fn choose(&self, random: f32) -> Option<(usize, f32, f32)> {
        let total = *self.cumulative.last()?;
        if total <= 0.0 {
            return None;
        }
        let wanted = random * total;
        // The last light that shines, where rounding leads past it.
        let last = self.cumulative.partition_point(|&sum| sum < total);
        let idx = self.cumulative.partition_point(|&sum| sum <= wanted).min(last);
        let before = idx.checked_sub(1).map_or(0.0, |before| self.cumulative[before]);
        let weight = self.cumulative[idx] - before;
        let rest = ((wanted - before) / weight).clamp(0.0, 1.0 - f32::EPSILON);
        Some((idx, weight / total, rest))
    }

    /// The lights that a wave asks, each with what its light is multiplied by: all where they are
    /// few, else some, chosen by `random`.
    pub(crate) fn asked(&self, random: f32) -> Vec<(usize, f32)> {
        let count = self.cumulative.len();
        if count <= ASKED {
            return (0..count).map(|idx| (idx, 1.0)).collect();
        }
        let places = (0..ASKED).map(|place| (place as f32 + random) / ASKED as f32);
        let chosen = places.filter_map(|place| self.choose(place));
        chosen.map(|(idx, chance, _)| (idx, 1.0 / (chance * ASKED as f32))).collect()
    }
}

/// The same light, brighter by `factor`.
pub(crate) fn brighter(light: &LightKind, factor: f32) -> LightKind {
    let mut brighter = *light;
    match &mut brighter {
        LightKind::Point { intensity, .. } | LightKind::Spot { intensity, .. } => {
            *intensity *= factor;
        }
        LightKind::Directional { irradiance, .. } => *irradiance *= factor,
    }
    brighter
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_lights_asked_stand_for_all_of_them() {
        let fluxes: Vec<Vec3> = (0..100).map(|i| Vec3::splat((i % 7) as f32)).collect();
        let choice = LightChoice::new(fluxes.iter().copied());
        let mean: f32 = (0..1000)
            .flat_map(|i| choice.asked((i as f32 + 0.5) / 1000.0))
            .map(|(idx, factor)| factor * fluxes[idx].x)
            .sum::<f32>()
            / 1000.0;
        let all: f32 = fluxes.iter().map(|flux| flux.x).sum();
        assert!((mean / all - 1.0).abs() < 1e-4, "{mean} instead of {all}");
    }

    #[test]
    fn dark_lights_are_never_chosen() {
        let dark = LightChoice::new([Vec3::ZERO, Vec3::NAN]);
        assert_eq!(dark.choose(0.5), None);
        let one = LightChoice::new([Vec3::ZERO, Vec3::ONE, Vec3::ZERO]);
        for random in [0.0, 0.5, 1.0] {
            let (idx, chance, rest) = one.choose(random).unwrap();
            assert_eq!((idx, chance), (1, 1.0));
            assert!((0.0..1.0).contains(&rest));
        }
        assert_eq!(LightChoice::default().choose(0.0), None);
    }
}
