//! The primitives of one frame in world space, laid out for the kernels; shared by the engines.
//!
//! Every primitive has a *slot*: triangles first, in the order of their objects, then spheres,
//! then user primitives, each kind starting at a multiple of sixteen so that sixteen consecutive
//! slots form a block. Beside the slots stand columns: corners (triangles only), bounding sphere,
//! rank and mask.
//!
//! The *rank* of a primitive is its place in the order of (object, primitive), across all kinds:
//! it decides between equally near hits and leads back to the ids.
//!
//! A commit plans what has to be written (`plan`), then writes ranks where the layout differs from
//! the frame before (`write_ranks`), corners and masks of triangles (`write_triangles`), and the
//! rest (`write_others`). Bounding spheres of triangles and blocks are written when an engine asks
//! for them (`write_bounds`).
//!
//! **Invariants.** A bounding sphere holds every point at which its primitive can be hit. A
//! primitive that is ignored has mask 0 and a bounding sphere that nothing touches, so ids stay
//! what they are; so does padding. What stands in the columns depends on the committed geometry
//! alone, bounds once they are written.
//!
//! **Cost.** One pass over the primitives of the objects that changed, one more for their bounds;
//! 61 bytes a triangle, 41 a sphere.

mod ignored;
mod plan;
mod rank_table;
mod span;
mod table;
mod write_bounds;
mod write_others;
mod write_ranks;
mod write_triangles;

pub(crate) use rank_table::RankedObject;
pub(crate) use span::ObjectSpan;
pub(crate) use table::{PrimitiveTable, SPHERE_BYTES, SlotKind, TRIANGLE_BYTES};

#[cfg(test)]
mod tests;
