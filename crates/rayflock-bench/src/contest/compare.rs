//! Whether two engines answer alike.
//!
//! A ray is a mismatch when one engine hits something and the other nothing, or when both do and
//! their `t` differ by more than `1e-5` of the larger and the points by more than `1e-5` of the
//! diagonal of the scene. What was hit does not count where `t` agrees: at an edge, either side is
//! right. An occluded ray is a mismatch when the other engine says it is free.
//!
//! Engines of this project agree in every bit of `t`; where one does not agree with the first of
//! them, that is a mismatch too, however small.

use rayflock::geom::{Geometry, NO_ID, Ray};

use super::answers::Answers;
use crate::work::{Question, RaySet};

/// How far two answers may be apart: of the larger `t`, and of the diagonal of the scene.
pub(super) const TOLERANCE: f64 = 1e-5;

/// Mismatches of a phase that are shown to the oracle.
pub(super) const SHOWN_COUNT: usize = 32;

/// What one engine says about one ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Answer {
    /// The distance of the closest hit.
    Hit(f32),
    /// Nothing is hit.
    Miss,
    /// Something lies in the way.
    Occluded,
    /// Nothing does.
    Free,
}

/// A ray that two engines answer differently.
#[derive(Clone, Copy, Debug)]
pub(super) struct Mismatch {
    pub(super) ray: Ray,
    pub(super) this: Answer,
    pub(super) reference: Answer,
}

/// How the answers of two engines differ.
#[derive(Clone, Debug, Default)]
pub(super) struct Comparison {
    /// How many do.
    pub(super) mismatches: u64,
    /// The first ones.
    pub(super) shown: Vec<Mismatch>,
}

impl Answers {
    /// The answer about one ray.
    pub(super) fn get(&self, question: Question, ray_idx: usize) -> Answer {
        match question {
            Question::ClosestHit if self.hits.object_id[ray_idx] == NO_ID => Answer::Miss,
            Question::ClosestHit => Answer::Hit(self.hits.t[ray_idx]),
            Question::Occluded if self.occluded[ray_idx] => Answer::Occluded,
            Question::Occluded => Answer::Free,
        }
    }
}

/// Compares answers about the same rays: `this` with those of the `reference` within the
/// tolerance, and with those of the first of our engines, where there are any, to the bit.
pub(super) fn compare(
    rays: &RaySet,
    geometry: &Geometry,
    this: &Answers,
    reference: &Answers,
    first_own: Option<&Answers>,
) -> Comparison {
    let (question, diagonal) = (rays.question(), diagonal(geometry));
    let mut comparison = Comparison::default();
    let mut start = 0;
    for batch in rays.batches() {
        for ray_idx in 0..batch.len() {
            let get = |answers: &Answers| answers.get(question, start + ray_idx);
            let (answer, expected) = (get(this), get(reference));
            let agrees = agree(answer, expected, &|| batch.ray(ray_idx), diagonal)
                && first_own.is_none_or(|first| same_bits(answer, get(first)));
            if agrees {
                continue;
            }
            comparison.mismatches += 1;
            if comparison.shown.len() < SHOWN_COUNT {
                let ray = batch.ray(ray_idx);
                comparison.shown.push(Mismatch { ray, this: answer, reference: expected });
            }
        }
        start += batch.len();
    }
    comparison
}

/// The diagonal of the box around all geometry.
pub(super) fn diagonal(geometry: &Geometry) -> f64 {
    geometry.bounds().size().as_dvec3().length()
}

/// How far from `t` another answer may be, in multiples of the length of the ray's direction.
pub(super) fn t_tolerance(t: f64, ray: &Ray, diagonal: f64) -> f64 {
    TOLERANCE * t.abs().max(diagonal / ray.direction.as_dvec3().length())
}

fn agree(this: Answer, reference: Answer, ray: &dyn Fn() -> Ray, diagonal: f64) -> bool {
    let (Answer::Hit(this), Answer::Hit(reference)) = (this, reference) else {
        return this == reference;
    };
    if this == reference {
        return true;
    }
    let (this, reference) = (f64::from(this), f64::from(reference));
    let larger = this.abs().max(reference.abs());
    (this - reference).abs() <= t_tolerance(larger, &ray(), diagonal)
}

fn same_bits(this: Answer, first: Answer) -> bool {
    match (this, first) {
        (Answer::Hit(this), Answer::Hit(first)) => this.to_bits() == first.to_bits(),
        _ => this == first,
    }
}
