//! One engine under measurement.

use std::time::Instant;

use rayflock::engine::{self, EngineKind};
use rayflock::render::{
    Film, FrameRenderer, FrameStats, RenderError, RenderSettings, View, WhittedRenderer,
};
use rayflock::scene::{Scene, SceneFrame};

/// An engine in its renderer, with what was measured of it.
#[derive(Debug)]
pub(super) struct Contestant {
    engine: EngineKind,
    renderer: WhittedRenderer,
    film: Film,
    samples: Vec<Sample>,
}

/// One frame, rendered once.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sample {
    /// Making the geometry the current one, in milliseconds.
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
    /// Pixels that differ in any bit from the first engine's.
    pub(super) differing_pixels: u64,
}

impl Sample {
    /// Update and tracing together, in milliseconds.
    pub(super) fn total_ms(&self) -> f64 {
        self.commit_ms + self.trace_ms
    }
}

impl Contestant {
    /// Nothing is rendered yet; `size` is width and height in pixels.
    pub(super) fn new(engine: EngineKind, [width, height]: [usize; 2]) -> Self {
        let renderer = WhittedRenderer::new(engine::create(engine));
        Self { engine, renderer, film: Film::new(width, height), samples: Vec::new() }
    }

    /// The name of the engine, as it was asked for.
    pub(super) fn name(&self) -> &str {
        self.engine.name()
    }

    /// What was measured, in the order of time.
    pub(super) fn samples(&self) -> &[Sample] {
        &self.samples
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
        self.samples.push(Sample {
            commit_ms: commit_ms.max(0.0),
            trace_ms: (1e3 * stats.trace_seconds - milliseconds(stats.trace.conversion_ns))
                .max(0.0),
            shade_ms: 1e3 * stats.shade_seconds,
            triangles: commit.prim_count,
            stats,
            memory_bytes: self.renderer.memory_usage(),
            differing_pixels: 0,
        });
        Ok(())
    }

    /// Notes in the last sample how far the film differs from that of the `first` engine.
    pub(super) fn compare_film(&mut self, first: &Self) {
        let bits = |pixel: &[f32; 3]| pixel.map(f32::to_bits);
        let pairs = self.film.pixels().iter().zip(first.film.pixels());
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
    use rayflock::scene::Projection;

    use super::*;

    #[test]
    fn a_pixel_that_differs_in_one_bit_is_counted() {
        let contestant = || {
            let mut contestant = Contestant::new(EngineKind::Brute, [4, 2]);
            let (scene, frame) = (Scene::default(), SceneFrame::default());
            let projection = Projection::Orthographic { height: 1.0 };
            let view = View::new(Default::default(), projection);
            contestant.render(&scene, &frame, &view, &RenderSettings::default()).unwrap();
            contestant
        };
        let (first, mut other) = (contestant(), contestant());
        other.compare_film(&first);
        assert_eq!(other.samples()[0].differing_pixels, 0);

        let value = &mut other.film.pixels_mut()[3][1];
        *value = f32::from_bits(value.to_bits() ^ 1);
        other.compare_film(&first);
        assert_eq!(other.samples()[0].differing_pixels, 1);
    }
}
