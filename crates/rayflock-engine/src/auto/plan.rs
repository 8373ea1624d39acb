//! Which engines a frame is prepared for.
//!
//! Batch by batch, the engine that needs no preparation would win each time, though another would
//! long have paid for its preparation. So before a frame the batches of the last frame are asked
//! about for every set of engines: the set is taken that would have answered all of them soonest,
//! preparations included. What is in the set is not charged for preparing when batches come.

use super::cost_model::CostModel;
use super::member::MEMBERS;
use super::situation::{Frame, Situation};

/// Batches of a frame that are remembered.
const LONGEST: usize = 256;

/// The engines counted on for this frame, and what it has asked so far.
#[derive(Clone, Debug, Default)]
pub(super) struct Plan {
    /// A bit a member.
    set: usize,
    /// What this frame has asked so far.
    batches: Vec<Situation>,
    /// What the last frame that asked anything asked.
    expected: Vec<Situation>,
}

impl Plan {
    /// Chooses the engines for a frame that asks what the last frame asked.
    pub(super) fn begin_frame(&mut self, model: &CostModel, frame: &Frame) {
        if !self.batches.is_empty() {
            std::mem::swap(&mut self.batches, &mut self.expected);
            self.batches.clear();
        }
        if self.expected.is_empty() {
            // Nothing tells engines apart: stay with the one that holds the frame before.
            self.set = 1;
            return;
        }
        for batch in &mut self.expected {
            batch.frame = *frame;
        }
        let sets = 1..1_usize << MEMBERS.len();
        let costs = sets.map(|set| (set, self.cost(set, model, frame)));
        self.set = costs.min_by(|a, b| a.1.total_cmp(&b.1)).map_or(1, |(set, _)| set);
    }

    /// Whether a member is counted on.
    pub(super) fn includes(&self, member_idx: usize) -> bool {
        self.set & (1 << member_idx) != 0
    }

    /// Takes note of a batch of this frame.
    pub(super) fn note(&mut self, batch: Situation) {
        if self.batches.len() < LONGEST {
            self.batches.push(batch);
        }
    }

    /// Nanoseconds that the batches take with the engines of `set`, preparations included.
    fn cost(&self, set: usize, model: &CostModel, frame: &Frame) -> f32 {
        let members = || (0..MEMBERS.len()).filter(|member_idx| set & (1 << member_idx) != 0);
        let commits: f32 = members().map(|idx| model.commit_ns(idx, frame)).sum();
        let mut is_fresh = [true; MEMBERS.len()];
        let mut total = commits;
        for batch in &self.expected {
            let cost = |idx: usize| model.trace_ns(idx, batch, is_fresh[idx]);
            let best = members().min_by(|&a, &b| cost(a).total_cmp(&cost(b)));
            if let Some(best) = best {
                total += cost(best);
                is_fresh[best] = false;
            }
        }
        total
    }
}

#[cfg(test)]
mod tests {
    use super::super::situation::RayClass;
    use super::*;
    use crate::packet::Question;

    const FRAME: Frame = Frame { prim_count: 1 << 16, changed_count: 1 << 16 };

    fn batch() -> Situation {
        let (class, question) = (RayClass::Unordered, Question::Closest);
        Situation { class, question, ray_count: 1 << 12, frame: FRAME }
    }

    /// Member 0 needs 2 ms for each batch; member 1 needs 10 for its first and 1 for each other.
    fn model() -> CostModel {
        let mut model = CostModel::default();
        for (member_idx, is_fresh, took_ns) in
            [(0, true, 2e6), (0, false, 2e6), (1, true, 10e6), (1, false, 1e6)]
        {
            (0..5).for_each(|_| model.learn(member_idx, &batch(), is_fresh, took_ns));
        }
        for member_idx in 0..MEMBERS.len() {
            (0..5).for_each(|_| model.learn_commit(member_idx, &FRAME, 1e3));
        }
        for member_idx in 2..MEMBERS.len() {
            for is_fresh in [true, false] {
                (0..5).for_each(|_| model.learn(member_idx, &batch(), is_fresh, 1e9));
            }
        }
        model
    }

    fn planned_after(batch_count: usize) -> Vec<bool> {
        let mut plan = Plan::default();
        (0..batch_count).for_each(|_| plan.note(batch()));
        plan.begin_frame(&model(), &FRAME);
        (0..MEMBERS.len()).map(|member_idx| plan.includes(member_idx)).collect()
    }

    #[test]
    fn preparing_pays_when_there_are_many_batches() {
        assert_eq!(planned_after(1)[..2], [true, false]);
        assert_eq!(planned_after(5)[..2], [true, false]);
        assert_eq!(planned_after(20)[..2], [false, true]);
    }

    #[test]
    fn a_frame_that_asks_nothing_keeps_the_plan() {
        let mut plan = Plan::default();
        (0..20).for_each(|_| plan.note(batch()));
        for _ in 0..3 {
            plan.begin_frame(&model(), &FRAME);
            assert!(plan.includes(1) && !plan.includes(0));
        }
    }
}
