//! Which primitives of a table belong to a structure: those of some objects.

use rayflock_geom::simd::LANES;

use crate::primitives::ObjectSpan;

/// Some primitives of a block of the table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct WantedLanes {
    pub(crate) block_idx: u32,
    /// One bit a lane.
    pub(crate) lanes: u32,
}

impl WantedLanes {
    /// The slots of the primitives.
    pub(crate) fn slots(&self) -> impl Iterator<Item = u32> + use<> {
        let Self { block_idx, lanes } = *self;
        let lanes = (0..LANES as u32).filter(move |lane| lanes & (1 << lane) != 0);
        lanes.map(move |lane| block_idx * LANES as u32 + lane)
    }
}

/// Primitives of some objects, by kind.
#[derive(Debug, Default)]
pub(crate) struct Wanted {
    pub(crate) triangles: Vec<WantedLanes>,
    pub(crate) others: Vec<WantedLanes>,
}

impl Wanted {
    /// Lists the primitives of the objects that are `chosen`, by their positions in the frame.
    pub(crate) fn list(&mut self, spans: &[ObjectSpan], chosen: impl Fn(usize) -> bool) {
        self.triangles.clear();
        self.others.clear();
        let spans = || (0..).zip(spans).filter(|&(idx, _)| chosen(idx)).map(|(_, span)| span);
        for span in spans() {
            let (first, count) = (&span.first_slot, &span.count);
            push_slots(&mut self.triangles, first.triangles, count.triangles);
        }
        for span in spans() {
            push_slots(&mut self.others, span.first_slot.spheres, span.count.spheres);
        }
        for span in spans() {
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
