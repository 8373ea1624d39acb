//! Folders, patterns and first files: a mesh a frame.

use serde_json::Value;

use crate::Workplace;

/// A triangle with a corner at `x`, `copies` times.
fn obj(x: usize, copies: usize) -> String {
    format!("v 0 0 0\nv {x} 0 0\nv 0 1 0\n{}", "f 1 2 3\n".repeat(copies))
}

/// A folder `s` with frames of these numbers.
fn with_frames(numbers: &[usize]) -> Workplace {
    let work = Workplace::new();
    std::fs::create_dir(work.path("s")).expect("the folder is writable");
    for &number in numbers {
        work.write(&format!("s/a_{number:02}.obj"), obj(number, number));
    }
    work
}

fn frames(work: &Workplace, words: &str) -> Value {
    let json = work.run(&format!("info --json {words}")).stdout;
    serde_json::from_str::<Value>(&json).expect("info prints JSON")["frames"].clone()
}

#[test]
fn a_sequence_is_a_folder_a_pattern_or_its_first_file() {
    let work = with_frames(&[1, 2, 3]);
    for input in ["s", "s/", "s/a_*.obj", "s/*"] {
        let text = work.run_quietly(&format!("info {input}")).stdout;
        assert!(text.contains("0..2 at 24 a second and no more"), "{input}: {text}");
        assert!(text.contains("1 changing topology"), "{input}: {text}");
    }
    let first = work.run("info s/a_01.obj").stdout;
    assert!(first.contains("0..2 at 24") && first.contains("the first of 3 numbered files"));
    let other = work.run_quietly("info s/a_02.obj").stdout;
    assert!(other.contains("shows everything"), "{other}");
}

#[test]
fn each_file_is_a_picture_and_gaps_are_told() {
    let work = with_frames(&[1, 2, 4]);
    let run = work.run("render s --size 12x8 --fps 50 --stats t.json -o out/");
    assert_eq!(
        (run.code, run.stderr.trim_end()),
        (0, "warning: s: numbers: 3 is missing; frames follow each other without them",)
    );
    let stats: Value = serde_json::from_slice(&work.read("t.json")).unwrap();
    let triangles: Vec<_> =
        stats["frames"].as_array().unwrap().iter().map(|frame| &frame["triangles"]).collect();
    assert_eq!(triangles, [1, 2, 4]);
    assert!(work.read("out/frame_0000.png") != work.read("out/frame_0002.png"));
    let run = work.run("render s --frames 1..3 --size 12x8 -o x.png");
    assert_eq!(run.code, 2);
    assert!(run.stderr.contains("asks for 1..3, but there are the frames 0..2"), "{}", run.stderr);
}

#[test]
fn interpolation_makes_pictures_between_files() {
    let work = Workplace::new();
    std::fs::create_dir(work.path("s")).expect("the folder is writable");
    work.write("s/1.obj", obj(1, 1));
    work.write("s/2.obj", obj(3, 1));
    assert_eq!(frames(&work, "s"), serde_json::json!([0, 1]));
    work.run_quietly("convert s --interpolate --fps 48 -o out/%d.obj");
    assert_eq!(crate::names_in(&work.path("out")), ["0.obj", "1.obj", "2.obj"]);
    let between = String::from_utf8(work.read("out/1.obj")).unwrap();
    assert_eq!(between.lines().nth(1), Some("v 2 0 0"), "{between}");
    work.run_quietly("convert s --fps 48 -o held/");
    assert_eq!(crate::names_in(&work.path("held")).len(), 2, "one a file");
}

#[test]
fn a_damaged_file_is_an_error_of_its_frame() {
    let work = with_frames(&[1, 2, 3]);
    work.write("s/a_02.obj", "v 1 2\n");
    // The camera is framed over all frames, so damage is found before the first picture.
    let run = work.run("render s --size 12x8 -o out/");
    assert_eq!(run.code, 2);
    let expected = "a_02.obj: line 1: found \"v 1 2\", expected 3 coordinates";
    assert!(run.stderr.contains(expected), "{}", run.stderr);
    let run = work.run("convert s -o out/");
    assert_eq!(run.code, 2);
    assert!(run.stderr.contains("s: frame 1: ") && run.stderr.contains(expected), "{}", run.stderr);
    assert_eq!(crate::names_in(&work.path("out")), ["frame_0000.ply"]);
}

#[test]
fn resuming_notices_a_frame_that_has_changed() {
    let work = with_frames(&[1, 2]);
    work.run_quietly("render s --size 12x8 -o out/");
    work.run_quietly("render s --size 12x8 -o out/ --resume");
    work.write("s/a_02.obj", obj(2, 7));
    let run = work.run("render s --size 12x8 -o out/ --resume");
    assert_eq!(run.code, 2);
    assert!(run.stderr.contains("INPUT's content"), "{}", run.stderr);
}

#[test]
fn folders_and_patterns_without_frames_say_what_is_there() {
    let work = with_frames(&[1]);
    work.write("s/b.ply", "");
    let message = |words: &str| {
        let run = work.run(words);
        assert_eq!(run.code, 2, "{words}");
        run.stderr
    };
    let mixed = message("info s");
    assert!(mixed.contains("s: folder: found 1 .obj and 1 .ply files, expected files of one"));
    assert!(message("info s/*.stl").contains("s/*.stl: pattern: found no files, expected"));
    std::fs::create_dir(work.path("empty")).unwrap();
    assert!(message("render empty -o x.png").contains("empty: folder: found no files, expected"));
}
