//! The subfields that are held, by direction, within a budget of memory.

use glam::Vec3;
use rayon::prelude::*;
use tracing::debug_span;

use super::bin_triangles::{Projection, TileSettings};
use super::build_grid::{GridBuilder, MOST_TASKS};
use super::config::{Config, TileOrder};
use super::subfield::Subfield;
use crate::primitives::PrimitiveTable;
use crate::wanted::Wanted;

/// Tasks for each thread when one direction is built.
const TASKS_PER_THREAD: usize = 2;

/// Bytes that grids take for each primitive, about, as long as there are none to tell.
const BYTES_PER_PRIM: usize = 256;

/// What is in the grids of a frame.
#[derive(Debug, Default)]
pub(super) struct Contents {
    pub(super) kept: Wanted,
    pub(super) moving: Wanted,
    /// The frame in which `kept` became what it is.
    pub(super) kept_frame: u64,
    pub(super) frame: u64,
}

impl Contents {
    /// Number of primitives in the grids.
    pub(super) fn prim_count(&self) -> usize {
        self.kept.prim_count() + self.moving.prim_count()
    }

    /// Bytes held.
    pub(super) fn memory_usage(&self) -> usize {
        self.kept.memory_usage() + self.moving.memory_usage()
    }
}

/// Subfields. See the [module](self).
#[derive(Debug, Default)]
pub(super) struct SubfieldStore {
    subfields: Vec<Subfield>,
    builder: GridBuilder,
    /// Counts how often subfields were asked for.
    clock: u64,
}

impl SubfieldStore {
    /// Brings the subfields of some directions, all different, up to date; writes their positions,
    /// which hold until the next call.
    pub(super) fn prepare(
        &mut self,
        config: &Config,
        table: &PrimitiveTable,
        contents: &Contents,
        directions: &[Vec3],
        places: &mut Vec<usize>,
    ) {
        self.hold(config, table, contents, directions, places);
        let clock = self.clock;
        self.update(config, table, contents, |subfield| subfield.used == clock);
    }

    /// Brings all subfields that are held up to date.
    pub(super) fn refresh(&mut self, config: &Config, table: &PrimitiveTable, contents: &Contents) {
        self.update(config, table, contents, |_| true);
    }

    /// Makes sure that there are subfields for some directions, whatever is in them; writes their
    /// positions, which hold until the next call.
    pub(super) fn hold(
        &mut self,
        config: &Config,
        table: &PrimitiveTable,
        contents: &Contents,
        directions: &[Vec3],
        places: &mut Vec<usize>,
    ) {
        self.clock += 1;
        self.make_room(directions, self.bytes_each(contents), config.budget);
        places.clear();
        places.extend(directions.iter().map(|&direction| self.find(direction, table)));
    }

    /// Brings what is out of date among the chosen subfields up to date, in parallel.
    fn update(
        &mut self,
        config: &Config,
        table: &PrimitiveTable,
        contents: &Contents,
        is_chosen: impl Fn(&Subfield) -> bool + Sync,
    ) {
        let _span = debug_span!("update_subfields").entered();
        let is_stale = |subfield: &Subfield| is_chosen(subfield) && !subfield.is_current(contents);
        let stale_count = self.subfields.iter().filter(|one| is_stale(one)).count();
        let tasks = (TASKS_PER_THREAD * rayon::current_num_threads()).min(MOST_TASKS);
        let task_count = tasks.div_ceil(stale_count.max(1));
        let builder = Builder(&self.builder);
        let stale = self.subfields.par_iter_mut().filter(|one| is_stale(one));
        stale.for_each(|subfield| builder.update(config, table, contents, subfield, task_count));
    }

    /// All subfields, by position, and what brings each up to date.
    pub(super) fn share(&mut self) -> (impl Iterator<Item = &mut Subfield>, Builder<'_>) {
        (self.subfields.iter_mut(), Builder(&self.builder))
    }

    /// A subfield, by its position.
    pub(super) fn get(&self, place: usize) -> &Subfield {
        &self.subfields[place]
    }

    /// The position of a direction's subfield, which is made if there is none.
    fn find(&mut self, direction: Vec3, table: &PrimitiveTable) -> usize {
        let found = self.subfields.iter().position(|one| one.direction == direction);
        found.unwrap_or_else(|| {
            self.subfields.push(Subfield::new(direction, table.some_point(), self.clock));
            self.subfields.len() - 1
        })
    }

    /// Gives up what was not used for longest, until what is still to come, of so many bytes each,
    /// is within the budget too. What is asked for stays.
    fn make_room(&mut self, directions: &[Vec3], bytes_each: usize, budget: usize) {
        let mut missing = directions.len();
        for subfield in &mut self.subfields {
            if directions.contains(&subfield.direction) {
                subfield.used = self.clock;
                missing -= 1;
            }
        }
        let room = budget.saturating_sub(missing * bytes_each);
        let mut held = self.grid_bytes();
        while held > room {
            let unused =
                (0..self.subfields.len()).filter(|&idx| self.subfields[idx].used < self.clock);
            let Some(oldest) = unused.min_by_key(|&idx| self.subfields[idx].used) else { return };
            held -= self.subfields.swap_remove(oldest).memory_usage();
        }
    }

    /// Bytes that the subfield of one direction takes, about.
    pub(super) fn bytes_each(&self, contents: &Contents) -> usize {
        let held = self.grid_bytes() / self.subfields.len().max(1);
        held.max(BYTES_PER_PRIM * contents.prim_count().max(1))
    }

    /// Number of subfields held.
    pub(super) fn len(&self) -> usize {
        self.subfields.len()
    }

    /// Bytes of the subfields themselves.
    pub(super) fn grid_bytes(&self) -> usize {
        self.subfields.iter().map(Subfield::memory_usage).sum()
    }

    /// Bytes held.
    pub(super) fn memory_usage(&self) -> usize {
        self.grid_bytes() + self.builder.memory_usage()
    }
}

/// Brings single subfields up to date.
#[derive(Clone, Copy)]
pub(super) struct Builder<'a>(&'a GridBuilder);

impl Builder<'_> {
    /// Writes the grids that are out of date, dividing the work into `task_count` tasks; with one,
    /// the calling thread does all.
    pub(super) fn update(
        &self,
        config: &Config,
        table: &PrimitiveTable,
        contents: &Contents,
        subfield: &mut Subfield,
        task_count: usize,
    ) {
        let Subfield { face, kept, moving, .. } = subfield;
        let parts = [
            (kept, &contents.kept, contents.kept_frame, TileOrder::Depth),
            (moving, &contents.moving, contents.frame, config.moving_order),
        ];
        for (grid, wanted, frame, order) in parts {
            if grid.frame != frame {
                let level = config.simd;
                let tiles = TileSettings { order, fewest: config.fewest_in_tile };
                let from = Projection { level, table, wanted, face, task_count, tiles };
                self.0.build(&from, frame, grid);
            }
        }
    }
}
