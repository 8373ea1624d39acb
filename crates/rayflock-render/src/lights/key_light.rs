//! The lights of scenes that have none: a key light over the viewer's left shoulder, and the sky.
//!
//! The key light comes from 45 degrees to the left of the view and well above the horizon, so that
//! shapes show whatever their front is. It turns with the camera's heading, never with its tilt:
//! shadows fall downward. The sky (the scene's background, or the default one) adds ambient light
//! from above and below.

use glam::{Affine3A, Vec3};
use rayflock_scene::LightKind;

/// Irradiance of a surface that faces the key light: white paper then has a radiance of 0.8, and
/// with the light of the sky just below 1.
const KEY_IRRADIANCE: Vec3 = Vec3::new(2.55, 2.45, 2.28);
/// The share of the sky's light that arrives, since nothing occludes ambient light.
pub(crate) const SKY_SHARE: f32 = 0.7;

/// The key light for a camera at `world_from_camera`.
pub(crate) fn key_light(world_from_camera: &Affine3A) -> LightKind {
    let camera_right = Vec3::from(world_from_camera.matrix3.x_axis);
    let right = (camera_right * Vec3::new(1.0, 0.0, 1.0)).normalize_or(Vec3::X);
    let back = right.cross(Vec3::Y);
    let to_light = 1.25 * Vec3::Y + 0.7 * back - 0.7 * right;
    LightKind::Directional { direction: -to_light.normalize(), irradiance: KEY_IRRADIANCE }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn light_comes_from_above_left_and_behind_the_viewer_however_tilted() {
        for tilt in [-1.2, 0.0, 1.2] {
            let camera = Affine3A::from_rotation_y(2.0) * Affine3A::from_rotation_x(tilt);
            let LightKind::Directional { direction, .. } = key_light(&camera) else { panic!() };
            let heading = Affine3A::from_rotation_y(2.0);
            let in_camera = heading.inverse().transform_vector3(-direction);
            assert!(in_camera.x < -0.3 && in_camera.y > 0.5 && in_camera.z > 0.3, "{in_camera}");
        }
    }
}
