//! Tests on folders of tiny files.

use std::io::Write;
use std::path::Path;
use std::sync::{Arc, Weak};

use glam::Vec3;
use rayflock_geom::{Mesh, ObjectChange, ObjectId};
use rayflock_scene::{Evaluator, FRAMES_KEPT, InBetweens, MotionKind, PrimMaterials, Scene};
use tempfile::TempDir;

use crate::{LoadOptions, NumberedFile, Reporter, UpAxis, load_with, source_files};

/// A folder with files of these names and contents.
fn folder(files: &[(&str, &str)]) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in files {
        std::fs::write(folder.path().join(name), text).unwrap();
    }
    folder
}

/// A triangle with a corner at `x`, `copies` times.
fn obj(x: usize, copies: usize) -> String {
    format!("v 0 0 0\nv {x} 0 0\nv 0 1 0\n{}", "f 1 2 3\n".repeat(copies))
}

/// The scene and its warnings, without the folder in their names.
fn load_at(path: &Path, options: &LoadOptions) -> Result<(Scene, Vec<String>), String> {
    let mut reporter = Reporter::new();
    let scene = load_with(path, options, &mut reporter).map_err(|error| error.to_string())?;
    Ok((scene, reporter.warnings().iter().map(|warning| warning.message.clone()).collect()))
}

fn load(path: &Path) -> (Scene, Vec<String>) {
    load_at(path, &LoadOptions::default()).unwrap()
}

fn error(path: &Path) -> String {
    load_at(path, &LoadOptions::default()).unwrap_err()
}

fn evaluator(scene: Scene) -> Evaluator {
    Evaluator::new(Arc::new(scene), None).unwrap()
}

fn mesh_at(evaluator: &mut Evaluator, frame: usize) -> Result<Arc<Mesh>, String> {
    let evaluated = evaluator.evaluate(frame as f64 / 24.0).map_err(|error| error.to_string())?;
    Ok(Arc::clone(&evaluated.surfaces[0].mesh))
}

/// The x coordinates of all frames' second vertices.
fn order(scene: Scene) -> Vec<f32> {
    let frame_count = scene.frame_count.unwrap();
    let mut evaluator = evaluator(scene);
    let x = |frame| mesh_at(&mut evaluator, frame).unwrap().vertices()[1].x;
    (0..frame_count).map(x).collect()
}

#[test]
fn numbers_count_as_numbers_and_need_no_prefix() {
    let texts = [1, 9, 10, 11].map(|number| (format!("{number}.obj"), obj(number, 1)));
    let files = texts.each_ref().map(|(name, text)| (name.as_str(), text.as_str()));
    let folder = folder(&files);
    std::fs::write(folder.path().join("notes.txt"), "not a frame").unwrap();
    std::fs::write(folder.path().join(".hidden.obj"), "not a frame").unwrap();
    let (scene, warnings) = load(folder.path());
    assert_eq!(scene.name, folder.path().file_name().unwrap().to_string_lossy());
    assert_eq!(order(scene), [1.0, 9.0, 10.0, 11.0]);
    assert_eq!(warnings, ["2..8 are missing; frames follow each other without them"]);
    let files = source_files(folder.path(), &LoadOptions::default()).unwrap();
    assert_eq!(files.last(), Some(&folder.path().join("11.obj")));
}

#[test]
fn missing_and_double_numbers_are_told() {
    let warnings = |numbers: &[&str]| {
        let text = obj(1, 1);
        let names: Vec<String> = numbers.iter().map(|number| format!("a_{number}.obj")).collect();
        let files: Vec<_> = names.iter().map(|name| (name.as_str(), text.as_str())).collect();
        load(folder(&files).path()).1.join("; ")
    };
    assert_eq!(warnings(&["001", "002", "003"]), "");
    assert_eq!(warnings(&["10", "20", "30"]), "", "every tenth step is a frame");
    assert!(warnings(&["1", "2", "4", "8"]).starts_with("3, 5..7 are missing"));
    assert!(warnings(&["1", "2", "4"]).starts_with("3 is missing"));
    assert!(warnings(&["0010", "0020", "0050"]).starts_with("30..40 are missing"));
    assert!(warnings(&["1", "01", "2"]).starts_with("1 is there twice"));
    let sparse = ["1", "2", "4", "6", "8", "10", "12", "14", "16", "18", "20"];
    assert!(warnings(&sparse).starts_with("3, 5, 7, 9, 11, 13, 15, 17 and 1 more are missing"));
}

#[test]
fn names_that_differ_in_two_numbers_have_no_gaps() {
    let (a, b) = (obj(1, 1), obj(2, 1));
    let folder = folder(&[("frame_05_iso150.obj", &a), ("frame_06_iso226.obj", &b)]);
    let (scene, warnings) = load(folder.path());
    assert_eq!((order(scene), warnings.len()), (vec![1.0, 2.0], 0));
}

