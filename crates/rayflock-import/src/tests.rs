//! What the tests of all formats share, and the tests of [`crate::load`].

use rayflock_scene::{Scene, Shape, SurfaceMesh};

use crate::{EXTENSIONS, ImportError, LoadOptions, Reporter, UpAxis, load, load_with};

/// Loads a file of this content and name; gives the scene and the warnings.
pub(crate) fn load_bytes(name: &str, bytes: &[u8]) -> Result<(Scene, Vec<String>), ImportError> {
    load_files(name, &[(name, bytes)])
}

/// Writes files into a new folder and loads one of them.
pub(crate) fn load_files(
    name: &str,
    files: &[(&str, &[u8])],
) -> Result<(Scene, Vec<String>), ImportError> {
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes) in files {
        std::fs::write(folder.path().join(name), bytes).unwrap();
    }
    let mut reporter = Reporter::new();
    let scene = load(&folder.path().join(name), &mut reporter)?;
    Ok((scene, reporter.warnings().iter().map(ToString::to_string).collect()))
}

/// The mesh of an object that does not deform.
pub(crate) fn fixed_mesh(scene: &Scene, object_idx: usize) -> &SurfaceMesh {
    match &scene.objects[object_idx].shape {
        Shape::Fixed(mesh) => mesh,
        other => panic!("not a fixed mesh: {other:?}"),
    }
}

const TRIANGLE_STL: &[u8] = b"solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n\
    vertex 1 0 0\nvertex 0 0 1\nendloop\nendfacet\nendsolid a\n";

#[test]
fn an_unknown_extension_lists_the_known_ones() {
    for name in ["a.txt", "b", "c.txt.gz", "d.gz"] {
        let message = load_bytes(name, b"").unwrap_err().to_string();
        let known = EXTENSIONS.iter().all(|known| message.contains(&format!(".{known}")));
        assert!(known, "{message}");
    }
}

#[test]
fn a_missing_file_and_a_folder_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let missing = folder.path().join("missing.stl");
    let message = load(&missing, &mut Reporter::new()).unwrap_err().to_string();
    assert!(message.contains("missing.stl"), "{message}");
    std::fs::create_dir(&missing).unwrap();
    let message = load(&missing, &mut Reporter::new()).unwrap_err().to_string();
    assert!(message.contains("missing.stl: folder: found no files"), "{message}");
}

#[test]
fn extensions_count_in_any_case_and_gz_is_unpacked() {
    use std::io::Write;
    assert!(load_bytes("A.STL", TRIANGLE_STL).is_ok());
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
    encoder.write_all(TRIANGLE_STL).unwrap();
    let (scene, _) = load_bytes("part.stl.gz", &encoder.finish().unwrap()).unwrap();
    assert_eq!((scene.name.as_str(), scene.objects.len()), ("part", 1));
    assert!(load_bytes("part.stl.gz", TRIANGLE_STL).is_err());
}

#[test]
fn z_up_files_can_be_turned() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.stl");
    std::fs::write(&path, TRIANGLE_STL).unwrap();
    let options = LoadOptions { up_axis: UpAxis::Z, ..LoadOptions::default() };
    let scene = load_with(&path, &options, &mut Reporter::new()).unwrap();
    let node = scene.objects[0].node.unwrap();
    let turned = scene.nodes[node.0 as usize].rest.to_affine().transform_point3(glam::Vec3::Z);
    assert!(turned.abs_diff_eq(glam::Vec3::Y, 1e-6), "{turned}");
}
