//! `demo`, `info`, `--help` and `--version`.

use serde_json::Value;

use crate::Workplace;

#[test]
fn the_demo_moves_and_says_what_is_next() {
    let work = Workplace::new();
    let run = work.run("demo");
    assert_eq!(run.code, 0, "{}", run.stderr);
    assert_eq!(work.names(), ["rayflock-demo.gif"]);
    assert!(run.stdout.contains("rayflock render"), "{}", run.stdout);
    let bytes = work.read("rayflock-demo.gif");
    let mut decoder = gif::DecodeOptions::new().read_info(&bytes[..]).unwrap();
    let mut frames = Vec::new();
    while let Some(frame) = decoder.read_next_frame().unwrap() {
        frames.push(frame.buffer.to_vec());
    }
    assert!(frames.len() >= 24 && frames[0] != frames[12]);
}

#[test]
fn info_tells_people_and_programs_the_same() {
    let work = Workplace::new();
    let text = work.run_quietly("info builtin:museum3").stdout;
    for part in ["objects", "triangles", "frames", "bounds", "cameras", "lights", "motion"] {
        assert!(text.contains(part), "{part} is not in {text}");
    }
    let json = work.run_quietly("info builtin:museum3 --json").stdout;
    let report: Value = serde_json::from_str(&json).unwrap();
    assert!(report["frames"][1].as_u64().unwrap() >= 239);
    assert!(text.contains(&report["triangles"].to_string()));
    let kinds = report["objects"].as_array().unwrap().iter().map(|object| &object["motion"]);
    assert!(kinds.into_iter().any(|kind| kind == "static"));
}

#[test]
fn graphics_adapters_are_listed_where_the_program_can_use_them() {
    let work = Workplace::new();
    if cfg!(feature = "gpu") {
        let devices = work.run_quietly("info --devices --json").stdout;
        let devices: Value = serde_json::from_str(&devices).unwrap();
        let numbers = devices.as_array().unwrap().iter().map(|device| &device["number"]);
        assert!(numbers.enumerate().all(|(idx, number)| *number == idx));
    } else {
        let run = work.run("info --devices");
        assert_eq!(run.code, 2);
        assert!(run.stderr.contains("build one that can with --features gpu"), "{}", run.stderr);
    }
    for wrong in ["info", "info builtin:cornell --devices"] {
        let run = work.run(wrong);
        assert_eq!(run.code, 2, "{wrong}");
        assert!(run.stderr.contains("--devices"), "{wrong}: {}", run.stderr);
    }
}

#[test]
fn help_and_version_go_to_standard_output() {
    let work = Workplace::new();
    assert!(work.run_quietly("--version").stdout.starts_with("rayflock "));
    let help = work.run_quietly("help render").stdout;
    for part in ["Examples:", "--resume", "[default: 640x360]", "Exit codes"] {
        assert!(help.contains(part), "{part}");
    }
    assert_eq!(work.run("").code, 2, "no command is a wrong command line");
    assert_eq!(work.run("dance").code, 2);
}

#[test]
fn an_input_can_be_turned_upright() {
    let work = Workplace::new();
    work.write("flat.obj", "v 0 0 0\nv 4 0 0\nv 0 2 1\nf 1 2 3\n");
    let height = |options: &str| {
        let run = work.run(&format!("info flat.obj --json {options}"));
        let info: Value = serde_json::from_str(&run.stdout).unwrap();
        info["bounds"]["max"][1].as_f64().unwrap()
    };
    assert_eq!((height(""), height("--up y"), height("--up z")), (2.0, 2.0, 1.0));
    assert_eq!(work.run("info flat.obj --up w").code, 2);
}
