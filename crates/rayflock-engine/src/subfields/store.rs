//! The subfields that are held, by direction, within a budget of memory.

use glam::Vec3;
use rayflock_geom::simd::SimdLevel;
use rayon::prelude::*;
use tracing::debug_span;

use super::bin_triangles::Projection;
use super::build_grid::GridBuilder;
use super::subfield::Subfield;
use crate::primitives::PrimitiveTable;
use crate::wanted::Wanted;

/// Tasks for each thread when one direction is built.
const TASKS_PER_THREAD: usize = 2;

/// There are at most so many tasks.
const MOST_TASKS: usize = 64;

/// Bytes that grids take for each primitive, about.
const BYTES_PER_PRIM: usize = 256;

/// Bytes that the subfield of one direction takes, about.
pub(super) fn bytes_for(table: &PrimitiveTable) -> usize {
    BYTES_PER_PRIM * table.geometry().prim_count().max(1)
}

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
    /// Brings the subfields of some directions, all different, up to date; returns their positions,
    /// which hold until the next call.
    pub(super) fn prepare(
        &mut self,
        level: SimdLevel,
        table: &PrimitiveTable,
        contents: &Contents,
        directions: &[Vec3],
        budget: usize,
    ) -> Vec<usize> {
        let _span = debug_span!("prepare_subfields").entered();
        self.clock += 1;
        self.make_room(directions, bytes_for(table), budget);
        let places = directions.iter().map(|&direction| self.find(direction, table)).collect();
        let stale = self.subfields.iter_mut().filter(|one| one.used == self.clock);
        let mut stale: Vec<&mut Subfield> = stale.filter(|one| !one.is_current(contents)).collect();
        let tasks = (TASKS_PER_THREAD * rayon::current_num_threads()).min(MOST_TASKS);
        let task_count = tasks.div_ceil(stale.len().max(1));
        let builder = &self.builder;
        stale.par_iter_mut().for_each(|subfield| {
            let Subfield { face, kept, moving, .. } = &mut **subfield;
            let parts = [
                (kept, &contents.kept, contents.kept_frame),
                (moving, &contents.moving, contents.frame),
            ];
            for (grid, wanted, frame) in parts {
                if grid.frame != frame {
                    let from = Projection { level, table, wanted, face, task_count };
                    builder.build(&from, frame, grid);
                }
            }
        });
        places
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
        let mut held: usize = self.subfields.iter().map(Subfield::memory_usage).sum();
        while held > room {
            let unused =
                (0..self.subfields.len()).filter(|&idx| self.subfields[idx].used < self.clock);
            let Some(oldest) = unused.min_by_key(|&idx| self.subfields[idx].used) else { return };
            held -= self.subfields.swap_remove(oldest).memory_usage();
        }
    }

    /// Bytes held.
    pub(super) fn memory_usage(&self) -> usize {
        self.subfields.iter().map(Subfield::memory_usage).sum::<usize>()
            + self.builder.memory_usage()
    }
}
