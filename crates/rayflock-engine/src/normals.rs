//! Normals of what was hit.

use glam::{DVec3, Vec3};
use rayflock_geom::{Geometry, HitBuffer, ObjectId, PrimId, PrimKind, RayBatch, transform_point};
use rayon::prelude::*;

/// Rays that one task takes.
const CHUNK: usize = 4096;

/// Writes the unit normal in world space of what each ray hit; zero for a miss, for a user primitive
/// and where there is no direction.
///
/// A triangle's normal points to where its corners run counter-clockwise, whatever side was hit;
/// a sphere's points outward. `geometry` is the frame in which `rays` hit `hits`.
///
/// # Panics
/// When the columns of `hits` and `normals` are not as long as the batch.
pub fn hit_normals(
    geometry: &Geometry,
    rays: &RayBatch<'_>,
    hits: HitColumns<'_>,
    normals: &mut [[f32; 3]],
) {
    let lens = [hits.t.len(), hits.object_id.len(), hits.prim_id.len(), normals.len()];
    assert_eq!(lens, [rays.len(); 4], "every column must have one entry for each ray");
    normals.par_chunks_mut(CHUNK).enumerate().for_each(|(chunk_idx, normals)| {
        for (ray_idx, normal) in (chunk_idx * CHUNK..).zip(normals) {
            *normal = hit_normal(geometry, rays, hits, ray_idx).to_array();
        }
    });
}

/// What normals are made of: columns of the hits of a batch.
#[derive(Clone, Copy, Debug)]
pub struct HitColumns<'a> {
    /// Distances.
    pub t: &'a [f32],
    /// Objects.
    pub object_id: &'a [u32],
    /// Primitives.
    pub prim_id: &'a [u32],
}

impl<'a> From<&'a HitBuffer> for HitColumns<'a> {
    fn from(hits: &'a HitBuffer) -> Self {
        Self { t: &hits.t, object_id: &hits.object_id, prim_id: &hits.prim_id }
    }
}

fn hit_normal(
    geometry: &Geometry,
    rays: &RayBatch<'_>,
    hits: HitColumns<'_>,
    ray_idx: usize,
) -> Vec3 {
    let Some(object) = geometry.object(ObjectId(hits.object_id[ray_idx])) else {
        return Vec3::ZERO;
    };
    let in_world = |point| match &object.world_from_object {
        Some(world_from_object) => transform_point(world_from_object, point),
        None => point,
    };
    match object.shape.prim_kind(PrimId(hits.prim_id[ray_idx])) {
        PrimKind::Triangle(triangle_idx) => {
            let [v0, v1, v2] = object.shape.corners(triangle_idx).map(in_world);
            unit((v1 - v0).as_dvec3().cross((v2 - v0).as_dvec3()))
        }
        PrimKind::Sphere(sphere_idx) => {
            let center = in_world(object.shape.spheres()[sphere_idx].center);
            unit((rays.ray(ray_idx).at(hits.t[ray_idx]) - center).as_dvec3())
        }
        PrimKind::User(_) => Vec3::ZERO,
    }
}

/// The vector at length one, or zero. Single precision is faster and enough for most lengths.
fn unit(vector: DVec3) -> Vec3 {
    let single = vector.as_vec3();
    let squared = single.length_squared();
    if squared.is_normal() && squared.is_finite() {
        single / squared.sqrt()
    } else {
        vector.normalize_or_zero().as_vec3()
    }
}

#[cfg(test)]
mod tests {
    use glam::Affine3A;
    use rayflock_geom::{FrameChanges, GeometryObject, Mesh, Sphere};

    use super::*;
    use crate::{EngineKind, create};

    #[test]
    fn normals_are_those_of_the_world_and_zero_for_a_miss() {
        let triangle = |size: f32| {
            let vertices = vec![Vec3::ZERO, size * Vec3::X, size * Vec3::Y];
            Mesh::from_triangles(vertices, vec![[0, 1, 2]]).unwrap()
        };
        let turned = Affine3A::from_translation(Vec3::X * 4.0) * Affine3A::from_rotation_y(1.0);
        let ball = Mesh::from_spheres(vec![Sphere::new(Vec3::ZERO, 1.0)]);
        let at = |x| Affine3A::from_translation(Vec3::X * x);
        let geometry = Geometry::new(vec![
            GeometryObject::new(ObjectId(0), triangle(1.0)),
            GeometryObject::new(ObjectId(3), triangle(1.0)).with_transform(turned),
            GeometryObject::new(ObjectId(5), ball).with_transform(at(8.0)),
            GeometryObject::new(ObjectId(7), triangle(1e-30)),
        ]);
        let geometry = geometry.unwrap();
        let mut engine = create(EngineKind::Brute);
        engine.commit(&geometry, &FrameChanges::all()).unwrap();
        let origins = [0.1, 4.1, 8.5, -4.0, 20.0].map(|x| Vec3::new(x, 0.1, 3.0));
        let rays = RayBatch::new(&origins[..], -Vec3::Z).unwrap();
        let mut hits = HitBuffer::new(rays.len());
        engine.closest_hit(&rays, &mut hits.as_hits());
        // Nothing hits so small a triangle: the row is written by hand.
        (hits.object_id[3], hits.prim_id[3]) = (7, 0);

        let mut normals = [[7.0; 3]; 5];
        hit_normals(&geometry, &rays, HitColumns::from(&hits), &mut normals);
        let tilted = turned.transform_vector3(Vec3::Z);
        let on_ball = Vec3::new(0.5, 0.1, (1.0_f32 - 0.25 - 0.01).sqrt());
        let expected = [Vec3::Z, tilted, on_ball, Vec3::Z, Vec3::ZERO];
        for (normal, expected) in normals.into_iter().zip(expected) {
            assert!((Vec3::from(normal) - expected).length() < 1e-6, "{normal:?} {expected}");
        }
    }
}
