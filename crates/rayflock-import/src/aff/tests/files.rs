//! Files that include others.

use crate::tests::load_files;
use crate::{ImportError, LoadOptions, Reporter, load_with};

const TRIANGLE: &str = "p 3 0 0 0 1 0 0 0 1 0\n";

fn load_two(top: &str, other: &str) -> Result<(rayflock_scene::Scene, Vec<String>), ImportError> {
    load_files("a.aff", &[("a.aff", top.as_bytes()), ("b.aff", other.as_bytes())])
}

fn message(top: &str, other: &str) -> String {
    load_two(top, other).unwrap_err().to_string()
}

#[test]
fn included_files_are_objects_and_leave_their_fill_behind() {
    let top = format!("i 0 b.aff\n{TRIANGLE}xs 1 1 1 0 0 0 0 5 0 0 {{ i 0 b.aff }}");
    let (scene, warnings) = load_two(&top, &format!("{TRIANGLE}f 1 0 0 1 0 1 0 0")).unwrap();
    assert!(warnings.is_empty(), "{warnings:?}");
    let names: Vec<&str> = scene.objects.iter().map(|object| object.name.as_str()).collect();
    assert_eq!(names, ["b", "a", "b"]);
    let materials = |idx: usize| {
        let mesh = crate::tests::fixed_mesh(&scene, idx);
        mesh.attributes.materials.get(rayflock_geom::PrimId(0)).0
    };
    assert_eq!([0, 1, 2].map(materials), [0, 1, 1]);
    assert_eq!(crate::tests::fixed_mesh(&scene, 2).mesh.bounds().min.x, 5.0);
}

#[test]
fn compressed_files_can_be_included() {
    use std::io::Write;
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
    encoder.write_all(TRIANGLE.as_bytes()).unwrap();
    let packed = encoder.finish().unwrap();
    let files: [(&str, &[u8]); 2] = [("a.nff", b"i 0 b.aff.gz"), ("b.aff.gz", &packed)];
    assert_eq!(load_files("a.nff", &files).unwrap().0.objects[0].name, "b");
}

#[test]
fn levels_of_detail_choose_files() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.aff");
    std::fs::write(folder.path().join("b.aff"), TRIANGLE).unwrap();
    let load = |text: &str, detail| {
        std::fs::write(&path, text).unwrap();
        let mut reporter = Reporter::new();
        let options = LoadOptions { detail, ..LoadOptions::default() };
        let scene = load_with(&path, &options, &mut reporter).unwrap();
        let skipped = reporter.warnings().iter().any(|warning| warning.message.contains("above"));
        (scene.objects.len(), skipped)
    };
    let all = "i 0 b.aff i 1 b.aff i 2 b.aff";
    assert_eq!(load(all, None), (3, false));
    assert_eq!(load(all, Some(1)), (2, true));
    let stated = format!("d 0 {all} d 2 {all}");
    assert_eq!(load(&stated, None), (4, true));
    assert_eq!(load(&stated, Some(0)), (2, true));
    assert_eq!(load(&stated, Some(2)), (6, false));
}

#[test]
fn files_that_are_missing_or_elsewhere_are_errors() {
    let missing = message("\ni 0 c.aff", "");
    assert!(missing.contains("a.aff: line 2: found \"c.aff\" cannot be read"), "{missing}");
    assert!(missing.contains("expected an AFF file in the folder"), "{missing}");
    for elsewhere in ["../../etc/passwd", "/etc/passwd", "c:\\b.aff", "..\\b.aff"] {
        let message = message(&format!("i 0 {elsewhere}"), "");
        assert!(message.contains("line 1: found \""), "{message}");
        assert!(message.contains("leads out") || message.contains("not a relative"), "{message}");
    }
    assert!(message("i 0", "").contains("expected the name of an AFF file"));
    assert!(message("i b.aff 0", "").contains("found \"b.aff\", expected a whole number"));
}

#[test]
fn errors_name_the_included_file_and_line() {
    let message = message("i 0 b.aff", "\n\ns 0 0 0 x");
    assert!(message.contains("a.aff: b.aff line 3: found \"x\""), "{message}");
}

#[test]
fn blocks_end_in_the_file_they_begin_in() {
    assert!(message("i 0 b.aff", "}").contains("b.aff line 1: found \"}\""));
    assert!(message("i 0 b.aff }", "x a {").contains("b.aff line 1: found a block without an end"));
}

#[test]
fn files_cannot_include_each_other_for_ever() {
    let message_of = message("i 0 a.aff", "");
    assert!(message_of.contains("found \"a.aff\", which is being read"), "{message_of}");
    let message_of = message("i 0 b.aff", "i 0 a.aff");
    assert!(message_of.contains("b.aff line 1: found \"a.aff\", which"), "{message_of}");
    // The same file by another name each time.
    let message_of = message("i 0 ././b.aff", "i 0 ./b.aff");
    assert!(message_of.contains("which is being read"), "{message_of}");
}

#[test]
fn files_cannot_be_included_too_often() {
    let folder = tempfile::tempdir().unwrap();
    // Each file includes the next one twice: 2^20 inclusions.
    for level in 0..20 {
        let next = format!("f{}.aff", level + 1);
        let text = format!("i 0 {next} i 0 {next}");
        std::fs::write(folder.path().join(format!("f{level}.aff")), text).unwrap();
    }
    std::fs::write(folder.path().join("f20.aff"), "# nothing").unwrap();
    let path = folder.path().join("f0.aff");
    let error = crate::load(&path, &mut Reporter::new()).unwrap_err();
    assert!(matches!(error, ImportError::TooLarge { .. }), "{error}");
    assert!(error.to_string().contains("65536 inclusions"), "{error}");
}
