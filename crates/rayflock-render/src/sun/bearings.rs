//! Which way is up, north and east in a scene.

use std::f64::consts::TAU;
use std::fmt;
use std::str::FromStr;

use glam::{Affine3A, DVec3, Vec3};

use super::SunPosition;

/// An axis of a scene, in its positive direction.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Axis {
    /// +X.
    X,
    /// +Y, which points up in glTF and in most scenes.
    #[default]
    Y,
    /// +Z, which points up in most CAD, robotics and map data.
    Z,
}

impl Axis {
    /// East, north and up where this axis points up and north is not turned.
    const fn unturned(self) -> [DVec3; 3] {
        match self {
            Self::X => [DVec3::Y, DVec3::Z, DVec3::X],
            Self::Y => [DVec3::X, DVec3::NEG_Z, DVec3::Y],
            Self::Z => [DVec3::X, DVec3::Y, DVec3::Z],
        }
    }

    /// Turns a scene whose +Y points up into one in which this axis does; north stays north.
    pub fn from_y_up(self) -> Affine3A {
        let [east, north, up] = self.unturned().map(DVec3::as_vec3a);
        Affine3A::from_cols(east, up, -north, glam::Vec3A::ZERO)
    }
}

impl fmt::Display for Axis {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::X => "x",
            Self::Y => "y",
            Self::Z => "z",
        })
    }
}

impl FromStr for Axis {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        match name {
            "x" => Ok(Self::X),
            "y" => Ok(Self::Y),
            "z" => Ok(Self::Z),
            _ => Err(format!("found \"{name}\", expected x, y or z")),
        }
    }
}

/// Which way is up, north and east in a scene: unit vectors at right angles, in world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bearings {
    east: DVec3,
    north: DVec3,
    up: DVec3,
}

impl Bearings {
    /// Bearings where `up` points up and north is turned by `north` radians, clockwise as seen
    /// from above, from where it is without a turn:
    ///
    /// | Up | North | East |
    /// |---|---|---|
    /// | +X | +Z | +Y |
    /// | +Y | -Z | +X |
    /// | +Z | +Y | +X |
    pub fn new(up: Axis, north: f64) -> Self {
        let [east_axis, north_axis, up] = up.unturned();
        // A whole turn changes nothing, so that large angles do not lose digits.
        let (sin, cos) = (north % TAU).sin_cos();
        let north = cos * north_axis + sin * east_axis;
        Self { east: cos * east_axis - sin * north_axis, north, up }
    }

    /// The direction towards the sun, of unit length, in world space.
    pub fn to_sun(&self, position: &SunPosition) -> Vec3 {
        let (sin_azimuth, cos_azimuth) = position.azimuth.sin_cos();
        let (sin_elevation, cos_elevation) = position.elevation.sin_cos();
        let along_ground = cos_azimuth * self.north + sin_azimuth * self.east;
        (cos_elevation * along_ground + sin_elevation * self.up).as_vec3()
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_2;

    use super::*;

    /// The direction towards a sun at this azimuth on the horizon, in degrees.
    fn towards(bearings: &Bearings, azimuth: f64) -> Vec3 {
        let azimuth = azimuth.to_radians();
        bearings.to_sun(&SunPosition { azimuth, elevation: 0.0 })
    }

    #[test]
    fn east_north_and_up_are_right_handed_whatever_points_up() {
        for up in [Axis::X, Axis::Y, Axis::Z] {
            for north in [0.0, 1.0, -2.5, 40.0] {
                let Bearings { east, north, up } = Bearings::new(up, north);
                assert!((east.cross(north) - up).length() < 1e-12, "{east} {north} {up}");
            }
            assert_eq!(up.to_string().parse(), Ok(up));
            assert!((up.from_y_up().matrix3.determinant() - 1.0).abs() < 1e-6);
        }
        assert_eq!("w".parse::<Axis>(), Err("found \"w\", expected x, y or z".to_owned()));
    }

    #[test]
    fn azimuth_runs_from_north_over_east() {
        let y_up = Bearings::new(Axis::Y, 0.0);
        assert!(towards(&y_up, 0.0).distance(-Vec3::Z) < 1e-6);
        assert!(towards(&y_up, 90.0).distance(Vec3::X) < 1e-6);
        assert!(towards(&Bearings::new(Axis::Z, 0.0), 0.0).distance(Vec3::Y) < 1e-6);
        let zenith = SunPosition { azimuth: 3.0, elevation: FRAC_PI_2 };
        assert!(Bearings::new(Axis::X, 1.0).to_sun(&zenith).distance(Vec3::X) < 1e-6);
    }

    #[test]
    fn north_turns_clockwise_as_seen_from_above() {
        let north_is_east = Bearings::new(Axis::Y, FRAC_PI_2);
        assert!(towards(&north_is_east, 0.0).distance(Vec3::X) < 1e-6);
        assert!(towards(&north_is_east, 90.0).distance(Vec3::Z) < 1e-6);
    }

    #[test]
    fn a_scene_keeps_its_north_when_another_axis_points_up() {
        let y_up = Bearings::new(Axis::Y, 0.0);
        for up in [Axis::X, Axis::Y, Axis::Z] {
            for azimuth in [0.0, 90.0, 200.0] {
                let turned = up.from_y_up().transform_vector3(towards(&y_up, azimuth));
                assert!(turned.distance(towards(&Bearings::new(up, 0.0), azimuth)) < 1e-6);
            }
        }
    }
}
