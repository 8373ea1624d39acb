//! What was measured, as it is kept.
//!
//! In JSON one object; fields are added later, never renamed. Times are wall-clock milliseconds.

use rayflock::geom::simd::SimdLevel;
use serde::Serialize;

/// Everything measured in one run of a benchmark.
#[derive(Clone, Debug, Serialize)]
pub struct Record {
    /// Version of this crate.
    pub version: &'static str,
    /// What it ran on.
    pub machine: Machine,
    /// Times each frame was measured.
    pub run_count: usize,
    /// One entry an engine, in the order they were asked for.
    pub cells: Vec<Cell>,
}

/// What a benchmark ran on.
#[derive(Clone, Debug, Serialize)]
pub struct Machine {
    /// Operating system.
    pub os: &'static str,
    /// Architecture of the processor.
    pub arch: &'static str,
    /// The instruction set of the kernels.
    pub simd: &'static str,
}

/// What one engine needed for one scene.
#[derive(Clone, Debug, Serialize)]
pub struct Cell {
    /// The scene, as it was asked for.
    pub scene: String,
    /// The engine.
    pub engine: &'static str,
    /// Threads worked with.
    pub threads: usize,
    /// Width and height in pixels.
    pub size: [usize; 2],
    /// The most primitives in any frame.
    pub triangles: usize,
    /// Rays a frame, mean over the frames.
    pub rays: f64,
    /// The same by kind.
    pub rays_by_kind: RaysByKind,
    /// Making a frame's geometry the current one; mean over the frames of their medians.
    pub commit_ms: f64,
    /// Tracing a frame's rays; mean over the frames of their medians.
    pub trace_ms: f64,
    /// Both together; mean over the frames of their medians.
    pub total_ms: f64,
    /// [`total_ms`](Self::total_ms) divided by that of the first engine.
    pub ratio: f64,
    /// Distance of the outer quartiles of a frame's total, as a share of its median; the median
    /// over the frames.
    pub spread: f64,
    /// Ray-triangle tests a ray, over all frames.
    pub triangle_tests_per_ray: f64,
    /// Sphere-cone tests a ray, over all frames.
    pub cone_tests_per_ray: f64,
    /// Pixels that differ in any bit from the film of the first engine, over all frames and runs.
    pub differing_pixels: u64,
    /// One entry a frame.
    pub phases: Vec<Phase>,
}

/// What one engine needed for one frame. Times are medians over the runs.
#[derive(Clone, Debug, Serialize)]
pub struct Phase {
    /// The frame, counted from 0.
    pub frame: u32,
    /// Primitives in the frame.
    pub triangles: usize,
    /// Rays.
    pub rays: u64,
    /// The same by kind.
    pub rays_by_kind: RaysByKind,
    /// Making the geometry the current one.
    pub commit_ms: f64,
    /// Tracing the rays.
    pub trace_ms: f64,
    /// Both together: the median of the sums.
    pub total_ms: f64,
    /// The lower and the upper quartile of both together.
    pub total_quartiles_ms: [f64; 2],
    /// [`total_ms`](Self::total_ms) divided by that of the first engine.
    pub ratio: f64,
    /// Ray-triangle tests.
    pub triangle_tests: u64,
    /// Sphere-cone tests.
    pub cone_tests: u64,
    /// Bytes held by engine and renderer, without the scene.
    pub memory_bytes: usize,
    /// Pixels that differ in any bit from the film of the first engine, over all runs.
    pub differing_pixels: u64,
}

/// Rays of a frame by kind; means where it stands for several frames.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct RaysByKind {
    /// From the camera.
    pub primary: f64,
    /// Between surfaces and lights.
    pub shadow: f64,
    /// Mirrored.
    pub mirror: f64,
    /// Refracted.
    pub refraction: f64,
}

impl Record {
    /// Whether all engines rendered the same films to the bit.
    pub fn same_films(&self) -> bool {
        self.cells.iter().all(|cell| cell.differing_pixels == 0)
    }
}

impl Machine {
    /// This machine.
    pub fn here() -> Self {
        let (os, arch) = (std::env::consts::OS, std::env::consts::ARCH);
        Self { os, arch, simd: SimdLevel::best().name() }
    }
}
