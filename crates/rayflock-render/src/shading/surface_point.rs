//! What a hit means in the world: position, normals, texture coordinates, material.
//!
//! Surfaces are two-sided: both normals are turned to the side from which the ray came.
//!
//! | Primitive | Geometric normal | Shading normal | Texture coordinates |
//! |---|---|---|---|
//! | triangle | its plane | interpolated, if the mesh has normals | interpolated, if it has any |
//! | sphere | from the centre | the same | longitude and latitude |
//! | user | toward the viewer: nothing else is known | the same | the hit's `u`, `v` |
//!
//! Rays leave a surface from a point moved off it by a distance that exceeds the rounding of the
//! point and of the next intersection, so that `t_min` can be 0.
//!
//! **Source**: the offset follows the reasoning, not the constants, of C. Waechter and N. Binder,
//! *A Fast and Robust Method for Avoiding Self-Intersection*, Ray Tracing Gems (2019), ch. 6: a
//! small multiple of the unit in the last place of the coordinates that went into the point.
//! Lifting shadow points to a smooth surface: J. Hanika, *Hacking the Shadow Terminator*, Ray
//! Tracing Gems II (2021), ch. 4.
//!
//! **Departures**: the offset is a length along the normal, in proportion to the largest vertex
//! coordinate, because `t` is solved from differences with the vertices. Shadow points are lifted
//! only where the vertex normals are within [`SMOOTH_COS`] of the facet's: others mean hard edges
//! that share normals, which lifting would let light leak around.

use glam::{DVec3, Vec2, Vec3, Vec3A};
use rayflock_geom::{Hit, PrimKind, Ray, transform_point, transform_sphere};
use rayflock_scene::{MaterialIdx, SurfaceAttributes};

use crate::frame_shading::{FrameShading, ShadedObject};

/// The offset relative to the largest coordinate: 32 units in the last place.
pub(super) const SLACK: f32 = 32.0 * f32::EPSILON;
/// Cosine of the angle up to which vertex normals count as those of a smooth surface.
pub(super) const SMOOTH_COS: f32 = 0.7;

/// A point of a surface, as a ray sees it. World space, unit lengths.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SurfacePoint {
    /// On the primitive.
    pub(crate) position: Vec3,
    /// Where shadow rays end: off the surface, and lifted toward the smooth one it stands for.
    pub(crate) shadow_position: Vec3,
    /// Geometric normal, on the side of the ray's origin.
    pub(crate) facet_normal: Vec3,
    /// Normal to shade with, in the hemisphere of `facet_normal`.
    pub(crate) normal: Vec3,
    /// Whether the ray came from outside, where the outward normal points.
    pub(crate) from_outside: bool,
    /// How far off the surface rays start.
    pub(crate) slack: f32,
    /// Texture coordinates, if there are any.
    pub(crate) uv: Option<Vec2>,
    /// Vertex colour; white where there is none.
    pub(crate) tint: Vec3,
    /// What the surface is made of.
    pub(crate) material: MaterialIdx,
}

impl SurfacePoint {
    /// A start for rays that stay on the ray's side.
    pub(crate) fn above(&self) -> Vec3 {
        self.position + self.slack * self.facet_normal
    }

    /// A start for rays that pass through.
    pub(crate) fn below(&self) -> Vec3 {
        self.position - self.slack * self.facet_normal
    }
}

/// The point that `ray` hit; `None` for a miss.
pub(crate) fn surface_point(frame: &FrameShading, ray: &Ray, hit: &Hit) -> Option<SurfacePoint> {
    let object = frame.object(hit.object_id)?;
    let mut point = match object.surface.mesh.prim_kind(hit.prim_id) {
        PrimKind::Triangle(triangle_idx) => on_triangle(object, triangle_idx, hit, ray),
        PrimKind::Sphere(sphere_idx) => on_sphere(object, sphere_idx, hit, ray),
        PrimKind::User(_) => on_user_primitive(hit, ray),
    };
    point.material = object.surface.attributes.materials.get(hit.prim_id);
    Some(point)
}

fn on_triangle(object: &ShadedObject, triangle_idx: usize, hit: &Hit, ray: &Ray) -> SurfacePoint {
    let shares = [1.0 - hit.u - hit.v, hit.u, hit.v];
    let corners = corners_of(object, triangle_idx);
    let position = interpolated(shares, corners);
    let outward = outward_normal(object, corners);
    let largest = corners.iter().fold(0.0_f32, |largest, v| largest.max(v.abs().max_element()));

    let mut point = facing(position, outward, largest, ray);
    (point.uv, point.tint) = attributes_of(object, triangle_idx, shares);
    if let Some(normals) = vertex_normals(object, triangle_idx) {
        smooth(&mut point, shares, corners, normals);
    }
    point
}

/// The corners of a triangle in world space.
#[inline]
pub(super) fn corners_of(object: &ShadedObject, triangle_idx: usize) -> [Vec3; 3] {
    let [v0, v1, v2] = object.surface.mesh.corners(triangle_idx);
    match &object.transform {
        Some(transform) => [
            transform_point(transform, v0),
            transform_point(transform, v1),
            transform_point(transform, v2),
        ],
        None => [v0, v1, v2],
    }
}

/// The unit normal of a triangle on its outer side.
#[inline]
pub(super) fn outward_normal(object: &ShadedObject, corners: [Vec3; 3]) -> Vec3 {
    triangle_normal(corners) * object.handedness
}

