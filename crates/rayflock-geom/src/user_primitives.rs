//! Primitives that users bring themselves: anything with a bounding sphere and a ray test.

use std::fmt::Debug;

use crate::{Ray, Sphere};

/// What a user primitive answers for one ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UserHit {
    /// Distance in multiples of the ray direction's length.
    pub t: f32,
    /// First surface coordinate, handed on to [`Hit::u`](crate::Hit::u).
    pub u: f32,
    /// Second surface coordinate, handed on to [`Hit::v`](crate::Hit::v).
    pub v: f32,
}

/// A column of user-defined primitives, in the object space of the mesh that holds them.
///
/// Source: L. Szecsi, "The Hierarchical Ray Engine", WSCG 2006: any primitive with a ray test and
/// an enclosing sphere can take part.
pub trait UserPrimitives: Debug + Send + Sync {
    /// Number of primitives; constant for the life of the value.
    fn len(&self) -> usize;

    /// Whether there is no primitive.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// A sphere in object space that holds every point that [`Self::intersect`] may report for
    /// primitive `prim_idx`, its own rounding included. A sphere that is not finite, or whose
    /// radius is negative, makes the primitive ignored and counted.
    fn bounding_sphere(&self, prim_idx: usize) -> Sphere;

    /// Finds, for each ray, the hit of primitive `prim_idx` with the smallest `t` in the ray's
    /// interval: `hits[i]` is written for `rays[i]`; `hits.len() == rays.len()`. Rays are in
    /// object space and keep the `t` of world space. The answer for a ray must depend on nothing
    /// but that ray and the primitive.
    fn intersect(&self, prim_idx: usize, rays: &[Ray], hits: &mut [Option<UserHit>]);
}
