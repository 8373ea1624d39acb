//! What each frame cost, and the file that `--stats` writes.
//!
//! Fields are added later, never renamed.

mod device;

use std::fs;
use std::path::Path;

use anyhow::Result;
use rayflock::render::{StageStats, TraceStages};
use serde::{Deserialize, Serialize};

pub(crate) use self::device::DeviceRecord;
use crate::output::atomic;
use crate::size::Size;

/// What one frame cost. Times are wall-clock milliseconds.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct FrameRecord {
    /// The frame.
    pub(crate) frame: u32,
    /// Its time in the scene, in seconds.
    pub(crate) time: f64,
    /// Primitives in the frame, ignored ones included.
    pub(crate) triangles: u64,
    /// Moving the scene to its place: skins, morph targets, keys.
    pub(crate) evaluate_ms: f64,
    /// Making the geometry the engine's current frame.
    pub(crate) update_ms: f64,
    /// Tracing rays.
    pub(crate) trace_ms: f64,
    /// Everything else the renderer does.
    pub(crate) shade_ms: f64,
    /// Leaving virtual lights; a part of what tracing and the rest took.
    #[serde(default)]
    pub(crate) shoot_ms: f64,
    /// Gathering their light; likewise a part.
    #[serde(default)]
    pub(crate) gather_ms: f64,
    /// Bringing spheres to where the geometry is; likewise a part.
    #[serde(default)]
    pub(crate) fit_ms: f64,
    /// Spheres that stand for the geometry.
    #[serde(default)]
    pub(crate) spheres: u64,
    /// Photons of light that mirrors and glass throw.
    #[serde(default)]
    pub(crate) photons: u64,
    /// Leaving and gathering them; likewise a part.
    #[serde(default)]
    pub(crate) caustics_ms: f64,
    /// From the first step to the finished film, files not included.
    pub(crate) total_ms: f64,
    /// Virtual lights.
    #[serde(default)]
    pub(crate) vpls: u64,
    /// The share of the light of virtual lights that the bound kept away.
    #[serde(default)]
    pub(crate) clamped: f64,
    /// How far the picture is from one with exact visibility, if that was asked for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) error: Option<ErrorRecord>,
    /// Rays by kind.
    pub(crate) rays: RayRecord,
    /// Of the rays from the camera, those that scan conversion on a graphics card stood for.
    #[serde(default)]
    pub(crate) scanned: u64,
    /// What tracing took, by stage.
    #[serde(default)]
    pub(crate) stages: StageRecords,
    /// Cone tests.
    pub(crate) cone_tests: u64,
    /// Box tests.
    #[serde(default)]
    pub(crate) box_tests: u64,
    /// Ray-triangle tests.
    pub(crate) triangle_tests: u64,
    /// Ray-sphere tests.
    pub(crate) sphere_tests: u64,
    /// Tiles of subfields visited.
    #[serde(default)]
    pub(crate) tiles: u64,
    /// Candidates that the engine wrote down.
    #[serde(default)]
    pub(crate) pairs: u64,
    /// Bytes that tests read and stages wrote while tracing.
    #[serde(default)]
    pub(crate) bytes: u64,
    /// Allocations on the heap from the update to the finished film; absent in journals of
    /// versions that did not count them.
    #[serde(default)]
    pub(crate) allocations: Option<u64>,
    /// Primitives ignored because they have no area or are not finite.
    pub(crate) ignored: u64,
    /// Bytes that the engine holds, without the meshes.
    pub(crate) memory_bytes: u64,
    /// What stages on a graphics device took; absent where none was at work.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) device: Option<DeviceRecord>,
}

/// How far a picture is from one with exact visibility of the same virtual lights.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct ErrorRecord {
    /// Mean FLIP of the pictures as they are shown, from 0 to 1.
    pub(crate) mean_flip: f64,
    /// Root mean squared error of the radiance over its root mean square.
    pub(crate) relative_rmse: f64,
}

