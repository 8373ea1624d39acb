//! Who is right where two engines disagree.
//!
//! The oracle says for each primitive whether a ray certainly hits it, certainly misses it, or
//! passes so near its edge that rounding decides, and where. An answer is right when
//!
//! - it hits at a `t` that some primitive allows, give or take the tolerance of the comparison,
//!   and no certain hit lies nearer than that;
//! - it misses, or says that nothing is in the way, and no hit is certain;
//! - it says that something is in the way, and something may be.
//!
//! **Cost**: the oracle looks at every primitive, some 100 ns each. So it is only shown those
//! triangles whose bounding spheres the ray touches, with more room than the oracle's own slack.

use rayflock::geom::{Geometry, GeometryObject, Mesh, Ray};
use rayflock::prelude::Vec3;
use rayflock_oracle::{Candidate, Oracle, Verdict};
use rayon::prelude::*;

use super::compare::{Answer, Mismatch, diagonal, t_tolerance};
use crate::record::Judged;

/// By which part of a triangle's distance from the origin of the ray its bounding sphere is
/// enlarged; the oracle moves vertices by a tenth of that.
const ROOM: f64 = 1e-5;

/// Decides about `mismatches` of rays in `geometry`.
pub(super) fn judge(mismatches: &[Mismatch], geometry: &Geometry) -> Judged {
    let diagonal = diagonal(geometry);
    let verdicts: Vec<[bool; 2]> = mismatches
        .par_iter()
        .map(|mismatch| {
            let candidates = candidates(&mismatch.ray, geometry);
            [mismatch.this, mismatch.reference]
                .map(|answer| is_right(answer, &mismatch.ray, &candidates, diagonal))
        })
        .collect();
    let count = |wanted| verdicts.iter().filter(|&&verdict| verdict == wanted).count() as u64;
    Judged {
        rays: verdicts.len() as u64,
        both_right: count([true, true]),
        only_this: count([true, false]),
        only_reference: count([false, true]),
        neither: count([false, false]),
    }
}

fn is_right(answer: Answer, ray: &Ray, candidates: &[Candidate], diagonal: f64) -> bool {
    let certain = candidates.iter().filter(|found| found.verdict == Verdict::CertainHit);
    let nearest = certain.map(|found| found.t.hi).min_by(f64::total_cmp);
    match answer {
        Answer::Miss | Answer::Free => nearest.is_none(),
        Answer::Occluded => !candidates.is_empty(),
        Answer::Hit(t) => {
            let t = f64::from(t);
            let slack = t_tolerance(t, ray, diagonal);
            let is_there = |found: &Candidate| found.t.lo - slack <= t && t <= found.t.hi + slack;
            candidates.iter().any(is_there) && nearest.is_none_or(|nearest| t <= nearest + slack)
        }
    }
}

/// What the oracle finds. Ids of triangles are not those of `geometry`.
fn candidates(ray: &Ray, geometry: &Geometry) -> Vec<Candidate> {
    let nearby = geometry.objects().iter().map(|object| near(object, ray)).collect();
    let Ok(nearby) = Geometry::new(nearby) else {
        unreachable!("fewer primitives under the same ids and transforms")
    };
    Oracle::new(&nearby).candidates(ray)
}

/// The object without triangles that are far from the ray.
fn near(object: &GeometryObject, ray: &Ray) -> GeometryObject {
    let mesh = &object.shape;
    let is_near = |&idx: &usize| {
        let corners = mesh.corners(idx).map(|corner| match &object.world_from_object {
            Some(transform) => rayflock::geom::transform_point(transform, corner),
            None => corner,
        });
        touches(ray, corners)
    };
    let kept: Vec<[Vec3; 3]> = (0..mesh.triangles().len())
        .into_par_iter()
        .filter(is_near)
        .map(|idx| mesh.corners(idx))
        .collect();
    let indices: Vec<_> =
        (0..kept.len() as u32).map(|idx| [3 * idx, 3 * idx + 1, 3 * idx + 2]).collect();
    let Ok(mut shape) = Mesh::from_triangles(kept.into_flattened(), indices) else {
        unreachable!("three vertices a triangle")
    };
    if !mesh.spheres().is_empty() {
        shape = shape.with_spheres(mesh.spheres().to_vec());
    }
    if let Some(user) = mesh.user() {
        shape = shape.with_user(user.clone());
    }
    GeometryObject { shape: shape.into(), ..object.clone() }
}

/// Whether the line of the ray may touch a triangle; also where a coordinate is not finite.
fn touches(ray: &Ray, corners: [Vec3; 3]) -> bool {
    let corners = corners.map(|corner| corner.as_dvec3() - ray.origin.as_dvec3());
    let center = (corners[0] + corners[1] + corners[2]) / 3.0;
    let radius = corners.map(|corner| corner.distance(center)).into_iter().fold(0.0, f64::max);
    let along = ray.direction.as_dvec3().normalize();
    let beside = center - along * center.dot(along);
    let reach = radius + ROOM * (center.length() + radius);
    beside.length_squared() <= reach * reach || !reach.is_finite()
}
