//! Subfields that are open, and what is in their tiles.
//!
//! **Invariants.** What is held is of one frame, one part of its primitives and one way to tell
//! directions and places apart; anything else is forgotten first. Between runs of rays, all entries
//! have their place.

use glam::Vec3;
use rayflock_engine::Budget;
use wgpu::{BindingResource, Buffer, CommandEncoder};

use super::choose_grid::Grid;
use super::{Config, MOST_CELLS};
use crate::GpuContext;
use crate::buffer::{GrowingBuffer, part_of};
use crate::layout::{Subfield, SubfieldCounters, TileRange};

/// What the rays of each cell want, and the subfield of each cell.
const CELL_BYTES: usize = MOST_CELLS * size_of::<u32>();

/// What subfields are of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Origin {
    pub(super) part_idx: usize,
    /// The direction of all rays, of unit length, if they share one.
    pub(super) shared: Option<Vec3>,
    pub(super) grid: Grid,
}

/// Subfields that are open, and what is in their tiles.
#[derive(Debug)]
pub(super) struct Held {
    cells: GrowingBuffer,
    subfields: GrowingBuffer,
    tiles: GrowingBuffer,
    entries: GrowingBuffer,
    counters: GrowingBuffer,
    /// None while nothing is held.
    origin: Option<Origin>,
    /// How many subfields may be open at a time, and how many tiles one may have along a side: less
    /// once a frame needed it.
    most_open: usize,
    most_tile_edge: usize,
    entry_capacity: usize,
    largest_capacity: usize,
    most_tiles: usize,
    /// Entries that are held.
    entry_count: u64,
}

impl Held {
    pub(super) const fn new(config: &Config) -> Self {
        Self {
            cells: GrowingBuffer::storage("cells"),
            subfields: GrowingBuffer::storage("subfields"),
            tiles: GrowingBuffer::storage("tiles"),
            entries: GrowingBuffer::storage("entries"),
            counters: GrowingBuffer::storage("counters"),
            origin: None,
            most_open: MOST_CELLS,
            most_tile_edge: usize::MAX,
            entry_capacity: config.first_capacity,
            largest_capacity: config.largest_capacity,
            most_tiles: config.most_tiles,
            entry_count: 0,
        }
    }

    /// A new frame: nothing of what is held holds any more.
    pub(super) const fn begin_frame(&mut self) {
        self.forget();
        self.most_open = MOST_CELLS;
        self.most_tile_edge = usize::MAX;
    }

    /// Lets the next round begin without subfields.
    pub(super) const fn forget(&mut self) {
        self.origin = None;
    }

    /// What suits rays for which `wanted` would: within what this frame has been found to allow, and
    /// with no fewer directions than are in use, so that batches of a frame share them.
    pub(super) fn allowed(&self, wanted: Origin) -> Origin {
        let tile_edge = wanted.grid.tile_edge.min(self.most_tile_edge);
        let same_part = self.origin.filter(|origin| origin.part_idx == wanted.part_idx);
        let in_use = same_part.map_or(0, |origin| origin.grid.direction_edge);
        let direction_edge = wanted.grid.direction_edge.max(in_use);
        Origin { grid: Grid { direction_edge, tile_edge }, ..wanted }
    }

    /// Subfields that there is room for.
    pub(super) fn subfield_capacity(&self, grid: Grid) -> usize {
        let room = (self.most_tiles / grid.tile_count()).max(1);
        room.min(grid.direction_count()).min(self.most_open)
    }

    pub(super) const fn entry_capacity(&self) -> usize {
        self.entry_capacity
    }

    /// Makes room for a round with subfields of `origin`, and begins it.
    pub(super) fn begin_round(
        &mut self,
        context: &GpuContext,
        encoder: &mut CommandEncoder,
        origin: Origin,
        is_first: bool,
    ) {
        let capacity = self.subfield_capacity(origin.grid);
        self.cells.reserve(context, 2 * CELL_BYTES);
        self.subfields.reserve(context, capacity * size_of::<Subfield>());
        let tile_bytes = capacity * origin.grid.tile_count() * size_of::<TileRange>();
        self.tiles.reserve(context, tile_bytes);
        self.entries.reserve(context, self.entry_capacity * size_of::<u32>());
        self.counters.reserve(context, size_of::<SubfieldCounters>());
        let cell_bytes = CELL_BYTES as u64;
        if is_first {
            encoder.clear_buffer(self.cells.buffer(), 0, Some(cell_bytes));
        }
        let mut kept = std::mem::offset_of!(SubfieldCounters, first_new) as u64;
        if self.origin != Some(origin) {
            encoder.clear_buffer(self.cells.buffer(), cell_bytes, Some(cell_bytes));
            encoder.clear_buffer(self.tiles.buffer(), 0, Some(tile_bytes as u64));
            (kept, self.entry_count) = (0, 0);
            self.origin = Some(origin);
        }
        encoder.clear_buffer(self.counters.buffer(), kept, None);
    }

    /// Takes note of a round; returns how many entries it wrote, or `None` where there was no room for
    /// them. Then there is more room for the next, or subfields need less; at least one subfield of
    /// one tile finds room.
    pub(super) fn end_round(&mut self, found: &SubfieldCounters, prim_count: usize) -> Option<u64> {
        let needed = u64::from(found.entries_high) << 32 | u64::from(found.entries);
        if needed <= self.entry_capacity as u64 {
            let before = std::mem::replace(&mut self.entry_count, needed);
            return Some(needed - before);
        }
        let largest = self.largest_capacity.max(prim_count) as u64;
        if needed <= largest {
            let capacity = needed.next_power_of_two().min(largest);
            self.entry_capacity = capacity as usize;
        } else if found.subfield_count > 1 {
            self.entry_capacity = largest as usize;
            self.most_open = found.subfield_count as usize / 2;
        } else {
            let tile_edge = self.origin.map_or(1, |origin| origin.grid.tile_edge);
            self.most_tile_edge = (tile_edge / 2).max(1);
        }
        self.forget();
        None
    }

    pub(super) fn cells(&self) -> BindingResource<'_> {
        part_of(self.cells.buffer(), 2 * CELL_BYTES)
    }

    pub(super) fn subfields(&self) -> BindingResource<'_> {
        self.subfields.buffer().as_entire_binding()
    }

    pub(super) fn tiles(&self) -> BindingResource<'_> {
        self.tiles.buffer().as_entire_binding()
    }

    pub(super) fn entries(&self) -> BindingResource<'_> {
        self.entries.buffer().as_entire_binding()
    }

    pub(super) fn counters(&self) -> BindingResource<'_> {
        part_of(self.counters.buffer(), size_of::<SubfieldCounters>())
    }

    pub(super) fn counter_buffer(&self) -> &Buffer {
        self.counters.buffer()
    }

    #[cfg(test)]
    pub(super) fn cell_buffer(&self) -> &Buffer {
        self.cells.buffer()
    }

    #[cfg(test)]
    pub(super) fn subfield_buffer(&self) -> &Buffer {
        self.subfields.buffer()
    }

    #[cfg(test)]
    pub(super) fn tile_buffer(&self) -> &Buffer {
        self.tiles.buffer()
    }

    #[cfg(test)]
    pub(super) fn entry_buffer(&self) -> &Buffer {
        self.entries.buffer()
    }

    /// Tells what is held.
    pub(super) fn hold(&self, budget: &mut Budget) {
        let all = [&self.cells, &self.subfields, &self.tiles, &self.entries, &self.counters];
        all.into_iter().for_each(|buffer| buffer.hold(budget));
    }
}
