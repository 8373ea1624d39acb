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
        let asked: Vec<Option<f32>> =
            rays_nearby(object_from_world, ray).map(|ray| self.ask(&ray)).collect();
        let found: Vec<f64> = asked.iter().flatten().map(|&t| f64::from(t)).collect();
        let lo = found.iter().copied().reduce(f64::min)?;
        let hi = found.iter().copied().fold(lo, f64::max);
        let slack = (hi - lo) + RELATIVE_SLACK * lo.abs().max(hi.abs()) + ABSOLUTE_SLACK;
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

/// The ray in object space, then the same moved by what `f32` may do to it.
fn rays_nearby(object_from_world: &DAffine3, ray: &OracleRay) -> impl Iterator<Item = Ray> + use<> {
    let like = ray.single;
    let matrix = object_from_world.matrix3;
    let origin = object_from_world.transform_point3(ray.org);
    let direction = matrix * ray.dir;
    let sizes = DMat3::from_cols(matrix.x_axis.abs(), matrix.y_axis.abs(), matrix.z_axis.abs());
    let origin_slack =
        RELATIVE_SLACK * (sizes * ray.org.abs() + object_from_world.translation.abs());
    let direction_slack = RELATIVE_SLACK * (sizes * ray.dir.abs());
    let moves = (0..3)
        .flat_map(|axis| [DVec3::AXES[axis], -DVec3::AXES[axis]].map(|step| (step, DVec3::ZERO)));
    let turns = (0..3)
        .flat_map(|axis| [DVec3::AXES[axis], -DVec3::AXES[axis]].map(|step| (DVec3::ZERO, step)));
    std::iter::once((DVec3::ZERO, DVec3::ZERO)).chain(moves).chain(turns).map(
        move |(step, turn)| Ray {
            origin: (origin + step * origin_slack).as_vec3(),
            direction: (direction + turn * direction_slack).as_vec3(),
            ..like
        },
    )
}
