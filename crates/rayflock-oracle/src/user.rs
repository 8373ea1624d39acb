//! Whether a ray passes through a user primitive.
//!
//! Only the primitive itself knows its shape, so the oracle asks it. In world space the answer
//! is taken as it is. Under a transform the ray reaches object space rounded; the oracle asks
//! for the ray and for rays moved a little along each axis, and is certain where all agree.

use std::sync::Arc;

use glam::{DAffine3, DMat3, DVec3};
use rayflock_geom::{Ray, UserPrimitives};

use super::candidate::{Crossing, TRange, Verdict};
use super::ray::OracleRay;
use super::{ABSOLUTE_SLACK, RELATIVE_SLACK};

/// Transforms that stretch some lengths this many times more than others flatten a primitive so
/// much that rounding decides what is hit.
const WORST_CONDITION: f64 = 1e4;

/// Rays moved by more than this part of a primitive's bound may all step over it.
const LARGEST_MOVE: f64 = 0.02;

/// A user primitive, with the transform that takes rays to it.
#[derive(Clone, Debug)]
pub(super) struct UserPrimitive {
    pub(super) prims: Arc<dyn UserPrimitives>,
    pub(super) prim_idx: usize,
    pub(super) object_from_world: Option<DAffine3>,
}

impl UserPrimitive {
    pub(super) fn meet(&self, ray: &OracleRay) -> Option<Crossing> {
        let Some(object_from_world) = &self.object_from_world else {
            let t = f64::from(self.ask(&ray.single)?);
            return Some(Crossing { verdict: Verdict::CertainHit, t: TRange { lo: t, hi: t } });
        };
        let nearby = Nearby::new(object_from_world, ray);
        let radius = f64::from(self.prims.bounding_sphere(self.prim_idx).radius);
        let coarse = nearby.origin_slack.length() > LARGEST_MOVE * radius;
        if coarse || condition(object_from_world) > WORST_CONDITION {
            let t = TRange { lo: f64::NEG_INFINITY, hi: f64::INFINITY };
            return Some(Crossing { verdict: Verdict::Borderline, t });
        }
        let asked: Vec<Option<f32>> = nearby.rays(&ray.single).map(|ray| self.ask(&ray)).collect();
        let found: Vec<f64> = asked.iter().flatten().map(|&t| f64::from(t)).collect();
        let lo = found.iter().copied().reduce(f64::min)?;
        let hi = found.iter().copied().fold(lo, f64::max);
        let relative = RELATIVE_SLACK * lo.abs().max(hi.abs()) + ABSOLUTE_SLACK;
        let slack = (hi - lo) + relative + nearby.t_slack();
        let t = TRange { lo, hi }.widened(slack);
        let sure = found.len() == asked.len();
        let shape = if sure { Verdict::CertainHit } else { Verdict::Borderline };
        match shape.min(t.verdict_within(ray)) {
            Verdict::CertainMiss => None,
            verdict => Some(Crossing { verdict, t }),
        }
    }

    fn ask(&self, ray: &Ray) -> Option<f32> {
        let mut hits = [None];
        self.prims.intersect(self.prim_idx, &[*ray], &mut hits);
        hits[0].map(|hit| hit.t)
    }
}

/// How much more a transform stretches some lengths than others, at most.
fn condition(object_from_world: &DAffine3) -> f64 {
    let size = |m: &DMat3| m.to_cols_array().iter().map(|entry| entry * entry).sum::<f64>().sqrt();
    let matrix = object_from_world.matrix3;
    size(&matrix) * size(&matrix.inverse())
}

/// A ray in object space, and what `f32` may do to it on its way there.
struct Nearby {
    origin: DVec3,
    direction: DVec3,
    origin_slack: DVec3,
    direction_slack: DVec3,
}

impl Nearby {
    fn new(object_from_world: &DAffine3, ray: &OracleRay) -> Self {
        let matrix = object_from_world.matrix3;
        let columns = [matrix.x_axis, matrix.y_axis, matrix.z_axis].map(DVec3::abs);
        let sizes = DMat3::from_cols(columns[0], columns[1], columns[2]);
        let shift = object_from_world.translation.abs();
        Self {
            origin: object_from_world.transform_point3(ray.org),
            direction: matrix * ray.dir,
            origin_slack: RELATIVE_SLACK * (sizes * ray.org.abs() + shift),
            direction_slack: RELATIVE_SLACK * (sizes * ray.dir.abs()),
        }
    }

    /// The ray, then the same moved and turned along each axis and diagonal.
    fn rays(&self, like: &Ray) -> impl Iterator<Item = Ray> {
        let axes = DVec3::AXES.into_iter().flat_map(|axis| [axis, -axis]);
        let sign = |bits: u8, axis: u8| if bits & (1 << axis) == 0 { 1.0 } else { -1.0 };
        let diagonal = move |bits| DVec3::new(sign(bits, 0), sign(bits, 1), sign(bits, 2));
        let steps = axes.chain((0..8).map(diagonal));
        let moves = steps.clone().map(|step| (step, DVec3::ZERO));
        let turns = steps.map(|step| (DVec3::ZERO, step));
        let all = std::iter::once((DVec3::ZERO, DVec3::ZERO)).chain(moves).chain(turns);
        all.map(|(step, turn)| Ray {
            origin: (self.origin + step * self.origin_slack).as_vec3(),
            direction: (self.direction + turn * self.direction_slack).as_vec3(),
            ..*like
        })
    }

    /// What moving the origin along the ray does to `t`.
    fn t_slack(&self) -> f64 {
        2.0 * self.origin_slack.length() / self.direction.length()
    }
}
