//! What rays of all kinds are made from.

use rayflock::geom::Aabb;
use rayflock::prelude::{Vec3, View};
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
    /// Height of the plane that orthographic rays start from.
    pub film_height: f32,
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
        let eye = Vec3::from(view.world_from_camera.translation);
        let film_height = match view.projection {
            Projection::Perspective { vertical_fov } => {
                2.0 * (0.5 * vertical_fov).tan() * eye.distance(center)
            }
            Projection::Orthographic { height } => height,
        };
        Self {
            view,
            point_light,
            to_sun: to_sun.unwrap_or_else(|| Vec3::new(0.3, 1.0, 0.2).normalize()),
            film_height,
            lidar: center,
            lidar_elevation: [-25.0_f32, 25.0].map(f32::to_radians),
            offset: 5e-5 * diagonal,
            shadow_end: 0.9999,
            ao_reach: 0.1 * diagonal,
        }
    }
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
    use rayflock::prelude::Affine3A;
    use rayflock::scene::Falloff;

    use super::*;

    const BOUNDS: Aabb = Aabb { min: Vec3::ZERO, max: Vec3::new(10.0, 4.0, 8.0) };

    fn view(projection: Projection) -> View {
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
        let view = view(Projection::Orthographic { height: 3.0 });
        let found = Surroundings::of_scene(&BOUNDS, view, &[sun, point(1.0), point(2.0)]);
        assert_eq!((found.point_light, found.to_sun), (Vec3::X, Vec3::Z));
        assert_eq!(found.film_height, 3.0);
    }

    #[test]
    fn a_scene_without_lights_gets_some_in_usual_places() {
        let vertical_fov = std::f32::consts::FRAC_PI_2;
        let view = view(Projection::Perspective { vertical_fov });
        let found = Surroundings::of_scene(&BOUNDS, view, &[]);
        let above = found.point_light - BOUNDS.center();
        assert!(above.y > 0.0 && found.point_light.y < BOUNDS.max.y);
        assert!((found.to_sun.length() - 1.0).abs() < 1e-6 && found.to_sun.y > 0.0);
        // A right angle from 10 in front of the middle.
        assert!((found.film_height - 20.0).abs() < 1e-4);
        assert!(found.offset > 0.0 && found.offset < 1e-3 * BOUNDS.size().length());
    }

    #[test]
    fn an_empty_scene_gives_numbers_that_can_be_traced() {
        let view = view(Projection::Orthographic { height: 3.0 });
        let found = Surroundings::of_scene(&Aabb::EMPTY, view, &[]);
        assert!(found.point_light.is_finite() && found.lidar.is_finite(), "{found:?}");
        assert!(found.offset >= 0.0 && found.ao_reach > 0.0);
    }
}
