//! What the oracle says about one primitive and one ray.

use rayflock_geom::{ObjectId, PrimId};

use super::ray::OracleRay;

/// How sure the oracle is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Verdict {
    /// No rounding that an engine may commit makes this a hit.
    CertainMiss,
    /// So near an edge, a silhouette or an end of the interval that an engine may decide either
    /// way.
    Borderline,
    /// No rounding that an engine may commit makes this a miss.
    CertainHit,
}

/// The closed range of `t` that an engine may report, in multiples of the direction's length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TRange {
    /// Smallest `t`.
    pub lo: f64,
    /// Largest `t`.
    pub hi: f64,
}

impl TRange {
    /// Whether `t` is allowed.
    pub fn holds(&self, t: f32) -> bool {
        (self.lo..=self.hi).contains(&f64::from(t))
    }

    /// This range, longer by `slack` at both ends.
    pub(super) fn widened(self, slack: f64) -> Self {
        Self { lo: self.lo - slack, hi: self.hi + slack }
    }

    /// How this range lies to the interval of `ray`. A `t` past the largest `f32` cannot be
    /// reported, so it is never certain.
    pub(super) fn verdict_within(&self, ray: &OracleRay) -> Verdict {
        if self.hi < ray.t_min || self.lo > ray.t_max {
            Verdict::CertainMiss
        } else if ray.t_min <= self.lo && self.hi <= ray.t_max && self.hi <= f64::from(f32::MAX) {
            Verdict::CertainHit
        } else {
            Verdict::Borderline
        }
    }
}

/// One place where a ray meets a primitive, certainly or perhaps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Crossing {
    pub(super) verdict: Verdict,
    pub(super) t: TRange,
}

/// A hit that an engine must or may find.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Candidate {
    /// The object.
    pub object_id: ObjectId,
    /// The primitive in the object's mesh.
    pub prim_id: PrimId,
    /// [`Verdict::CertainHit`] or [`Verdict::Borderline`].
    pub verdict: Verdict,
    /// Where along the ray.
    pub t: TRange,
}
