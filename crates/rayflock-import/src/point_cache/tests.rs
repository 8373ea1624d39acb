//! Tests on tiny files.

use std::path::Path;
use std::sync::Arc;

use glam::Vec3;
use rayflock_scene::{Evaluator, MotionKind, Scene};

use crate::{LoadOptions, Reporter, load, source_files};

/// Four points of which the faces use three, two of them twice: a seam.
const OBJ: &str = "v 0 0 0\nv 9 9 9\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 1\nvn 0 0 1\n\
    usemtl a\nf 1/1/1 3/1/1 4/1/1\ng b\nf 1/2/1 4/1/1 3/2/1\n";

/// Sample i: points at x = i, apart along y, with the last at z = i.
fn positions(samples: usize) -> Vec<f32> {
    let point = |i: usize, p: usize| [i as f32, p as f32, if p == 3 { i as f32 } else { 0.0 }];
    (0..samples).flat_map(|i| (0..4).flat_map(move |p| point(i, p))).collect()
}

fn pc2(samples: usize, frames_a_sample: f32) -> Vec<u8> {
    let mut bytes = b"POINTCACHE2\0".to_vec();
    bytes.extend([1_i32, 4].map(i32::to_le_bytes).as_flattened());
    bytes.extend([0.0, frames_a_sample].map(f32::to_le_bytes).as_flattened());
    bytes.extend((samples as i32).to_le_bytes());
    bytes.extend(positions(samples).iter().flat_map(|value| value.to_le_bytes()));
    bytes
}

fn mdd(times: &[f32]) -> Vec<u8> {
    let mut bytes = [times.len() as i32, 4].map(i32::to_be_bytes).concat();
    bytes.extend(times.iter().flat_map(|time| time.to_be_bytes()));
    bytes.extend(positions(times.len()).iter().flat_map(|value| value.to_be_bytes()));
    bytes
}

/// Loads `name` from a folder with these files.
fn load_in(folder: &Path, files: &[(&str, &[u8])]) -> Result<(Scene, Vec<String>), String> {
    for (name, bytes) in files {
        std::fs::write(folder.join(name), bytes).unwrap();
    }
    let mut reporter = Reporter::new();
    let scene = load(&folder.join(files[0].0), &mut reporter).map_err(|error| error.to_string())?;
    Ok((scene, reporter.warnings().iter().map(|warning| warning.message.clone()).collect()))
}

fn load_files(files: &[(&str, &[u8])]) -> Result<(Scene, Vec<String>), String> {
    let folder = tempfile::tempdir().unwrap();
    load_in(folder.path(), files)
}

#[test]
fn vertices_follow_their_points() {
    for (name, bytes, rate) in
        [("c.pc2", pc2(3, 1.0), 24.0), ("c.mdd", mdd(&[0.5, 0.54, 0.58]), 25.0)]
    {
        let folder = tempfile::tempdir().unwrap();
        let (scene, warnings) =
            load_in(folder.path(), &[(name, &bytes), ("c.obj", OBJ.as_bytes())]).unwrap();
        assert!(warnings.is_empty(), "{warnings:?}");
        assert_eq!((scene.frame_count, scene.default_frame_rate()), (Some(3), rate));
        assert_eq!((scene.name.as_str(), scene.materials[0].name.as_str()), ("c", "a"));
        let mut evaluator = Evaluator::new(Arc::new(scene), None).unwrap();
        assert_eq!(evaluator.motion_kinds(), [MotionKind::Deforming]);
        let first = Arc::clone(&evaluator.evaluate(0.0).unwrap().surfaces[0].mesh);
        let frame = evaluator.evaluate(2.0 / rate).unwrap();
        let surface = &frame.surfaces[0];
        assert!(surface.mesh.has_topology_of(&first));
        // Points 0, 2 and 3 of the first object, and again of the second.
        let [a, b, c] = [[2.0, 0.0, 0.0], [2.0, 2.0, 0.0], [2.0, 3.0, 2.0]].map(Vec3::from);
        assert_eq!(surface.mesh.vertices(), [a, b, c, a, b, c]);
        assert_eq!(surface.normals.len(), 6);
        assert!(surface.normals.iter().all(|normal| normal.is_normalized()));
    }
}

#[test]
fn normals_follow_the_triangles_and_flat_meshes_have_none() {
    let flat = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\n";
    let smooth = flat.replace("f 1 2 3", "vn 0 0 1\nf 1//1 2//1 3//1");
    for (text, expected) in [(smooth.as_str(), vec![Vec3::NEG_X; 3]), (flat, vec![])] {
        let mut bytes = pc2(1, 1.0);
        // The first three points in the plane x = 0: (0, 0, 0), (0, 0, 1), (0, 1, 0).
        let start = bytes.len() - 4 * 12;
        let corners = [0.0_f32, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 0.0];
        for (idx, value) in corners.iter().enumerate() {
            bytes[start + 4 * idx..][..4].copy_from_slice(&value.to_le_bytes());
        }
        let folder = tempfile::tempdir().unwrap();
        let (scene, _) =
            load_in(folder.path(), &[("c.pc2", &bytes), ("c.obj", text.as_bytes())]).unwrap();
        let mut evaluator = Evaluator::new(Arc::new(scene), None).unwrap();
        assert_eq!(*evaluator.evaluate(0.0).unwrap().surfaces[0].normals, *expected);
    }
}

