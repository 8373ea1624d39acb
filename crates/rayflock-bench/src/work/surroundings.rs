//! What rays of all kinds are made from.

use rayflock::geom::Aabb;
use rayflock::prelude::{Affine3A, Vec3, View};
use rayflock::scene::{LightKind, Projection};

/// Where the camera, the lights and the scanner are, and how near to surfaces rays begin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surroundings {
    /// The camera.
    pub view: View,
    /// Place of the point light.
    pub point_light: Vec3,
    /// Direction to the sun, of unit length.
    pub to_sun: Vec3,
    /// A camera that looks straight down, for rays of one direction.
    pub from_above: View,
    /// Place of the scanner.
    pub lidar: Vec3,
    /// Angles above the horizon of the scanner's lowest and highest row.
    pub lidar_elevation: [f32; 2],
    /// How far from the surface rays start that leave it.
    pub offset: f32,
    /// The share of the way to a surface at which rays from a light end.
    pub shadow_end: f32,
    /// Length of rays for ambient occlusion.
    pub ao_reach: f32,
}

impl Surroundings {
    /// Surroundings for any scene: its first lights, or others in usual places, and lengths that
    /// suit `bounds` (where those are empty, a box of edge 2).
    pub fn of_scene(bounds: &Aabb, view: View, lights: &[LightKind]) -> Self {
        let unit_box = Aabb { min: -Vec3::ONE, max: Vec3::ONE };
        let bounds = if bounds.is_empty() { &unit_box } else { bounds };
        let (center, size) = (bounds.center(), bounds.size());
        let diagonal = size.length().max(f32::MIN_POSITIVE);
        let point_light = lights
            .iter()
            .find_map(place_of)
            .unwrap_or_else(|| center + size * Vec3::new(0.2, 0.45, 0.3));
        let to_sun = lights.iter().find_map(direction_to);
        let top = center.with_y(bounds.max.y + 1e-3 * diagonal);
        let edge = size.x.max(size.z).max(1e-3 * diagonal);
        Self {
            view,
            point_light,
            to_sun: to_sun.unwrap_or_else(|| Vec3::new(0.3, 1.0, 0.2).normalize()),
            from_above: from_above(top, edge),
            lidar: center,
            lidar_elevation: [-25.0_f32, 25.0].map(f32::to_radians),
            offset: 5e-5 * diagonal,
            shadow_end: 0.9999,
            ao_reach: 0.1 * diagonal,
        }
    }
}

/// A camera that looks straight down from a level square, with -Z at the top of its picture.
pub(super) fn from_above(middle: Vec3, edge: f32) -> View {
    let world_from_camera = Affine3A::from_translation(middle)
        * Affine3A::from_rotation_x(-std::f32::consts::FRAC_PI_2);
    View::new(world_from_camera, Projection::Orthographic { height: edge })
}

fn place_of(light: &LightKind) -> Option<Vec3> {
    match light {
        LightKind::Point { position, .. } | LightKind::Spot { position, .. } => Some(*position),
        LightKind::Directional { .. } => None,
    }
}

fn direction_to(light: &LightKind) -> Option<Vec3> {
    match light {
        LightKind::Directional { direction, .. } => (-*direction).try_normalize(),
        LightKind::Point { .. } | LightKind::Spot { .. } => None,
    }
}

#[cfg(test)]
mod tests {
    use rayflock::scene::Falloff;

    use super::*;

    const BOUNDS: Aabb = Aabb { min: Vec3::ZERO, max: Vec3::new(10.0, 4.0, 8.0) };

    fn view() -> View {
        let projection = Projection::Perspective { vertical_fov: 1.0 };
        View::new(Affine3A::from_translation(Vec3::new(5.0, 2.0, 14.0)), projection)
    }

    #[test]
    fn a_scene_brings_its_first_light_of_each_kind() {
        let point = |x| LightKind::Point {
            position: Vec3::new(x, 0.0, 0.0),
            intensity: Vec3::ONE,
            falloff: Falloff::InverseSquare,
        };
        let sun = LightKind::Directional { direction: -2.0 * Vec3::Z, irradiance: Vec3::ONE };
        let view = view();
        let found = Surroundings::of_scene(&BOUNDS, view, &[sun, point(1.0), point(2.0)]);
        assert_eq!((found.point_light, found.to_sun), (Vec3::X, Vec3::Z));
        assert_eq!(found.view, view);
    }

    #[test]
    fn a_scene_without_lights_gets_some_in_usual_places() {
        let found = Surroundings::of_scene(&BOUNDS, view(), &[]);
        let above = found.point_light - BOUNDS.center();
        assert!(above.y > 0.0 && found.point_light.y < BOUNDS.max.y);
        assert!((found.to_sun.length() - 1.0).abs() < 1e-6 && found.to_sun.y > 0.0);
        let eye = Vec3::from(found.from_above.world_from_camera.translation);
        assert!(eye.y > 4.0 && eye.with_y(0.0) == Vec3::new(5.0, 0.0, 4.0));
        assert_eq!(found.from_above.projection, Projection::Orthographic { height: 10.0 });
        assert!(found.offset > 0.0 && found.offset < 1e-3 * BOUNDS.size().length());
    }

    #[test]
    fn an_empty_scene_gives_numbers_that_can_be_traced() {
        let view = view();
        let found = Surroundings::of_scene(&Aabb::EMPTY, view, &[]);
        assert!(found.point_light.is_finite() && found.lidar.is_finite(), "{found:?}");
        assert!(found.offset >= 0.0 && found.ao_reach > 0.0);
    }
}
