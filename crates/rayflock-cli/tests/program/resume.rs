//! A render that was stopped and goes on gives the same bytes as one that was not.

use std::path::Path;
use std::process::{Child, Stdio};
use std::thread;

use crate::{Run, Workplace, names_in};

const RENDER: &str = "render builtin:cornell --size 40x30 --spp 2";

/// A render that takes long enough to be stopped in the middle.
const LONG: &str = "render builtin:cornell --size 64x48 --spp 4 --frames 0..39";

#[test]
fn finished_frames_are_taken_over() {
    let work = Workplace::new();
    work.run_quietly(&format!("{RENDER} --frames 0..3 -o whole/"));
    work.run_quietly(&format!("{RENDER} --frames 0..1 -o parts/"));
    // A frame that is taken over keeps its bytes, whatever they are.
    work.write("parts/frame_0000.png", "taken over");
    work.run_quietly(&format!("{RENDER} --frames 0..3 --stats s.json --resume -o parts/"));
    assert_eq!(work.read("parts/frame_0000.png"), b"taken over");
    assert_eq!(names_in(&work.path("whole")), names_in(&work.path("parts")));
    for frame in ["frame_0001.png", "frame_0002.png", "frame_0003.png"] {
        let of = |folder: &str| work.read(&format!("{folder}/{frame}"));
        assert_eq!(of("whole"), of("parts"), "{frame}");
    }
    let stats: serde_json::Value = serde_json::from_slice(&work.read("s.json")).unwrap();
    assert_eq!(stats["frames"].as_array().unwrap().len(), 4, "stats cover all frames");
}

#[test]
fn frames_that_are_gone_or_not_in_the_journal_are_rendered() {
    let work = Workplace::new();
    work.run_quietly(&format!("{RENDER} --frames 0..2 -o whole/"));
    work.run_quietly(&format!("{RENDER} --frames 0..2 -o parts/"));
    std::fs::remove_file(work.path("parts/frame_0000.png")).unwrap();
    work.write("parts/frame_0002.png", "of another render");
    let journal = String::from_utf8(work.read("parts/.frame_%04d.png.rayflock")).unwrap();
    // The last line is torn, as by a full disk.
    work.write("parts/.frame_%04d.png.rayflock", &journal[..journal.len() - 20]);
    work.run_quietly(&format!("{RENDER} --frames 0..2 --resume -o parts/"));
    for frame in ["frame_0000.png", "frame_0001.png", "frame_0002.png"] {
        let of = |folder: &str| work.read(&format!("{folder}/{frame}"));
        assert_eq!(of("whole"), of("parts"), "{frame}");
    }
}

#[test]
fn different_settings_are_not_mixed() {
    let work = Workplace::new();
    work.run_quietly("render builtin:cornell --size 8x6 --frames 0..1 -o x/");
    let run = work.run("render builtin:cornell --size 9x6 --frames 0..2 --resume -o x/");
    assert_eq!(run.code, 2);
    for part in ["cannot resume", "--size \"8x6\"", "\"9x6\""] {
        assert!(run.stderr.contains(part), "{}", run.stderr);
    }
    // Without --resume it starts anew.
    work.run_quietly("render builtin:cornell --size 9x6 --frames 0..1 -o x/");
}

#[test]
fn a_changed_input_is_not_mixed_with_what_it_was() {
    let work = Workplace::new();
    let empty = "{\"asset\": {\"version\": \"2.0\"}}";
    work.write("x.gltf", empty);
    work.run_quietly("render x.gltf --size 8x6 --frames 0..1 -o x/");
    work.write("x.gltf", format!("{empty}\n"));
    let run = work.run("render x.gltf --size 8x6 --frames 0..2 --resume -o x/");
    assert!(run.code == 2 && run.stderr.contains("content"), "{}", run.stderr);
}

#[test]
fn resuming_nothing_starts_at_the_first_frame() {
    let work = Workplace::new();
    work.run_quietly("render builtin:cornell --size 8x6 --frames 0..1 --resume -o x.gif");
    work.run_quietly("render builtin:cornell --size 8x6 --resume -o x.png");
    assert_eq!(work.names(), ["x.gif", "x.png"]);
}

#[test]
fn a_killed_film_is_finished_byte_by_byte_the_same() {
    let work = Workplace::new();
    work.run_quietly(&format!("{LONG} -o whole.gif"));
    let mut child = start(&work, &format!("{LONG} -o parts.gif"));
    wait_for(&mut child, &work.path(".parts.gif.frames/frame_0003.png"));
    child.kill().unwrap();
    child.wait().unwrap();
    assert!(!work.path("parts.gif").exists(), "the film appears when it is whole");

    work.run_quietly(&format!("{LONG} --resume -o parts.gif"));
    assert_eq!(work.read("whole.gif"), work.read("parts.gif"));
    assert_eq!(work.names(), ["parts.gif", "whole.gif"]);
}

#[cfg(unix)]
#[test]
fn ctrl_c_ends_cleanly_and_says_how_to_go_on() {
    let work = Workplace::new();
    work.run_quietly(&format!("{LONG} -o whole/"));
    let mut child = start(&work, &format!("{LONG} -o parts/"));
    wait_for(&mut child, &work.path("parts/frame_0003.png"));
    let signal =
        std::process::Command::new("kill").args(["-INT", &child.id().to_string()]).status();
    assert!(signal.unwrap().success());
    let run = Run::from(child.wait_with_output().unwrap());
    assert_eq!(run.code, 130, "{}", run.stderr);
    assert!(
        run.stderr.contains("of 40 frames") && run.stderr.contains("--resume"),
        "{}",
        run.stderr
    );
    let names = names_in(&work.path("parts"));
    assert!(names.iter().all(|name| !name.ends_with(".partial")), "{names:?}");

    work.run_quietly(&format!("{LONG} --resume -o parts/"));
    assert_eq!(names_in(&work.path("whole")), names_in(&work.path("parts")));
    assert_eq!(work.read("whole/frame_0039.png"), work.read("parts/frame_0039.png"));
}

fn start(work: &Workplace, words: &str) -> Child {
    work.command(words).stderr(Stdio::piped()).spawn().expect("the program starts")
}

/// Waits until `path` exists, or fails when the program ends first.
fn wait_for(child: &mut Child, path: &Path) {
    while !path.exists() {
        let ended = child.try_wait().expect("the program can be asked");
        assert!(ended.is_none(), "ended before {}", path.display());
        thread::yield_now();
    }
}
