//! The node hierarchy, checked to be a forest, and which nodes the scene shows.

use glam::{Affine3A, Mat4, Quat, Vec3};
use gltf::json::{Node as JsonNode, Root};
use rayflock_scene::{LocalTransform, Node, NodeIdx};

use super::label;
use crate::ImportError;
use crate::job::Job;

/// All nodes, in the order of the file, and those of the default scene.
#[derive(Debug)]
pub(super) struct Hierarchy {
    pub(super) nodes: Vec<Node>,
    /// In ascending order.
    pub(super) drawn: Vec<NodeIdx>,
}

/// Reads the nodes.
pub(super) fn load(root: &Root, job: &mut Job<'_>) -> Result<Hierarchy, ImportError> {
    let parents = parents(root, job)?;
    check_acyclic(root, &parents, job)?;
    let mut nodes = Vec::with_capacity(root.nodes.len());
    for (idx, json) in root.nodes.iter().enumerate() {
        let rest = rest_transform(idx, json, job)?;
        let (name, parent) = (json.name.clone().unwrap_or_default(), parents[idx]);
        let rest_weights = rest_weights(root, json);
        if !rest_weights.iter().all(|weight| weight.is_finite()) {
            let element = label("node", idx, json.name.as_ref());
            return Err(job.invalid(element, "weights that are not finite", "finite weights"));
        }
        nodes.push(Node { name, parent, rest, rest_weights });
    }
    Ok(Hierarchy { nodes, drawn: drawn(root, &parents) })
}

/// The parent of each node; each child has one.
fn parents(root: &Root, job: &Job<'_>) -> Result<Vec<Option<NodeIdx>>, ImportError> {
    let mut parents = vec![None; root.nodes.len()];
    for (idx, node) in root.nodes.iter().enumerate() {
        for child in node.children.iter().flatten() {
            let child_name = root.nodes[child.value()].name.as_ref();
            if let Some(NodeIdx(other)) = parents[child.value()] {
                let element = label("node", child.value(), child_name);
                let found = format!("a child of node {other} and of node {idx}");
                return Err(job.invalid(element, found, "at most one parent"));
            }
            parents[child.value()] = Some(NodeIdx(idx as u32));
        }
    }
    Ok(parents)
}

/// Checks that every node leads up to one without a parent.
fn check_acyclic(
    root: &Root,
    parents: &[Option<NodeIdx>],
    job: &Job<'_>,
) -> Result<(), ImportError> {
    // The walk on which each node was first seen; 0 for none.
    let mut walks = vec![0; parents.len()];
    for start in 0..parents.len() {
        let walk = start + 1;
        let mut next = Some(start);
        while let Some(idx) = next.filter(|&idx| walks[idx] == 0) {
            walks[idx] = walk;
            next = parents[idx].map(|parent| parent.0 as usize);
        }
        if let Some(idx) = next.filter(|&idx| walks[idx] == walk) {
            let element = label("node", idx, root.nodes[idx].name.as_ref());
            return Err(job.invalid(element, "a node that is its own ancestor", "a tree"));
        }
    }
    Ok(())
}

/// Where the node is at rest.
fn rest_transform(
    idx: usize,
    json: &JsonNode,
    job: &mut Job<'_>,
) -> Result<LocalTransform, ImportError> {
    let rest = match json.matrix {
        Some(matrix) => LocalTransform::Matrix(Affine3A::from_mat4(Mat4::from_cols_array(&matrix))),
        None => {
            let rotation = json.rotation.map_or(Quat::IDENTITY, |q| Quat::from_array(q.0));
            let unit = rotation.normalize();
            if rotation.is_finite() && !unit.is_finite() {
                let element = label("node", idx, json.name.as_ref());
                job.warn(element, "the rotation has no length; it is left out");
            }
            LocalTransform::Parts {
                translation: Vec3::from(json.translation.unwrap_or_default()),
                rotation: if rotation.is_finite() && !unit.is_finite() {
                    Quat::IDENTITY
                } else {
                    unit
                },
                scale: json.scale.map_or(Vec3::ONE, Vec3::from),
            }
        }
    };
    if rest.to_affine().is_finite() {
        return Ok(rest);
    }
    let element = label("node", idx, json.name.as_ref());
    Err(job.invalid(element, "a transform that is not finite", "finite numbers"))
}

/// The node's morph weights, else its mesh's, else zeros: one a target.
fn rest_weights(root: &Root, json: &JsonNode) -> Vec<f32> {
    let Some(mesh) = json.mesh.map(|mesh| &root.meshes[mesh.value()]) else { return Vec::new() };
    let targets = mesh.primitives.iter().map(|primitive| primitive.targets.as_ref().map(Vec::len));
    let target_count = targets.flatten().max().unwrap_or(0);
    let stated = json.weights.as_ref().or(mesh.weights.as_ref());
    let mut weights = stated.cloned().unwrap_or_default();
    weights.resize(target_count, 0.0);
    weights
}

/// The nodes of the default scene, else of the first, else all.
fn drawn(root: &Root, parents: &[Option<NodeIdx>]) -> Vec<NodeIdx> {
    let scene_idx = root.scene.map_or(0, |scene| scene.value());
    let scene = root.scenes.get(scene_idx);
    let mut is_drawn = vec![scene.is_none(); parents.len()];
    let mut pending = scene.map_or(Vec::new(), |scene| scene.nodes.clone());
    while let Some(node) = pending.pop() {
        // Each node has one parent, so only a scene that lists a node twice comes here again.
        if !std::mem::replace(&mut is_drawn[node.value()], true) {
            pending.extend(root.nodes[node.value()].children.iter().flatten());
        }
    }
    let drawn = is_drawn.iter().enumerate().filter(|(_, is_drawn)| **is_drawn);
    drawn.map(|(idx, _)| NodeIdx(idx as u32)).collect()
}
