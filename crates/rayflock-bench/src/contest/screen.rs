//! Finds the settings of Embree that are best for a piece of work.
//!
//! For each build an engine is made, gets the frame before the phase and the frames of the phase,
//! and traces up to 65,536 of the rays, in sixteen slices from all over the batch, with each
//! traversal. Commit, and trace put in proportion to all rays, are added over up to two phases.
//! A build is given up when its commit alone takes much longer than the best total so far, a
//! traversal when its total does. The three best are then measured like every other engine.
//!
//! **Cost**: [`Effort::screen_time`], and one build at most beyond it; one engine at a time.

use std::time::{Duration, Instant};

use rayflock::engine::EngineError;
use rayflock::geom::RayBatch;

use super::answers::Answers;
use super::effort::Effort;
use super::held::Held;
use super::piece::{Piece, PiecePhase};
use crate::BenchError;
use crate::peer::embree::{Build, EmbreeEngine, EmbreeLibrary, Setting, Traversal};
use crate::work::RaySet;

/// Settings that are measured fully.
const FINALIST_COUNT: usize = 3;

/// Phases that settings are tried in.
const PHASE_COUNT: usize = 2;

/// Rays that settings are tried with.
const RAY_COUNT: usize = 1 << 16;

/// Slices that those rays come in.
const SLICE_COUNT: usize = 16;

/// Whatever takes less than this is tried several times, the fastest counts.
const SHORT: Duration = Duration::from_millis(8);

/// How much worse than the best so far a setting may seem before it is given up.
const HOPELESS: f64 = 1.5;

/// The best settings for `piece`, best first.
///
/// # Errors
/// [`BenchError`] when Embree does not start or cannot hold the geometry.
pub(super) fn screen(
    library: &EmbreeLibrary,
    piece: &Piece,
    effort: &Effort,
    is_stopped: &dyn Fn() -> bool,
) -> Result<Vec<Setting>, BenchError> {
    let start = Instant::now();
    let mut builds = Setting::builds();
    // Those that hardly ever win come last: they are the slow ones, and time may run out.
    builds.sort_by_key(|build| build.quality);
    let mut screening = Screening::new(piece);
    for build in builds {
        let enough = screening.found.len() >= FINALIST_COUNT;
        if is_stopped() || (enough && start.elapsed() > effort.screen_time) {
            break;
        }
        let engine = EmbreeEngine::new(library, Setting { build, ..Setting::default() })?;
        screening.try_build(Trial { engine, held: Held::default() }, build)?;
    }
    Ok(screening.finalists())
}

struct Screening<'a> {
    phases: Vec<&'a PiecePhase>,
    /// The best total so far, by phase.
    best: Vec<Duration>,
    /// Totals over all phases.
    found: Vec<(Setting, Duration)>,
    answers: Answers,
}

impl<'a> Screening<'a> {
    fn new(piece: &'a Piece) -> Self {
        let step = piece.phases.len().div_ceil(PHASE_COUNT).max(1);
        let phases: Vec<_> = piece.phases.iter().step_by(step).collect();
        let best = vec![Duration::MAX; phases.len()];
        Self { phases, best, found: Vec::new(), answers: Answers::default() }
    }

    /// Tries a build with all traversals that do not seem hopeless.
    fn try_build(&mut self, mut trial: Trial, build: Build) -> Result<(), EngineError> {
        let mut in_race: Vec<(Traversal, Duration)> = Setting::traversals()
            .into_iter()
            .map(|traversal| (traversal, Duration::ZERO))
            .collect();
        for phase_idx in 0..self.phases.len() {
            let phase = self.phases[phase_idx];
            let Some(first) = phase.frames.first() else { continue };
            let commit = trial.commit(phase)?;
            if is_hopeless(commit, self.best[phase_idx]) {
                return Ok(());
            }
            for (traversal, sum) in &mut in_race {
                trial.engine.set_traversal(*traversal);
                let total = commit + trial.trace(&first.rays, &mut self.answers);
                self.best[phase_idx] = self.best[phase_idx].min(total);
                *sum += total;
            }
            let best: Duration = self.best[..=phase_idx].iter().sum();
            in_race.retain(|&(_, sum)| !is_hopeless(sum, best));
        }
        let setting = |traversal| Setting { build, traversal, robust: false };
        self.found.extend(in_race.into_iter().map(|(traversal, sum)| (setting(traversal), sum)));
        Ok(())
    }

    fn finalists(mut self) -> Vec<Setting> {
        self.found.sort_by_key(|&(_, total)| total);
        self.found.into_iter().map(|(setting, _)| setting).take(FINALIST_COUNT).collect()
    }
}

fn is_hopeless(time: Duration, best: Duration) -> bool {
    best < Duration::MAX && time > best.mul_f64(HOPELESS)
}

/// One build at work.
struct Trial {
    engine: EmbreeEngine,
    held: Held,
}

impl Trial {
    /// The time to commit the first frame of a phase, coming from another one.
    fn commit(&mut self, phase: &PiecePhase) -> Result<Duration, EngineError> {
        let [first, others @ ..] = &phase.frames[..] else { return Ok(Duration::ZERO) };
        let other = others.last().map_or(&phase.before, |last| &last.geometry);
        self.held.begin_with(&mut self.engine, &phase.before, &first.geometry)?;
        fastest(|| {
            self.held.commit(&mut self.engine, other)?;
            Ok(self.held.commit(&mut self.engine, &first.geometry)?.time)
        })
    }

    /// The time that all rays would take, by some of them.
    fn trace(&mut self, rays: &RaySet, answers: &mut Answers) -> Duration {
        let engine = &mut self.engine;
        let step = rays.len().div_ceil(RAY_COUNT);
        let measured = fastest::<EngineError>(|| {
            if step <= 1 {
                return Ok(answers.fill(engine, rays).cost.time);
            }
            Ok(rays.batches().map(|batch| trace_slices(engine, rays, &batch, step, answers)).sum())
        });
        measured.unwrap_or_default()
    }
}

/// The time that a batch would take, by a part in `step` of its rays.
fn trace_slices(
    engine: &mut EmbreeEngine,
    rays: &RaySet,
    batch: &RayBatch<'_>,
    step: usize,
    answers: &mut Answers,
) -> Duration {
    let part = batch.len().div_ceil(SLICE_COUNT).max(1);
    let (mut time, mut traced) = (Duration::ZERO, 0);
    for start in (0..batch.len()).step_by(part) {
        let len = part.div_ceil(step).min(batch.len() - start);
        let slice = batch.slice(start, len);
        time += answers.fill_from(engine, rays.question(), &slice).cost.time;
        traced += len;
    }
    time.mul_f64(batch.len() as f64 / traced.max(1) as f64)
}

/// The least time that `measure` tells; once is enough if it takes long.
fn fastest<E>(mut measure: impl FnMut() -> Result<Duration, E>) -> Result<Duration, E> {
    let start = Instant::now();
    let mut best = measure()?;
    while start.elapsed() < SHORT {
        best = best.min(measure()?);
    }
    Ok(best)
}
