//! Every engine gives the same picture, in every bit, of whole scenes that move: shadows, mirrors
//! and all that follows from a hit included.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use rayflock::import::Reporter;
use rayflock::prelude::*;
use rayflock::scene::{builtin, frame_bounds};

const SIZE: (usize, usize) = (64, 48);

/// The films of a scene at several times, rendered by one engine that sees all frames in turn.
fn films(scene: &Arc<Scene>, times: &[f64], kind: EngineKind) -> Vec<Film> {
    let mut evaluator = Evaluator::new(Arc::clone(scene), None).expect("the scene is sound");
    let mut renderer = WhittedRenderer::new(rayflock::engine::create(kind));
    let bounds = evaluator.bounds_over_clip().expect("the scene is sound");
    let render = |&time: &f64| {
        let frame = evaluator.evaluate(time).expect("the scene is sound");
        let (world_from_camera, projection) = match scene.cameras.first() {
            Some(camera) => (frame.cameras[0], camera.projection),
            None => frame_bounds(&bounds, SIZE.0 as f32 / SIZE.1 as f32),
        };
        renderer.commit(scene, frame).expect("engines take any scene");
        let mut film = Film::new(SIZE.0, SIZE.1);
        let view = View::new(world_from_camera, projection);
        renderer.render(&view, &RenderSettings::default(), &mut film);
        film
    };
    times.iter().map(render).collect()
}

fn assert_same_pictures(scene: Scene, times: &[f64]) {
    let scene = Arc::new(scene);
    let bits = |films: Vec<Film>| -> Vec<_> {
        films.iter().flat_map(|film| film.pixels().iter().map(|p| p.map(f32::to_bits))).collect()
    };
    let expected = bits(films(&scene, times, EngineKind::Brute));
    assert!(expected.iter().any(|pixel| *pixel != expected[0]), "{} is empty", scene.name);
    for kind in EngineKind::ALL {
        let found = bits(films(&scene, times, kind));
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
    assert_same_pictures(scene, &[1.2, 2.4, 3.5, 4.6]);
}

#[test]
fn engines_agree_on_every_pixel_of_crowd() {
    let scene = builtin::build("crowd").expect("it is built in");
    assert_same_pictures(scene, &[0.0, 1.3]);
}

#[test]
fn engines_agree_on_every_pixel_of_the_fox() {
    let Some(path) = real_scene("fox/Fox.glb") else { return };
    let scene = rayflock::import::load(&path, &mut Reporter::new()).expect("it is sound");
    assert_same_pictures(scene, &[0.0, 0.4, 0.8]);
}
