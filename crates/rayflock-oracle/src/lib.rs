//! The independent oracle: which hits are right, which are wrong, and which may go either way.
//!
//! One ray at a time, in `f64`, against every primitive. It shares no code with the kernels and
//! the engines, transforms included. An engine's closest hit is right when
//!
//! - it is on a primitive that the ray certainly or perhaps passes through,
//! - its `t` lies in the range that the primitive allows, and in the ray's interval,
//! - the point that `u` and `v` name lies on the ray, within the tolerance,
//! - no certain hit is nearer beyond its own range of `t`.
//!
//! **Tolerance.** Each vertex may be moved by `2^-20` of its largest coordinate relative to the
//! ray's origin, which is what shearing it in `f32` does with some room; under a transform, also
//! by `2^-21` of the sizes that the transform adds up. The sphere's centre likewise. Everything
//! that this may change is [`Verdict::Borderline`]; all else is certain.
//!
//! **Cost**: some 100 ns for a primitive and a ray.
//!
//! ```
//! use glam::Vec3;
//! use rayflock_geom::{Geometry, GeometryObject, Hit, Mesh, ObjectId, Ray};
//! use rayflock_oracle::{Fault, Oracle};
//!
//! let corners = vec![Vec3::new(-1.0, -1.0, 2.0), Vec3::new(3.0, -1.0, 2.0), Vec3::new(0.0, 3.0, 2.0)];
//! let mesh = Mesh::from_triangles(corners, vec![[0, 1, 2]])?;
//! let oracle = Oracle::new(&Geometry::new(vec![GeometryObject::new(ObjectId(0), mesh)])?);
//! let ray = Ray::new(Vec3::ZERO, Vec3::Z);
//! assert!(matches!(oracle.judge(&ray, &Hit::MISS), Err(Fault::Beaten { .. })));
//! # Ok::<(), rayflock_geom::GeometryError>(())
//! ```
#![forbid(unsafe_code)]

mod candidate;
mod judge;
mod ray;
mod sphere;
mod triangle;
mod user;

use std::sync::Arc;

use glam::{Affine3A, DAffine3, DMat3, DVec3, Vec3};
use rayflock_geom::{Geometry, GeometryObject, ObjectId, PrimId, PrimKind, Ray, RayState};

pub use candidate::{Candidate, TRange, Verdict};
pub use judge::Fault;

use candidate::Crossing;
use ray::OracleRay;
use sphere::OracleSphere;
use triangle::Triangle;
use user::UserPrimitive;

/// How far a coordinate may be moved, relative to its distance from the ray's origin: `2^-20`.
const RELATIVE_SLACK: f64 = 1.0 / (1_u64 << 20) as f64;

/// What sums of transformed coordinates lose in `f32`, relative to the sum of sizes: `2^-21`.
const TRANSFORM_SLACK: f64 = 1.0 / (1_u64 << 21) as f64;

/// A few times the smallest `f32`: what underflow may lose.
const ABSOLUTE_SLACK: f64 = 1e-44;

/// Coordinates past this may overflow in `f32` arithmetic; nothing is certain there.
const OVERFLOW: f64 = 1e37;

/// All primitives of one frame, in world space and `f64`.
#[derive(Clone, Debug)]
pub struct Oracle {
    prims: Vec<Primitive>,
}

#[derive(Clone, Debug)]
struct Primitive {
    object_id: ObjectId,
    prim_id: PrimId,
    mask: u32,
    shape: Shape,
}

#[derive(Clone, Debug)]
enum Shape {
    Triangle(Triangle),
    Sphere(OracleSphere),
    User(UserPrimitive),
}

impl Oracle {
    /// The oracle for one frame. Primitives that are ignored by definition are left out.
    pub fn new(geometry: &Geometry) -> Self {
        let prims = geometry.objects().iter().flat_map(|object| {
            (0..object.shape.prim_count() as u32).filter_map(|idx| primitive(object, PrimId(idx)))
        });
        Self { prims: prims.collect() }
    }

    /// Every hit of `ray` in its interval that is certain or borderline, in the order of ids. A
    /// sphere may have two.
    pub fn candidates(&self, ray: &Ray) -> Vec<Candidate> {
        if ray.state() != RayState::Active {
            return Vec::new();
        }
        let seen_by = OracleRay::new(ray);
        let visible = self.prims.iter().filter(|prim| prim.mask & ray.mask != 0);
        visible
            .flat_map(|prim| {
                prim.meet(&seen_by).into_iter().flatten().map(|crossing| Candidate {
                    object_id: prim.object_id,
                    prim_id: prim.prim_id,
                    verdict: crossing.verdict,
                    t: crossing.t,
                })
            })
            .collect()
    }

