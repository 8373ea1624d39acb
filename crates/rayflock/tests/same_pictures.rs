//! Every engine gives the same picture, in every bit, of whole scenes that move: shadows, mirrors
//! and all that follows from a hit included.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use rayflock::import::Reporter;
use rayflock::prelude::*;
use rayflock::scene::{builtin, frame_bounds};

type Size = (usize, usize);

const SIZE: Size = (64, 48);
/// For scenes where many rays meet many primitives, of which `brute` tests each with all.
const SMALL: Size = (32, 24);

/// The films of a scene at several times, rendered by one engine that sees all frames in turn.
fn films(scene: &Arc<Scene>, times: &[f64], size: Size, kind: EngineKind) -> Vec<Film> {
    let mut evaluator = Evaluator::new(Arc::clone(scene), None).expect("the scene is sound");
    let mut renderer = WhittedRenderer::new(rayflock::engine::create(kind));
    let bounds = evaluator.bounds_over_clip().expect("the scene is sound");
    let render = |&time: &f64| {
        let frame = evaluator.evaluate(time).expect("the scene is sound");
        let (world_from_camera, projection) = match scene.cameras.first() {
            Some(camera) => (frame.cameras[0], camera.projection),
            None => frame_bounds(&bounds, size.0 as f32 / size.1 as f32),
        };
        renderer.commit(scene, frame).expect("engines take any scene");
        let mut film = Film::new(size.0, size.1);
        let view = View::new(world_from_camera, projection);
        renderer.render(&view, &RenderSettings::default(), &mut film);
        film
    };
    times.iter().map(render).collect()
}

fn assert_same_pictures(scene: Scene, times: &[f64], size: Size) {
    let scene = Arc::new(scene);
    let bits = |films: Vec<Film>| -> Vec<_> {
        films.iter().flat_map(|film| film.pixels().iter().map(|p| p.map(f32::to_bits))).collect()
    };
    let expected = bits(films(&scene, times, size, EngineKind::Brute));
    assert!(expected.iter().any(|pixel| *pixel != expected[0]), "{} is empty", scene.name);
    for kind in EngineKind::ALL.into_iter().filter(|kind| *kind != EngineKind::Brute) {
        let found = bits(films(&scene, times, size, kind));
        let differing = found.iter().zip(&expected).filter(|(found, expected)| found != expected);
        assert_eq!(differing.count(), 0, "pixels of {} by {kind} differ", scene.name);
    }
}

/// A file among the real scenes, or a word on why the test is skipped.
fn real_scene(name: &str) -> Option<PathBuf> {
    let beside = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data");
    let folder = std::env::var_os("RAYFLOCK_DATA").map_or(beside, PathBuf::from);
    let path = folder.join(name);
    if path.exists() {
        return Some(path);
    }
    println!("skipped: {} is not there; RAYFLOCK_DATA says where real scenes are", path.display());
    None
}

#[test]
fn engines_agree_on_every_pixel_of_museum5() {
    let scene = builtin::build("museum5").expect("it is built in");
    assert_same_pictures(scene, &[1.2, 2.4, 3.5, 4.6], SIZE);
}

#[test]
fn engines_agree_on_every_pixel_of_crowd() {
    let scene = builtin::build("crowd").expect("it is built in");
    assert_same_pictures(scene, &[0.0, 1.3], SIZE);
}

#[test]
fn engines_agree_on_every_pixel_of_fluid_and_particles() {
    for name in ["fluid", "particles"] {
        let scene = builtin::build(name).expect("it is built in");
        assert_same_pictures(scene, &[3.0, 3.0 + 1.0 / 24.0], SMALL);
    }
}

/// Compares pictures of some frames of a real scene, if it is there.
fn assert_same_frames(name: &str, frames: &[u32]) {
    let Some(path) = real_scene(name) else { return };
    let scene = rayflock::import::load(&path, &mut Reporter::new()).expect("it is sound");
    let rate = scene.default_frame_rate();
    let times: Vec<f64> = frames.iter().map(|&frame| f64::from(frame) / rate).collect();
    assert_same_pictures(scene, &times, SIZE);
}

#[test]
fn engines_agree_on_every_pixel_of_the_fox() {
    assert_same_frames("fox/Fox.glb", &[0, 10, 20]);
}

#[test]
fn engines_agree_on_every_pixel_of_bart_s_robots_and_kitchen() {
    assert_same_frames("bart/robot/Robot.aff", &[400]);
    assert_same_frames("bart/kitchen/kitchen.aff", &[100]);
}

#[test]
fn engines_agree_on_every_pixel_of_sequences_that_change_topology() {
    // Of the grid, 1, 2 and 237 are empty.
    assert_same_frames("hypergrid/frames", &[1, 2, 3, 236, 237]);
    assert_same_frames("ct-cranium/derived_isosweep", &[0, 5, 6, 12]);
}
