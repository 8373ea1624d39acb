//! One engine under measurement.

use std::time::Instant;

use rayflock::engine::{Fact, RayEngine};
use rayflock::render::{
    Film, FrameRenderer, FrameStats, RenderError, RenderSettings, View, WhittedRenderer,
};
use rayflock::scene::{Scene, SceneFrame};

use crate::peer::PeerError;
use crate::peer::embree::EmbreeLibrary;
use crate::{BenchError, EngineSpec};

/// An engine in its renderer, with what was measured of it.
#[derive(Debug)]
pub(super) struct Contestant {
    /// The engine, as it was asked for.
    pub(super) name: String,
    /// The setting it runs with, where it has any.
    pub(super) setting: String,
    /// Whether it is one of ours, which all agree to the bit.
    pub(super) is_own: bool,
    renderer: WhittedRenderer,
    film: Film,
    samples: Vec<Sample>,
}

/// One frame, rendered once.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sample {
    /// Making the geometry the current one, in milliseconds: `commit`, and what the engine left to
    /// do for the first batch.
    pub(super) commit_ms: f64,
    /// Tracing the rays, in milliseconds.
    pub(super) trace_ms: f64,
    /// Everything else that makes the picture, in milliseconds.
    pub(super) shade_ms: f64,
    /// Primitives in the frame.
    pub(super) triangles: usize,
    /// What the renderer counted.
    pub(super) stats: FrameStats,
    /// Bytes held by engine and renderer.
    pub(super) memory_bytes: usize,
    /// Pixels that differ in any bit from the reference.
    pub(super) differing_pixels: u64,
}

impl Sample {
    /// Update and tracing together, in milliseconds.
    pub(super) fn total_ms(&self) -> f64 {
        self.commit_ms + self.trace_ms
    }
}

impl Contestant {
    /// Nothing is rendered yet; `size` is width and height in pixels. The name is that of the
    /// engine.
    ///
    /// # Errors
    /// [`PeerError`] when the engine cannot be had.
    pub(super) fn new(
        spec: EngineSpec,
        library: Option<&EmbreeLibrary>,
        size: [usize; 2],
    ) -> Result<Self, PeerError> {
        let setting = match spec {
            EngineSpec::Embree(setting) => setting.to_string(),
            _ => String::new(),
        };
        Ok(Self::of(spec.to_string(), setting, spec.is_own(), spec.create(library)?, size))
    }

    fn of(
        name: String,
        setting: String,
        is_own: bool,
        engine: Box<dyn RayEngine>,
        [width, height]: [usize; 2],
    ) -> Self {
        let renderer = WhittedRenderer::new(engine);
        Self {
            name,
            setting,
            is_own,
            renderer,
            film: Film::new(width, height),
            samples: Vec::new(),
        }
    }

    /// What was measured, in the order of time.
    pub(super) fn samples(&self) -> &[Sample] {
        &self.samples
    }

    /// What the engine tells about what it holds.
    pub(super) fn facts(&self) -> Vec<Fact> {
        self.renderer.facts()
    }

    /// Whether what was measured is the engine's own work.
    ///
    /// # Errors
    /// [`BenchError::HandedOver`] when it is not.
    pub(super) fn check(&self) -> Result<(), BenchError> {
        BenchError::unless_own(&self.name, self.renderer.notice())
    }

    /// Mean of update and tracing over everything measured, in milliseconds.
    pub(super) fn mean_total_ms(&self) -> f64 {
        let sum: f64 = self.samples.iter().map(Sample::total_ms).sum();
        sum / self.samples.len().max(1) as f64
    }

    /// Forgets what was measured so far.
    pub(super) fn forget_samples(&mut self) {
        self.samples.clear();
    }

    /// Makes a frame the current one, unmeasured.
    pub(super) fn prepare(&mut self, scene: &Scene, frame: &SceneFrame) -> Result<(), RenderError> {
        self.renderer.commit(scene, frame).map(|_| ())
    }

