//! What engines take: the shipped figures, corrected by what recent frames took.
//!
//! For each kind of situation and member stands the ratio of measured to shipped time. In a
//! situation that a member never met, its ratio is guessed: from that of the other members there,
//! for a machine that is slow or a view that is mostly empty is so for all of them, and from its
//! own ratio in the situation most alike, the less the farther that is. Seven tenths of it count:
//! an engine that might be the best is tried a few times. A ratio that is not measured again sinks
//! slowly, so that one bad moment of the machine does not rule an engine out for good.
//!
//! **Cost.** A search in a table of the situations met; memory grows with their kinds only.

use std::collections::BTreeMap;

use super::member::MEMBERS;
use super::prior;
use super::situation::{Frame, Situation, SituationKey};

/// How eager the model is to try what it does not know.
const OPTIMISM: f32 = 0.7;

/// How far one measurement moves a ratio.
const STEP: f32 = 0.3;

/// No measurement counts for more than this many times what was known before.
const WORST_SURPRISE: f32 = 2.0;

/// What a ratio sinks to, each time that another member was asked.
const SINKING: f32 = 0.997;

/// Measurements that it takes to know a ratio: the first of them come while memory is got and
/// what rests is prepared, so the least of them counts.
const TRIALS: u32 = 3;

/// Nanoseconds from which on a measurement stands for two, and for three: starting slowly is a
/// smaller part of it, and trying costs more.
const LONG_NS: [f32; 2] = [2.5e7, 1e8];

/// Nanoseconds that everything takes, also where the clock is too coarse to tell.
const LEAST_NS: f32 = 1.0;

/// Measured over shipped time.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Ratio {
    value: f32,
    /// Measurements so far, counted up to [`TRIALS`].
    trials: u32,
}

impl Default for Ratio {
    fn default() -> Self {
        Self { value: f32::INFINITY, trials: 0 }
    }
}

impl Ratio {
    /// The ratio, once it is known.
    fn known(&self) -> Option<f32> {
        (self.trials == TRIALS).then_some(self.value)
    }

    fn learn(&mut self, measured: f32, took_ns: f32) {
        if self.trials < TRIALS {
            let counted = 1 + LONG_NS.iter().filter(|&&long_ns| took_ns >= long_ns).count() as u32;
            self.trials = (self.trials + counted).min(TRIALS);
            self.value = self.value.min(measured);
        } else {
            self.value += STEP * (measured.min(WORST_SURPRISE * self.value) - self.value);
        }
    }

    fn sink(&mut self) {
        self.value *= SINKING;
    }
}

/// One ratio a member.
type Ratios = [Ratio; MEMBERS.len()];

/// See the [module](self).
#[derive(Clone, Debug, Default)]
pub(super) struct CostModel {
    /// By situation, and by whether it was the member's first batch of the frame.
    traces: BTreeMap<(SituationKey, bool), Ratios>,
    commits: Ratios,
}

impl CostModel {
    /// Nanoseconds that a member is expected to take for a batch; `is_fresh` when it is the first
    /// after a commit.
    pub(super) fn trace_ns(&self, member_idx: usize, situation: &Situation, is_fresh: bool) -> f32 {
        let here = self.traces.get(&(situation.key(), is_fresh));
        let ratio = here.and_then(|ratios| ratios[member_idx].known());
        let ratio = ratio.unwrap_or_else(|| OPTIMISM * self.guess(member_idx, &situation.key()));
        ratio * prior::trace_ns(MEMBERS[member_idx], situation, is_fresh)
    }

    /// The ratio of a member in the situation that is most alike, drawn with distance towards what
    /// members have in common here.
    fn guess(&self, member_idx: usize, key: &SituationKey) -> f32 {
        let common = self.common_ratio(key);
        let known = self.traces.iter().filter_map(|((other, _), ratios)| {
            Some((key.distance(other)?, ratios[member_idx].known()?))
        });
        let nearest = known.min_by_key(|&(distance, _)| distance);
        nearest.map_or(common, |(distance, ratio)| {
            common * (ratio / common).powf(1.0 / (1 + distance) as f32)
        })
    }

    /// The geometric mean of the ratios that are known in a situation; 1 where none is.
    fn common_ratio(&self, key: &SituationKey) -> f32 {
        let here =
            [true, false].into_iter().filter_map(|is_fresh| self.traces.get(&(*key, is_fresh)));
        let logarithms = here.flatten().filter_map(|ratio| ratio.known().map(f32::ln));
        let (sum, count) = logarithms.fold((0.0, 0), |(sum, count), log| (sum + log, count + 1));
        (sum / count.max(1) as f32).exp()
    }

    /// Nanoseconds that a member is expected to take for a commit.
    pub(super) fn commit_ns(&self, member_idx: usize, frame: &Frame) -> f32 {
        self.commits[member_idx].known().unwrap_or(1.0)
            * prior::commit_ns(MEMBERS[member_idx], frame)
    }

