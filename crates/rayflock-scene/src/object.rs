//! Objects: meshes in the world that may move as a whole, deform, or change topology.

use std::sync::Arc;

use glam::{Affine3A, Vec3};

use crate::{AnimatedMesh, NodeIdx, SurfaceMesh};

/// Something that can be seen. Its position in [`Scene::objects`](crate::Scene::objects) is its
/// [`ObjectId`](rayflock_geom::ObjectId).
#[derive(Clone, Debug)]
pub struct SceneObject {
    /// Name in the file, for messages.
    pub name: String,
    /// The node that carries it; `None` for world space.
    pub node: Option<NodeIdx>,
    /// Which rays see it: those with `ray.mask & mask != 0`.
    pub mask: u32,
    /// What it is made of and how that changes.
    pub shape: Shape,
}

/// What an object is made of at a time.
#[derive(Clone, Debug)]
pub enum Shape {
    /// A mesh that moves with its node at most.
    Fixed(SurfaceMesh),
    /// A mesh bent by morph targets, then by a skin.
    Deformed {
        /// The mesh at rest.
        rest: SurfaceMesh,
        /// Offsets added in proportion to the node's weights.
        targets: Arc<[MorphTarget]>,
        /// Joints that carry the vertices; the object's own node then has no effect (glTF).
        skin: Option<Arc<Skin>>,
    },
    /// A mesh that is a function of time: sequences, point caches, generators.
    Animated(Arc<dyn AnimatedMesh>),
}

/// Offsets from the mesh at rest, each column empty or with one entry a vertex.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MorphTarget {
    /// Added to positions.
    pub positions: Vec<Vec3>,
    /// Added to normals.
    pub normals: Vec<Vec3>,
}

/// Joints and how much each vertex follows them.
#[derive(Clone, Debug, PartialEq)]
pub struct Skin {
    /// The joints, each with the transform from the mesh at rest to the joint's space.
    pub joints: Vec<(NodeIdx, Affine3A)>,
    /// One entry a vertex.
    pub influences: Vec<VertexInfluences>,
}

/// The joints a vertex follows: up to eight, as positions in [`Skin::joints`], with weights that
/// sum to 1. Unused entries have weight 0.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct VertexInfluences {
    /// Positions in the skin's joint list.
    pub joints: [u16; 8],
    /// Shares.
    pub weights: [f32; 8],
}
