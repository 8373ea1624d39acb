//! Where a path goes on when that is left to chance.
//!
//! A path turns in one of four ways, each as likely as it is bright: over the hemisphere by the
//! cosine, about the mirrored direction as the highlight is spread, mirrored, or refracted. The
//! first two may lead to the same direction; their densities add up.
//!
//! **Source**: M. Pharr, W. Jakob, G. Humphreys, *Physically Based Rendering*, 4th ed. (2023),
//! sections 9.1.2 and 13.4.

use std::f32::consts::{FRAC_1_PI, TAU};

use glam::Vec3;

use super::sampling::cosine_direction;
use super::scatter::{Scatter, highlight_albedo};

/// How likely each kind of turn is; they add up to 1, or to 0 where the path ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Chances {
    pub(crate) matte: f32,
    pub(crate) highlight: f32,
    pub(crate) mirror: f32,
    pub(crate) refraction: f32,
}

/// A kind of turn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum TurnKind {
    /// Into a direction of [`Chances::rough_direction`].
    Rough {
        is_highlight: bool,
    },
    Mirror,
    Refraction,
}

impl Chances {
    /// The path does not go on by chance.
    pub(crate) const NONE: Self = Self { matte: 0.0, highlight: 0.0, mirror: 0.0, refraction: 0.0 };

    /// By what a path of this weight would carry on.
    pub(crate) fn new(weight: Vec3, scatter: &Scatter, highlight: Vec3, shininess: f32) -> Self {
        let carried = |share: Vec3| (weight * share).element_sum();
        let matte = carried(scatter.diffuse);
        let highlight = carried(highlight * highlight_albedo(shininess));
        let (mirror, refraction) = (carried(scatter.mirror), carried(scatter.transmission));
        let all = matte + highlight + mirror + refraction;
        if !all.is_finite() || all <= 0.0 {
            return Self::NONE;
        }
        Self {
            matte: matte / all,
            highlight: highlight / all,
            mirror: mirror / all,
            refraction: refraction / all,
        }
    }

    /// The kind of turn that `random` in `0..1` chooses; `None` where the path ends.
    pub(crate) fn choose(&self, random: f32) -> Option<TurnKind> {
        if *self == Self::NONE {
            return None;
        }
        let rough = self.matte + self.highlight;
        Some(if random < self.matte {
            TurnKind::Rough { is_highlight: false }
        } else if random < rough {
            TurnKind::Rough { is_highlight: true }
        } else if random < rough + self.mirror || self.refraction == 0.0 {
            match self.mirror > 0.0 {
                true => TurnKind::Mirror,
                false => TurnKind::Rough { is_highlight: self.highlight > 0.0 },
            }
        } else {
            TurnKind::Refraction
        })
    }

    /// The density, by solid angle, with which a rough turn leads to unit `direction`.
    pub(crate) fn density(
        &self,
        normal: Vec3,
        to_viewer: Vec3,
        shininess: f32,
        direction: Vec3,
    ) -> f32 {
        let mut density = self.matte * normal.dot(direction).max(0.0) * FRAC_1_PI;
        if self.highlight > 0.0 {
            let halfway = (to_viewer + direction).normalize_or_zero();
            let exponent = shininess.max(0.0);
            let of_halfway = (exponent + 1.0) / TAU * normal.dot(halfway).max(0.0).powf(exponent);
            let of_direction = of_halfway / (4.0 * to_viewer.dot(halfway));
            if of_direction.is_finite() {
                density += self.highlight * of_direction.max(0.0);
            }
        }
        density
    }
}

/// A direction above the surface into which a rough turn leads, chosen by `random`; `None` where
/// it would lead below.
pub(crate) fn rough_direction(
    is_highlight: bool,
    normal: Vec3,
    to_viewer: Vec3,
    shininess: f32,
    random: [f32; 2],
) -> Option<Vec3> {
    let direction = if is_highlight {
        let halfway = halfway(normal, shininess, random);
        2.0 * to_viewer.dot(halfway) * halfway - to_viewer
    } else {
        cosine_direction(normal, random)
    };
    (normal.dot(direction) > 0.0).then_some(direction)
}

/// A direction about `normal` with a density of `(n + 1) / 2 pi` times its cosine to the `n`.
fn halfway(normal: Vec3, shininess: f32, random: [f32; 2]) -> Vec3 {
    let cos = (1.0 - random[0]).powf((shininess.max(0.0) + 1.0).recip());
    let sin = (1.0 - cos * cos).max(0.0).sqrt();
    let (side, up) = normal.any_orthonormal_pair();
    let (sin_turn, cos_turn) = (TAU * random[1]).sin_cos();
    (side * cos_turn + up * sin_turn) * sin + normal * cos
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shading::sampling::PathSeed;
    use crate::shading::scatter::reflected;

    /// The share of light from everywhere that a surface sends back, by turns of chance.
    fn albedo(diffuse: Vec3, specular: Vec3, shininess: f32, to_viewer: Vec3) -> f32 {
        let scatter = Scatter {
            ambient: Vec3::ZERO,
            diffuse,
            mirror: Vec3::ZERO,
            mirror_direction: Vec3::Y,
            transmission: Vec3::ZERO,
            refraction_direction: Vec3::Y,
        };
        let chances = Chances::new(Vec3::ONE, &scatter, specular, shininess);
        let seed = PathSeed::of_walks(1);
        let sum: f32 = (0..4096)
            .filter_map(|i| {
                let [choice, u, v, _] = seed.unit_4_cube(i, 0);
                let Some(TurnKind::Rough { is_highlight }) = chances.choose(choice) else {
                    panic!("there is nothing but a rough turn")
                };
                let direction =
                    rough_direction(is_highlight, Vec3::Y, to_viewer, shininess, [u, v])?;
                let sent = reflected(diffuse, specular, shininess, Vec3::Y, to_viewer, direction).x;
                Some(sent / chances.density(Vec3::Y, to_viewer, shininess, direction))
            })
            .sum();
        sum / 4096.0
    }

    #[test]
    fn a_highlight_sends_back_what_its_integral_says() {
        for shininess in [1.0, 10.0, 100.0] {
            // From above, halfway directions reach down to 45 degrees.
            let below = 0.5_f32.sqrt().powf(shininess + 2.0);
            let expected = 8.0 / (shininess + 2.0) * (1.0 - below);
            for diffuse in [0.0, 0.5] {
                let found = albedo(Vec3::splat(diffuse), Vec3::ONE, shininess, Vec3::Y);
                let expected = expected + diffuse;
                assert!((found / expected - 1.0).abs() < 0.01, "{found} instead of {expected}");
            }
        }
    }

    #[test]
    fn no_highlight_exceeds_the_bound_on_its_albedo() {
        for (shininess, height) in [(0.0, 1.0), (1.0, 0.5), (8.0, 0.9), (40.0, 0.2)] {
            let to_viewer = Vec3::new(1.0, height, 0.0).normalize();
            let found = albedo(Vec3::ZERO, Vec3::ONE, shininess, to_viewer);
            assert!(found <= 1.01 * highlight_albedo(shininess), "{found} at {shininess}");
        }
    }

    #[test]
    fn a_path_that_carries_nothing_ends() {
        assert_eq!(Chances::NONE.choose(0.3), None);
    }
}
