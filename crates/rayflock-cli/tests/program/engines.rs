//! Engines of others render, too, and say what they miss.

use rayflock_bench::peer::PeerError;
use rayflock_bench::peer::embree::EmbreeLibrary;

use crate::Workplace;

/// Renders a frame of the box with an engine or on a device, by an option and its value, and expects
/// nearly the picture of our own.
fn renders_like_ours([option, value]: [&str; 2]) {
    let work = Workplace::new();
    let render = "render builtin:cornell --frames 40 --size 48x36";
    work.run_quietly(&format!("{render} -o ours.png"));
    work.run_quietly(&format!("{render} --{option} {value} -o theirs.png --stats s.json"));
    let [ours, theirs] = ["ours.png", "theirs.png"]
        .map(|name| image::open(work.path(name)).expect("a picture").into_rgb8());
    let differs = |(a, b): &(&image::Rgb<u8>, &image::Rgb<u8>)| {
        a.0.iter().zip(b.0).any(|(&a, b)| a.abs_diff(b) > 8)
    };
    let differing = ours.pixels().zip(theirs.pixels()).filter(differs).count();
    assert!(differing < 20, "{differing} of {} pixels differ", 48 * 36);
    let stats = String::from_utf8(work.read("s.json")).expect("text");
    assert!(stats.contains(&format!("\"{option}\": \"{value}")), "{stats}");
}

#[test]
fn embree_renders_like_ours() {
    match EmbreeLibrary::load(None) {
        Ok(_) => {
            renders_like_ours(["engine", "embree"]);
            renders_like_ours(["engine", "embree:medium+instances+packets+robust"]);
        }
        Err(error @ PeerError::LibraryNotFound { .. }) => eprintln!("skipped: {error}"),
        Err(error) => panic!("{error}"),
    }
}

#[cfg(feature = "gpu")]
#[test]
fn the_graphics_card_renders_like_ours() {
    if rayflock::gpu::list_adapters().is_empty() {
        eprintln!("skipped: there is no graphics adapter");
        return;
    }
    renders_like_ours(["engine", "gpu:compute@0"]);
    renders_like_ours(["engine", "gpu:subfields@0"]);
    renders_like_ours(["device", "gpu:0"]);
    let work = Workplace::new();
    for words in ["--engine gpu:compute@99", "--device gpu:99"] {
        let run = work.run(&format!("render builtin:cornell {words} -o x.png"));
        assert_eq!(run.code, 2, "{}", run.stderr);
        assert!(run.stderr.contains("there is no graphics adapter \"99\"; there are: 0: "));
    }
    let paths = "render builtin:cornell --frames 0 --size 8x6 --spp 1 --depth 1 --integrator path";
    let run = work.run(&format!("{paths} --device gpu:0 -o x.png"));
    assert_eq!(run.code, 0, "{}", run.stderr);
    assert!(run.stderr.contains("the graphics device cannot trace paths"), "{}", run.stderr);
}

#[test]
fn an_engine_without_its_library_says_how_to_get_it() {
    let work = Workplace::new();
    work.write("text.so", "not a library");
    let before = work.names();
    for (words, expected) in [
        ("--embree-lib nothing.so", "nothing.so: found no library there"),
        ("--embree-lib nothing.so", "`cargo xtask embree` fetches it"),
        ("--embree-lib text.so", "text.so: cannot be loaded as Embree"),
    ] {
        let run = work.run(&format!("render builtin:cornell --engine embree {words} -o x.png"));
        assert_eq!(run.code, 2, "{}", run.stderr);
        assert!(run.stderr.contains(expected), "{}", run.stderr);
        assert_eq!(work.names(), before);
    }
}

#[test]
fn wrong_settings_are_told_which_there_are() {
    let work = Workplace::new();
    for (engine, expected) in [
        ("embree:fast", "expected words joined by +: low, medium or refit"),
        ("embree:low+medium", "both \"low\" and \"medium\""),
        ("embree:best", "only benchmarks do"),
        ("embre", "subfields:SETTING, embree, embree:SETTING"),
        ("subfields:egaer", "on-demand, eager, locked"),
    ] {
        let run = work.run(&format!("render builtin:cornell --engine {engine} -o x.png"));
        assert_eq!(run.code, 2, "{}", run.stderr);
        assert!(run.stderr.contains(expected), "{engine}: {}", run.stderr);
    }
}
