//! A sequence of ten thousand files takes the room of a few.

use std::fs;
use std::path::Path;
use std::sync::Arc;

use rayflock_import::{Reporter, load};
use rayflock_scene::Evaluator;

use crate::limit;

const FRAME_COUNT: usize = 10_000;
/// Bytes that the names and places of all files may take.
const NAMES: usize = 300 * FRAME_COUNT;
/// Bytes for the frames that are held.
const FRAMES: usize = 1 << 20;

/// Shows all frames of a long sequence, and checks what that took and whether all came.
pub(crate) fn assert_streams(folder: &Path) {
    let folder = folder.join("frames");
    fs::create_dir(&folder).expect("the new folder is writable");
    for frame in 0..FRAME_COUNT {
        // Neighbours differ in their numbers of triangles.
        let mut text = format!("v {frame} 0 0\nv 1 0 0\nv 0 1 0\n");
        text.push_str(&"f 1 2 3\n".repeat(frame % 100));
        fs::write(folder.join(format!("{frame}.obj")), text).expect("the new folder is writable");
    }
    let (taken, shown) = limit::taken_by(|| show_all(&folder));
    assert_eq!(shown, (0..FRAME_COUNT).map(|frame| frame % 100).sum::<usize>());
    assert!(taken <= NAMES + FRAMES, "{FRAME_COUNT} frames took {taken} bytes");
}

/// The number of triangles of all frames together.
fn show_all(folder: &Path) -> usize {
    let scene = load(folder, &mut Reporter::new()).expect("the frames are sound");
    assert_eq!(scene.frame_count, Some(FRAME_COUNT));
    let rate = scene.default_frame_rate();
    let mut evaluator = Evaluator::new(Arc::new(scene), None).expect("the frames are sound");
    let mut triangle_count = |frame: usize| {
        let frame = evaluator.evaluate(frame as f64 / rate).expect("the frame is sound");
        frame.surfaces[0].mesh.triangles().len()
    };
    (0..FRAME_COUNT).map(&mut triangle_count).sum()
}
