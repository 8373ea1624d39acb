//! Small scenes for tests.

use std::sync::Arc;

use glam::{Affine3A, Quat, Vec3};
use rayflock_geom::Mesh;
use rayflock_scene::{
    Channel, ChannelValues, Clip, Evaluator, Interpolation, LocalTransform, Material, MaterialIdx,
    MorphTarget, Node, NodeIdx, Scene, SceneObject, Shape, Skin, SurfaceMesh, VertexInfluences,
};

/// A triangle with corners 0, X and Y, and normals along Z.
pub(crate) fn triangle() -> SurfaceMesh {
    let mesh = Mesh::from_triangles(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 1, 2]]);
    let mut surface = SurfaceMesh::new(mesh.expect("indices are in range"), MaterialIdx(0));
    surface.normals = vec![Vec3::Z; 3].into();
    surface
}

pub(crate) fn node(parent: Option<u32>, translation: Vec3) -> Node {
    let rest = LocalTransform::Parts { translation, rotation: Quat::IDENTITY, scale: Vec3::ONE };
    let parent = parent.map(NodeIdx);
    Node { name: "node".to_owned(), parent, rest, rest_weights: Vec::new() }
}

pub(crate) fn object(name: &str, node: Option<u32>, shape: Shape) -> SceneObject {
    SceneObject { name: name.to_owned(), node: node.map(NodeIdx), mask: u32::MAX, shape }
}

pub(crate) fn scene(nodes: Vec<Node>, objects: Vec<SceneObject>) -> Scene {
    Scene { nodes, objects, materials: vec![Material::default()], ..Scene::default() }
}

/// A clip of linear channels with keys at 0 and 2 seconds.
pub(crate) fn clip(channels: Vec<(u32, ChannelValues)>) -> Clip {
    let channel = |(node, values)| Channel {
        node: NodeIdx(node),
        times: vec![0.0, 2.0],
        interpolation: Interpolation::Linear,
        values,
    };
    Clip { name: "clip".to_owned(), channels: channels.into_iter().map(channel).collect() }
}

pub(crate) fn slide(from: Vec3, to: Vec3) -> ChannelValues {
    ChannelValues::Translation(vec![from, to])
}

pub(crate) fn weights(weights_per_key: usize, values: &[f32]) -> ChannelValues {
    ChannelValues::Weights { weights_per_key, values: values.to_vec() }
}

/// The triangle with one morph target, which lifts corner 1 by Z.
pub(crate) fn morphed(skin: Option<Skin>) -> Shape {
    let lift = MorphTarget { positions: vec![Vec3::ZERO, Vec3::Z, Vec3::ZERO], normals: vec![] };
    Shape::Deformed { rest: triangle(), targets: vec![lift].into(), skin: skin.map(Arc::new) }
}

/// Two joints at the origin of the mesh at rest: corner 0 follows the first, corner 1 the second,
/// corner 2 both alike.
pub(crate) fn two_joints(first: u32, second: u32) -> Skin {
    let joint = |node| (NodeIdx(node), Affine3A::IDENTITY);
    let influences = vec![
        VertexInfluences::new([(0, 1.0)]),
        VertexInfluences::new([(1, 1.0)]),
        VertexInfluences::new([(0, 1.0), (1, 1.0)]),
    ];
    Skin { joints: vec![joint(first), joint(second)], influences }
}

pub(crate) fn evaluator(scene: Scene) -> Evaluator {
    Evaluator::new(Arc::new(scene), None).expect("the scene hangs together")
}
