//! The engine that chooses: composes the others and asks, batch by batch, whichever is expected to
//! answer soonest.
//!
//! ```text
//!   situation   what is known of a batch before it is traced: which rays share what, how many
//!               rays and primitives there are
//!   prior       what each engine takes in a situation, as shipped
//!   cost_model  the prior, corrected by what recent frames took
//!   plan        which engines this frame is prepared for, if it asks what the last frame asked
//!   member      an engine and the frame that it holds
//!   choice      what was chosen and why
//! ```
//!
//! Engines get a frame when they are first needed in it, except those that the plan counts on,
//! which get it in `commit`.
//!
//! **Source.** The idea of one strategy chosen for each search, itself an engine among engines, is
//! that of the Rust library `regex-automata` (its `meta` engine).
//!
//! **Invariants.** A choice changes speed, never an answer: every member gives the same one. Only
//! this engine lets the clock decide anything; others read it for their stats.
//!
//! **Cost.** Under a microsecond a batch; a frame is held by each member that was needed, at most
//! one table of primitives each.

mod choice;
mod config;
mod cost_model;
mod member;
mod plan;
mod prior;
mod situation;

use rayflock_geom::{FrameChanges, Geometry, Hits, RayBatch};
use web_time::Instant;

pub use choice::Choice;
pub use config::Config;
pub use situation::RayClass;

use self::choice::Expectation;
use self::cost_model::CostModel;
use self::member::{MEMBERS, Member};
use self::plan::Plan;
use self::situation::{Frame, Situation};
use crate::packet::Question;
use crate::{CommitStats, EngineError, EngineKind, RayEngine, TraceStats};

/// Asks whichever engine is expected to answer soonest.
#[derive(Debug)]
pub struct AutoEngine {
    members: [Member; MEMBERS.len()],
    model: CostModel,
    plan: Plan,
    geometry: Geometry,
    frame: Frame,
    choices: Vec<Choice>,
}

impl Default for AutoEngine {
    fn default() -> Self {
        Self::new(Config::default())
    }
}

impl AutoEngine {
    /// An engine with an empty frame.
    pub fn new(config: Config) -> Self {
        Self {
            members: MEMBERS.map(|kind| Member::new(kind, config.simd)),
            model: CostModel::default(),
            plan: Plan::default(),
            geometry: Geometry::default(),
            frame: Frame::default(),
            choices: Vec::new(),
        }
    }

    /// Has the best member answer a batch, by `trace`.
    fn ask(
        &mut self,
        rays: &RayBatch<'_>,
        question: Question,
        trace: impl FnOnce(&mut dyn RayEngine) -> TraceStats,
    ) -> TraceStats {
        let situation = Situation::of(rays, question, &self.frame);
        let costs = self.expect(&situation);
        let member_idx = lowest(&costs);
        self.prepare(member_idx);
        let member = &mut self.members[member_idx];
        let start = Instant::now();
        let stats = trace(member.engine());
        let took_ns = start.elapsed().as_nanos() as f32;
        let is_first = std::mem::replace(&mut member.has_traced, true);
        self.model.learn(member_idx, &situation, !is_first, took_ns);
        self.plan.note(situation);
        self.choices.push(Choice::new(&situation, member_idx, &costs, took_ns));
        stats
    }

    /// What each member is expected to take for a batch, with what it still has to prepare. What
    /// the plan counts on anyway is not counted against a batch.
    fn expect(&self, situation: &Situation) -> [Expectation; MEMBERS.len()] {
        let mut costs = [Expectation::default(); MEMBERS.len()];
        for (member_idx, (cost, member)) in costs.iter_mut().zip(&self.members).enumerate() {
            let is_fresh = !member.has_traced && !self.plan.includes(member_idx);
            let mut ns = self.model.trace_ns(member_idx, situation, is_fresh);
            if is_fresh && !member.is_current {
                ns += self.model.commit_ns(member_idx, &self.frame);
            }
            *cost = Expectation { kind: MEMBERS[member_idx], ns };
        }
        costs
    }

    /// Makes the frame the current one of a member that does not hold it yet.
    fn prepare(&mut self, member_idx: usize) {
        let member = &mut self.members[member_idx];
        if !member.is_current {
            let changes = FrameChanges::between(&member.held, &self.geometry);
            if let Err(error) = member.commit(&self.geometry, &changes) {
                unreachable!("the engines of this crate hold every geometry: {error}");
            }
            self.model.learn_commit(member_idx, &self.frame, member.commit_ns);
        }
    }
}

/// The position of the least expectation.
fn lowest(costs: &[Expectation]) -> usize {
    let by_cost = |a: &usize, b: &usize| costs[*a].ns.total_cmp(&costs[*b].ns);
    (0..costs.len()).min_by(by_cost).unwrap_or_default()
}

impl RayEngine for AutoEngine {
    fn name(&self) -> &str {
        EngineKind::Auto.name()
    }

    fn commit(
        &mut self,
        geometry: &Geometry,
        changes: &FrameChanges,
    ) -> Result<CommitStats, EngineError> {
        let before = std::mem::replace(&mut self.geometry, geometry.clone());
        self.frame = Frame::of(geometry, &before);
        self.choices.clear();
        self.plan.begin_frame(&self.model, &self.frame);
        let mut stats = None;
        for (member_idx, member) in self.members.iter_mut().enumerate() {
            let held_before = member.is_current;
            member.is_current = false;
            member.has_traced = false;
            if self.plan.includes(member_idx) {
                let since_held;
                let changes = if held_before {
                    changes
                } else {
                    since_held = FrameChanges::between(&member.held, geometry);
                    &since_held
                };
                stats = Some(member.commit(geometry, changes)?);
                self.model.learn_commit(member_idx, &self.frame, member.commit_ns);
            }
        }
        Ok(stats.unwrap_or_default())
    }

    fn closest_hit(&mut self, rays: &RayBatch<'_>, hits: &mut Hits<'_>) -> TraceStats {
        self.ask(rays, Question::Closest, |engine| engine.closest_hit(rays, hits))
    }

    fn occluded(&mut self, rays: &RayBatch<'_>, occluded: &mut [bool]) -> TraceStats {
        self.ask(rays, Question::Occluded, |engine| engine.occluded(rays, occluded))
    }

    fn memory_usage(&self) -> usize {
        self.members.iter().map(Member::memory_usage).sum()
    }

    fn choices(&self) -> &[Choice] {
        &self.choices
    }
}
