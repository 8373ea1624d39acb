//! The paper's scheme: threads trace rays in the order of the picture, alternate rows each; a ray
//! that wants a subfield which is out of date brings it up to date under its lock, and rays of
//! other threads that want the same one wait.
//!
//! Kept to be compared with. A thread that builds must not take up other work meanwhile, which
//! might want the lock that it holds: it builds alone, in one piece.

use rayflock_geom::simd::{LANES, Simd, dispatch};
use rayflock_geom::{RayOrder, RayState};
use rayon::prelude::*;
use tracing::debug_span;
use web_time::Instant;

use super::Policy;
use crate::TraceStats;
use crate::primitives::PrimitiveTable;
use crate::subfields::asked::{Asked, RayList};
use crate::subfields::config::Config;
use crate::subfields::direction_set::DirectionSet;
use crate::subfields::fields::Fields;
use crate::subfields::hand_over::HandOver;
use crate::subfields::ray_group::RayGroup;
use crate::subfields::store::{Builder, Contents};
use crate::subfields::subfield::Subfield;
use crate::subfields::trace_walking::{finish, load, walk};

pub(super) struct Locked;

/// Rays of a row where the batch is not a picture.
const ROW_LEN: usize = 512;

/// What the threads share.
struct Shared<'a> {
    config: &'a Config,
    held: &'a PrimitiveTable,
    asked: &'a Asked<'a>,
    rays: RayList<'a>,
    contents: &'a Contents,
    builder: Builder<'a>,
    set: &'a DirectionSet,
    subfields: Vec<HandOver<&'a mut Subfield>>,
    /// For each direction of the set, which of the subfields is its own.
    places: &'a [usize],
}

impl Policy for Locked {
    fn begin_frame(&self, _: &mut Fields, _: &PrimitiveTable) {}

    fn trace(
        &self,
        fields: &mut Fields,
        held: &PrimitiveTable,
        asked: &Asked<'_>,
        rays: RayList<'_>,
    ) -> TraceStats {
        fields.choose_set(rays.len());
        let _span = debug_span!("trace_locked").entered();
        let Fields { config, contents, store, sorter, groups, places, .. } = fields;
        let Some(set) = sorter.set() else { return TraceStats::default() };
        store.hold(config, held, contents, set.directions(), places);
        let (subfields, builder) = store.share();
        let subfields = subfields.map(HandOver::new).collect();
        let shared =
            Shared { config, held, asked, rays, contents, builder, set, subfields, places };

        let thread_count = rayon::current_num_threads();
        let threads = (0..thread_count).into_par_iter().with_max_len(1);
        let counted = threads.map(|thread_idx| {
            let mut group = groups.take();
            group.stats = TraceStats::default();
            dispatch!(config.simd.level(), simd => {
                shared.trace_rows(simd, &mut group, thread_idx, thread_count);
            });
            let stats = group.stats;
            groups.give_back(group);
            stats
        });
        let mut stats = counted.reduce(TraceStats::default, |a, b| a + b);
        stats.rays = rays.len() as u64;
        stats.update_ns /= thread_count as u64;
        stats
    }
}

impl Shared<'_> {
    /// Answers the rays of every `thread_count`th row from row `thread_idx` on.
    #[inline(always)]
    fn trace_rows<S: Simd>(
        &self,
        simd: S,
        group: &mut RayGroup,
        thread_idx: usize,
        thread_count: usize,
    ) {
        let row_len = match self.asked.batch.order() {
            RayOrder::Image { width, .. } => width.max(1),
            _ => ROW_LEN,
        };
        let ray_count = self.rays.len();
        // A row may be said to be longer than the batch.
        let row_len = row_len.min(ray_count);
        for start in (thread_idx * row_len..ray_count).step_by(thread_count * row_len) {
            let row = start..(start + row_len).min(ray_count);
            for first in row.clone().step_by(LANES) {
                let group_rays = first..(first + LANES).min(row.end);
                self.trace_group(simd, group, group_rays.map(|idx| self.rays.get(idx)));
            }
        }
    }

    /// Answers up to sixteen rays.
    #[inline(always)]
    fn trace_group<S: Simd>(
        &self,
        simd: S,
        group: &mut RayGroup,
        rays: impl Iterator<Item = usize>,
    ) {
        group.clear();
        for (lane, ray_idx) in rays.enumerate() {
            let ray = self.asked.batch.ray(ray_idx);
            match ray.state() {
                RayState::Active => {}
                state => {
                    group.stats.invalid_rays += u64::from(state == RayState::Invalid);
                    self.asked.answers.set_none(ray_idx);
                    continue;
                }
            }
            group.ray_idx[lane] = ray_idx;
            let direction = self.asked.ray_in_grids(&ray).direction;
            let place = self.places[self.set.nearest(direction)];
            let mut update_ns = 0;
            self.subfields[place].with(
                |subfield| subfield.is_current(self.contents),
                |subfield| update_ns = self.update(subfield),
                |subfield| {
                    let line = load(self.asked, subfield, group, lane);
                    walk(simd, self.asked, subfield, &line, lane, group);
                    group.note_others(subfield.everywhere());
                },
            );
            group.stats.update_ns += update_ns;
        }
        finish(simd, self.asked, group);
    }

    /// Brings a subfield up to date; returns the nanoseconds that it took.
    fn update(&self, subfield: &mut Subfield) -> u64 {
        let start = Instant::now();
        self.builder.update(self.config, self.held, self.contents, subfield, 1);
        start.elapsed().as_nanos() as u64
    }
}
