//! A camera for scenes that bring none.

use glam::{Affine3A, Mat3A, Vec3, Vec3A};
use rayflock_geom::Aabb;

use crate::Projection;

/// Angle between the top and the bottom of the picture.
const VERTICAL_FOV: f32 = 40.0_f32.to_radians();
/// Angle around the vertical by which the camera stands off the front (+Z) towards +X.
const AZIMUTH: f32 = 35.0_f32.to_radians();
/// Angle by which the camera looks down.
const ELEVATION: f32 = 20.0_f32.to_radians();
/// Share of the distance that is added, so that nothing touches the edge of the picture.
const MARGIN: f32 = 0.05;

/// A camera that sees all of `bounds` in a picture of `aspect` (width / height): three-quarter
/// view from slightly above. Returns `world_from_camera` and the projection.
///
/// The camera looks at the middle of the box from just so far that all eight corners are in the
/// picture. Where the box is empty or has no size that can be used, it is taken for a cube of
/// edge 2; an aspect that is no positive number is taken for 1.
pub fn frame_bounds(bounds: &Aabb, aspect: f32) -> (Affine3A, Projection) {
    let usable = !bounds.is_empty() && (bounds.max - bounds.min).length_squared().is_normal();
    let bounds = if usable { *bounds } else { cube_at(bounds) };
    let aspect = if aspect.is_finite() && aspect > 0.0 { aspect } else { 1.0 };
    let towards_camera = Vec3A::new(
        AZIMUTH.sin() * ELEVATION.cos(),
        ELEVATION.sin(),
        AZIMUTH.cos() * ELEVATION.cos(),
    );
    let right = Vec3A::Y.cross(towards_camera).normalize();
    let axes = Mat3A::from_cols(right, towards_camera.cross(right), towards_camera);

    // A corner (x, y, z) relative to the middle, in the camera's axes, is in the picture iff
    // |y| <= (distance - z) * tan(fov / 2), and the same for x.
    let tan_up = (0.5 * VERTICAL_FOV).tan();
    let tan_right = tan_up * aspect;
    let center = bounds.center();
    let half = 0.5 * bounds.size();
    let distance = (0..8).fold(0.0_f32, |distance, bits| {
        let sign = |axis: i32| if bits & (1 << axis) == 0 { -1.0 } else { 1.0 };
        let corner = axes.transpose() * Vec3A::from(half * Vec3::new(sign(0), sign(1), sign(2)));
        let reach = (corner.x.abs() / tan_right).max(corner.y.abs() / tan_up);
        distance.max(corner.z + reach)
    });

    let eye = Vec3A::from(center) + towards_camera * (distance * (1.0 + MARGIN));
    let projection = Projection::Perspective { vertical_fov: VERTICAL_FOV };
    (Affine3A { matrix3: axes, translation: eye }, projection)
}

/// A cube of edge 2 around the middle of the box where that is finite, or else the origin.
fn cube_at(bounds: &Aabb) -> Aabb {
    let center = if bounds.center().is_finite() { bounds.center() } else { Vec3::ZERO };
    Aabb { min: center - Vec3::ONE, max: center + Vec3::ONE }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Positions of the corners in the picture, in which the edges are at -1 and 1.
    fn projected_corners(bounds: &Aabb, aspect: f32) -> Vec<(f32, f32)> {
        let (world_from_camera, projection) = frame_bounds(bounds, aspect);
        let Projection::Perspective { vertical_fov } = projection else { panic!("{projection:?}") };
        let camera_from_world = world_from_camera.inverse();
        let tan = (0.5 * vertical_fov).tan();
        let pick = |bits: u8, axis: usize| {
            if bits & (1 << axis) == 0 { bounds.min[axis] } else { bounds.max[axis] }
        };
        let corner = |bits| {
            let corner = Vec3::new(pick(bits, 0), pick(bits, 1), pick(bits, 2));
            let p = camera_from_world.transform_point3(corner);
            assert!(p.z < 0.0, "behind the camera: {p}");
            (p.x / (-p.z * tan * aspect), p.y / (-p.z * tan))
        };
        (0..8).map(corner).collect()
    }

    proptest! {
        #[test]
        fn the_box_is_in_the_picture_and_fills_it(
            center in prop::array::uniform3(-50.0..50.0_f32),
            half in prop::array::uniform3(0.1..20.0_f32),
            aspect in 0.3..3.0_f32,
        ) {
            let (center, half) = (Vec3::from(center), Vec3::from(half));
            let bounds = Aabb { min: center - half, max: center + half };
            let corners = projected_corners(&bounds, aspect);
            let reach = corners.iter().fold(0.0_f32, |r, (x, y)| r.max(x.abs()).max(y.abs()));
            prop_assert!(reach < 0.999 && reach > 0.8, "{reach}");
        }
    }

    #[test]
    fn the_camera_stands_upright_and_looks_down_a_little() {
        let (camera, _) = frame_bounds(&Aabb { min: -Vec3::ONE, max: Vec3::ONE }, 1.0);
        let axes = camera.matrix3;
        assert!((axes.determinant() - 1.0).abs() < 1e-5);
        assert!(axes.x_axis.y.abs() < 1e-6 && axes.y_axis.y > 0.9);
        assert!(camera.translation.x > 0.0 && camera.translation.y > 0.0);
    }

    #[test]
    fn boxes_without_size_and_odd_aspects_still_give_a_camera() {
        let far = Vec3::splat(f32::MAX);
        let boxes = [
            Aabb::EMPTY,
            Aabb { min: Vec3::ONE, max: Vec3::ONE },
            Aabb { min: -far, max: far },
            Aabb { min: Vec3::splat(f32::NAN), max: Vec3::ONE },
        ];
        for bounds in boxes {
            for aspect in [1.0, 0.0, f32::NAN, f32::INFINITY] {
                assert!(frame_bounds(&bounds, aspect).0.is_finite(), "{bounds:?} {aspect}");
            }
        }
    }
}
