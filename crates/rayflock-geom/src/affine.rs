//! Transforms in one fixed order of operations, so that every engine gets the same bits.

use glam::{Affine3A, DAffine3, DMat3, DVec3, Vec3, Vec3A};

use crate::{Ray, Sphere};

/// How far two columns of a similarity may differ in squared length, and two axes from a right
/// angle, relative to the scale.
const SIMILARITY_TOLERANCE: f32 = 1e-4;

/// The image of a point: `((x * X + y * Y) + z * Z) + T`, without fused operations.
#[inline(always)]
pub fn transform_point(world_from_object: &Affine3A, point: Vec3) -> Vec3 {
    let m = &world_from_object.matrix3;
    let (x, y, z) = (Vec3::from(m.x_axis), Vec3::from(m.y_axis), Vec3::from(m.z_axis));
    x * point.x + y * point.y + z * point.z + Vec3::from(world_from_object.translation)
}

/// The factor by which a similarity (rotation, reflection, uniform scale, translation) scales
/// lengths; `None` for any other transform.
pub fn similarity_scale(world_from_object: &Affine3A) -> Option<f32> {
    let m = &world_from_object.matrix3;
    let squared = [m.x_axis, m.y_axis, m.z_axis].map(Vec3A::length_squared);
    let scale_squared = (squared[0] + squared[1] + squared[2]) / 3.0;
    let tolerance = SIMILARITY_TOLERANCE * scale_squared;
    let even = squared.iter().all(|length| (length - scale_squared).abs() <= tolerance);
    let dots = [m.x_axis.dot(m.y_axis), m.y_axis.dot(m.z_axis), m.z_axis.dot(m.x_axis)];
    let square = dots.iter().all(|dot| dot.abs() <= tolerance);
    (even && square).then(|| scale_squared.sqrt())
}

/// The image of a sphere under a similarity; under any other transform a sphere of NaN radius,
/// which nothing hits.
pub fn transform_sphere(world_from_object: &Affine3A, sphere: &Sphere) -> Sphere {
    let scale = similarity_scale(world_from_object).unwrap_or(f32::NAN);
    Sphere::new(transform_point(world_from_object, sphere.center), scale * sphere.radius)
}

/// Takes rays into an object's space and bounds back out of it, for user primitives.
#[derive(Clone, Copy, Debug)]
pub struct RayTransform {
    object_from_world: Affine3A,
    /// Largest factor by which the transform stretches a length.
    stretch: f32,
    /// Rounding of a ray taken to object space, seen in world space, relative to the magnitudes
    /// of origin and hit; and absolutely.
    relative_slack: f32,
    absolute_slack: f32,
}

impl RayTransform {
    /// The transform between world and object; `None` when it cannot be inverted in `f32`.
    pub fn new(world_from_object: &Affine3A) -> Option<Self> {
        let m = &world_from_object.matrix3;
        let columns = [m.x_axis, m.y_axis, m.z_axis].map(|axis| Vec3::from(axis).as_dvec3());
        let matrix = DMat3::from_cols(columns[0], columns[1], columns[2]);
        let translation = Vec3::from(world_from_object.translation).as_dvec3();
        let inverse = DAffine3 { matrix3: matrix, translation }.inverse();
        let [x, y, z] = [inverse.x_axis, inverse.y_axis, inverse.z_axis].map(DVec3::as_vec3a);
        let object_from_world = Affine3A::from_cols(x, y, z, inverse.translation.as_vec3a());
        if !object_from_world.is_finite() {
            return None;
        }
        let stretch = frobenius(columns);
        let shrink = frobenius([inverse.x_axis, inverse.y_axis, inverse.z_axis]);
        let relative = f64::from(f32::EPSILON) * 8.0 * (1.0 + stretch * shrink);
        let absolute = f64::from(f32::EPSILON) * 8.0 * stretch * inverse.translation.length();
        Some(Self {
            object_from_world,
            stretch: (stretch * (1.0 + 1e-6)) as f32,
            relative_slack: relative as f32,
            absolute_slack: absolute as f32,
        })
    }

    /// The ray in object space; `t` stays the same.
    pub fn ray_in_object(&self, ray: &Ray) -> Ray {
        let m = &self.object_from_world.matrix3;
        let (x, y, z) = (Vec3::from(m.x_axis), Vec3::from(m.y_axis), Vec3::from(m.z_axis));
        let d = ray.direction;
        let origin = transform_point(&self.object_from_world, ray.origin);
        Ray { origin, direction: x * d.x + y * d.y + z * d.z, ..*ray }
    }

    /// A sphere in world space around the image of a sphere in object space.
    pub fn sphere_in_world(&self, world_from_object: &Affine3A, sphere: &Sphere) -> Sphere {
        let center = transform_point(world_from_object, sphere.center);
        let translation = Vec3::from(world_from_object.translation);
        let magnitude = center.abs().max_element() + 2.0 * translation.abs().max_element();
        let rounding = 4.0 * f32::EPSILON * magnitude;
        let radius = self.stretch * sphere.radius * (1.0 + 4.0 * f32::EPSILON);
        Sphere::new(center, radius + rounding + self.absolute_slack)
    }

    /// How far, relative to the magnitudes of origin and hit in world space, a hit found in
    /// object space may lie beside the ray.
    pub const fn relative_slack(&self) -> f32 {
        self.relative_slack
    }
}

fn frobenius(columns: [DVec3; 3]) -> f64 {
    columns.iter().map(|column| column.length_squared()).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_similarities_have_a_scale() {
        let similar = Affine3A::from_rotation_x(0.3) * Affine3A::from_scale(Vec3::splat(-2.0));
        assert!((similarity_scale(&similar).unwrap() - 2.0).abs() < 1e-5);
        assert!(similarity_scale(&Affine3A::from_scale(Vec3::new(1.0, 1.0, 1.01))).is_none());
    }

    #[test]
    fn a_ray_keeps_its_parameter_in_object_space() {
        let transform = Affine3A::from_scale_rotation_translation(
            Vec3::new(2.0, 3.0, 0.5),
            glam::Quat::from_rotation_y(0.7),
            Vec3::new(5.0, -1.0, 2.0),
        );
        let ray = Ray::new(Vec3::new(1.0, 2.0, 3.0), Vec3::new(-1.0, 0.5, 2.0));
        let in_object = RayTransform::new(&transform).unwrap().ray_in_object(&ray);
        let back = transform_point(&transform, in_object.at(1.5));
        assert!((back - ray.at(1.5)).length() < 1e-5);
        assert!(RayTransform::new(&Affine3A::from_scale(Vec3::new(1.0, 0.0, 1.0))).is_none());
    }
}