    fn primitive(&self, object_id: ObjectId, prim_id: PrimId) -> Option<&Primitive> {
        let key = |prim: &Primitive| (prim.object_id, prim.prim_id);
        self.prims.binary_search_by_key(&(object_id, prim_id), key).ok().map(|i| &self.prims[i])
    }
}

impl Primitive {
    fn meet(&self, ray: &OracleRay) -> [Option<Crossing>; 2] {
        match &self.shape {
            Shape::Triangle(triangle) => [triangle.meet(ray), None],
            Shape::Sphere(sphere) => sphere.meet(ray),
            Shape::User(user) => [user.meet(ray), None],
        }
    }
}

/// The primitive in world space; `None` when it is ignored.
fn primitive(object: &GeometryObject, prim_id: PrimId) -> Option<Primitive> {
    let mesh = &object.shape;
    let transform = object.world_from_object.as_ref().map(in_f64);
    let shape = match mesh.prim_kind(prim_id) {
        PrimKind::Triangle(idx) => {
            let placed = mesh.corners(idx).map(|corner| place(transform.as_ref(), corner));
            let triangle = Triangle { corners: placed.map(|p| p.0), slack: placed.map(|p| p.1) };
            let finite = triangle.corners.iter().all(|corner| corner.is_finite());
            // Under a transform rounding may give a flat triangle some area; it stays borderline.
            let flat = transform.is_none() && triangle.is_flat();
            (finite && !flat).then_some(Shape::Triangle(triangle))
        }
        PrimKind::Sphere(idx) => {
            let sphere = mesh.spheres()[idx];
            let (center, slack) = place(transform.as_ref(), sphere.center);
            let radius = f64::from(sphere.radius) * scale(transform.as_ref());
            let valid = center.is_finite() && radius.is_finite() && radius > 0.0;
            valid.then_some(Shape::Sphere(OracleSphere { center, radius, slack }))
        }
        PrimKind::User(prim_idx) => user_primitive(object, transform.as_ref(), prim_idx),
    };
    shape.map(|shape| Primitive { object_id: object.id, prim_id, mask: object.mask, shape })
}

fn user_primitive(
    object: &GeometryObject,
    world_from_object: Option<&DAffine3>,
    prim_idx: usize,
) -> Option<Shape> {
    let prims = Arc::clone(object.shape.user()?);
    let bound = prims.bounding_sphere(prim_idx);
    let bounded = bound.center.is_finite() && bound.radius.is_finite() && bound.radius >= 0.0;
    let object_from_world = world_from_object.map(DAffine3::inverse);
    let invertible = object_from_world.is_none_or(|inverse| inverse.is_finite());
    let shape = UserPrimitive { prims, prim_idx, object_from_world };
    (bounded && invertible).then_some(Shape::User(shape))
}

fn in_f64(transform: &Affine3A) -> DAffine3 {
    let column = |axis: glam::Vec3A| Vec3::from(axis).as_dvec3();
    let m = &transform.matrix3;
    DAffine3 {
        matrix3: DMat3::from_cols(column(m.x_axis), column(m.y_axis), column(m.z_axis)),
        translation: column(transform.translation),
    }
}

/// A point in world space, and how far `f32` arithmetic may put it from there.
fn place(transform: Option<&DAffine3>, point: Vec3) -> (DVec3, f64) {
    let point = point.as_dvec3();
    let Some(transform) = transform else { return (point, 0.0) };
    let m = &transform.matrix3;
    let sizes = m.x_axis.abs() * point.x.abs()
        + m.y_axis.abs() * point.y.abs()
        + m.z_axis.abs() * point.z.abs()
        + transform.translation.abs();
    (transform.transform_point3(point), TRANSFORM_SLACK * sizes.max_element())
}

/// The root mean square of the factors by which the axes are scaled.
fn scale(transform: Option<&DAffine3>) -> f64 {
    let Some(transform) = transform else { return 1.0 };
    let m = &transform.matrix3;
    let squared = [m.x_axis, m.y_axis, m.z_axis].map(DVec3::length_squared);
    (squared.into_iter().sum::<f64>() / 3.0).sqrt()
}

#[cfg(test)]
mod tests;
