//! Tests on tiny files.

mod files;
mod looks;
mod motion;
mod shapes;

use rayflock_scene::Scene;

use crate::tests::load_bytes;

/// The scene of a file without warnings.
fn load(text: &str) -> Scene {
    let (scene, warnings) = load_with_warnings(text);
    assert!(warnings.is_empty(), "{warnings:?}");
    scene
}

fn load_with_warnings(text: &str) -> (Scene, Vec<String>) {
    load_bytes("a.aff", text.as_bytes()).unwrap_or_else(|error| panic!("{error}"))
}

/// What is wrong with a file, without its name.
fn message(text: &str) -> String {
    let error = load_bytes("a.aff", text.as_bytes()).unwrap_err().to_string();
    error.split_once("a.aff: ").map_or(error.clone(), |(_, message)| message.to_owned())
}
