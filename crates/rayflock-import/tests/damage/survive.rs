//! What is asked of every file, damaged or not: an error or a scene that makes frames, soon.
//!
//! Fuzz targets ask it too.

use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

use rayflock_import::{Reporter, load};
use rayflock_scene::{Evaluator, Scene};
use zip::CompressionMethod;

use crate::samples::{OBJ, arrays, npz};

/// Longest time that a file of a few kilobytes may take.
const PATIENCE: Duration = Duration::from_secs(5);

/// Has the parser that `target` names read `bytes`, in a folder where the neighbours of the samples
/// lie.
pub(crate) fn ask(target: &str, folder: &Path, bytes: &[u8]) -> Result<usize, String> {
    match target {
        "mtl" => {
            std::fs::write(folder.join("a.mtl"), bytes).expect("the folder is writable");
            load_in(folder, "a.obj", OBJ)
        }
        // The zip file is sound, or nothing else would get past its checksums. The first byte tells
        // which of its arrays the rest is.
        "npy" => {
            let Some((array, content)) = bytes.split_first() else { return Ok(0) };
            let mut arrays = arrays();
            let chosen = usize::from(*array) % arrays.len();
            arrays[chosen].1 = content.to_vec();
            let name = arrays[chosen].0;
            // The others that it is nothing without; to read all takes twice as long.
            let company = match name {
                "centers" | "radii" => ["centers", "radii"],
                _ => ["vertices", "triangles"],
            };
            let is_read = |(other, _): &(&str, Vec<u8>)| *other == name || company.contains(other);
            let few: Vec<_> = arrays.into_iter().filter(is_read).collect();
            load_in(folder, "a.npz", &npz(&few, CompressionMethod::Stored))
        }
        "gz" => load_in(folder, "a.stl.gz", bytes),
        "pc2" | "mdd" => load_in(folder, &format!("b.{target}"), bytes),
        _ => load_in(folder, &format!("a.{target}"), bytes),
    }
}

/// Loads a file, and its frames if it has any; gives the number of objects.
pub(crate) fn load_in(folder: &Path, name: &str, bytes: &[u8]) -> Result<usize, String> {
    std::fs::write(folder.join(name), bytes).expect("the new folder is writable");
    let start = Instant::now();
    let loaded = load(&folder.join(name), &mut Reporter::new()).map_err(|error| error.to_string());
    let shown = loaded.and_then(show_frames);
    assert!(start.elapsed() < PATIENCE, "{name} took {:?}", start.elapsed());
    shown
}

/// Evaluates the first frames of a source that has frames.
pub(crate) fn show_frames(scene: Scene) -> Result<usize, String> {
    let (object_count, frame_count) = (scene.objects.len(), scene.frame_count.unwrap_or(0));
    let rate = scene.default_frame_rate();
    let error = |error: rayflock_scene::SceneError| error.to_string();
    let mut evaluator = Evaluator::new(Arc::new(scene), None).map_err(error)?;
    for frame in 0..frame_count.min(3) {
        evaluator.evaluate(frame as f64 / rate).map_err(error)?;
    }
    Ok(object_count)
}
