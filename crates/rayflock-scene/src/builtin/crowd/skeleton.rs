//! The joints of a figure: where they are at rest, and the nodes that stand for them.
//!
//! ```text
//!            head
//!             |
//!            neck
//!    arm ____|____ arm        Figure space: +Y up, +Z forward, +X to the left, 1.75 high;
//!     |    chest    |         at rest no joint is turned.
//!  forearm   |   forearm
//!          spine
//!          pelvis
//!          /    \
//!       thigh  thigh
//!         |      |
//!       shin   shin
//!         |      |
//!       foot   foot
//! ```

use glam::{Affine3A, Vec3};

use super::figure::Figure;
use crate::builtin::node;
use crate::{LocalTransform, Node, NodeIdx};

/// Number of joints.
pub(super) const JOINT_COUNT: usize = 15;

pub(super) const PELVIS: usize = 0;
pub(super) const SPINE: usize = 1;
pub(super) const CHEST: usize = 2;
pub(super) const NECK: usize = 3;
pub(super) const HEAD: usize = 4;
/// Joints of the left and the right side.
pub(super) const ARM: [usize; 2] = [5, 7];
pub(super) const FOREARM: [usize; 2] = [6, 8];
pub(super) const THIGH: [usize; 2] = [9, 12];
pub(super) const SHIN: [usize; 2] = [10, 13];
pub(super) const FOOT: [usize; 2] = [11, 14];

struct Joint {
    name: &'static str,
    parent: Option<usize>,
    rest: Vec3,
}

const fn joint(name: &'static str, parent: usize, x: f32, y: f32, z: f32) -> Joint {
    Joint { name, parent: Some(parent), rest: Vec3::new(x, y, z) }
}

/// The joints with their places at rest in figure space; parents come first.
const JOINTS: [Joint; JOINT_COUNT] = [
    Joint { name: "pelvis", parent: None, rest: Vec3::new(0.0, 0.95, 0.0) },
    joint("spine", PELVIS, 0.0, 1.08, 0.0),
    joint("chest", SPINE, 0.0, 1.25, 0.0),
    joint("neck", CHEST, 0.0, 1.46, 0.0),
    joint("head", NECK, 0.0, 1.56, 0.01),
    joint("left arm", CHEST, 0.19, 1.41, 0.0),
    joint("left forearm", ARM[0], 0.232, 1.13, 0.0),
    joint("right arm", CHEST, -0.19, 1.41, 0.0),
    joint("right forearm", ARM[1], -0.232, 1.13, 0.0),
    joint("left thigh", PELVIS, 0.095, 0.92, 0.0),
    joint("left shin", THIGH[0], 0.095, 0.50, 0.0),
    joint("left foot", SHIN[0], 0.095, 0.085, 0.0),
    joint("right thigh", PELVIS, -0.095, 0.92, 0.0),
    joint("right shin", THIGH[1], -0.095, 0.50, 0.0),
    joint("right foot", SHIN[1], -0.095, 0.085, 0.0),
];

/// Where a joint is at rest, in figure space.
pub(super) const fn rest(joint: usize) -> Vec3 {
    JOINTS[joint].rest
}

/// Adds the nodes of a figure: its root, which walks along the path, and its joints. Tells the
/// root.
pub(super) fn add_nodes(nodes: &mut Vec<Node>, figure: &Figure) -> NodeIdx {
    let root = NodeIdx(nodes.len() as u32);
    let mut root_node = node(figure.name, None, Vec3::ZERO);
    if let LocalTransform::Parts { scale, .. } = &mut root_node.rest {
        *scale = Vec3::splat(figure.scale);
    }
    nodes.push(root_node);
    for part in &JOINTS {
        let (parent, origin) = match part.parent {
            Some(parent) => (joint_node(root, parent), rest(parent)),
            None => (root, Vec3::ZERO),
        };
        nodes.push(node(part.name, Some(parent), part.rest - origin));
    }
    root
}

/// The node of a joint of the figure whose root is `root`.
pub(super) const fn joint_node(root: NodeIdx, joint: usize) -> NodeIdx {
    NodeIdx(root.0 + 1 + joint as u32)
}

/// The joints as a skin names them: each with the transform from figure space to its own.
pub(super) fn skin_joints(root: NodeIdx) -> Vec<(NodeIdx, Affine3A)> {
    let bind = |joint: usize| Affine3A::from_translation(-rest(joint));
    (0..JOINT_COUNT).map(|joint| (joint_node(root, joint), bind(joint))).collect()
}
