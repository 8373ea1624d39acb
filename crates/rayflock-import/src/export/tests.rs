//! What is written is read again as it was, in every bit.

use std::io::Cursor;
use std::sync::Arc;

use glam::{Affine3A, Vec3};
use rayflock_geom::{Geometry, GeometryObject, Mesh, ObjectId, Sphere};
use rayflock_scene::{Evaluator, Scene};

use super::{FrameMesh, FrameSet, MorphSet, write_obj, write_ply};
use crate::tests::{fixed_mesh, load_bytes};

/// A quad with coordinates of many digits.
fn quad(seed: u16) -> FrameMesh {
    let number = |i: u16| (f32::from(i) + 0.1) / f32::from(seed + 3) * 10.0_f32.powi(i.into());
    let vertices = (0..4).map(|i| Vec3::new(number(i), -number(i + 1), number(0))).collect();
    FrameMesh { vertices, triangles: vec![[0, 1, 2], [0, 2, 3]], spheres: vec![] }
}

fn drops(count: u16) -> FrameMesh {
    let drop =
        |i: u16| Sphere::new(Vec3::new(f32::from(i) / 3.0, 0.1, 0.2), 1.0 / f32::from(i + 3));
    FrameMesh { spheres: (0..count).map(drop).collect(), ..FrameMesh::default() }
}

/// The frame that a scene shows at a time.
fn frame_at(evaluator: &mut Evaluator, frame: usize, rate: f64) -> FrameMesh {
    FrameMesh::new(&evaluator.evaluate(frame as f64 / rate).unwrap().geometry)
}

fn only_frame(scene: &Scene) -> FrameMesh {
    let mesh = Mesh::clone(&fixed_mesh(scene, 0).mesh);
    FrameMesh::new(&Geometry::new(vec![GeometryObject::new(ObjectId(0), mesh)]).unwrap())
}

#[test]
fn meshes_come_back_from_obj_and_ply() {
    let frame = quad(1);
    let mut text = Vec::new();
    write_obj(&frame, &mut text).unwrap();
    assert_eq!(only_frame(&load_bytes("a.obj", &text).unwrap().0), frame);
    let mut bytes = Vec::new();
    write_ply(&frame, &mut bytes).unwrap();
    let (scene, warnings) = load_bytes("a.ply", &bytes).unwrap();
    assert_eq!((only_frame(&scene), warnings.len()), (frame, 0));
}

#[test]
fn spheres_and_empty_frames_come_back_from_ply() {
    for frame in [drops(5), FrameMesh::default()] {
        let mut bytes = Vec::new();
        write_ply(&frame, &mut bytes).unwrap();
        let (scene, warnings) = load_bytes("a.ply", &bytes).unwrap();
        assert_eq!((only_frame(&scene), warnings.len()), (frame, 0));
    }
    let mut text = Vec::new();
    write_obj(&FrameMesh::default(), &mut text).unwrap();
    assert!(load_bytes("a.obj", &text).unwrap().0.objects.is_empty());
}

#[test]
fn all_frames_come_back_from_a_set() {
    let more = FrameMesh { triangles: vec![[3, 1, 0]], ..quad(9) };
    let both = FrameMesh { spheres: drops(3).spheres, ..quad(5) };
    let sets = [
        vec![quad(1), quad(2), quad(3)],
        vec![quad(1), quad(2), more, FrameMesh::default(), quad(4)],
        vec![FrameMesh::default(), FrameMesh::default()],
        vec![drops(3), drops(3)],
        vec![drops(3), FrameMesh::default(), drops(7)],
        vec![both, quad(6), drops(2)],
    ];
    for frames in sets {
        let mut set = FrameSet::new();
        frames.iter().for_each(|frame| set.push(frame));
        assert_eq!(set.frame_count(), frames.len());
        let mut file = Cursor::new(Vec::new());
        set.write(30.0, &mut file).unwrap();
        let (scene, warnings) = load_bytes("a.npz", file.get_ref()).unwrap();
        assert!(warnings.is_empty(), "{warnings:?}");
        assert_eq!((scene.frame_count, scene.frame_rate), (Some(frames.len()), Some(30.0)));
        let mut evaluator = Evaluator::new(Arc::new(scene), None).unwrap();
        for (idx, frame) in frames.iter().enumerate() {
            assert_eq!(&frame_at(&mut evaluator, idx, 30.0), frame, "frame {idx}");
        }
    }
}

#[test]
fn frames_of_the_same_triangles_come_back_from_a_glb() {
    let frames = [quad(1), quad(2), quad(5), quad(3)];
    let mut set = MorphSet::new();
    frames.iter().for_each(|frame| set.push(frame).unwrap());
    let mut file = Vec::new();
    set.write(30.0, &mut file).unwrap();
    let (scene, warnings) = load_bytes("a.glb", &file).unwrap();
    assert!(warnings.is_empty(), "{warnings:?}");
    let mut evaluator = Evaluator::new(Arc::new(scene), None).unwrap();
    // The last frame is where the clip begins again.
    for (idx, frame) in frames[..3].iter().enumerate() {
        let found = frame_at(&mut evaluator, idx, 30.0);
        assert_eq!(found.triangles, frame.triangles);
        for (found, expected) in found.vertices.iter().zip(&frame.vertices) {
            let size = expected.abs().max_element();
            assert!(found.abs_diff_eq(*expected, 1e-5 * size), "{found} {expected}");
        }
    }
}

#[test]
fn a_glb_has_one_topology() {
    let mut set = MorphSet::new();
    set.push(&quad(1)).unwrap();
    let turned = FrameMesh { triangles: vec![[0, 2, 1], [0, 2, 3]], ..quad(2) };
    let expected = "found other triangles, expected those as in the first frame: glTF moves \
                    vertices only";
    assert_eq!(set.push(&turned).unwrap_err().to_string(), expected);
    let message = set.push(&FrameMesh::default()).unwrap_err().to_string();
    assert!(message.starts_with("found 0 vertices in 0 triangles, expected 4 vertices in 2"));
    let mut file = Vec::new();
    MorphSet::new().write(30.0, &mut file).unwrap();
    assert!(load_bytes("a.glb", &file).unwrap().0.objects.is_empty());
}

#[test]
fn frames_are_in_world_space() {
    let quad = quad(1);
    let mesh = Mesh::from_triangles(quad.vertices.clone(), quad.triangles.clone()).unwrap();
    let mesh = mesh.with_spheres(vec![Sphere::new(Vec3::X, 1.0)]);
    let place =
        Affine3A::from_scale_rotation_translation(Vec3::splat(2.0), glam::Quat::IDENTITY, Vec3::Y);
    let loose = Mesh::from_triangles(vec![Vec3::ONE], Vec::new()).unwrap();
    let objects = vec![
        GeometryObject::new(ObjectId(0), mesh.clone()),
        GeometryObject::new(ObjectId(1), loose),
        GeometryObject::new(ObjectId(2), mesh).with_transform(place),
    ];
    let frame = FrameMesh::new(&Geometry::new(objects).unwrap());
    assert_eq!((frame.vertices.len(), frame.triangles[2]), (8, [4, 5, 6]));
    assert_eq!(frame.vertices[5], 2.0 * quad.vertices[1] + Vec3::Y);
    assert_eq!(frame.spheres[1], Sphere::new(Vec3::new(2.0, 1.0, 0.0), 2.0));
}
