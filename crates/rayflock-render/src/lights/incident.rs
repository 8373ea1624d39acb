//! How much light a light sends to a point, were nothing in the way.

use glam::Vec3;
use rayflock_scene::{Falloff, LightKind};

/// Between the cosines of a spot light's cones lies at least this, so that it can be divided by.
pub(super) const MIN_CONE_WIDTH: f32 = 1e-4;

/// Light that arrives at a point from one direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Incident {
    /// Where the light comes from, of unit length.
    pub(crate) to_light: Vec3,
    /// Irradiance of a surface that faces the light.
    pub(crate) irradiance: Vec3,
}

/// What `light` sends to `position`; `None` where it sends nothing.
#[inline]
pub(crate) fn incident(light: &LightKind, position: Vec3) -> Option<Incident> {
    let (to_light, irradiance) = match *light {
        LightKind::Directional { direction, irradiance } => {
            (-direction.normalize_or_zero(), irradiance)
        }
        LightKind::Point { position: source, intensity, falloff } => {
            let (to_light, distance_squared) = toward(source, position);
            match falloff {
                Falloff::InverseSquare => (to_light, intensity / distance_squared),
                Falloff::Constant => (to_light, intensity),
            }
        }
        LightKind::Spot { position: source, direction, intensity, cos_inner, cos_outer } => {
            let (to_light, distance_squared) = toward(source, position);
            let cos = -to_light.dot(direction.normalize_or_zero());
            let share = cone_share(cos, cos_inner, cos_outer);
            (to_light, intensity * share / distance_squared)
        }
    };
    let arrives = irradiance.is_finite() && irradiance != Vec3::ZERO && to_light != Vec3::ZERO;
    arrives.then_some(Incident { to_light, irradiance })
}

fn toward(source: Vec3, position: Vec3) -> (Vec3, f32) {
    let offset = source - position;
    (offset.normalize_or_zero(), offset.length_squared())
}

/// The share of a spot light's intensity at an angle with cosine `cos` from its axis: smooth
/// between the two cones, as glTF's `KHR_lights_punctual` recommends.
fn cone_share(cos: f32, cos_inner: f32, cos_outer: f32) -> f32 {
    let width = (cos_inner - cos_outer).max(MIN_CONE_WIDTH);
    let share = ((cos - cos_outer) / width).clamp(0.0, 1.0);
    share * share
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_point_light_falls_with_the_square_unless_it_is_constant() {
        let at = |falloff, distance: f32| {
            let intensity = Vec3::splat(8.0);
            let light = LightKind::Point { position: Vec3::ZERO, intensity, falloff };
            incident(&light, Vec3::X * distance).unwrap().irradiance.x
        };
        assert_eq!(at(Falloff::InverseSquare, 2.0), 2.0);
        assert_eq!(at(Falloff::InverseSquare, 4.0), 0.5);
        assert_eq!(at(Falloff::Constant, 4.0), 8.0);
    }

    #[test]
    fn a_spot_is_full_inside_soft_between_and_dark_outside() {
        let at = |angle: f32| {
            let light = LightKind::Spot {
                position: Vec3::ZERO,
                direction: Vec3::NEG_Y,
                intensity: Vec3::ONE,
                cos_inner: 0.3_f32.cos(),
                cos_outer: 0.5_f32.cos(),
            };
            let position = Vec3::new(angle.sin(), -angle.cos(), 0.0);
            incident(&light, position).map_or(0.0, |light| light.irradiance.x)
        };
        assert!((at(0.2) - 1.0).abs() < 1e-5);
        assert!(at(0.4) > 0.1 && at(0.4) < 0.9);
        assert_eq!(at(0.6), 0.0);
    }

    #[test]
    fn a_point_at_the_light_itself_gets_nothing_that_is_not_finite() {
        let light = LightKind::Point {
            position: Vec3::ONE,
            intensity: Vec3::ONE,
            falloff: Falloff::InverseSquare,
        };
        assert_eq!(incident(&light, Vec3::ONE), None);
    }
}
