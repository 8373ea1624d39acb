//! Finds out that an engine is too slow for a cell before it has to do the whole cell.
//!
//! The engine traces 256 rays from the middle of the batch, then four times as many, and so on
//! up to a quarter of them. From two such times a straight line foretells the whole batch: what
//! a batch costs whatever its size is in its constant. Many engines become cheaper a ray with
//! more rays, so early forecasts are believed only where they are far off: at a share `s` of the
//! rays the limit is taken `sqrt(1 / 4s)` times. What is over it is measured once more, as the
//! machine may have been busy.
//!
//! **Cost**: a third of a frame for engines within the limit; two limits at most for others.

use std::time::Duration;

use rayflock::geom::RayBatch;

use super::answers::Answers;
use super::contestant::Contestant;
use crate::work::{Question, RaySet};

/// Rays of the first slice.
const FIRST_SLICE: usize = 256;

/// How much longer each slice is than the one before.
const GROWTH: usize = 4;

/// Why `contestant` needs longer than `limit` for `rays` of the frame that it holds; `None` where
/// it does not. In that case all rays have been traced once.
pub(super) fn forecast(
    contestant: &mut Contestant,
    rays: &RaySet,
    limit: Duration,
    answers: &mut Answers,
) -> Option<String> {
    let limit_ms = milliseconds(limit);
    let batch = rays.batches().next()?;
    // Batches of one set have nearly the same length.
    let batch_count = rays.len() as f64 / batch.len().max(1) as f64;
    let mut trials = Trials { contestant, answers, question: rays.question(), batch, before: None };
    while let Some((len, forecast_ms)) = trials.next(limit_ms / batch_count) {
        if let Some(forecast_ms) = forecast_ms {
            let share = batch.len() / len;
            return Some(format!(
                "over {limit_ms:.0} ms a frame: {:.0} ms foretold by 1/{share} of the rays",
                forecast_ms * batch_count
            ));
        }
    }
    let whole = contestant.trace(rays, answers).cost.time;
    (whole > limit)
        .then(|| format!("over {limit_ms:.0} ms a frame: it took {:.0} ms", milliseconds(whole)))
}

/// Slices of one batch, each longer than the one before.
struct Trials<'a, 'b> {
    contestant: &'a mut Contestant,
    answers: &'a mut Answers,
    question: Question,
    batch: RayBatch<'b>,
    /// Rays and milliseconds of the last slice.
    before: Option<(usize, f64)>,
}

impl Trials<'_, '_> {
    /// Traces the next slice; `None` where it would be longer than a quarter of the batch. Tells
    /// its length, and what it foretells for the batch if that is too much.
    fn next(&mut self, limit_ms: f64) -> Option<(usize, Option<f64>)> {
        let len = self.before.map_or(FIRST_SLICE, |(len, _)| GROWTH * len);
        if GROWTH * len > self.batch.len() {
            return None;
        }
        let allowed = limit_ms * (self.batch.len() as f64 / (GROWTH * len) as f64).sqrt();
        let mut best_ms = f64::INFINITY;
        let mut foretold_ms = f64::INFINITY;
        for _ in 0..2 {
            best_ms = best_ms.min(self.trace(len));
            foretold_ms = foretell(self.before, (len, best_ms), self.batch.len());
            if foretold_ms <= allowed {
                break;
            }
        }
        self.before = Some((len, best_ms));
        Some((len, (foretold_ms > allowed).then_some(foretold_ms)))
    }

    fn trace(&mut self, len: usize) -> f64 {
        let slice = self.batch.slice((self.batch.len() - len) / 2, len);
        let engine = self.contestant.engine();
        milliseconds(self.answers.fill_from(engine, self.question, &slice).cost.time)
    }
}

/// The time for `total` rays on the line through two measurements; without an earlier one, what
/// the slice itself took and the next one may take.
fn foretell(before: Option<(usize, f64)>, (len, ms): (usize, f64), total: usize) -> f64 {
    let Some((before_len, before_ms)) = before else { return GROWTH as f64 * ms };
    let slope = (ms - before_ms).max(0.0) / (len - before_len) as f64;
    ms + slope * (total - len) as f64
}

fn milliseconds(time: Duration) -> f64 {
    1e3 * time.as_secs_f64()
}
