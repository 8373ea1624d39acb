//! Makes room for a layout and writes what depends on the layout alone: ranks, and padding that
//! holds nothing to hit.

use std::ops::Range;

use rayflock_geom::Sphere;
use rayflock_geom::simd::LANES;
use rayflock_geom::simd::cone_sphere::SphereBlock;
use rayon::prelude::*;

use super::ignored::Ignored;
use super::table::PrimitiveTable;
use super::write_triangles::BLOCKS_PER_TASK;

impl PrimitiveTable {
    /// Takes over the layout. All objects have to be written after that.
    pub(super) fn begin_layout(&mut self) {
        let block_count = self.layout.slot_count / LANES;
        let triangle_blocks = self.layout.begin.spheres / LANES;
        let sphere_slots = self.layout.begin.users - self.layout.begin.spheres;
        self.spheres.clear();
        self.spheres.resize(sphere_slots, Sphere::default());
        self.users.clear();
        self.bounds.resize(block_count, SphereBlock::EMPTY);
        self.block_bounds.resize(block_count.div_ceil(LANES), SphereBlock::EMPTY);
        self.stale_groups.resize(block_count.div_ceil(LANES), true);
        self.ranks.resize(block_count, [u32::MAX; LANES]);
        self.masks.resize(block_count, [0; LANES]);

        // Padding ends the triangles, and lies anywhere among what is not triangles.
        let padded = triangle_blocks.saturating_sub(1);
        self.corners.truncate(padded);
        self.others_ignored.clear();
        self.others_ignored.resize(self.layout.spans.len(), Ignored::default());
        self.ranks[padded..].fill([u32::MAX; LANES]);
        self.masks[padded..].fill([0; LANES]);
        self.bounds[triangle_blocks..].fill(SphereBlock::EMPTY);
        self.write_ranks(triangle_blocks);
        self.rank_table.assign(&self.layout);
    }

    fn write_ranks(&mut self, triangle_blocks: usize) {
        let layout = &self.layout;
        let tasks = self.ranks[..triangle_blocks].par_chunks_mut(BLOCKS_PER_TASK).enumerate();
        tasks.for_each(|(task_idx, ranks)| {
            let first_slot = task_idx * BLOCKS_PER_TASK * LANES;
            let slots = first_slot..first_slot + ranks.len() * LANES;
            for span in &layout.spans[layout.objects_of_triangles(slots.clone())] {
                let own = span.triangle_slots();
                let part = own.start.max(slots.start)..own.end.min(slots.end);
                let first_rank = span.first_rank + (part.start - own.start);
                count_up(&mut ranks.as_flattened_mut()[shift(&part, first_slot)], first_rank);
            }
        });
        let ranks = self.ranks.as_flattened_mut();
        for span in &layout.spans {
            let first_rank = span.first_rank + span.count.triangles;
            count_up(&mut ranks[span.sphere_slots()], first_rank);
            count_up(&mut ranks[span.user_slots()], first_rank + span.count.spheres);
        }
    }
}

fn shift(range: &Range<usize>, by: usize) -> Range<usize> {
    range.start - by..range.end - by
}

fn count_up(ranks: &mut [u32], first_rank: usize) {
    for (place, rank) in ranks.iter_mut().zip(first_rank as u32..) {
        *place = rank;
    }
}
