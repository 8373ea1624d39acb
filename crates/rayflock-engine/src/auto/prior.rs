//! What each engine takes in a situation, as shipped: fitted to `rayflock bench map` on servers
//! with two AVX-512 cores.
//!
//! Only ratios between engines matter where nothing was measured yet; what the machine at hand
//! really takes is learnt by the [cost model](super::cost_model).

use super::situation::{Frame, RayClass, Situation, log2};
use crate::EngineKind;

/// Nanoseconds, by what they grow with.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Coefficients {
    /// Whatever there is.
    fixed: f32,
    /// A primitive.
    prim: f32,
    /// A primitive near a ray: eight a ray at most.
    near_prim: f32,
    /// A primitive that changed, once a frame, when the first batch comes.
    fresh_prim: f32,
    /// A primitive that changed, whenever a batch comes: what is prepared serves that batch only.
    moved_prim: f32,
    /// A ray.
    ray: f32,
    /// A ray, for each doubling of the primitives from 1024 on.
    ray_level: f32,
    /// A ray and a primitive.
    test: f32,
}

const NOTHING: Coefficients = Coefficients {
    fixed: 0.0,
    prim: 0.0,
    near_prim: 0.0,
    fresh_prim: 0.0,
    moved_prim: 0.0,
    ray: 0.0,
    ray_level: 0.0,
    test: 0.0,
};

/// Nanoseconds that no engine takes.
const NEVER: f32 = 1e15;

/// Nanoseconds of tracing a batch, `is_fresh` when it is the first after a commit.
pub(super) fn trace_ns(kind: EngineKind, situation: &Situation, is_fresh: bool) -> f32 {
    let costs = coefficients(kind, situation.class);
    let (rays, prims) = (situation.ray_count as f32, situation.frame.prim_count as f32);
    let moved = situation.frame.changed_count as f32;
    let fresh = if is_fresh { moved } else { 0.0 };
    let levels = log2(situation.frame.prim_count).saturating_sub(10) as f32;
    costs.fixed
        + costs.prim * prims
        + costs.near_prim * prims.min(8.0 * rays)
        + costs.fresh_prim * fresh
        + costs.moved_prim * moved
        + rays * (costs.ray + costs.ray_level * levels)
        + costs.test * rays * prims
}

/// Nanoseconds of a commit: some engines write a table then, others when a batch comes.
pub(super) fn commit_ns(kind: EngineKind, frame: &Frame) -> f32 {
    let changed = match kind {
        EngineKind::Brute | EngineKind::Subfields => 4.0,
        EngineKind::Hierarchy | EngineKind::Bvh | EngineKind::Auto => 0.0,
    };
    10_000.0 + changed * frame.changed_count as f32
}

fn coefficients(kind: EngineKind, class: RayClass) -> Coefficients {
    match kind {
        EngineKind::Brute => Coefficients { fixed: 5_000.0, test: 0.2, ..NOTHING },
        EngineKind::Bvh => of_bvh(class),
        EngineKind::Hierarchy => of_hierarchy(class),
        EngineKind::Subfields if class == RayClass::SharedDirection => Coefficients {
            fixed: 100_000.0,
            moved_prim: 45.0,
            ray: 15.0,
            ray_level: 6.0,
            ..NOTHING
        },
        EngineKind::Subfields if class == RayClass::SharedDirectionImage => Coefficients {
            fixed: 100_000.0,
            moved_prim: 45.0,
            ray: 38.0,
            ray_level: 1.0,
            ..NOTHING
        },
        // A subfield for each of many directions never pays.
        EngineKind::Subfields => Coefficients { fixed: NEVER, ..NOTHING },
        EngineKind::Auto => NOTHING,
    }
}

fn of_bvh(class: RayClass) -> Coefficients {
    let [near_prim, fresh_prim, ray, ray_level] = match class {
        RayClass::SharedOriginImage => [11.9, 16.5, 2.9, 3.4],
        RayClass::SharedOrigin => [7.1, 15.9, 0.0, 6.2],
        RayClass::SharedDirectionImage => [3.8, 16.6, 2.9, 2.4],
        RayClass::SharedDirection => [13.8, 14.7, 0.0, 5.2],
        RayClass::Ordered => [15.1, 15.3, 0.0, 8.2],
        RayClass::Unordered => [5.0, 15.3, 0.0, 16.4],
    };
    Coefficients { fixed: 20_000.0, near_prim, fresh_prim, ray, ray_level, ..NOTHING }
}

fn of_hierarchy(class: RayClass) -> Coefficients {
    let [fixed, prim, near_prim, ray, ray_level] = match class {
        RayClass::SharedOriginImage => [78_000.0, 3.0, 16.5, 0.0, 3.7],
        RayClass::SharedOrigin => [60_000.0, 11.8, 35.5, 13.7, 2.9],
        RayClass::SharedDirectionImage => [92_000.0, 3.2, 3.7, 3.8, 1.9],
        RayClass::SharedDirection => [168_000.0, 6.7, 24.4, 13.5, 3.2],
        RayClass::Ordered | RayClass::Unordered => {
            return Coefficients {
                fixed: 100_000.0,
                prim: 20.0,
                ray: 300.0,
                test: 0.15,
                ..NOTHING
            };
        }
    };
    Coefficients { fixed, prim, near_prim, ray, ray_level, ..NOTHING }
}