/// What tracing the rays of one frame took, by stage.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct StageRecords {
    /// Rays from the camera.
    pub(crate) primary: StageRecord,
    /// Mirrored and refracted rays.
    pub(crate) secondary: StageRecord,
    /// Rays towards lights.
    pub(crate) shadow: StageRecord,
    /// Walks from lights, and rays towards virtual ones.
    pub(crate) indirect: StageRecord,
}

/// What tracing the rays of one stage took.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct StageRecord {
    /// Rays.
    pub(crate) rays: u64,
    /// Milliseconds in the engine.
    pub(crate) trace_ms: f64,
    /// Cone tests.
    pub(crate) cone_tests: u64,
    /// Box tests.
    pub(crate) box_tests: u64,
    /// Ray-triangle tests.
    pub(crate) triangle_tests: u64,
    /// Ray-sphere tests.
    pub(crate) sphere_tests: u64,
    /// Candidates that the engine wrote down.
    pub(crate) pairs: u64,
}

impl StageRecord {
    fn new(stats: &StageStats) -> Self {
        Self {
            rays: stats.trace.rays,
            trace_ms: 1e3 * stats.seconds,
            cone_tests: stats.trace.cone_tests,
            box_tests: stats.trace.box_tests,
            triangle_tests: stats.trace.triangle_tests,
            sphere_tests: stats.trace.sphere_tests,
            pairs: stats.trace.pairs,
        }
    }
}

impl StageRecords {
    /// What the renderer counted.
    pub(crate) fn new(stages: &TraceStages) -> Self {
        Self {
            primary: StageRecord::new(&stages.primary),
            secondary: StageRecord::new(&stages.secondary),
            shadow: StageRecord::new(&stages.shadow),
            indirect: StageRecord::new(&stages.indirect),
        }
    }
}

/// Rays of one frame by kind.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct RayRecord {
    /// From the camera.
    pub(crate) primary: u64,
    /// Towards lights.
    pub(crate) shadow: u64,
    /// Mirrored.
    pub(crate) mirror: u64,
    /// Refracted.
    pub(crate) refraction: u64,
    /// Turned by chance, and walks from lights.
    #[serde(default)]
    pub(crate) indirect: u64,
}

/// A whole render.
#[derive(Debug, Serialize)]
pub(crate) struct Stats {
    /// Version of the program.
    pub(crate) version: &'static str,
    /// INPUT as given.
    pub(crate) input: String,
    /// The engine.
    pub(crate) engine: String,
    /// What rendered whole frames; on a graphics device no engine is asked.
    pub(crate) device: String,
    /// Threads worked with.
    pub(crate) threads: usize,
    /// The instruction set of the kernels.
    pub(crate) simd: &'static str,
    /// Width and height in pixels.
    pub(crate) size: Size,
    /// Samples a pixel.
    pub(crate) samples_per_pixel: u32,
    /// How often a ray may be mirrored or refracted.
    pub(crate) depth: u32,
    /// The most primitives in any frame.
    pub(crate) triangles: u64,
    /// What each frame cost, in order.
    pub(crate) frames: Vec<FrameRecord>,
}

impl Stats {
    /// Writes the statistics as one JSON object.
    pub(crate) fn write(&self, path: &Path) -> Result<()> {
        let json = serde_json::to_string_pretty(self)?;
        atomic::write_whole(path, |partial| Ok(fs::write(partial, json + "\n")?))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_journal_line_of_an_earlier_version_is_still_read() {
        let line = r#"{"frame":3,"time":0.125,"triangles":12,"evaluate_ms":0.1,"update_ms":0.2,
            "trace_ms":0.3,"shade_ms":0.4,"total_ms":1.0,
            "rays":{"primary":4,"shadow":3,"mirror":2,"refraction":1},
            "cone_tests":64,"triangle_tests":32,"sphere_tests":0,"ignored":0,"memory_bytes":99}"#;
        let record: FrameRecord = serde_json::from_str(line).unwrap();
        assert_eq!((record.frame, record.triangle_tests), (3, 32));
        assert_eq!((record.box_tests, record.pairs, record.bytes), (0, 0, 0));
        assert_eq!((record.allocations, record.device), (None, None));
    }
}
