//! What the camera sees: where rays of most kinds start.

use rayflock::engine::RayEngine;
use rayflock::geom::{Geometry, GeometryObject, PrimKind, Ray, transform_point};
use rayflock::prelude::*;
use rayon::prelude::*;

use super::super::Surroundings;
use super::camera_rays::camera_rays;

/// What one pixel sees.
#[derive(Clone, Copy, Debug)]
pub(super) struct SurfacePoint {
    /// Whether it sees anything; if not, the point is the camera and the normal looks back.
    pub(super) is_there: bool,
    /// The point.
    pub(super) position: Vec3,
    /// The point, moved off the surface by the surroundings' offset.
    pub(super) start: Vec3,
    /// Unit normal of the surface, on the side that is seen.
    pub(super) normal: Vec3,
    /// Where the ray from the camera goes.
    pub(super) incoming: Vec3,
}

/// One point for each pixel of an image of `size`, in tiles. `engine` has `geometry` committed.
pub(super) fn surface_points(
    surroundings: &Surroundings,
    size: [usize; 2],
    geometry: &Geometry,
    engine: &mut dyn RayEngine,
) -> Vec<SurfacePoint> {
    let rays = camera_rays(&surroundings.view, size);
    let batch = rays.batch();
    let mut hits = HitBuffer::new(batch.len());
    engine.closest_hit(&batch, &mut hits.as_hits());
    let point =
        |ray_idx| point_of(&batch.ray(ray_idx), &hits.get(ray_idx), geometry, surroundings.offset);
    (0..batch.len()).into_par_iter().map(point).collect()
}

fn point_of(ray: &Ray, hit: &Hit, geometry: &Geometry, offset: f32) -> SurfacePoint {
    let incoming = ray.direction;
    let back = -incoming;
    let is_there = !hit.is_miss();
    let position = if is_there { ray.at(hit.t) } else { ray.origin };
    let object = geometry.object(hit.object_id).filter(|_| is_there);
    let normal = object.and_then(|object| normal_at(object, hit, position)).unwrap_or(back);
    let normal = if normal.dot(back) < 0.0 { -normal } else { normal };
    SurfacePoint { is_there, position, start: position + offset * normal, normal, incoming }
}

/// A unit normal at a point of an object; `None` for primitives that have none to tell.
fn normal_at(object: &GeometryObject, hit: &Hit, position: Vec3) -> Option<Vec3> {
    let in_world = |point: Vec3| {
        object.world_from_object.map_or(point, |transform| transform_point(&transform, point))
    };
    match object.shape.prim_kind(hit.prim_id) {
        PrimKind::Triangle(idx) => {
            // Edges of the smallest triangles have products too small for single precision.
            let [a, b, c] = object.shape.corners(idx).map(|corner| in_world(corner).as_dvec3());
            let normal = (b - a).cross(c - a).try_normalize()?;
            Some(normal.as_vec3())
        }
        PrimKind::Sphere(idx) => {
            (position - in_world(object.shape.spheres()[idx].center)).try_normalize()
        }
        PrimKind::User(_) => None,
    }
}
