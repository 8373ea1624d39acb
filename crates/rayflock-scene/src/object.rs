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
    /// A mesh bent by morph targets, then by a skin. Vertices bend; its spheres stay.
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
/// sum to 1. Entries of weight 0 are not used, and their joints need not exist.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct VertexInfluences {
    /// Positions in the skin's joint list.
    pub joints: [u16; 8],
    /// Shares.
    pub weights: [f32; 8],
}

impl VertexInfluences {
    /// The influences of these joints: those of the eight largest weights, scaled to sum to 1.
    /// Weights that are not positive numbers are left out. A vertex with none left follows the
    /// skin's first joint.
    pub fn new(joints: impl IntoIterator<Item = (u16, f32)>) -> Self {
        let usable = |&(_, weight): &(u16, f32)| weight.is_finite() && weight > 0.0;
        let mut kept: Vec<(u16, f32)> = joints.into_iter().filter(usable).collect();
        kept.sort_by(|a, b| b.1.total_cmp(&a.1));
        kept.truncate(8);
        if kept.is_empty() {
            kept.push((0, 1.0));
        }
        // Dividing by the largest first keeps the sum finite.
        let largest = kept[0].1;
        let sum: f32 = kept.iter().map(|(_, weight)| weight / largest).sum();
        let mut influences = Self::default();
        for (slot, (joint, weight)) in kept.into_iter().enumerate() {
            influences.joints[slot] = joint;
            influences.weights[slot] = weight / largest / sum;
        }
        influences
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn influences_keep_the_eight_largest_and_sum_to_one() {
        let influences = VertexInfluences::new((1..=10).map(|i| (i, f32::from(i))));
        assert_eq!(influences.joints, [10, 9, 8, 7, 6, 5, 4, 3]);
        assert!((influences.weights.iter().sum::<f32>() - 1.0).abs() < 1e-6);
        let huge = VertexInfluences::new([(4, f32::MAX), (5, f32::MAX), (6, f32::NAN), (7, -1.0)]);
        assert_eq!(
            (huge.joints[..3].to_vec(), huge.weights[..3].to_vec()),
            (vec![4, 5, 0], vec![0.5, 0.5, 0.0])
        );
    }

    #[test]
    fn a_vertex_without_influences_follows_the_first_joint() {
        let influences = VertexInfluences::new([(3, 0.0)]);
        assert_eq!((influences.joints[0], influences.weights[0]), (0, 1.0));
    }
}