#[test]
fn the_mesh_may_be_a_ply_file() {
    let ply = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n\
        property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n\
        0 0 0\n1 0 0\n0 1 0\n0 0 1\n4 0 1 2 3\n";
    let folder = tempfile::tempdir().unwrap();
    let files = [("c.pc2", pc2(2, 1.0)), ("c.ply", ply.into())];
    let files = files.each_ref().map(|(name, bytes)| (*name, bytes.as_slice()));
    let (scene, _) = load_in(folder.path(), &files).unwrap();
    let mut evaluator = Evaluator::new(Arc::new(scene), None).unwrap();
    let mesh = &evaluator.evaluate(1.0 / 24.0).unwrap().surfaces[0].mesh;
    assert_eq!((mesh.vertices()[2], mesh.triangles().len()), (Vec3::new(1.0, 2.0, 0.0), 2));
    let cache = folder.path().join("c.pc2");
    let sources = source_files(&cache, &LoadOptions::default()).unwrap();
    assert_eq!(sources, [cache, folder.path().join("c.ply")]);
}

#[test]
fn odd_rates_and_tails_are_told() {
    let mut tail = pc2(2, 0.5);
    tail.extend([1, 2, 3]);
    let (_, warnings) = load_files(&[("c.pc2", &tail), ("c.obj", OBJ.as_bytes())]).unwrap();
    let expected = [
        "0.5 frames a sample are stated; one is shown",
        "3 bytes follow the 2 samples of 4 points",
    ];
    assert_eq!(warnings, expected);
    let uneven = mdd(&[0.0, 0.1, 0.5]);
    let (scene, warnings) = load_files(&[("c.mdd", &uneven), ("c.obj", OBJ.as_bytes())]).unwrap();
    assert!(scene.frame_rate.is_none() && warnings[0].contains("not evenly apart"));
}

#[test]
fn headers_are_checked_against_file_and_mesh() {
    let whole = pc2(3, 1.0);
    let edited = |at: usize, value: i32| {
        let mut bytes = whole.clone();
        bytes[at..at + 4].copy_from_slice(&value.to_le_bytes());
        bytes
    };
    let message = |name: &str, bytes: &[u8]| {
        load_files(&[(name, bytes), ("c.obj", OBJ.as_bytes())]).unwrap_err()
    };
    let cases = [
        (whole[..31].to_vec(), "header: found failed to fill whole buffer"),
        (b"POINTCACHE1\0".repeat(4), "header: found \"POINTCACHE1"),
        (edited(12, 2), "header: found version 2, expected version 1"),
        (edited(16, -4), "header: found -4 points, expected one at least"),
        (edited(28, 0), "header: found 0 samples, expected one at least"),
        (edited(28, 4), "found a file of 176 bytes, expected 224 bytes for 4 samples of 4 points"),
        (edited(16, i32::MAX), "found a file of 176 bytes"),
        (edited(16, 3), "header: found 3 points, expected 4, as "),
    ];
    for (bytes, expected) in cases {
        let message = message("c.pc2", &bytes);
        assert!(message.contains("c.pc2") && message.contains(expected), "{expected}: {message}");
    }
    let mut huge = mdd(&[0.0, 0.1]);
    huge[..8].fill(0x7F);
    assert!(message("c.mdd", &huge).contains("found a file of 112 bytes"));
    let alone = load_files(&[("c.pc2", &whole)]).unwrap_err();
    assert!(
        alone.contains("mesh: found none, expected one of c.obj, c.obj.gz, c.ply, c.ply.gz beside")
    );
    let packed = load_files(&[("c.pc2.gz", &whole)]).unwrap_err();
    assert!(packed.contains("a compressed point cache is not supported"), "{packed}");
}

#[test]
fn a_cache_that_shrinks_is_an_error_of_the_frame() {
    let folder = tempfile::tempdir().unwrap();
    let bytes = pc2(3, 1.0);
    let (scene, _) =
        load_in(folder.path(), &[("c.pc2", &bytes), ("c.obj", OBJ.as_bytes())]).unwrap();
    std::fs::write(folder.path().join("c.pc2"), &bytes[..bytes.len() - 1]).unwrap();
    let mut evaluator = Evaluator::new(Arc::new(scene), None).unwrap();
    assert!(evaluator.evaluate(1.0 / 24.0).is_ok());
    let message = evaluator.evaluate(2.0 / 24.0).unwrap_err().to_string();
    assert!(message.contains("c.pc2: sample 2: "), "{message}");
}
