//! Whether an engine's answer is acceptable.

use rayflock_geom::{Hit, Ray, RayState};
use thiserror::Error;

use super::candidate::{Candidate, TRange, Verdict};
use super::ray::OracleRay;
use super::{Oracle, Shape};

/// Why an answer is wrong.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum Fault {
    /// A ray that can hit nothing hit something.
    #[error("the ray is {state:?}, yet it hit {hit:?}")]
    NotTraced {
        /// Why it can hit nothing.
        state: RayState,
        /// What was reported.
        hit: Hit,
    },
    /// A certain hit was overlooked.
    #[error("missed {overlooked:?}; found {hit:?}")]
    Beaten {
        /// The hit that is certain and nearer.
        overlooked: Candidate,
        /// What was reported.
        hit: Hit,
    },
    /// The primitive is not there, masked, ignored, or the ray certainly passes it by.
    #[error("{hit:?} is not even borderline")]
    NotAHit {
        /// What was reported.
        hit: Hit,
    },
    /// The primitive is hit, but somewhere else.
    #[error("{hit:?} should lie at {expected:?}")]
    WrongT {
        /// What was reported.
        hit: Hit,
        /// What is allowed.
        expected: TRange,
    },
    /// The hit lies outside the closed interval of the ray.
    #[error("{hit:?} lies outside {t_min}..={t_max}")]
    OutsideInterval {
        /// What was reported.
        hit: Hit,
        /// Smallest allowed `t`.
        t_min: f32,
        /// Largest allowed `t`.
        t_max: f32,
    },
    /// The barycentric coordinates name a point that is not on the ray, or not in the triangle.
    #[error(
        "the coordinates of {hit:?} name a point {beside:e} beside the ray, where {tolerance:e} \
         is allowed, at t = {depth:e}"
    )]
    WrongPoint {
        /// What was reported.
        hit: Hit,
        /// Distance of that point from the ray.
        beside: f64,
        /// Largest allowed distance.
        tolerance: f64,
        /// The `t` of that point.
        depth: f64,
    },
}

impl Oracle {
    /// Decides whether `hit` is an acceptable closest hit of `ray`.
    ///
    /// # Errors
    /// [`Fault`] says why it is not.
    pub fn judge(&self, ray: &Ray, hit: &Hit) -> Result<(), Fault> {
        let hit = *hit;
        let state = ray.state();
        if state != RayState::Active {
            return if hit.is_miss() { Ok(()) } else { Err(Fault::NotTraced { state, hit }) };
        }
        let candidates = self.candidates(ray);
        if let Some(overlooked) = overlooked(&candidates, &hit) {
            return Err(Fault::Beaten { overlooked, hit });
        }
        if hit.is_miss() { Ok(()) } else { self.judge_hit(ray, &hit, &candidates) }
    }

    fn judge_hit(&self, ray: &Ray, hit: &Hit, candidates: &[Candidate]) -> Result<(), Fault> {
        let hit = *hit;
        if !(ray.t_min..=ray.t_max).contains(&hit.t) {
            return Err(Fault::OutsideInterval { hit, t_min: ray.t_min, t_max: ray.t_max });
        }
        let mut same = candidates
            .iter()
            .filter(|found| (found.object_id, found.prim_id) == (hit.object_id, hit.prim_id))
            .peekable();
        let Some(first) = same.peek() else { return Err(Fault::NotAHit { hit }) };
        let expected = first.t;
        let Some(found) = same.find(|found| found.t.holds(hit.t)) else {
            return Err(Fault::WrongT { hit, expected });
        };
        self.judge_point(ray, &hit, found)
    }

    fn judge_point(&self, ray: &Ray, hit: &Hit, found: &Candidate) -> Result<(), Fault> {
        let prim = self.primitive(found.object_id, found.prim_id);
        let Some(Shape::Triangle(triangle)) = prim.map(|prim| &prim.shape) else {
            return Ok(());
        };
        let point = triangle.named_point(&OracleRay::new(ray), hit.u, hit.v);
        let (beside, tolerance) = (point.beside, point.beside_tolerance);
        let deep = found.t.widened(point.depth_tolerance);
        let inside = hit.u >= 0.0 && hit.v >= 0.0 && hit.u + hit.v <= 1.0 + f32::EPSILON;
        if inside && beside <= tolerance && (deep.lo..=deep.hi).contains(&point.depth) {
            Ok(())
        } else {
            Err(Fault::WrongPoint { hit: *hit, beside, tolerance, depth: point.depth })
        }
    }
}

/// The nearest of the certain hits that `hit` is behind.
fn overlooked(candidates: &[Candidate], hit: &Hit) -> Option<Candidate> {
    let certain = candidates.iter().filter(|found| found.verdict == Verdict::CertainHit);
    let nearest = certain.min_by(|a, b| a.t.hi.total_cmp(&b.t.hi))?;
    (hit.is_miss() || f64::from(hit.t) > nearest.t.hi).then_some(*nearest)
}