    /// Renders a frame and adds a sample.
    pub(super) fn render(
        &mut self,
        scene: &Scene,
        frame: &SceneFrame,
        view: &View,
        settings: &RenderSettings,
    ) -> Result<(), RenderError> {
        let start = Instant::now();
        let commit = self.renderer.commit(scene, frame)?;
        let commit_ms = 1e3 * start.elapsed().as_secs_f64() - milliseconds(commit.conversion_ns);
        let stats = self.renderer.render(view, settings, &mut self.film);
        let trace_ms = 1e3 * stats.trace_seconds - milliseconds(stats.trace.conversion_ns);
        let late_ms = milliseconds(stats.trace.update_ns).min(trace_ms.max(0.0));
        self.samples.push(Sample {
            commit_ms: commit_ms.max(0.0) + late_ms,
            trace_ms: trace_ms.max(0.0) - late_ms,
            shade_ms: 1e3 * stats.shade_seconds,
            triangles: commit.prim_count,
            stats,
            memory_bytes: self.renderer.memory_usage(),
            differing_pixels: 0,
        });
        Ok(())
    }

    /// Notes in the last sample how far the film differs from that of the `reference`.
    pub(super) fn compare_film(&mut self, reference: &Self) {
        let bits = |pixel: &[f32; 3]| pixel.map(f32::to_bits);
        let pairs = self.film.pixels().iter().zip(reference.film.pixels());
        let differing = pairs.filter(|(ours, theirs)| bits(ours) != bits(theirs)).count();
        if let Some(sample) = self.samples.last_mut() {
            sample.differing_pixels = differing as u64;
        }
    }
}

fn milliseconds(nanoseconds: u64) -> f64 {
    nanoseconds as f64 * 1e-6
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use rayflock::engine::{CommitStats, EngineError, EngineKind, TraceStats, create};
    use rayflock::geom::{FrameChanges, Geometry, Hits, RayBatch};
    use rayflock::scene::Projection;

    use super::*;

    /// Says that it spent a second on conversions for each commit and each batch.
    #[derive(Debug)]
    struct Converting;

    impl RayEngine for Converting {
        fn name(&self) -> &str {
            "converting"
        }

        fn commit(&mut self, _: &Geometry, _: &FrameChanges) -> Result<CommitStats, EngineError> {
            let conversion_ns = Duration::from_secs(1).as_nanos() as u64;
            Ok(CommitStats { conversion_ns, ..CommitStats::default() })
        }

        fn closest_hit(&mut self, _: &RayBatch<'_>, _: &mut Hits<'_>) -> TraceStats {
            let conversion_ns = Duration::from_secs(1).as_nanos() as u64;
            TraceStats { conversion_ns, ..TraceStats::default() }
        }

        fn occluded(&mut self, _: &RayBatch<'_>, _: &mut [bool]) -> TraceStats {
            TraceStats::default()
        }

        fn memory_usage(&self) -> usize {
            0
        }
    }

    fn render(engine: Box<dyn RayEngine>) -> Contestant {
        let mut contestant = Contestant::of(String::new(), String::new(), true, engine, [4, 2]);
        let (scene, frame) = (Scene::default(), SceneFrame::default());
        let view = View::new(Default::default(), Projection::Orthographic { height: 1.0 });
        contestant.render(&scene, &frame, &view, &RenderSettings::default()).unwrap();
        contestant
    }

    #[test]
    fn a_pixel_that_differs_in_one_bit_is_counted() {
        let contestant = || render(create(EngineKind::Brute));
        let (first, mut other) = (contestant(), contestant());
        other.compare_film(&first);
        assert_eq!(other.samples()[0].differing_pixels, 0);

        let value = &mut other.film.pixels_mut()[3][1];
        *value = f32::from_bits(value.to_bits() ^ 1);
        other.compare_film(&first);
        assert_eq!(other.samples()[0].differing_pixels, 1);
    }

    #[test]
    fn conversions_that_users_of_an_engine_would_not_pay_are_taken_off() {
        let contestant = render(Box::new(Converting));
        let Sample { commit_ms, trace_ms, .. } = contestant.samples()[0];
        assert_eq!((commit_ms, trace_ms), (0.0, 0.0), "a second is more than it took");
    }
}
