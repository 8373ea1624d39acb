//! What the device makes of objects is what the host would have written.

use std::sync::Arc;

use glam::{Affine3A, Quat, Vec3};
use rayflock_geom::{FrameChanges, Mesh, Sphere};
use rayflock_render::FrameRenderer;
use rayflock_scene::{
    Channel, ChannelValues, Clip, Deformation, Evaluator, Interpolation, LocalTransform, Material,
    MaterialIdx, MorphTarget, Node, NodeIdx, Scene, SceneFrame, SceneObject, Shape, Skin,
    SurfaceMesh, VertexFrames, VertexInfluences, VertexKey, builtin,
};

use crate::GpuContext;
use crate::frame::GpuRenderer;
use crate::frame::attributes::AttributeStore;
use crate::layout::{Attributes, DevicePrimitive};
use crate::primitives::PrimitiveStore;
use crate::testing::{contexts, near, read};

/// Corners of a ring of triangles, all about one unit apart, and normals.
fn ring(count: u32) -> (Vec<Vec3>, Vec<Vec3>) {
    let corner = |idx: u32| {
        let turn = Quat::from_rotation_y(idx as f32 * std::f32::consts::TAU / count as f32);
        turn * Vec3::new(1.0, (idx % 3) as f32, 0.5)
    };
    let positions: Vec<Vec3> = (0..count).map(corner).collect();
    let normals = positions.iter().map(|position| position.normalize()).collect();
    (positions, normals)
}

fn surface(count: u32, is_smooth: bool) -> SurfaceMesh {
    let (positions, normals) = ring(count);
    let triangles: Vec<_> =
        (0..count).map(|idx| [idx, (idx + 1) % count, (idx + 2) % count]).collect();
    let mesh = Mesh::from_triangles(positions, triangles).unwrap();
    let mut surface = SurfaceMesh::new(mesh, MaterialIdx(0));
    if is_smooth {
        surface.normals = normals.into();
    }
    surface
}

/// Offsets of some length in some direction.
fn offsets(count: u32, phase: f32) -> Vec<Vec3> {
    (0..count).map(|idx| (Vec3::new(1.3, 2.1, 3.7) * idx as f32 + phase).map(f32::sin)).collect()
}

fn bent(count: u32, skin: Option<Skin>) -> Shape {
    let both = MorphTarget { positions: offsets(count, 0.1), normals: offsets(count, 0.2) };
    let only = MorphTarget { positions: offsets(count, 0.3), normals: Vec::new() };
    let rest = surface(count, true);
    Shape::Deformed { rest, targets: [both, only].into(), skin: skin.map(Arc::new) }
}

fn skin(count: u32) -> Skin {
    let joints = vec![
        (NodeIdx(0), Affine3A::from_translation(Vec3::X)),
        (NodeIdx(1), Affine3A::IDENTITY),
        (NodeIdx(2), Affine3A::from_scale(Vec3::new(0.5, 2.0, -1.0))),
    ];
    let follows = |idx: u32| {
        let weight = (idx % 5) as f32 / 5.0;
        VertexInfluences::new([(0, weight), ((1 + idx % 2) as u16, 1.0 - weight)])
    };
    Skin { joints, influences: (0..count).map(follows).collect() }
}

/// A mesh with normals between four keys, of which one is met exactly.
fn keyed(count: u32) -> Shape {
    let key = |idx: u32| {
        let (positions, normals) = (offsets(count, idx as f32), offsets(count, 5.0 + idx as f32));
        let normals = normals.iter().map(|normal| normal.normalize()).collect();
        VertexKey { time: 0.5 * f64::from(idx), positions, normals }
    };
    let frames = VertexFrames::new(&surface(count, true), (0..4).map(key).collect()).unwrap();
    Shape::Animated(Arc::new(frames))
}

/// Three nodes that turn, move and morph for two seconds.
fn clip() -> Clip {
    let channel = |node: u32, values: ChannelValues| Channel {
        node: NodeIdx(node),
        times: vec![0.0, 2.0],
        interpolation: Interpolation::Linear,
        values,
    };
    let turn = vec![Quat::IDENTITY, Quat::from_rotation_y(2.0)];
    let channels = vec![
        channel(0, ChannelValues::Rotation(turn)),
        channel(1, ChannelValues::Translation(vec![Vec3::ZERO, Vec3::new(1.0, -2.0, 3.0)])),
        channel(2, ChannelValues::Weights { weights_per_key: 2, values: vec![0.0, 0.3, 1.0, 0.0] }),
    ];
    Clip { name: "all".to_owned(), channels }
}

/// One object of each kind, and spheres and a fixed mesh among them.
fn every_kind() -> Scene {
    let node = |rest_weights: Vec<f32>| Node {
        name: String::new(),
        parent: None,
        rest: LocalTransform::IDENTITY,
        rest_weights,
    };
    let object = |node: Option<u32>, mask: u32, shape: Shape| SceneObject {
        name: String::new(),
        node: node.map(NodeIdx),
        mask,
        shape,
    };
    let balls = Mesh::from_spheres(vec![Sphere::new(Vec3::Y, 0.5)]);
    let balls = SurfaceMesh::new(balls, MaterialIdx(0));
    Scene {
        nodes: vec![node(vec![]), node(vec![]), node(vec![0.0, 0.0])],
        objects: vec![
            object(None, 1, Shape::Fixed(surface(7, false))),
            object(Some(0), 2, Shape::Fixed(surface(70, true))),
            object(Some(1), 3, Shape::Fixed(balls)),
            object(Some(2), 4, bent(9, None)),
            object(Some(2), 5, bent(130, Some(skin(130)))),
            object(Some(1), 6, keyed(65)),
        ],
        materials: vec![Material::default()],
        clips: vec![clip()],
        ..Scene::default()
    }
}

