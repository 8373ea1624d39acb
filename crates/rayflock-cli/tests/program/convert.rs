//! `convert`: geometry of frames as files.

use serde_json::Value;

use crate::{Workplace, names_in};

fn info(work: &Workplace, words: &str) -> Value {
    serde_json::from_str(&work.run(&format!("info --json {words}")).stdout).expect("JSON")
}

#[test]
fn a_scene_becomes_a_frame_set_or_a_sequence() {
    let work = Workplace::new();
    let whole = info(&work, "builtin:museum3");
    let name = "builtin:museum3 --frames 100..102";
    work.run_quietly(&format!("convert {name} -o s.npz"));
    work.run_quietly(&format!("convert {name} -o ply/"));
    work.run_quietly(&format!("convert {name} -o obj/%02d.obj"));
    assert_eq!(names_in(&work.path("ply"))[0], "frame_0100.ply");
    assert_eq!(names_in(&work.path("obj")), ["100.obj", "101.obj", "102.obj"]);
    let set = info(&work, "s.npz");
    assert_eq!((&set["triangles"], set["frames"][1].as_u64()), (&whole["triangles"], Some(2)));
    assert_eq!(set["frame_rate"], whole["frame_rate"]);
    for sequence in ["ply", "obj"] {
        let info = info(&work, sequence);
        assert_eq!((&info["triangles"], &info["bounds"]), (&set["triangles"], &set["bounds"]));
    }
}

#[test]
fn frames_of_the_same_triangles_become_morphs() {
    let work = Workplace::new();
    let one = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    work.write("0.obj", one);
    work.write("1.obj", one.replace("v 1 0 0", "v 3 0 0"));
    work.run_quietly("convert *.obj --fps 10 -o a.glb");
    let morphs = info(&work, "a.glb");
    assert_eq!((&morphs["triangles"], &morphs["bounds"]["max"][0]), (&1.into(), &3.0.into()));

    work.write("2.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 3 2 1\n");
    let run = work.run("convert *.obj -o b.glb");
    let expected = "frame 2: found other triangles, expected those as in the first frame";
    assert!(run.code == 2 && run.stderr.contains(expected), "{}", run.stderr);
    assert!(!work.path("b.glb").exists());
}

#[test]
fn one_frame_goes_to_exactly_the_path() {
    let work = Workplace::new();
    work.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    work.run_quietly("convert a.obj -o b.obj");
    assert_eq!(work.read("b.obj"), work.read("a.obj"));
    work.run_quietly("convert a.obj --frames 0..1 --up z -o c.ply");
    assert_eq!(work.names(), ["a.obj", "b.obj", "c_0000.ply", "c_0001.ply"]);
    let depth = info(&work, "c_0001.ply")["bounds"]["min"][2].as_f64().unwrap();
    assert!((depth + 1.0).abs() < 1e-6, "y has become -z: {depth}");
}

#[test]
fn spheres_that_find_no_place_are_told_once() {
    let work = Workplace::new();
    let points = "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\n\
        property float z\nproperty float radius\nend_header\n0 0 0 1\n4 0 0 0.5\n";
    work.write("a.ply", points);
    work.run_quietly("convert a.ply -o b.ply");
    work.run_quietly("convert a.ply -o b.npz");
    for file in ["b.ply", "b.npz"] {
        assert_eq!(info(&work, file)["spheres"], 2, "{file}");
    }
    let run = work.run("convert a.ply --frames 0..2 -o out/%d.obj");
    let expected = "warning: a.ply: frame 0: 2 spheres are left out, for which .obj has no place; \
                    .npz has\n";
    assert_eq!((run.code, run.stderr.as_str()), (0, expected));
}

#[test]
fn wrong_arguments_and_outputs_are_told() {
    let work = Workplace::new();
    work.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    let fails = |words: &str, code: i32, expected: &str| {
        let run = work.run(words);
        assert_eq!(run.code, code, "{words}: {}", run.stderr);
        assert!(run.stderr.contains(expected), "{words}: {}", run.stderr);
        assert_eq!(work.names(), ["a.obj"], "{words}");
    };
    fails("convert a.obj -o x.stl", 2, "cannot tell the format of the output \"x.stl\"");
    fails("convert a.obj", 2, "--output <PATH>");
    fails("convert b.obj -o x.npz", 2, "b.obj");
    fails("convert a.obj --clip Run -o x.npz", 2, "no clip is called \"Run\"");
    fails("convert a.obj -o no/such/x.npz", 1, "cannot write no/such/x.npz");
    fails("convert a.obj -o no/such/folder/", 1, "cannot create the folder");
    fails("convert a.obj -o a.obj/x.ply", 1, "cannot write a.obj/x.ply");
}
