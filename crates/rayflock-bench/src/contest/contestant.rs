//! One engine under measurement.

use rayflock::engine::{EngineError, Fact, RayEngine};
use rayflock::geom::Geometry;
use tracing::debug_span;

use super::answers::{Answers, Traced};
use super::compare::Comparison;
use super::held::Held;
use super::judge::judge;
use super::meter::{Cost, Meter};
use super::piece::PieceFrame;
use crate::record::{Counters, Judged};
use crate::work::RaySet;

/// An engine with what was measured of it in the current cell.
#[derive(Debug)]
pub(super) struct Contestant {
    /// As it was asked for.
    pub(super) name: String,
    /// The setting it runs with, where it has any.
    pub(super) setting: String,
    /// Whether it is one of ours, which all agree to the bit.
    pub(super) is_own: bool,
    /// Whether what it answers is meant.
    pub(super) is_answering: bool,
    engine: Box<dyn RayEngine>,
    held: Held,
    /// Why it does not take part in the current cell.
    pub(super) skipped: Option<String>,
    /// What was measured, by phase.
    pub(super) phases: Vec<PhaseSamples>,
}

/// What was measured of one engine in one phase.
#[derive(Clone, Debug, Default)]
pub(super) struct PhaseSamples {
    pub(super) samples: Vec<Sample>,
    pub(super) comparison: Comparison,
    pub(super) judged: Judged,
    pub(super) counters: Counters,
    pub(super) memory_bytes: usize,
    pub(super) facts: Vec<Fact>,
}

/// One turn.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sample {
    /// Making the geometry the current one.
    pub(super) commit: Cost,
    /// Tracing the rays.
    pub(super) trace: Cost,
}

impl Sample {
    /// Both together.
    pub(super) fn total(&self) -> Cost {
        self.commit + self.trace
    }
}

impl Contestant {
    /// Holds nothing and has nothing measured yet.
    pub(super) fn new(
        name: &str,
        setting: &str,
        is_own: bool,
        engine: Box<dyn RayEngine>,
        meter: Meter,
    ) -> Self {
        Self {
            name: name.to_owned(),
            setting: setting.to_owned(),
            is_own,
            is_answering: true,
            engine,
            held: Held::new(meter),
            skipped: None,
            phases: Vec::new(),
        }
    }

    /// The same, measured without a look at its answers.
    pub(super) fn unanswering(self) -> Self {
        Self { is_answering: false, ..self }
    }

    /// Forgets the last cell; the engine keeps what it holds.
    pub(super) fn begin_cell(&mut self) {
        self.skipped = None;
        self.phases.clear();
    }

    /// Whether it takes part.
    pub(super) fn is_in(&self) -> bool {
        self.skipped.is_none()
    }

    /// The engine, to trace with what it holds.
    pub(super) fn engine(&mut self) -> &mut dyn RayEngine {
        self.engine.as_mut()
    }

    /// Makes `geometry` the current one.
    pub(super) fn commit(&mut self, geometry: &Geometry) -> Result<Cost, EngineError> {
        self.held.commit(self.engine.as_mut(), geometry)
    }

    /// Makes `before` the current one, with nothing kept of earlier frames; what differs in
    /// `later` is known to move.
    pub(super) fn begin_with(
        &mut self,
        before: &Geometry,
        later: &Geometry,
    ) -> Result<(), EngineError> {
        self.held.begin_with(self.engine.as_mut(), before, later)
    }

    /// Traces all rays of a frame that is committed.
    pub(super) fn trace(&mut self, rays: &RaySet, answers: &mut Answers) -> Traced {
        answers.fill(self.engine.as_mut(), rays)
    }

    /// Commits and traces one frame, measured. What goes wrong takes the engine out of the cell.
    pub(super) fn take_turn(&mut self, frame: &PieceFrame, answers: &mut Answers) {
        let _span = debug_span!("turn", engine = self.name).entered();
        let commit = match self.commit(&frame.geometry) {
            Ok(commit) => commit,
            Err(error) => return self.skipped = Some(error.to_string()),
        };
        let traced = self.trace(&frame.rays, answers);
        if let Some(notice) = self.engine.notice() {
            return self.skipped = Some(notice.to_owned());
        }
        let memory_bytes = self.engine.memory_usage();
        if let Some(phase) = self.phases.last_mut() {
            phase.samples.push(Sample { commit, trace: traced.cost });
            phase.counters = Counters::from(&traced.stats);
            phase.memory_bytes = phase.memory_bytes.max(memory_bytes);
            phase.facts = self.engine.facts();
        }
    }

    /// Notes how its answers differ from the reference's.
    pub(super) fn note(&mut self, comparison: Comparison) {
        if let Some(phase) = self.phases.last_mut() {
            phase.comparison = comparison;
        }
    }

    /// Has the oracle judge what was noted of the last phase.
    pub(super) fn judge_noted(&mut self, geometry: &Geometry) {
        if let Some(phase) = self.phases.last_mut() {
            phase.judged = judge(&phase.comparison.shown, geometry);
        }
    }
}
