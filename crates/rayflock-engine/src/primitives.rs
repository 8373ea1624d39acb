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
//! the frame before (`write_ranks`), and all but triangles (`write_others`). Corners and masks of
//! triangles are written when an engine asks for them (`write_triangles`), bounding spheres of
//! triangles and blocks too (`write_bounds`). Who looks at each triangle just once reads them from
//! their meshes instead (`read_triangles`): writing them down costs more than that.
//!
//! **Invariants.** A bounding sphere holds every point at which its primitive can be hit. A
//! primitive that is ignored has mask 0 and a bounding sphere that nothing touches, so ids stay
//! what they are; so does padding. What stands in the columns depends on the committed geometry
//! alone, triangles and bounds once they are written.
//!
//! **Cost.** A commit costs by the object, by the sphere and, where the layout differs, four bytes
//! a primitive. One pass over the triangles of the objects that changed writes them, one more their
//! bounds; 61 bytes a triangle, 41 a sphere.

mod ignored;
mod plan;
mod rank_table;
mod read_triangles;
mod span;
mod table;
mod write_bounds;
mod write_others;
mod write_ranks;
mod write_triangles;

pub use ignored::{Ignored, count_ignored};
pub(crate) use rank_table::RankedObject;
pub(crate) use read_triangles::{BLOCKS_PER_READ, BlockReader};
pub(crate) use span::ObjectSpan;
pub(crate) use table::{PrimitiveTable, SPHERE_BYTES, SlotKind, TRIANGLE_BYTES};

#[cfg(test)]
mod tests;
