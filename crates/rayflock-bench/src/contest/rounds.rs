//! One phase: warm-up, settling in, then round after round in which each engine has its turn.

use std::time::{Duration, Instant};

use super::answers::Answers;
use super::compare::{Comparison, compare};
use super::contestant::{Contestant, PhaseSamples};
use super::effort::Effort;
use super::forecast::forecast;
use super::meter::Meter;
use super::piece::{PieceFrame, PiecePhase};

/// A phase and the rules by which it is measured.
pub(super) struct Rounds<'a> {
    pub(super) phase: &'a PiecePhase,
    pub(super) effort: &'a Effort,
    /// What turns are measured by.
    pub(super) meter: Meter,
    /// What the phase may take.
    pub(super) time: Duration,
    /// Whether the user wants to stop.
    pub(super) is_stopped: &'a dyn Fn() -> bool,
}

/// The user has stopped the measurement.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stopped;

/// What answers are compared with.
#[derive(Default)]
struct Expected {
    reference: Option<Answers>,
    first_own: Option<Answers>,
}

impl Rounds<'_> {
    /// Measures all that take part. The first frame's answers are compared with those of the
    /// `reference`; without one, with the first that takes part.
    pub(super) fn run(
        &self,
        contestants: &mut [&mut Contestant],
        reference: Option<&mut Contestant>,
    ) -> Result<(), Stopped> {
        let start = Instant::now();
        let Some((first, last)) = self.phase.frames.first().zip(self.phase.frames.last()) else {
            return Ok(());
        };
        let mut answers = Answers::new(self.meter);
        for contestant in &mut *contestants {
            contestant.phases.push(PhaseSamples::default());
            self.warm_up(contestant, last, &mut answers)?;
        }
        let reference = reference.and_then(|reference| self.answer(reference, first));
        let mut expected = Expected { reference, first_own: None };

        self.settle(contestants, &mut answers)?;
        let rounds_start = Instant::now();
        for round_idx in 0.. {
            let round_start = Instant::now();
            let frame = &self.phase.frames[round_idx % self.phase.frames.len()];
            for contestant in contestants.iter_mut().filter(|contestant| contestant.is_in()) {
                if (self.is_stopped)() {
                    return Err(Stopped);
                }
                self.take_turn(contestant, frame, &mut answers);
                if round_idx == 0 {
                    let comparison = expected.compare(contestant, frame, &answers);
                    contestant.note(comparison);
                }
            }
            let (elapsed, last) = (rounds_start.elapsed(), round_start.elapsed());
            let remaining = self.time.saturating_sub(start.elapsed());
            if self.effort.is_over(round_idx + 1, elapsed, last, remaining) {
                break;
            }
        }
        contestants.iter_mut().for_each(|contestant| contestant.judge_noted(&first.geometry));
        Ok(())
    }

    /// Rounds that do not count. Each goes over all frames, so that the first one is news to the
    /// first round that does. Each engine has time of its own, so that slow ones keep no other from
    /// settling.
    fn settle(
        &self,
        contestants: &mut [&mut Contestant],
        answers: &mut Answers,
    ) -> Result<(), Stopped> {
        let mut spent = vec![Duration::ZERO; contestants.len()];
        for _ in (0..self.effort.settling_rounds).step_by(self.phase.frames.len().max(1)) {
            let settles: Vec<_> =
                spent.iter().map(|spent| *spent < self.effort.settling_time).collect();
            for frame in &self.phase.frames {
                let turns = contestants.iter_mut().zip(&mut spent).zip(&settles);
                for ((contestant, spent), settles) in turns {
                    if (self.is_stopped)() {
                        return Err(Stopped);
                    }
                    if *settles && contestant.is_in() {
                        let start = Instant::now();
                        self.take_turn(contestant, frame, answers);
                        *spent += start.elapsed();
                    }
                }
            }
        }
        for contestant in contestants.iter_mut() {
            if let Some(phase) = contestant.phases.last_mut() {
                phase.samples.clear();
            }
        }
        Ok(())
    }

    /// Gives an engine the geometry before the phase and then the last frame, so that the first
    /// is news to it, and traces once; finds out whether it is too slow.
    fn warm_up(
        &self,
        contestant: &mut Contestant,
        last: &PieceFrame,
        answers: &mut Answers,
    ) -> Result<(), Stopped> {
        if (self.is_stopped)() {
            return Err(Stopped);
        }
        if !contestant.is_in() {
            return Ok(());
        }
        let committed = contestant
            .begin_with(&self.phase.before, &last.geometry)
            .and_then(|()| contestant.commit(&last.geometry));
        contestant.skipped = match committed {
            Ok(_) => forecast(contestant, &last.rays, self.effort.frame_limit, answers),
            Err(error) => Some(error.to_string()),
        };
        Ok(())
    }

    /// What the reference says about a frame; `None` where it cannot hold the geometry.
    fn answer(&self, reference: &mut Contestant, frame: &PieceFrame) -> Option<Answers> {
        let mut answers = Answers::default();
        reference.commit(&frame.geometry).ok()?;
        reference.trace(&frame.rays, &mut answers);
        Some(answers)
    }

    fn take_turn(&self, contestant: &mut Contestant, frame: &PieceFrame, answers: &mut Answers) {
        if self.phase.frames.len() == 1
            && let Err(error) = contestant.commit(&self.phase.before)
        {
            contestant.skipped = Some(error.to_string());
            return;
        }
        contestant.take_turn(frame, answers);
    }
}

impl Expected {
    /// Compares, and keeps the answers where they are the first ones.
    fn compare(
        &mut self,
        contestant: &Contestant,
        frame: &PieceFrame,
        answers: &Answers,
    ) -> Comparison {
        if !contestant.is_in() || !contestant.is_answering {
            return Comparison::default();
        }
        let own = if contestant.is_own { self.first_own.as_ref() } else { None };
        let reference = self.reference.as_ref().unwrap_or(answers);
        let comparison = compare(&frame.rays, &frame.geometry, answers, reference, own);
        if contestant.is_own {
            self.first_own.get_or_insert_with(|| answers.clone());
        }
        self.reference.get_or_insert_with(|| answers.clone());
        comparison
    }
}
