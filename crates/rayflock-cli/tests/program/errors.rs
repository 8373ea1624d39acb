//! Bad input gets a clear error, the right exit code and no half-written output.

use crate::Workplace;

/// A triangle, and one without area.
const STL: &str = "solid x
facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet
facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 2 0 0\nendloop\nendfacet
endsolid x\n";

/// Runs, and expects `code`, the words of `expected` on standard error, and no new files.
pub(crate) fn fails(work: &Workplace, words: &str, code: i32, expected: &[&str]) {
    let before = work.names();
    let run = work.run(words);
    assert_eq!(run.code, code, "{words}: {}", run.stderr);
    assert!(run.stderr.starts_with("error: "), "{words}: {}", run.stderr);
    for expected in expected {
        assert!(run.stderr.contains(expected), "{words}: {expected} is not in {}", run.stderr);
    }
    assert_eq!((work.names(), run.stdout.as_str()), (before, ""), "{words}");
}

#[test]
fn wrong_arguments_say_what_is_expected() {
    let work = Workplace::new();
    for (option, expected) in [
        ("--engine warp", ["\"warp\"", "brute, hierarchy"]),
        ("--engine brute --explain", ["engine auto", "--engine is brute"]),
        ("--frames 5..2", ["5..2", "expected 2..5"]),
        ("--frames x", ["'x'", "0..47"]),
        ("--size 0x5", ["0x5", "640x360"]),
        ("--size 99999x5", ["99999x5", "16384"]),
        ("--fps 0", ["--fps", "0.001 to 1000"]),
        ("--spp 0", ["--spp", "1..=65536"]),
        ("--depth 33", ["--depth", "0..=32"]),
        ("--threads 0", ["--threads", "1..=1024"]),
        ("--exposure nan", ["nan", "-100 to 100"]),
        ("--tone-map film", ["film", "agx"]),
        ("--bits 12", ["12", "16"]),
        ("--clip Dance", ["Dance", "no clip"]),
        ("--camera Nobody", ["Nobody", "no camera"]),
        ("--plot x.pdf", ["x.pdf", ".svg or .html"]),
    ] {
        fails(&work, &format!("render builtin:cornell {option} -o x.png"), 2, &expected);
    }
}

#[test]
fn wrong_outputs_say_what_there_is() {
    let work = Workplace::new();
    fails(&work, "render builtin:cornell", 2, &["--output <PATH>"]);
    fails(&work, "render builtin:cornell -o x.jpg", 2, &["x.jpg", ".png", ".mp4"]);
    fails(&work, "render builtin:cornell --size 16384x1 -o x.webp", 2, &["x.webp", "16383"]);
}

#[test]
fn unwritable_outputs_are_found_before_rendering() {
    let work = Workplace::new();
    work.write("file", "not a folder");
    for output in [
        "-o no/such/x.png",
        "-o no/such/folder/",
        "-o file/x.gif",
        "-o file/%03d.png",
        "--stats no/s.json -o x.png",
        "--plot no/p.svg -o x.png",
    ] {
        // At this size and depth, rendering first would take minutes.
        let words = format!("render builtin:museum8 --size 4000x3000 --spp 64 {output}");
        fails(&work, &words, 1, &["cannot "]);
    }
}

#[test]
fn inputs_that_are_not_there_are_named() {
    let work = Workplace::new();
    fails(&work, "info nothing.glb", 2, &["nothing.glb"]);
    fails(&work, "render builtin:kettle -o x.png", 2, &["\"kettle\"", "builtin:museum7"]);
    fails(&work, "info .", 2, &["folder: found no files"]);
    fails(&work, "render frames/*.obj -o x.png", 2, &["pattern: found no files"]);
    work.write("x.fbx", "Kaydara");
    fails(&work, "info x.fbx", 2, &["x.fbx"]);
}

#[test]
fn damaged_files_are_errors_of_the_input() {
    let work = Workplace::new();
    let mut stl = vec![0; 80];
    stl.extend(u32::MAX.to_le_bytes());
    let header = "ply\nformat ascii 1.0\nelement vertex 4000000000\nproperty float x\n\
                  property float y\nproperty float z\nend_header\n0 0 0\n";
    let cases: [(&str, &[u8]); 8] = [
        ("empty.glb", b""),
        ("garbage.glb", &[0xAB; 100]),
        ("short.glb", b"glTF\x02\0\0\0\xFF\xFF\0\0"),
        ("text.gltf", b"{\"asset\": {\"version\": \"2.0\"}, \"nodes\": [{\"mesh\": 7}]}"),
        ("index.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n"),
        ("absurd.stl", &stl),
        ("absurd.ply", header.as_bytes()),
        ("packed.obj.gz", b"not gzip"),
    ];
    for (name, bytes) in cases {
        work.write(name, bytes);
        fails(&work, &format!("info {name}"), 2, &[name]);
        fails(&work, &format!("render {name} -o x.png"), 2, &[name]);
    }
}

#[test]
fn a_loop_of_nodes_is_an_error() {
    let work = Workplace::new();
    let nodes = "{\"asset\": {\"version\": \"2.0\"}, \"scene\": 0, \"scenes\": [{\"nodes\": [0]}], \
                 \"nodes\": [{\"children\": [1]}, {\"children\": [0]}]}";
    work.write("loop.gltf", nodes);
    fails(&work, "render loop.gltf -o x.png", 2, &["node"]);
}

#[test]
fn triangles_without_area_are_counted_once() {
    let work = Workplace::new();
    work.write("x.stl", STL);
    let run = work.run("render x.stl --size 8x6 --frames 0..2 -o x.gif");
    assert_eq!(run.code, 0, "{}", run.stderr);
    let told = run.stderr.matches("1 of 2 primitives are ignored").count();
    assert_eq!(told, 1, "once for all frames: {}", run.stderr);
    assert!(work.run("info x.stl").stdout.contains("without area"));
}

#[test]
fn an_empty_scene_renders_background() {
    let work = Workplace::new();
    work.write("empty.gltf", "{\"asset\": {\"version\": \"2.0\"}}");
    work.run_quietly("render empty.gltf --size 8x6 -o x.png");
    assert_eq!(image::open(work.path("x.png")).unwrap().into_rgb8().dimensions(), (8, 6));
    assert!(work.run_quietly("info empty.gltf").stdout.contains("shows everything"));
}

#[test]
fn a_failed_render_leaves_what_was_there() {
    let work = Workplace::new();
    work.write("x.png", "old");
    assert_eq!(work.run("render nothing.obj -o x.png").code, 2);
    assert_eq!(work.read("x.png"), b"old");
}