fn assert_as_written(renderer: &GpuRenderer, frame: &SceneFrame) {
    let (context, device) = (&renderer.context, &renderer.device);
    let mut expected = PrimitiveStore::default();
    expected.commit(context, &frame.geometry, &FrameChanges::all(), "test").unwrap();
    let prims = expected.host();
    let mut attributes = AttributeStore::default();
    attributes.commit(context, frame, &expected, &[]);
    let part = device.primitives.parts().next().unwrap();
    let found: Vec<DevicePrimitive> = read(context, part.buffer, prims.len());
    for (found, expected) in found.iter().zip(prims) {
        let numbers = |p: &DevicePrimitive| [p.mask, p.kind, p.rank];
        assert_eq!(numbers(found), numbers(expected), "{found:?}, not {expected:?}");
        for (a, b) in [(found.a, expected.a), (found.b, expected.b), (found.c, expected.c)] {
            assert!(near(&a, &b), "{found:?}, not {expected:?}");
        }
    }
    let found: Vec<Attributes> = read(context, device.attributes.buffer(), prims.len());
    for (found, expected) in found.iter().zip(attributes.host()) {
        let normals = |a: &Attributes| [a.normal_a, a.normal_b, a.normal_c];
        for (a, b) in normals(found).iter().zip(normals(expected)) {
            assert!(near(a, &b), "{found:?}, not {expected:?}");
        }
        let [normal_a, normal_b, normal_c] = normals(expected);
        assert_eq!(Attributes { normal_a, normal_b, normal_c, ..*found }, *expected);
    }
}

/// Forth and back, resting, at a key and between keys.
const TIMES: [f64; 9] = [0.0, 0.2, 0.2, 0.3, 0.7, 1.0, 1.2, 0.7, 1.7];

#[test]
fn objects_are_as_the_host_would_write_them() {
    for scene in [every_kind(), builtin::build("museum3").unwrap()].map(Arc::new) {
        for context in contexts() {
            let mut evaluator = Evaluator::new(Arc::clone(&scene), None).unwrap();
            let mut renderer = GpuRenderer::new(context).unwrap();
            for time in TIMES {
                let frame = evaluator.evaluate(time).unwrap();
                renderer.commit(&scene, frame).unwrap();
                assert_as_written(&renderer, frame);
            }
        }
    }
}

/// What commits of a new renderer send at these times.
fn sent<const N: usize>(
    context: &Arc<GpuContext>,
    scene: &Arc<Scene>,
    times: [f64; N],
) -> [u64; N] {
    let mut evaluator = Evaluator::new(Arc::clone(scene), None).unwrap();
    let mut renderer = GpuRenderer::new(context).unwrap();
    times.map(|time| {
        let frame = evaluator.evaluate(time).unwrap();
        let stats = renderer.commit(scene, frame).unwrap();
        assert!(stats.rewritten_count > 0);
        renderer.budget().sent_bytes
    })
}

/// Once all is there, what moves takes a few numbers a frame.
#[test]
fn geometry_does_not_cross_the_bus() {
    let crowd = Arc::new(builtin::build("crowd").unwrap());
    let museum = Arc::new(builtin::build("museum3").unwrap());
    for (scene, times) in [(crowd, [0.1, 0.2, 0.3]), (museum, [3.2, 3.4, 3.6])] {
        for context in contexts() {
            let sent = sent(context, &scene, times);
            let name = &scene.name;
            assert!(sent[0] > 100 * sent[2], "{name}: {sent:?}");
            assert_eq!(sent[1], sent[2], "{name}");
        }
    }
}

#[test]
fn a_span_takes_over_the_key_that_ended_the_one_before() {
    let scene = Arc::new(builtin::build("museum3").unwrap());
    let key_bytes = 3 * 4_u64.pow(3) * size_of::<Vec3>() as u64;
    for context in contexts() {
        // Keys lie at whole seconds; back in the third span, its other key is missing.
        let sent = sent(context, &scene, [2.5, 2.6, 3.5, 4.5, 3.6, 3.7]);
        let keys = sent.map(|bytes| (bytes - sent[1]) / key_bytes);
        assert_eq!(keys[1..], [0, 1, 1, 1, 0], "{sent:?}");
    }
}

/// Whoever says how a mesh came about may be wrong: that of another object, or of too many vertices.
#[test]
fn what_a_mesh_cannot_have_come_from_is_not_used() {
    let scene = Arc::new(every_kind());
    for context in contexts() {
        let mut evaluator = Evaluator::new(Arc::clone(&scene), None).unwrap();
        let mut renderer = GpuRenderer::new(context).unwrap();
        for time in [0.2, 0.3] {
            let mut frame = evaluator.evaluate(time).unwrap().clone();
            frame.deformations.swap(3, 4);
            if let Deformation::Between(span) = &mut frame.deformations[5] {
                span.after = surface(66, true);
            }
            renderer.commit(&scene, &frame).unwrap();
            assert_as_written(&renderer, &frame);
        }
    }
}

/// An object that goes away and comes again has its place taken by others in between.
#[test]
fn objects_come_and_go() {
    for context in contexts() {
        let (few, many) = (Arc::new(every_kind()), Arc::new(builtin::build("museum3").unwrap()));
        let mut renderer = GpuRenderer::new(context).unwrap();
        for (scene, time) in [(&few, 0.4), (&many, 3.4), (&few, 0.8), (&few, 0.9)] {
            let mut evaluator = Evaluator::new(Arc::clone(scene), None).unwrap();
            let frame = evaluator.evaluate(time).unwrap();
            renderer.commit(scene, frame).unwrap();
            assert_as_written(&renderer, frame);
        }
    }
}
