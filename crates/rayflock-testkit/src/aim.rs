//! Points of a scene that are worth a ray, and rays at them.

use glam::{Affine3A, Vec3};
use rayflock_geom::{Aabb, Geometry, GeometryObject, PrimId, PrimKind};

use crate::Rng;

/// What a scene offers as targets.
#[derive(Debug)]
pub(crate) struct Aim<'a> {
    objects: Vec<&'a GeometryObject>,
    bounds: Aabb,
}

impl<'a> Aim<'a> {
    pub(crate) fn at(geometry: &'a Geometry) -> Self {
        let objects: Vec<_> =
            geometry.objects().iter().filter(|object| object.shape.prim_count() > 0).collect();
        let bounds = geometry.bounds();
        let unit = Aabb { min: Vec3::NEG_ONE, max: Vec3::ONE };
        Self { objects, bounds: if bounds.is_empty() { unit } else { bounds } }
    }

    pub(crate) fn center(&self) -> Vec3 {
        self.bounds.center()
    }

    /// The longest edge of the box around the scene; never zero.
    pub(crate) fn size(&self) -> f32 {
        self.bounds.size().max_element().max(f32::MIN_POSITIVE)
    }

    /// A ray from anywhere at a target.
    pub(crate) fn ray(&self, rng: &mut Rng) -> (Vec3, Vec3) {
        let origin = match rng.below(8) {
            0 => self.target(rng),
            1 => self.center() + rng.pick(&[1e3, 1e6]) * self.size() * rng.on_sphere(),
            2 | 3 => self.center() + 2.0 * self.size() * rng.on_sphere(),
            _ => self.anywhere(rng),
        };
        self.ray_from(rng, origin)
    }

    /// A ray from `origin` at a target, or along an axis.
    pub(crate) fn ray_from(&self, rng: &mut Rng, origin: Vec3) -> (Vec3, Vec3) {
        let direction = match rng.below(8) {
            0 => rng.pick(&[1.0, -1.0]) * Vec3::AXES[rng.below(3)],
            1 => self.target(rng) - self.target(rng),
            _ => self.target(rng) - origin,
        };
        (origin, direction * any_length(rng))
    }

    /// A ray at a target along `direction`.
    pub(crate) fn ray_along(&self, rng: &mut Rng, direction: Vec3) -> (Vec3, Vec3) {
        let unit = direction.normalize_or(Vec3::X);
        let distance = rng.pick(&[0.0, 1.0, 3.0, 3.0]) * self.size();
        (self.target(rng) - distance * unit, direction)
    }

    fn anywhere(&self, rng: &mut Rng) -> Vec3 {
        self.center() + 0.6 * self.bounds.size() * rng.in_cube()
    }

    /// A vertex, a point of an edge or a face, a silhouette, or any point of the box.
    fn target(&self, rng: &mut Rng) -> Vec3 {
        let point = match self.objects.get(rng.below(self.objects.len())) {
            Some(object) if !rng.one_in(6) => point_of(rng, object),
            _ => self.anywhere(rng),
        };
        if point.is_finite() { point } else { self.anywhere(rng) }
    }
}

/// A point of a random primitive, in world space.
fn point_of(rng: &mut Rng, object: &GeometryObject) -> Vec3 {
    let mesh = &object.shape;
    let prim_id = PrimId(rng.below(mesh.prim_count()) as u32);
    let point = match mesh.prim_kind(prim_id) {
        PrimKind::Triangle(idx) => point_of_triangle(rng, mesh.corners(idx)),
        PrimKind::Sphere(idx) => {
            let sphere = mesh.spheres()[idx];
            sphere.center + rng.pick(&[0.0, 0.5, 0.99, 1.0]) * sphere.radius * rng.on_sphere()
        }
        PrimKind::User(idx) => {
            let bound = mesh.user().map(|user| user.bounding_sphere(idx)).unwrap_or_default();
            bound.center + 0.5 * bound.radius * rng.in_cube()
        }
    };
    let place = |transform: &Affine3A| transform.transform_point3(point);
    object.world_from_object.as_ref().map_or(point, place)
}

fn point_of_triangle(rng: &mut Rng, [a, b, c]: [Vec3; 3]) -> Vec3 {
    let (s, t) = (rng.unit(), rng.unit());
    match rng.below(4) {
        0 => a,
        1 => a.lerp(b, s),
        2 => 0.5 * (b + c),
        _ => a.lerp(b, s).lerp(c, t),
    }
}

/// A factor for directions: mostly 1, now and then huge or tiny.
fn any_length(rng: &mut Rng) -> f32 {
    match rng.below(16) {
        0 => rng.power_of_ten(-28, 28),
        1..4 => rng.power_of_ten(-12, 12),
        _ => 1.0,
    }
}
