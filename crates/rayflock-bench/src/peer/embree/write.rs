//! Brings objects into the columns that Embree shares: positions in world space.
//!
//! Embree's own users keep their vertices there in the first place, so this is conversion.

use rayflock::geom::{
    GeometryObject, Sphere, is_degenerate_triangle, transform_point, transform_sphere,
};
use rayon::prelude::*;

/// Items that one task writes.
const CHUNK: usize = 4096;

/// Primitives that are not hit, because of what they are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Ignored {
    /// A coordinate or radius is not finite.
    pub(super) non_finite: usize,
    /// There is no area or no positive radius.
    pub(super) degenerate: usize,
}

impl Ignored {
    /// Both together.
    pub(super) fn plus(self, other: Self) -> Self {
        Self {
            non_finite: self.non_finite + other.non_finite,
            degenerate: self.degenerate + other.degenerate,
        }
    }
}

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
/// cannot be hit become such that Embree ignores, too.
pub(super) fn write_spheres(object: &GeometryObject, out: &mut [f32]) -> Ignored {
    let mut ignored = Ignored::default();
    for (out, sphere) in out.as_chunks_mut::<4>().0.iter_mut().zip(object.shape.spheres()) {
        let moved = object.world_from_object.as_ref().map(|m| transform_sphere(m, sphere));
        let Sphere { center, radius } = moved.unwrap_or(*sphere);
        *out = [center.x, center.y, center.z, radius];
        if !Sphere::new(center, radius).is_valid() {
            let is_finite = center.is_finite() && radius.is_finite();
            ignored.non_finite += usize::from(!is_finite);
            ignored.degenerate += usize::from(is_finite);
            *out = [f32::NAN; 4];
        }
    }
    ignored
}

/// Counts the triangles of `object` that are not hit; `vertices` are those written by
/// [`write_vertices`].
pub(super) fn count_ignored(object: &GeometryObject, vertices: &[f32]) -> Ignored {
    let vertices = vertices.as_chunks::<3>().0;
    let count = |triangles: &[[u32; 3]]| {
        let mut ignored = Ignored::default();
        for triangle in triangles {
            let corners = triangle.map(|i| glam::Vec3::from_array(vertices[i as usize]));
            if is_degenerate_triangle(corners) {
                let is_finite = corners.iter().all(|corner| corner.is_finite());
                ignored.non_finite += usize::from(!is_finite);
                ignored.degenerate += usize::from(is_finite);
            }
        }
        ignored
    };
    let chunks = object.shape.triangles().par_chunks(CHUNK);
    chunks.map(count).reduce(Ignored::default, Ignored::plus)
}
