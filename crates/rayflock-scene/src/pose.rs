//! Where all nodes are at one time, and whether they are there at all.
//!
//! Nodes are visited parents first, in an order found once; a node's place in the world is its
//! parent's times its own. A clip replaces the parts of a node's place that it has channels for;
//! the others stay at rest. A node is there if it and all that it hangs on are.
//!
//! **Invariants.** What no channel changes has the same bits at all times.
//!
//! **Cost.** One matrix product a node, one binary search a channel, each frame.

use glam::Affine3A;

use crate::sample::KeySpan;
use crate::{Channel, ChannelValues, Clip, LocalTransform, Node, NodeIdx, SceneError};

/// Where all nodes of a scene are at one time of a clip, and their morph weights.
#[derive(Clone, Debug)]
pub(crate) struct Pose {
    /// Positions of all nodes, each after its parent.
    order: Vec<usize>,
    /// Places relative to the parents where no clip moves them, a node each.
    rest: Vec<LocalTransform>,
    /// Places relative to the parents, a node each.
    locals: Vec<LocalTransform>,
    /// Places in the world, a node each.
    world_from_node: Vec<Affine3A>,
    /// Morph weights, a list a node.
    weights: Vec<Vec<f32>>,
    /// Whether the clip moves the node or one it hangs on, a node each.
    moves: Vec<bool>,
    /// Whether the clip changes the node's morph weights, a node each.
    morphs: Vec<bool>,
    /// Whether the clip lets the node be there by itself, and whether it is, a node each.
    visible: Vec<bool>,
    shows: Vec<bool>,
    /// Whether the clip hides the node, or one it hangs on, at any time, a node each.
    hides: Vec<bool>,
}

impl Pose {
    /// The nodes at rest, ready to be moved by `clip`, all of whose nodes exist.
    ///
    /// # Errors
    /// [`SceneError::CyclicNodes`] when a node is its own ancestor.
    pub(crate) fn new(nodes: &[Node], clip: Option<&Clip>) -> Result<Self, SceneError> {
        let mut pose = Self {
            order: parents_first(nodes)?,
            rest: nodes.iter().map(|node| node.rest).collect(),
            locals: nodes.iter().map(|node| node.rest).collect(),
            world_from_node: vec![Affine3A::IDENTITY; nodes.len()],
            weights: nodes.iter().map(|node| node.rest_weights.clone()).collect(),
            moves: vec![false; nodes.len()],
            morphs: vec![false; nodes.len()],
            visible: vec![true; nodes.len()],
            shows: vec![true; nodes.len()],
            hides: vec![false; nodes.len()],
        };
        for channel in clip.iter().flat_map(|clip| &clip.channels) {
            pose.prepare(channel);
        }
        for &node_idx in &pose.order {
            if let Some(parent) = nodes[node_idx].parent {
                pose.moves[node_idx] |= pose.moves[parent.0 as usize];
                pose.hides[node_idx] |= pose.hides[parent.0 as usize];
            }
        }
        pose.place(nodes);
        Ok(pose)
    }

    /// Moves the nodes to where `clip` has them at a time of its own.
    pub(crate) fn set_time(&mut self, nodes: &[Node], clip: &Clip, local_time: f64) {
        self.locals.copy_from_slice(&self.rest);
        for channel in &clip.channels {
            // Key times are `f32`: frame times have to be rounded like them to meet them.
            self.apply(channel, local_time as f32);
        }
        self.place(nodes);
    }

    /// Where a node is in the world.
    pub(crate) fn world_from_node(&self, node: NodeIdx) -> Affine3A {
        self.world_from_node[node.0 as usize]
    }

    /// The morph weights of a node.
    pub(crate) fn weights(&self, node: NodeIdx) -> &[f32] {
        &self.weights[node.0 as usize]
    }

    /// Whether the clip moves the node in the world.
    pub(crate) fn moves(&self, node: NodeIdx) -> bool {
        self.moves[node.0 as usize]
    }

    /// Whether the clip changes the node's morph weights.
    pub(crate) fn morphs(&self, node: NodeIdx) -> bool {
        self.morphs[node.0 as usize]
    }

    /// Whether the node is there.
    pub(crate) fn shows(&self, node: NodeIdx) -> bool {
        self.shows[node.0 as usize]
    }

    /// Whether the clip hides the node at any time.
    pub(crate) fn hides(&self, node: NodeIdx) -> bool {
        self.hides[node.0 as usize]
    }

    /// Notes what a channel moves, and takes its node's transform apart if it is a matrix.
    fn prepare(&mut self, channel: &Channel) {
        let node_idx = channel.node.0 as usize;
        let changes = !channel.is_constant();
        match &channel.values {
            ChannelValues::Weights { .. } => self.morphs[node_idx] |= changes,
            ChannelValues::Visibility(values) => self.hides[node_idx] |= values.contains(&false),
            ChannelValues::Translation(_)
            | ChannelValues::Rotation(_)
            | ChannelValues::Scale(_) => {
                self.rest[node_idx] = self.rest[node_idx].in_parts();
                self.moves[node_idx] |= changes;
            }
        }
    }

