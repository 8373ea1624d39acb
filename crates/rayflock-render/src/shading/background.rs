//! What rays see that hit nothing, and the light that comes from there.

use glam::Vec3;
use rayflock_scene::Background;

/// The sky of scenes that state no background: a clear day over bare ground, dark enough for
/// white things to stand out.
pub(crate) const DEFAULT_SKY: Background = Background::Gradient {
    zenith: Vec3::new(0.10, 0.20, 0.42),
    horizon: Vec3::new(0.42, 0.50, 0.58),
    ground: Vec3::new(0.13, 0.125, 0.12),
};

/// The radiance from along `direction`, of any length; gradients are linear in the sine of the
/// elevation.
#[inline]
pub(crate) fn radiance(background: &Background, direction: Vec3) -> Vec3 {
    match *background {
        Background::Uniform(radiance) => radiance,
        Background::Gradient { zenith, horizon, ground } => {
            let sine = direction.normalize_or_zero().y;
            horizon.lerp(if sine > 0.0 { zenith } else { ground }, sine.abs())
        }
    }
}

/// The irradiance, divided by pi, of a surface with unit `normal` under the whole background and
/// in nobody's shadow.
///
/// Exact for surfaces that face straight up or down; between, a blend of the two.
pub(crate) fn irradiance_over_pi(background: &Background, normal: Vec3) -> Vec3 {
    match *background {
        Background::Uniform(radiance) => radiance,
        Background::Gradient { zenith, horizon, ground } => {
            // The mean of the sine of the elevation over a hemisphere, weighted by the cosine.
            let mean_sine = 2.0 / 3.0;
            let (up, down) = (horizon.lerp(zenith, mean_sine), horizon.lerp(ground, mean_sine));
            down.lerp(up, 0.5 + 0.5 * normal.y)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gradient_meets_its_three_colours() {
        let Background::Gradient { zenith, horizon, ground } = DEFAULT_SKY else { panic!() };
        assert_eq!(radiance(&DEFAULT_SKY, 3.0 * Vec3::Y), zenith);
        assert_eq!(radiance(&DEFAULT_SKY, Vec3::X), horizon);
        assert_eq!(radiance(&DEFAULT_SKY, Vec3::NEG_Y), ground);
    }

    #[test]
    fn a_furnace_lights_every_side_alike() {
        let furnace = Background::Uniform(Vec3::ONE);
        let same =
            Background::Gradient { zenith: Vec3::ONE, horizon: Vec3::ONE, ground: Vec3::ONE };
        for normal in [Vec3::X, Vec3::Y, Vec3::NEG_Y] {
            assert_eq!(irradiance_over_pi(&furnace, normal), Vec3::ONE);
            assert_eq!(irradiance_over_pi(&same, normal), Vec3::ONE);
        }
    }
}
