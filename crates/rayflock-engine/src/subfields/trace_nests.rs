//! Sends the rays of a batch that come near nested objects through their subfields.
//!
//! ```text
//!   touch   for each ray, which of sixteen spheres around objects it may touch before its hit
//!   list    the rays of one object
//!   trace   as through any subfields; what is nearer than what was found before is kept
//! ```
//!
//! Rays that share a direction share one in object space too. Where the batch of the frame before
//! had the same one there, as where the object goes without turning, a subfield is written for
//! exactly that; elsewhere a set of directions is asked, whose subfields last.

use glam::Vec3;
use rayflock_geom::simd::cone_sphere::{Reach, SphereBlock, touches};
use rayflock_geom::simd::{LANES, Simd, SimdMask, dispatch};
use rayflock_geom::{Ray, RayState, SphereCone};
use rayon::prelude::*;
use tracing::debug_span;

use super::asked::{Asked, RayList};
use super::fields::RAYS_PER_TASK;
use super::nest_place::NestPlace;
use super::nests::{Nest, Nests};
use super::policy::Policy;
use crate::TraceStats;
use crate::packet::{Question, direction_length, far_distance, unit_direction};

/// Every place of a block.
const ALL: u16 = u16::MAX;

/// Traces through nested objects; memory is kept.
#[derive(Debug, Default)]
pub(super) struct NestTracer {
    /// For each ray, which of sixteen places it may touch, one bit each.
    touched: Vec<u16>,
    /// The rays of one place.
    ray_idx: Vec<u32>,
}

impl NestTracer {
    /// Brings the answers of a batch nearer, by what is in the nests. `shared` is the direction that
    /// all rays share, if they do.
    pub(super) fn trace(
        &mut self,
        nests: &mut Nests,
        policy: &dyn Policy,
        asked: &Asked<'_>,
        shared: Option<Vec3>,
    ) -> TraceStats {
        let _span = debug_span!("trace_nests").entered();
        let (nests, bounds) = nests.parts();
        let mut stats = TraceStats::default();
        let mut place_idx = 0;
        for nest in nests {
            let places = std::mem::take(&mut nest.places);
            for place in &places {
                if place_idx % LANES == 0 {
                    self.touch(nest, asked, &bounds[place_idx / LANES]);
                }
                self.list(asked, place, place_idx % LANES);
                stats += trace_place(nest, place, policy, asked, &self.ray_idx, shared);
                place_idx += 1;
            }
            nest.places = places;
        }
        stats
    }

    /// Finds which of sixteen places each ray may touch.
    fn touch(&mut self, nest: &Nest, asked: &Asked<'_>, bounds: &SphereBlock) {
        let level = nest.fields.config.simd.level();
        self.touched.resize(asked.batch.len(), 0);
        let tasks = self.touched.par_chunks_mut(RAYS_PER_TASK).enumerate();
        tasks.for_each(|(task_idx, touched)| {
            let first_ray = task_idx * RAYS_PER_TASK;
            dispatch!(level, simd => touch_part(simd, asked, bounds, first_ray, touched));
        });
    }

    /// Lists the rays that may touch a place.
    fn list(&mut self, asked: &Asked<'_>, place: &NestPlace, lane: usize) {
        let wants_more = |ray_idx: usize| match asked.question {
            Question::Closest => true,
            Question::Occluded => !asked.answers.is_occluded(ray_idx),
        };
        let touched = self.touched.par_iter().with_min_len(RAYS_PER_TASK).enumerate();
        let touched = touched.filter(|&(ray_idx, touched)| {
            touched & (1 << lane) != 0
                && wants_more(ray_idx)
                && asked.batch.ray(ray_idx).mask & place.mask != 0
        });
        self.ray_idx.clear();
        self.ray_idx.par_extend(touched.map(|(ray_idx, _)| ray_idx as u32));
    }

    /// Bytes held.
    pub(super) fn memory_usage(&self) -> usize {
        2 * self.touched.capacity() + 4 * self.ray_idx.capacity()
    }
}

/// Finds which of sixteen spheres consecutive rays may touch.
#[inline(always)]
fn touch_part<S: Simd>(
    simd: S,
    asked: &Asked<'_>,
    bounds: &SphereBlock,
    first_ray: usize,
    touched: &mut [u16],
) {
    let spheres = bounds.load(simd);
    for (ray_idx, touched) in (first_ray..).zip(touched) {
        let ray = asked.batch.ray(ray_idx);
        let found = match asked.question {
            Question::Closest => asked.answers.nearest(ray_idx).t,
            Question::Occluded => f32::INFINITY,
        };
        let t_max = ray.t_max.min(asked.t_bound(ray_idx)).min(found);
        let ray = Ray { t_max, ..ray };
        *touched = match ray.state() {
            RayState::Active if ray.t_min >= 0.0 => {
                let far = far_distance(ray.t_min, t_max, direction_length(&ray));
                let cone = SphereCone::around_ray(ray.origin, unit_direction(&ray));
                let reach = Reach { near: 0.0, far };
                let (near, _) = touches(simd, &cone, reach, asked.table.slack(), &spheres);
                near.to_bitmask() as u16
            }
            RayState::Active => ALL,
            RayState::Inactive | RayState::Invalid => 0,
        };
    }
}

/// Traces some rays through the subfields of an object at one place.
fn trace_place(
    nest: &mut Nest,
    place: &NestPlace,
    policy: &dyn Policy,
    asked: &Asked<'_>,
    ray_idx: &[u32],
    shared: Option<Vec3>,
) -> TraceStats {
    if ray_idx.is_empty() {
        return TraceStats::default();
    }
    let along = shared.map(|direction| place.direction_in_object(direction));
    let is_held = along.is_some_and(|along| nest.notes_direction(along));
    let Nest { table, fields, loose, .. } = nest;
    let asked = Asked { place: Some(place), everywhere: loose, ..*asked };
    let rays = RayList::Some(ray_idx);
    let traced = match along.filter(|_| is_held) {
        Some(along) => fields.trace_along(table, &asked, rays, along),
        None => policy.trace(fields, table, &asked, rays),
    };
    // The batch was counted when it met the scene.
    TraceStats { rays: 0, invalid_rays: 0, ..traced }
}
