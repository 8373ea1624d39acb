//! Objects: meshes in the world that may move as a whole, deform, or change topology.

use std::fmt::Debug;
use std::sync::Arc;

use glam::{Affine3A, Vec3};

use crate::{NodeIdx, SurfaceMesh};

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

/// A mesh that is a function of time.
pub trait AnimatedMesh: Debug + Send + Sync {
    /// The interval in which the mesh moves, in seconds; before and after, it rests.
    fn time_range(&self) -> (f64, f64);

    /// The mesh at `time`, and how it relates to the mesh at another time: where vertices move
    /// and triangles stay, the mesh shares its triangles with those of other times
    /// ([`Mesh::with_vertices`](rayflock_geom::Mesh::with_vertices)).
    ///
    /// # Errors
    /// A message for the user when the mesh cannot be had, such as a file gone or damaged.
    fn at(&self, time: f64) -> Result<SurfaceMesh, String>;

    /// A mesh whose bounds stand for all times, when that is cheaper to tell than by evaluating.
    fn triangle_count_hint(&self) -> Option<usize> {
        None
    }
}
