//! Engines measured side by side on one piece of work, their answers compared.
//!
//! A piece of work has phases, each with frames of slightly different time. For each phase
//!
//! 1. every engine learns from two frames what moves, the second of which is the frame before the
//!    phase, so that what it keeps of it is as old as the user's would be; then it gets the last
//!    frame of the phase;
//! 2. every engine traces a part of the rays, then all, to warm up; one that is too slow is
//!    skipped ([`Effort::frame_limit`]);
//! 3. round by round each engine in turn commits and traces one frame, A B A B; rounds alternate
//!    between the frames of the phase, so that every commit moves everything that moves. What
//!    slows the machine for a while slows all engines alike.
//!
//! Times are wall-clock times of commit and of trace, without what an engine spends on
//! conversions that its own users would not need. Moving the scene to its place, making rays and
//! preparing the memory of answers are not measured. A phase's times are medians over its rounds,
//! a cell's are means over its phases. A cell whose quartiles lie more than [`NOISY`] of the
//! median apart is marked.
//!
//! | Stage | What it does |
//! |---|---|
//! | `forecast` | finds engines that are too slow |
//! | `screen` | finds the three best of Embree's settings |
//! | `rounds` | measures a phase |
//! | `compare` | counts rays that are answered otherwise than by the reference |
//! | `judge` | asks the oracle who is right |
//! | `summarize` | makes a [`Cell`] of it |
//!
//! **Cost**: one engine each; answers of one frame for the current engine, the reference and the
//! first engine of ours.

mod answers;
mod compare;
mod contestant;
mod course;
mod effort;
mod entry;
mod forecast;
mod held;
mod judge;
mod meter;
mod piece;
mod rounds;
mod screen;
mod setup;
mod summarize;
mod watch;

use crate::peer::embree::{EmbreeEngine, EmbreeLibrary};
use crate::record::Cell;
use crate::{BenchError, EngineSpec};

use contestant::Contestant;
use effort::Clock;
use entry::Entry;
use meter::Meter;
use rounds::{Rounds, Stopped};

pub(crate) use course::Course;
pub use effort::Effort;
pub use piece::{Piece, PieceFrame, PiecePhase};
pub use setup::Setup;
pub use summarize::NOISY;
pub(crate) use summarize::{named, of_frame, of_phases};
pub use watch::{Progress, Unwatched, Watch};

/// The setting of Embree that others are compared with.
const REFERENCE: &str = "low+instances+robust";

/// Engines that are measured piece after piece. They keep their memory from piece to piece.
#[derive(Debug)]
pub struct Contest {
    entries: Vec<Entry>,
    /// What answers are compared with; without it, with those of the first engine.
    reference: Option<Contestant>,
    library: Option<EmbreeLibrary>,
    effort: Effort,
    meter: Meter,
}

impl Contest {
    /// Makes the engines.
    ///
    /// # Errors
    /// [`BenchError`] when there is no engine, or when one needs Embree and that cannot be had.
    pub fn new(setup: &Setup) -> Result<Self, BenchError> {
        let Setup { engines, library, effort, allocations } = setup;
        let (library, meter) = (library.as_ref(), Meter(*allocations));
        if engines.is_empty() {
            return Err(BenchError::Nothing("engines"));
        }
        let is_needed = library.is_none() && engines.iter().any(EngineSpec::needs_embree);
        let found = if is_needed { Some(EmbreeLibrary::load(None)?) } else { library.cloned() };
        let entries = engines.iter().map(|&spec| Entry::new(spec, found.as_ref(), meter));
        let entries = entries.collect::<Result<_, _>>()?;
        let reference = found.as_ref().map(reference).transpose()?;
        Ok(Self { entries, reference, library: found, effort: *effort, meter })
    }

    /// Measures all engines on the current rayon thread pool: one cell each, in the order they
    /// were asked for; `None` when `is_stopped` says that the user has had enough.
    ///
    /// # Errors
    /// [`BenchError`] when Embree does not start.
    pub fn measure(
        &mut self,
        piece: &Piece,
        is_stopped: &dyn Fn() -> bool,
    ) -> Result<Option<Vec<Cell>>, BenchError> {
        let clock = Clock::start(&self.effort);
        for entry in &mut self.entries {
            entry.begin_cell(self.library.as_ref(), piece, &self.effort, is_stopped)?;
        }
        for (phase_idx, phase) in piece.phases.iter().enumerate() {
            let time = clock.share(piece.phases.len() - phase_idx);
            let rounds =
                Rounds { phase, effort: &self.effort, meter: self.meter, time, is_stopped };
            let mut contestants: Vec<&mut Contestant> =
                self.entries.iter_mut().flat_map(Entry::contestants).collect();
            if let Err(Stopped) = rounds.run(&mut contestants, self.reference.as_mut()) {
                return Ok(None);
            }
        }
        Ok(Some(self.entries.iter_mut().map(|entry| entry.end_cell(piece)).collect()))
    }
}

fn reference(library: &EmbreeLibrary) -> Result<Contestant, BenchError> {
    let engine = EmbreeEngine::new(library, REFERENCE.parse()?)?;
    Ok(Contestant::new("reference", REFERENCE, false, Box::new(engine), Meter::default()))
}

#[cfg(test)]
mod tests;