    /// Gives one property of one node its value at a time.
    fn apply(&mut self, channel: &Channel, local_time: f32) {
        let node_idx = channel.node.0 as usize;
        let interpolation = channel.interpolation;
        let span = KeySpan::locate(&channel.times, local_time);
        match (&channel.values, &mut self.locals[node_idx]) {
            (ChannelValues::Weights { weights_per_key: count, values }, _) => {
                let weight = |idx| span.sample(interpolation, |i| values[i * count + idx]);
                self.weights[node_idx].clear();
                self.weights[node_idx].extend((0..*count).map(weight));
            }
            (ChannelValues::Visibility(values), _) => self.visible[node_idx] = values[span.key()],
            (ChannelValues::Translation(values), LocalTransform::Parts { translation, .. }) => {
                *translation = span.sample(interpolation, |i| values[i]);
            }
            (ChannelValues::Rotation(values), LocalTransform::Parts { rotation, .. }) => {
                *rotation = span.sample(interpolation, |i| values[i]);
            }
            (ChannelValues::Scale(values), LocalTransform::Parts { scale, .. }) => {
                *scale = span.sample(interpolation, |i| values[i]);
            }
            (_, LocalTransform::Matrix(_)) => {
                unreachable!("matrices of nodes that a clip moves are taken apart at the start")
            }
        }
    }

    /// Forms the places in the world from those relative to the parents, and hides what hangs on
    /// what is hidden.
    fn place(&mut self, nodes: &[Node]) {
        for &node_idx in &self.order {
            let local = self.locals[node_idx].to_affine();
            self.world_from_node[node_idx] = match nodes[node_idx].parent {
                Some(parent) => self.world_from_node[parent.0 as usize] * local,
                None => local,
            };
            let parent_shows =
                nodes[node_idx].parent.is_none_or(|parent| self.shows[parent.0 as usize]);
            self.shows[node_idx] = parent_shows && self.visible[node_idx];
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
    use crate::Interpolation;

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
        let pose = Pose::new(&nodes, None).unwrap();
        let x = |idx| pose.world_from_node(NodeIdx(idx)).translation.x;
        assert_eq!([x(0), x(1), x(2)], [101.0, 111.0, 100.0]);
    }

    #[test]
    fn a_node_that_is_its_own_ancestor_is_an_error() {
        let nodes = [node(None, 0.0), node(Some(2), 1.0), node(Some(1), 2.0), node(Some(1), 3.0)];
        let message = Pose::new(&nodes, None).unwrap_err().to_string();
        assert_eq!(message, "node 1 (\"x1\") is its own ancestor");
        assert!(Pose::new(&[node(Some(0), 0.0)], None).is_err());
    }

    fn moving(node: u32, values: ChannelValues) -> Channel {
        let (node, times) = (NodeIdx(node), vec![0.0, 1.0]);
        Channel { node, times, interpolation: Interpolation::Linear, values }
    }

    fn posed(nodes: &[Node], channel: Channel, time: f64) -> Pose {
        let clip = Clip { name: String::new(), channels: vec![channel] };
        let mut pose = Pose::new(nodes, Some(&clip)).unwrap();
        pose.set_time(nodes, &clip, time);
        pose
    }

    #[test]
    fn a_channel_replaces_one_part_and_moves_what_hangs_on_it() {
        let nodes = [node(Some(1), 1.0), node(Some(2), 10.0), node(None, 100.0)];
        let channel = moving(1, ChannelValues::Scale(vec![Vec3::ONE, Vec3::splat(3.0)]));
        let pose = posed(&nodes, channel, 0.5);
        let x = |idx| pose.world_from_node(NodeIdx(idx)).translation.x;
        assert_eq!([x(0), x(1), x(2)], [112.0, 110.0, 100.0]);
        assert_eq!([0, 1, 2].map(|idx| pose.moves(NodeIdx(idx))), [true, true, false]);
    }

    #[test]
    fn a_channel_takes_a_matrix_apart() {
        let mut matrix = node(None, 0.0);
        let place = Affine3A::from_scale_rotation_translation(
            Vec3::splat(2.0),
            glam::Quat::from_rotation_z(std::f32::consts::FRAC_PI_2),
            Vec3::Y,
        );
        matrix.rest = LocalTransform::Matrix(place);
        let channel = moving(0, ChannelValues::Translation(vec![Vec3::ZERO, Vec3::Z]));
        let pose = posed(&[matrix], channel, 0.5);
        let image = pose.world_from_node(NodeIdx(0)).transform_point3(Vec3::X);
        assert!(image.distance(Vec3::new(0.0, 2.0, 0.5)) < 1e-5, "{image}");
    }

    #[test]
    fn a_singular_matrix_taken_apart_keeps_its_translation() {
        let mut flat = node(None, 0.0);
        flat.rest = LocalTransform::Matrix(
            Affine3A::from_translation(Vec3::X) * Affine3A::from_scale(Vec3::ZERO),
        );
        let channel = moving(0, ChannelValues::Scale(vec![Vec3::ONE; 2]));
        let place = posed(&[flat], channel, 0.0).world_from_node(NodeIdx(0));
        assert!(place.is_finite());
        assert_eq!(Vec3::from(place.translation), Vec3::X);
    }

    #[test]
    fn weights_are_those_of_the_clip_or_at_rest() {
        let mut nodes = [node(None, 0.0), node(None, 0.0)];
        nodes[1].rest_weights = vec![0.25];
        let values = vec![0.0, 1.0, 0.5, 2.0];
        let channel = moving(0, ChannelValues::Weights { weights_per_key: 2, values });
        let pose = posed(&nodes, channel, 0.5);
        assert_eq!(pose.weights(NodeIdx(0)), [0.25, 1.5]);
        assert_eq!(pose.weights(NodeIdx(1)), [0.25]);
        assert!(pose.morphs(NodeIdx(0)) && !pose.moves(NodeIdx(0)) && !pose.morphs(NodeIdx(1)));
    }
}
