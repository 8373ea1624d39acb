//! Stable identities of objects and primitives.

/// The id that stands for "nothing was hit", in object and primitive columns alike.
pub const NO_ID: u32 = u32::MAX;

/// The stable identity of an object, chosen by whoever builds the [`Geometry`](crate::Geometry).
///
/// `ObjectId(NO_ID)` is reserved for "none".
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[repr(transparent)]
pub struct ObjectId(pub u32);

/// The identity of a primitive within its [`Mesh`](crate::Mesh): triangles first, then spheres,
/// then user primitives, each in the order of its column.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[repr(transparent)]
pub struct PrimId(pub u32);

impl ObjectId {
    /// No object.
    pub const NONE: Self = Self(NO_ID);
}

impl PrimId {
    /// No primitive.
    pub const NONE: Self = Self(NO_ID);
}
