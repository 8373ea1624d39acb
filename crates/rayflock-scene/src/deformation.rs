//! How the meshes of a frame came about, for those who make them elsewhere.
//!
//! A frame has its meshes; who deforms meshes by other means, as on a graphics device, takes what
//! stays the same from frame to frame, and does with it what `blend` and `deform` do here.

use std::sync::Arc;

use glam::Affine3A;

use crate::{MorphTarget, Skin, SurfaceMesh};

/// How the mesh of an object at one time came about.
#[derive(Clone, Debug, Default)]
#[non_exhaustive]
pub enum Deformation {
    /// Nothing deforms it, or nobody tells how.
    #[default]
    None,
    /// Its vertices are on their way from one key to the next.
    Between(KeySpan),
    /// Morph targets and a skin bend it.
    Bent(Bend),
}

/// A mesh between two keys of the same topology: vertices are `before + share (after - before)`,
/// normals the same, given unit length; one without a direction is that of `before`. Where `after`
/// has another number of normals, they are those of `before`.
#[derive(Clone, Debug)]
pub struct KeySpan {
    /// The mesh at the key before.
    pub before: SurfaceMesh,
    /// The mesh at the next key.
    pub after: SurfaceMesh,
    /// How much of the way is done, in `0..=1`.
    pub share: f32,
}

/// A mesh bent by morph targets, then by a skin, as [`Shape::Deformed`](crate::Shape::Deformed)
/// is.
#[derive(Clone, Debug)]
pub struct Bend {
    /// The mesh at rest.
    pub rest: SurfaceMesh,
    /// Offsets.
    pub targets: Arc<[MorphTarget]>,
    /// A weight a morph target.
    pub weights: Vec<f32>,
    /// Which joints carry which vertex.
    pub skin: Option<Arc<Skin>>,
    /// From the mesh at rest by each joint of the skin to the world.
    pub world_from_rest: Vec<Affine3A>,
}
