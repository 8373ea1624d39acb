//! Whether a ray passes through a sphere whose centre may be moved a little.

use glam::DVec3;

use super::candidate::{Crossing, TRange, Verdict};
use super::ray::OracleRay;
use super::{ABSOLUTE_SLACK, OVERFLOW, RELATIVE_SLACK};

/// A sphere in world space.
#[derive(Clone, Copy, Debug)]
pub(super) struct OracleSphere {
    pub(super) center: DVec3,
    pub(super) radius: f64,
    /// How far rounding of the object's transform may have moved the surface.
    pub(super) slack: f64,
}

impl OracleSphere {
    /// Up to two crossings: the far one counts where the near one may lie before the interval.
    pub(super) fn meet(&self, ray: &OracleRay) -> [Option<Crossing>; 2] {
        let offset = self.center - ray.org;
        let speed = ray.dir.length();
        let middle = offset.dot(ray.dir / speed);
        let beside = (offset - middle * (ray.dir / speed)).length();
        let slack = RELATIVE_SLACK * (offset.length() + self.radius) + self.slack + ABSOLUTE_SLACK;
        if beside > self.radius + slack {
            return [None, None];
        }
        let surely = beside < self.radius - slack && offset.length() < OVERFLOW;
        let sure = if surely { Verdict::CertainHit } else { Verdict::Borderline };
        let half = |radius: f64| (radius * radius - beside * beside).max(0.0).sqrt();
        let (shortest, longest) = (half((self.radius - slack).max(0.0)), half(self.radius + slack));
        let range = |lo: f64, hi: f64| {
            let size = lo.abs().max(hi.abs());
            TRange { lo: lo / speed, hi: hi / speed }
                .widened((slack + RELATIVE_SLACK * size) / speed + ABSOLUTE_SLACK)
        };
        let near = range(middle - longest, middle - shortest);
        let far = range(middle + shortest, middle + longest);
        match near.verdict_within(ray) {
            Verdict::CertainHit => [Some(Crossing { verdict: sure, t: near }), None],
            Verdict::Borderline => {
                let near = Crossing { verdict: Verdict::Borderline, t: near };
                [Some(near), far_crossing(far, sure, ray)]
            }
            Verdict::CertainMiss => [None, far_crossing(far, sure, ray)],
        }
    }
}

fn far_crossing(t: TRange, sure: Verdict, ray: &OracleRay) -> Option<Crossing> {
    match t.verdict_within(ray).min(sure) {
        Verdict::CertainMiss => None,
        verdict => Some(Crossing { verdict, t }),
    }
}
