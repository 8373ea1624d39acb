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
//! **Invariants.** A bounding sphere holds every point at which its primitive can be hit. A
//! primitive that is ignored has mask 0 and a bounding sphere that nothing touches, so ids stay
//! what they are. What stands in the columns depends on the committed geometry alone.
//!
//! **Cost.** One pass over the primitives of the objects that changed; 61 bytes a triangle, 41 a sphere.

mod span;
mod table;
mod write;

pub(crate) use span::ObjectSpan;
pub(crate) use table::{PrimitiveTable, SPHERE_BYTES, SlotKind, TRIANGLE_BYTES, is_same};