/// The normals of the vertices of a triangle in world space, of any length, if the mesh has any.
#[inline]
pub(super) fn vertex_normals(object: &ShadedObject, triangle_idx: usize) -> Option<[Vec3; 3]> {
    let normals = &object.surface.normals;
    if normals.is_empty() {
        return None;
    }
    let [v0, v1, v2] = object.surface.mesh.triangles()[triangle_idx];
    let in_world = |idx: u32| object.normal_from_object * normals[idx as usize];
    Some([in_world(v0), in_world(v1), in_world(v2)])
}

/// Texture coordinates and colour at a point of a triangle, where the vertices have any.
#[inline(always)]
pub(super) fn attributes_of(
    object: &ShadedObject,
    triangle_idx: usize,
    shares: [f32; 3],
) -> (Option<Vec2>, Vec3) {
    let SurfaceAttributes { uvs, colors, .. } = &*object.surface.attributes;
    let corner_idxs = object.surface.mesh.triangles()[triangle_idx].map(|idx| idx as usize);
    let uv = (!uvs.is_empty()).then(|| interpolated(shares, corner_idxs.map(|idx| uvs[idx])));
    let tint = if colors.is_empty() {
        Vec3::ONE
    } else {
        interpolated(shares, corner_idxs.map(|idx| colors[idx]))
    };
    (uv, tint)
}

fn on_sphere(object: &ShadedObject, sphere_idx: usize, hit: &Hit, ray: &Ray) -> SurfacePoint {
    let local = object.surface.mesh.spheres()[sphere_idx];
    let sphere = object.transform.map_or(local, |transform| transform_sphere(&transform, &local));
    // The point on the ray is rounded; the point on the sphere below it is much less so.
    let outward = (ray.at(hit.t) - sphere.center).normalize_or(-ray.direction);
    let position = sphere.center + sphere.radius * outward;
    let largest = sphere.center.abs().max_element() + sphere.radius;

    let mut point = facing(position, outward, largest, ray);
    let axis = object.transform.map_or(outward, |m| {
        Vec3::from(m.matrix3.transpose() * Vec3A::from(outward)).normalize_or(outward)
    });
    let longitude = axis.x.atan2(axis.z) / std::f32::consts::TAU;
    let latitude = axis.y.clamp(-1.0, 1.0).acos() / std::f32::consts::PI;
    point.uv = Some(Vec2::new(0.5 + longitude, latitude));
    point
}

fn on_user_primitive(hit: &Hit, ray: &Ray) -> SurfacePoint {
    let position = ray.at(hit.t);
    let largest = position.abs().max_element().max(ray.origin.abs().max_element());
    let toward_viewer = (-ray.direction).normalize_or(Vec3::Y);
    let mut point = facing(position, toward_viewer, largest, ray);
    point.uv = Some(Vec2::new(hit.u, hit.v));
    point
}

/// A point without attributes, its normal turned to the viewer.
fn facing(position: Vec3, outward: Vec3, largest_coordinate: f32, ray: &Ray) -> SurfacePoint {
    let from_outside = outward.dot(ray.direction) <= 0.0;
    let facet_normal = if from_outside { outward } else { -outward };
    let slack = slack(largest_coordinate);
    SurfacePoint {
        position,
        shadow_position: position + slack * facet_normal,
        facet_normal,
        normal: facet_normal,
        from_outside,
        slack,
        uv: None,
        tint: Vec3::ONE,
        material: MaterialIdx::default(),
    }
}

/// Takes the shading normal from those of the vertices, which need not be of unit length.
fn smooth(point: &mut SurfacePoint, shares: [f32; 3], corners: [Vec3; 3], normals: [Vec3; 3]) {
    let units = normals.map(Vec3::normalize_or_zero);
    let normal = interpolated(shares, units).normalize_or_zero();
    if !normal.is_finite() || normal == Vec3::ZERO {
        return;
    }
    let side = if normal.dot(point.facet_normal) < 0.0 { -1.0 } else { 1.0 };
    point.normal = side * normal;

    let units = units.map(|unit| side * unit);
    if units.iter().all(|unit| unit.dot(point.facet_normal) > SMOOTH_COS) {
        let lift = |i: usize| (corners[i] - point.position).dot(units[i]).max(0.0) * units[i];
        point.shadow_position += interpolated(shares, [lift(0), lift(1), lift(2)]);
    }
}

/// The unit normal on the side from which the corners run counter-clockwise.
fn triangle_normal(corners: [Vec3; 3]) -> Vec3 {
    area_normal(corners).normalize_or_zero().as_vec3()
}

/// The normal on the side from which the corners run counter-clockwise, twice as long as the
/// triangle is large; formed in `f64` so that it does not underflow.
pub(crate) fn area_normal(corners: [Vec3; 3]) -> DVec3 {
    let [v0, v1, v2] = corners.map(Vec3::as_dvec3);
    (v1 - v0).cross(v2 - v0)
}

/// How far off a surface rays start, where no coordinate of its corners exceeds this.
pub(crate) fn slack(largest_coordinate: f32) -> f32 {
    SLACK * largest_coordinate.max(f32::MIN_POSITIVE)
}

fn interpolated<T>(shares: [f32; 3], values: [T; 3]) -> T
where
    T: Copy + std::ops::Add<Output = T> + std::ops::Mul<f32, Output = T>,
{
    values[0] * shares[0] + values[1] * shares[1] + values[2] * shares[2]
}
