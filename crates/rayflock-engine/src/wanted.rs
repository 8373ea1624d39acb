//! Which primitives of a table belong to a structure: those of some objects.

use rayflock_geom::simd::LANES;

use crate::parts::Place;
use crate::primitives::PrimitiveTable;

/// Some primitives of a block of the table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct WantedLanes {
    pub(crate) block_idx: u32,
    /// One bit a lane.
    pub(crate) lanes: u32,
}

/// Primitives of some objects, by kind.
#[derive(Debug, Default)]
pub(crate) struct Wanted {
    pub(crate) triangles: Vec<WantedLanes>,
    pub(crate) others: Vec<WantedLanes>,
}

impl Wanted {
    /// Lists the primitives of the objects whose place is `chosen`.
    pub(crate) fn list(
        &mut self,
        table: &PrimitiveTable,
        places: &[Place],
        chosen: impl Fn(Place) -> bool,
    ) {
        self.triangles.clear();
        self.others.clear();
        for (span, _) in table.spans().iter().zip(places).filter(|&(_, &place)| chosen(place)) {
            let (first, count) = (&span.first_slot, &span.count);
            push_slots(&mut self.triangles, first.triangles, count.triangles);
        }
        for (span, _) in table.spans().iter().zip(places).filter(|&(_, &place)| chosen(place)) {
            push_slots(&mut self.others, span.first_slot.spheres, span.count.spheres);
        }
        for (span, _) in table.spans().iter().zip(places).filter(|&(_, &place)| chosen(place)) {
            push_slots(&mut self.others, span.first_slot.users, span.count.users);
        }
    }

    /// Number of primitives.
    pub(crate) fn prim_count(&self) -> usize {
        let lanes = self.triangles.iter().chain(&self.others).map(|wanted| wanted.lanes);
        lanes.map(|lanes| lanes.count_ones() as usize).sum()
    }

    /// Bytes held.
    pub(crate) fn memory_usage(&self) -> usize {
        (self.triangles.capacity() + self.others.capacity()) * size_of::<WantedLanes>()
    }
}

/// Adds `count` slots from `first` on, which lie behind those that are in the list.
fn push_slots(wanted: &mut Vec<WantedLanes>, first: usize, count: usize) {
    let end = first + count;
    let mut slot = first;
    while slot < end {
        let (block_idx, lane) = ((slot / LANES) as u32, slot % LANES);
        let lane_count = (LANES - lane).min(end - slot);
        let lanes = ((1_u32 << lane_count) - 1) << lane;
        match wanted.last_mut().filter(|last| last.block_idx == block_idx) {
            Some(last) => last.lanes |= lanes,
            None => wanted.push(WantedLanes { block_idx, lanes }),
        }
        slot += lane_count;
    }
}
