//! What was chosen, and why.

use std::fmt;

use super::member::MEMBERS;
use super::situation::{RayClass, Situation};
use crate::EngineKind;
use crate::packet::Question;

/// What an engine is expected to take for a batch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Expectation {
    pub(super) kind: EngineKind,
    /// Nanoseconds, with what is still to be prepared.
    pub(super) ns: f32,
}

impl Default for Expectation {
    fn default() -> Self {
        Self { kind: MEMBERS[0], ns: 0.0 }
    }
}

/// The engine that was asked about one batch, and what the others were expected to take.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Choice {
    /// Who was asked.
    pub engine: EngineKind,
    /// What the rays share.
    pub class: RayClass,
    /// Rays in the batch.
    pub ray_count: usize,
    /// Primitives in the frame.
    pub prim_count: usize,
    /// Nanoseconds that tracing took.
    pub took_ns: f32,
    is_occlusion: bool,
    expected: [Expectation; MEMBERS.len()],
}

impl Choice {
    pub(super) fn new(
        situation: &Situation,
        member_idx: usize,
        expected: &[Expectation; MEMBERS.len()],
        took_ns: f32,
    ) -> Self {
        Self {
            engine: MEMBERS[member_idx],
            class: situation.class,
            ray_count: situation.ray_count,
            prim_count: situation.frame.prim_count,
            took_ns,
            is_occlusion: situation.question == Question::Occluded,
            expected: *expected,
        }
    }

    /// Nanoseconds that each engine was expected to take, with what it still had to prepare.
    pub fn expected_ns(&self) -> impl Iterator<Item = (EngineKind, f32)> + '_ {
        self.expected.iter().map(|expectation| (expectation.kind, expectation.ns))
    }
}

impl fmt::Display for Choice {
    /// `hierarchy for 65536 rays of an image from one point past 26336 primitives: took 1.92 ms
    /// (expected: hierarchy 2.0, brute 480)`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let rays = if self.is_occlusion { "shadow rays" } else { "rays" };
        let Self { engine, class, ray_count, prim_count, .. } = self;
        write!(f, "{engine} for {ray_count} {rays} {class} past {prim_count} primitives: ")?;
        write!(f, "took {:.3} ms (expected:", self.took_ns * 1e-6)?;
        for (idx, (kind, ns)) in self.expected_ns().enumerate() {
            let separator = if idx > 0 { "," } else { "" };
            write!(f, "{separator} {kind} {:.3}", ns * 1e-6)?;
        }
        f.write_str(")")
    }
}
