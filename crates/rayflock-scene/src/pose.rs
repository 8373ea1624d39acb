//! Where all nodes are at one time.
//!
//! Nodes are visited parents first, in an order found once; a node's place in the world is its
//! parent's times its own.
//!
//! **Cost.** One matrix product a node and frame.

use glam::Affine3A;

use crate::{LocalTransform, Node, NodeIdx, SceneError};

/// Where all nodes of a scene are at one time.
#[derive(Clone, Debug)]
pub(crate) struct Pose {
    /// Positions of all nodes, each after its parent.
    order: Vec<usize>,
    /// Places relative to the parents, a node each.
    locals: Vec<LocalTransform>,
    /// Places in the world, a node each.
    world_from_node: Vec<Affine3A>,
}

impl Pose {
    /// The nodes at rest.
    ///
    /// # Errors
    /// [`SceneError::CyclicNodes`] when a node is its own ancestor.
    pub(crate) fn at_rest(nodes: &[Node]) -> Result<Self, SceneError> {
        let mut pose = Self {
            order: parents_first(nodes)?,
            locals: nodes.iter().map(|node| node.rest).collect(),
            world_from_node: vec![Affine3A::IDENTITY; nodes.len()],
        };
        pose.place(nodes);
        Ok(pose)
    }

    /// Where a node is in the world.
    pub(crate) fn world_from_node(&self, node: NodeIdx) -> Affine3A {
        self.world_from_node[node.0 as usize]
    }

    /// Forms the places in the world from those relative to the parents.
    fn place(&mut self, nodes: &[Node]) {
        for &node_idx in &self.order {
            let local = self.locals[node_idx].to_affine();
            self.world_from_node[node_idx] = match nodes[node_idx].parent {
                Some(parent) => self.world_from_node[parent.0 as usize] * local,
                None => local,
            };
        }
    }
}

/// The positions of all nodes, each after its parent. The nodes' parents must exist.
fn parents_first(nodes: &[Node]) -> Result<Vec<usize>, SceneError> {
    let mut order = Vec::with_capacity(nodes.len());
    let mut ordered = vec![false; nodes.len()];
    // The start of the climb that came by, to notice when one meets itself.
    let mut climbed_from = vec![usize::MAX; nodes.len()];
    for start in 0..nodes.len() {
        let first_of_climb = order.len();
        let mut next = Some(start);
        while let Some(node_idx) = next.filter(|&node_idx| !ordered[node_idx]) {
            if climbed_from[node_idx] == start {
                let name = nodes[node_idx].name.clone();
                return Err(SceneError::CyclicNodes { node_idx: node_idx as u32, name });
            }
            climbed_from[node_idx] = start;
            order.push(node_idx);
            next = nodes[node_idx].parent.map(|parent| parent.0 as usize);
        }
        order[first_of_climb..].reverse();
        for &node_idx in &order[first_of_climb..] {
            ordered[node_idx] = true;
        }
    }
    Ok(order)
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    fn node(parent: Option<u32>, x: f32) -> Node {
        Node {
            name: format!("x{x}"),
            parent: parent.map(NodeIdx),
            rest: LocalTransform::Parts {
                translation: Vec3::X * x,
                rotation: glam::Quat::IDENTITY,
                scale: Vec3::ONE,
            },
            rest_weights: Vec::new(),
        }
    }

    #[test]
    fn parents_may_come_after_their_children() {
        let nodes = [node(Some(2), 1.0), node(Some(0), 10.0), node(None, 100.0)];
        let pose = Pose::at_rest(&nodes).unwrap();
        let x = |idx| pose.world_from_node(NodeIdx(idx)).translation.x;
        assert_eq!([x(0), x(1), x(2)], [101.0, 111.0, 100.0]);
    }

    #[test]
    fn a_node_that_is_its_own_ancestor_is_an_error() {
        let nodes = [node(None, 0.0), node(Some(2), 1.0), node(Some(1), 2.0), node(Some(1), 3.0)];
        let message = Pose::at_rest(&nodes).unwrap_err().to_string();
        assert_eq!(message, "node 1 (\"x1\") is its own ancestor");
        assert!(Pose::at_rest(&[node(Some(0), 0.0)]).is_err());
    }
}