    /// Takes note of what a batch took.
    pub(super) fn learn(
        &mut self,
        member_idx: usize,
        situation: &Situation,
        is_fresh: bool,
        took_ns: f32,
    ) {
        let took_ns = took_ns.max(LEAST_NS);
        let measured = took_ns / prior::trace_ns(MEMBERS[member_idx], situation, is_fresh);
        let ratios = self.traces.entry((situation.key(), is_fresh)).or_default();
        for (idx, ratio) in ratios.iter_mut().enumerate() {
            if idx == member_idx { ratio.learn(measured, took_ns) } else { ratio.sink() }
        }
    }

    /// Takes note of what a commit took.
    pub(super) fn learn_commit(&mut self, member_idx: usize, frame: &Frame, took_ns: f32) {
        let took_ns = took_ns.max(LEAST_NS);
        let shipped = prior::commit_ns(MEMBERS[member_idx], frame);
        self.commits[member_idx].learn(took_ns / shipped, took_ns);
    }
}

#[cfg(test)]
mod tests {
    use super::super::situation::RayClass;
    use super::*;
    use crate::packet::Question;

    fn situation(ray_count: usize, class: RayClass) -> Situation {
        let frame = Frame { prim_count: 1000, changed_count: 1000 };
        Situation { class, question: Question::Closest, ray_count, frame }
    }

    /// Has a member take `took_ns` as often as it takes to know it.
    fn learn(model: &mut CostModel, member_idx: usize, situation: &Situation, took_ns: f32) {
        (0..TRIALS).for_each(|_| model.learn(member_idx, situation, true, took_ns));
    }

    #[test]
    fn what_was_measured_counts_for_sizes_alike() {
        let mut model = CostModel::default();
        let here = situation(4096, RayClass::Unordered);
        learn(&mut model, 0, &here, 5e6);
        assert!((model.trace_ns(0, &here, true) / 5e6 - 1.0).abs() < 1e-6);
        let alike = model.trace_ns(0, &situation(6000, RayClass::Unordered), true);
        assert!((5e6..10e6).contains(&alike), "{alike}");
        let other = situation(4096, RayClass::SharedOrigin);
        let expected = OPTIMISM * prior::trace_ns(MEMBERS[0], &other, true);
        assert_eq!(model.trace_ns(0, &other, true), expected, "other rays, other costs");
    }

    #[test]
    fn what_is_easy_for_one_is_expected_to_be_so_for_others() {
        let mut model = CostModel::default();
        let here = situation(4096, RayClass::SharedOrigin);
        let shipped = |member_idx: usize| prior::trace_ns(MEMBERS[member_idx], &here, true);
        learn(&mut model, 0, &here, 0.25 * shipped(0));
        let expected = model.trace_ns(1, &here, true);
        assert!((expected / (OPTIMISM * 0.25 * shipped(1)) - 1.0).abs() < 1e-5);
        learn(&mut model, 1, &here, 2.0 * shipped(1));
        let known = model.trace_ns(1, &here, true);
        assert!((known / (2.0 * shipped(1)) - 1.0).abs() < 1e-5, "what was measured counts");
    }

    #[test]
    fn a_coarse_clock_does_no_harm() {
        let mut model = CostModel::default();
        let here = situation(4096, RayClass::SharedOrigin);
        learn(&mut model, 0, &here, 0.0);
        learn(&mut model, 1, &here, 0.0);
        for member_idx in 0..MEMBERS.len() {
            let expected = model.trace_ns(member_idx, &here, false);
            assert!(expected > 0.0 && expected.is_finite(), "{member_idx}: {expected}");
        }
    }

    #[test]
    fn a_slow_start_is_not_held_against_anyone() {
        let mut model = CostModel::default();
        let here = situation(4096, RayClass::Unordered);
        let before = model.trace_ns(0, &here, true);
        model.learn(0, &here, true, 4e6);
        assert_eq!(model.trace_ns(0, &here, true), before, "it is tried again");
        (1..TRIALS).for_each(|_| model.learn(0, &here, true, 2e6));
        assert!((model.trace_ns(0, &here, true) / 2e6 - 1.0).abs() < 1e-6);
    }

    #[test]
    fn one_bad_moment_moves_little_and_is_forgotten() {
        let mut model = CostModel::default();
        let here = situation(4096, RayClass::Unordered);
        learn(&mut model, 0, &here, 1e6);
        model.learn(0, &here, true, 1e9);
        assert!(model.trace_ns(0, &here, true) < 1.5e6);
        for _ in 0..400 {
            model.learn(1, &here, true, 1.2e6);
        }
        assert!(model.trace_ns(0, &here, true) < 1e6, "another try must come");
    }

    #[test]
    fn a_lasting_change_is_learnt() {
        let mut model = CostModel::default();
        let here = situation(4096, RayClass::Ordered);
        learn(&mut model, 0, &here, 1e6);
        (0..20).for_each(|_| model.learn(0, &here, true, 3e6));
        assert!((model.trace_ns(0, &here, true) / 3e6 - 1.0).abs() < 0.1);
    }
}
