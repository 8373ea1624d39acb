//! Brings objects into the columns that Embree shares: positions in world space.
//!
//! Embree's own users keep their vertices there in the first place, so this is conversion.

use rayflock::geom::{GeometryObject, Sphere, transform_point, transform_sphere};
use rayon::prelude::*;

/// Items that one task writes.
const CHUNK: usize = 4096;

/// Writes the vertices of `object` in world space; `out.len() == 3 * vertices.len()`.
pub(super) fn write_vertices(object: &GeometryObject, out: &mut [f32]) {
    let vertices = object.shape.vertices();
    let chunks = out.par_chunks_mut(3 * CHUNK).zip(vertices.par_chunks(CHUNK));
    chunks.for_each(|(out, vertices)| {
        for (out, &vertex) in out.as_chunks_mut::<3>().0.iter_mut().zip(vertices) {
            let moved = object.world_from_object.as_ref().map(|m| transform_point(m, vertex));
            *out = moved.unwrap_or(vertex).to_array();
        }
    });
}

/// Writes the spheres of `object` in world space; `out.len() == 4 * spheres.len()`. Spheres that
/// cannot be hit become such that Embree ignores, too. Returns how many are not finite.
pub(super) fn write_spheres(object: &GeometryObject, out: &mut [f32]) -> usize {
    let mut non_finite = 0;
    for (out, sphere) in out.as_chunks_mut::<4>().0.iter_mut().zip(object.shape.spheres()) {
        let moved = object.world_from_object.as_ref().map(|m| transform_sphere(m, sphere));
        let sphere = moved.unwrap_or(*sphere);
        let Sphere { center, radius } = sphere;
        *out = [center.x, center.y, center.z, radius];
        if !sphere.is_valid() {
            non_finite += usize::from(!(center.is_finite() && radius.is_finite()));
            *out = [f32::NAN; 4];
        }
    }
    non_finite
}

/// Counts the triangles of `object` that are not finite; `vertices` are those written by
/// [`write_vertices`].
pub(super) fn count_non_finite(object: &GeometryObject, vertices: &[f32]) -> usize {
    let vertices = vertices.as_chunks::<3>().0;
    let is_finite = |i: &u32| vertices[*i as usize].iter().all(|axis| axis.is_finite());
    let chunks = object.shape.triangles().par_chunks(CHUNK);
    let count = |triangles: &[[u32; 3]]| {
        triangles.iter().filter(|corners| !corners.iter().all(is_finite)).count()
    };
    chunks.map(count).sum()
}
