//! What an engine answers about the rays of a frame.

use rayflock::engine::{RayEngine, TraceStats};
use rayflock::geom::{HitBuffer, Hits, RayBatch};

use super::meter::{Cost, Meter};
use crate::work::{Question, RaySet};

/// Answers to one question about all rays of a frame, batch after batch. Reused from frame to
/// frame; of the two columns only that of the question is in use.
#[derive(Clone, Debug, Default)]
pub(super) struct Answers {
    pub(super) hits: HitBuffer,
    pub(super) occluded: Vec<bool>,
    meter: Meter,
}

/// What tracing cost, without conversions that the engine's own users would not need.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Traced {
    pub(super) cost: Cost,
    pub(super) stats: TraceStats,
}

impl Answers {
    /// No answers yet; asking is measured by `meter`.
    pub(super) fn new(meter: Meter) -> Self {
        Self { meter, ..Self::default() }
    }

    /// Asks `engine` about all rays. Preparing the memory for the answers is not measured.
    pub(super) fn fill(&mut self, engine: &mut dyn RayEngine, rays: &RaySet) -> Traced {
        self.prepare(rays.question(), rays.len());
        let (mut sum, mut start) = (None, 0);
        for batch in rays.batches() {
            let traced = self.ask(engine, rays.question(), &batch, start);
            start += batch.len();
            sum = Some(sum.map_or(traced, |sum: Traced| sum.and(traced)));
        }
        sum.unwrap_or_default()
    }

    /// Asks about one batch only.
    pub(super) fn fill_from(
        &mut self,
        engine: &mut dyn RayEngine,
        question: Question,
        batch: &RayBatch<'_>,
    ) -> Traced {
        self.prepare(question, batch.len());
        self.ask(engine, question, batch, 0)
    }

    fn prepare(&mut self, question: Question, len: usize) {
        match question {
            Question::ClosestHit => self.hits.reset(len),
            Question::Occluded => {
                self.occluded.clear();
                self.occluded.resize(len, false);
            }
        }
    }

    fn ask(
        &mut self,
        engine: &mut dyn RayEngine,
        question: Question,
        batch: &RayBatch<'_>,
        first: usize,
    ) -> Traced {
        let range = first..first + batch.len();
        let (stats, cost) = match question {
            Question::ClosestHit => {
                let mut hits = Hits {
                    t: &mut self.hits.t[range.clone()],
                    uv: Some(&mut self.hits.uv[range.clone()]),
                    object_id: Some(&mut self.hits.object_id[range.clone()]),
                    prim_id: Some(&mut self.hits.prim_id[range]),
                };
                self.meter.measure(|| engine.closest_hit(batch, &mut hits))
            }
            Question::Occluded => {
                let occluded = &mut self.occluded[range];
                self.meter.measure(|| engine.occluded(batch, occluded))
            }
        };
        Traced { cost: cost.without(stats.conversion_ns), stats }
    }
}

impl Traced {
    fn and(self, other: Self) -> Self {
        Self { cost: self.cost + other.cost, stats: self.stats + other.stats }
    }
}