#[test]
fn frames_may_be_empty_and_change_topology() {
    let (one, three) = (obj(1, 1), obj(3, 3));
    let folder = folder(&[("a1.obj", "# nothing\n"), ("a2.obj", &one), ("a3.obj", &three)]);
    let (scene, warnings) = load(folder.path());
    assert_eq!((scene.name.as_str(), scene.frame_count), ("a", Some(3)));
    assert!(warnings.is_empty(), "{warnings:?}");
    let mut evaluator = evaluator(scene);
    assert_eq!(evaluator.motion_kinds(), [MotionKind::Topology]);
    let counts =
        [0, 1, 2, 0].map(|frame| mesh_at(&mut evaluator, frame).unwrap().triangles().len());
    assert_eq!(counts, [0, 1, 3, 0]);
}

#[test]
fn materials_are_those_of_the_first_frame_that_shows_something() {
    let mtl = "newmtl red\nKd 1 0 0\nnewmtl blue\nKd 0 0 1\n";
    let quad = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\n";
    let first = format!("{quad}usemtl red\nf 1 2 3\ng b\nusemtl blue\nf 1 2 3\n");
    let second = format!("{quad}usemtl blue\nf 1 2 3\nusemtl new\nf 1 2 3\nf 1 2 3\n");
    let folder = folder(&[("a.mtl", mtl), ("a1.obj", ""), ("a2.obj", &first), ("a3.obj", &second)]);
    let (scene, warnings) = load(folder.path());
    assert!(warnings.is_empty(), "{warnings:?}");
    let names: Vec<_> = scene.materials.iter().map(|material| material.name.clone()).collect();
    assert_eq!(names, ["red", "blue", ""]);
    let mut evaluator = evaluator(scene);
    let mut materials = |frame: usize| {
        let frame = evaluator.evaluate(frame as f64 / 24.0).unwrap();
        match &frame.surfaces[0].attributes.materials {
            PrimMaterials::PerPrim(materials) => materials.iter().map(|idx| idx.0).collect(),
            PrimMaterials::Uniform(idx) => vec![idx.0],
        }
    };
    assert_eq!((materials(1), materials(2)), (vec![0, 1], vec![1, 2, 2]));
}

#[test]
fn patterns_choose_files() {
    let (a, b) = (obj(1, 1), obj(2, 1));
    let folder = folder(&[("a1.obj", &a), ("b1.obj", &b), ("b2.obj", &a), ("b3.ply", "")]);
    let pattern = |pattern: &str| folder.path().join(pattern);
    let (scene, warnings) = load(&pattern("b*.obj"));
    assert_eq!((scene.name.as_str(), warnings.len()), ("b", 0));
    assert_eq!(order(scene), [2.0, 1.0]);
    assert_eq!(order(load(&pattern("?1.obj")).0), [1.0, 2.0]);
    assert!(error(&pattern("c*.obj")).ends_with(
        "c*.obj: pattern: found no files, expected files .obj, .ply, .stl, .vtk, .vtp, or these \
         with .gz"
    ));
    assert!(error(&pattern("a***.obj")).contains("pattern, character"));
    assert!(error(&pattern("b*")).contains("pattern: found 2 .obj and 1 .ply files, expected"));
}

#[test]
fn folders_without_frames_or_with_several_formats_say_what_is_there() {
    let empty = folder(&[]);
    assert!(error(empty.path()).contains("folder: found no files, expected files .obj"));
    let others = folder(&[("a.mtl", ""), ("b.glb", ""), ("c.glb", ""), ("d", "")]);
    let message = error(others.path());
    assert!(message.contains("found 1 without extension, 2 .glb and 1 .mtl files"), "{message}");
    let mixed = folder(&[("a.obj", ""), ("b.ply", ""), ("c.obj", ""), ("d.png", "")]);
    let message = error(mixed.path());
    assert!(message.contains("found 2 .obj and 1 .ply files, expected files of one format"));
}

#[test]
fn the_first_of_numbered_files_stands_for_all() {
    let texts = [3, 5, 6].map(|number| (format!("a_{number:03}_x.obj"), obj(number, 1)));
    let files = texts.each_ref().map(|(name, text)| (name.as_str(), text.as_str()));
    let folder = folder(&files);
    std::fs::write(folder.path().join("b_001_x.obj"), obj(1, 1)).unwrap();
    let options = LoadOptions { numbered_file: NumberedFile::FirstFrame, ..Default::default() };
    let load = |name: &str| load_at(&folder.path().join(name), &options).unwrap();
    let (scene, warnings) = load("a_003_x.obj");
    assert_eq!(order(scene), [3.0, 5.0, 6.0]);
    assert_eq!(warnings.len(), 2, "{warnings:?}");
    assert!(warnings[0].starts_with("the first of 3 numbered files"));
    assert_eq!(load("a_005_x.obj").0.frame_count, None, "another than the first");
    assert_eq!(load("b_001_x.obj").0.frame_count, None, "no others");
    let alone = load_at(&folder.path().join("a_003_x.obj"), &LoadOptions::default()).unwrap();
    assert_eq!(alone.0.frame_count, None, "not asked for");
}

