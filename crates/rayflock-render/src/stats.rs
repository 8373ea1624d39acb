//! What a frame took.

use rayflock_engine::TraceStats;

use crate::lightcuts::CutStats;
use crate::vpl::VisibilityStats;

/// Rays by what they were traced for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RayCounts {
    /// From the camera.
    pub primary: u64,
    /// Between surfaces and lights.
    pub shadow: u64,
    /// Mirrored.
    pub mirror: u64,
    /// Refracted.
    pub refraction: u64,
    /// Turned by chance, and walks from lights.
    pub indirect: u64,
}

impl RayCounts {
    /// Rays of all kinds.
    pub const fn total(&self) -> u64 {
        self.primary + self.shadow + self.mirror + self.refraction + self.indirect
    }
}

/// What tracing the rays of one stage took.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StageStats {
    /// What the engine counted.
    pub trace: TraceStats,
    /// Time spent in the engine, in seconds; 0 where there is no clock.
    pub seconds: f64,
}

impl std::ops::AddAssign for StageStats {
    fn add_assign(&mut self, other: Self) {
        self.trace += other.trace;
        self.seconds += other.seconds;
    }
}

/// What tracing took, by stage.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TraceStages {
    /// Rays from the camera.
    pub primary: StageStats,
    /// Mirrored and refracted rays, which share waves.
    pub secondary: StageStats,
    /// Rays between surfaces and lights.
    pub shadow: StageStats,
    /// Walks from lights, and rays between surfaces and virtual lights.
    pub indirect: StageStats,
}

/// A stage of [`TraceStages`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Stage {
    Primary,
    Secondary,
    Shadow,
    Indirect,
}

/// What rendering a frame took.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FrameStats {
    /// What the engine counted.
    pub trace: TraceStats,
    /// The same, and the time, by stage.
    pub stages: TraceStages,
    /// Rays by kind.
    pub rays: RayCounts,
    /// Of the rays from the camera, those that were not traced, since scan conversion found what
    /// they hit.
    pub scanned: u64,
    /// Light from virtual lights.
    pub indirect: IndirectStats,
    /// Light thrown by mirrors and glass.
    pub caustics: CausticStats,
    /// Time spent in the engine, in seconds; 0 where there is no clock (WebAssembly).
    pub trace_seconds: f64,
    /// Time spent on everything else, in seconds; 0 where there is no clock.
    pub shade_seconds: f64,
    /// Contributions that were not finite and therefore left out, as from values beyond `f32`.
    pub dropped: u64,
}

impl FrameStats {
    /// Adds what tracing took, in a stage and in all.
    pub(crate) fn add_traced(&mut self, stage: Stage, traced: StageStats) {
        self.trace += traced.trace;
        self.trace_seconds += traced.seconds;
        let stages = &mut self.stages;
        *match stage {
            Stage::Primary => &mut stages.primary,
            Stage::Secondary => &mut stages.secondary,
            Stage::Shadow => &mut stages.shadow,
            Stage::Indirect => &mut stages.indirect,
        } += traced;
    }
}

/// What light that mirrors and glass throw took.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CausticStats {
    /// Photons that rays from lights left.
    pub photons: u64,
    /// Time spent on those rays, tracing included, in seconds; 0 where there is no clock.
    pub shoot_seconds: f64,
    /// Time spent on gathering photons, in seconds; 0 where there is no clock, and on a graphics
    /// device, whose budget tells it.
    pub gather_seconds: f64,
}

/// What light from virtual lights took.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct IndirectStats {
    /// Virtual lights.
    pub lights: u64,
    /// What visibility took.
    pub visibility: VisibilityStats,
    /// Radiance that arrived at pixels from virtual lights, summed over colours and samples.
    pub gathered: f64,
    /// Radiance that the bound kept away, summed likewise.
    pub clamped: f64,
    /// Time spent on walks, tracing included, in seconds; 0 where there is no clock.
    pub shoot_seconds: f64,
    /// Time spent on gathering, visibility included, in seconds; 0 where there is no clock.
    pub gather_seconds: f64,
    /// Spheres that stand for geometry, where visibility is asked of them.
    pub spheres: u64,
    /// Time spent on bringing them to where geometry is, in seconds; 0 where there is no clock.
    pub fit_seconds: f64,
    /// What cuts through the lights took.
    pub cuts: CutStats,
}

impl IndirectStats {
    /// The share of the light of virtual lights that the bound kept away.
    pub fn clamped_share(&self) -> f64 {
        let all = self.gathered + self.clamped;
        if all > 0.0 { self.clamped / all } else { 0.0 }
    }
}

/// Measures seconds where there is a clock.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stopwatch {
    #[cfg(not(target_arch = "wasm32"))]
    start: std::time::Instant,
}

impl Stopwatch {
    pub(crate) fn start() -> Self {
        Self {
            #[cfg(not(target_arch = "wasm32"))]
            start: std::time::Instant::now(),
        }
    }

    #[cfg(not(target_arch = "wasm32"))]
    pub(crate) fn seconds(&self) -> f64 {
        self.start.elapsed().as_secs_f64()
    }

    #[cfg(target_arch = "wasm32")]
    pub(crate) fn seconds(&self) -> f64 {
        0.0
    }
}