#[test]
fn what_is_wrong_with_a_late_file_is_an_error_of_its_frame() {
    let good = obj(1, 1);
    let folder = folder(&[("a1.obj", &good), ("a2.obj", "v 0 0\n"), ("a3.obj", &good)]);
    std::fs::remove_file(folder.path().join("a3.obj")).unwrap();
    std::fs::create_dir(folder.path().join("a3.obj")).unwrap();
    std::fs::write(folder.path().join("a4.obj"), &good).unwrap();
    let mut evaluator = evaluator(load(folder.path()).0);
    let message = mesh_at(&mut evaluator, 1).unwrap_err();
    assert!(message.starts_with("object \"a\" at 0.0416"), "{message}");
    assert!(message.contains("a2.obj: line 1: found \"v 0 0\", expected 3 coordinates"));
    assert!(mesh_at(&mut evaluator, 0).is_ok() && mesh_at(&mut evaluator, 2).is_ok());
    std::fs::remove_file(folder.path().join("a4.obj")).unwrap();
    mesh_at(&mut evaluator, 0).unwrap();
    mesh_at(&mut evaluator, 1).unwrap_err();
    assert!(mesh_at(&mut evaluator, 2).unwrap_err().contains("a4.obj: "));
}

#[test]
fn frames_may_be_compressed_and_damage_is_told() {
    let folder = folder(&[("a1.obj", &obj(1, 1))]);
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
    encoder.write_all(obj(2, 1).as_bytes()).unwrap();
    let compressed = encoder.finish().unwrap();
    std::fs::write(folder.path().join("a2.obj.gz"), &compressed).unwrap();
    std::fs::write(folder.path().join("a3.obj.gz"), &compressed[..20]).unwrap();
    let (scene, warnings) = load(folder.path());
    assert!(warnings.is_empty(), "{warnings:?}");
    let mut evaluator = evaluator(scene);
    assert_eq!(mesh_at(&mut evaluator, 1).unwrap().vertices()[1], 2.0 * Vec3::X);
    assert!(mesh_at(&mut evaluator, 2).unwrap_err().contains("a3.obj.gz: gzip stream: found"));
}

#[test]
fn frames_are_turned_and_interpolated_as_asked() {
    let folder = folder(&[("a1.obj", &obj(1, 1)), ("a2.obj", &obj(2, 1))]);
    let options = LoadOptions {
        up_axis: UpAxis::Z,
        frame_rate: Some(10.0),
        in_betweens: InBetweens::Linear,
        ..LoadOptions::default()
    };
    let (scene, _) = load_at(folder.path(), &options).unwrap();
    assert_eq!((scene.frame_rate, scene.objects[0].node.is_some()), (Some(10.0), true));
    let mut evaluator = evaluator(scene);
    evaluator.evaluate(0.0).unwrap();
    let frame = evaluator.evaluate(0.05).unwrap();
    assert_eq!(frame.changes.get(ObjectId(0)), ObjectChange::Deformed);
    assert!((frame.geometry.bounds().max.x - 1.5).abs() < 1e-6);
    assert!((frame.geometry.bounds().min.z + 1.0).abs() < 1e-6, "y has become -z");
}

#[test]
fn thousands_of_frames_are_read_one_after_the_other() {
    let folder = tempfile::tempdir().unwrap();
    for frame in 0..3000 {
        let name = folder.path().join(format!("{frame}.obj"));
        std::fs::write(name, obj(frame + 1, 1 + frame % 5)).unwrap();
    }
    let (scene, warnings) = load(folder.path());
    assert_eq!((scene.frame_count, warnings.len()), (Some(3000), 0));
    let mut evaluator = evaluator(scene);
    let mut meshes: Vec<Weak<Mesh>> = Vec::new();
    for frame in 0..3000 {
        let mesh = mesh_at(&mut evaluator, frame).unwrap();
        assert_eq!(mesh.vertices()[1].x, (frame + 1) as f32);
        meshes.push(Arc::downgrade(&mesh));
        drop(mesh);
        meshes.retain(|mesh| mesh.strong_count() > 0);
        assert!(meshes.len() <= FRAMES_KEPT, "{} frames are held", meshes.len());
    }
}
