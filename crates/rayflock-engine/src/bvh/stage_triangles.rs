//! Reads triangles in the order of the leaves, for two of these at a time.
//!
//! A mesh has the nine coordinates of a triangle in one to four lines of the cache. Its rows are
//! copied one after the other and then brought into columns by shuffles. Corners are brought into
//! the world by the operation by which a table would be written, so they are the same bits.

use glam::{Affine3A, Vec3};
use rayflock_geom::simd::LANES;
use rayflock_geom::simd::triangle_rows::{ROW_COUNT, TriangleRow};
use rayflock_geom::{Mesh, prefetch, transform_point};

use crate::primitives::PrimitiveTable;

/// Triangles of two leaves.
#[derive(Clone, Copy, Debug)]
pub(super) struct StagedTriangles {
    pub(super) rows: [TriangleRow; ROW_COUNT],
    /// What brings the rows of a leaf into the world, where they are not there yet.
    pub(super) transforms: [Option<Affine3A>; 2],
    pub(super) masks: [[u32; LANES]; 2],
    pub(super) ranks: [[u32; LANES]; 2],
}

impl StagedTriangles {
    /// Nothing to hit.
    pub(super) const EMPTY: Self = Self {
        rows: [[0.0; 9]; ROW_COUNT],
        transforms: [None; 2],
        masks: [[0; LANES]; 2],
        ranks: [[u32::MAX; LANES]; 2],
    };
}

/// Reads triangles by slots; quickest where all of a leaf are of one object.
#[derive(Debug)]
pub(super) struct TriangleReader<'a> {
    table: &'a PrimitiveTable,
    last: Option<ReadObject<'a>>,
}

/// The object of the triangle that was read last.
#[derive(Clone, Copy, Debug)]
struct ReadObject<'a> {
    first_slot: usize,
    triangle_count: usize,
    first_rank: usize,
    mask: u32,
    mesh: &'a Mesh,
    /// The triangles, where the mesh has them as rows.
    rows: Option<&'a [TriangleRow]>,
    transform: Option<&'a Affine3A>,
}

impl<'a> TriangleReader<'a> {
    pub(super) const fn new(table: &'a PrimitiveTable) -> Self {
        Self { table, last: None }
    }

    /// Reads the triangles of a leaf, to be the first or the second that is staged. Where there are
    /// fewer than sixteen, the first is there again, out of sight.
    #[inline(always)]
    pub(super) fn stage(&mut self, slots: &[u32], leaf_idx: usize, staged: &mut StagedTriangles) {
        let StagedTriangles { rows, transforms, masks, ranks } = staged;
        let rows = &mut rows[leaf_idx * LANES..(leaf_idx + 1) * LANES];
        let (masks, ranks) = (&mut masks[leaf_idx], &mut ranks[leaf_idx]);
        let object = self.object(slots[0]);
        if slots.iter().all(|&slot| object.has(slot)) {
            object.copy_rows(slots, rows);
            transforms[leaf_idx] = object.transform.copied();
            *masks = [object.mask; LANES];
            for (rank, &slot) in ranks.iter_mut().zip(slots) {
                *rank = object.rank(slot);
            }
        } else {
            transforms[leaf_idx] = None;
            for (lane, &slot) in slots.iter().enumerate() {
                let object = self.object(slot);
                rows[lane] = object.row_in_world(slot);
                (masks[lane], ranks[lane]) = (object.mask, object.rank(slot));
            }
        }
        for lane in slots.len()..LANES {
            rows[lane] = rows[0];
            (masks[lane], ranks[lane]) = (0, u32::MAX);
        }
    }

    /// Asks for triangles that will be read soon, so that they are in the cache by then.
    #[inline(always)]
    pub(super) fn ask_for(&mut self, slots: &[u32]) {
        let Some(&first) = slots.first() else { return };
        let object = self.object(first);
        if slots.iter().all(|&slot| object.has(slot)) {
            object.ask_for(slots);
        } else {
            slots.chunks(1).for_each(|slot| self.object(slot[0]).ask_for(slot));
        }
    }

    /// The object of a slot.
    #[inline(always)]
    fn object(&mut self, slot: u32) -> ReadObject<'a> {
        match self.last {
            Some(last) if last.has(slot) => last,
            _ => self.find(slot as usize),
        }
    }

    /// Finds the object of a slot.
    #[inline(never)]
    fn find(&mut self, slot: usize) -> ReadObject<'a> {
        let spans = self.table.spans();
        // Objects without triangles begin where the next one does, and lie before it.
        let object_idx = spans.partition_point(|span| span.first_slot.triangles <= slot) - 1;
        let (span, object) = (&spans[object_idx], &self.table.geometry().objects()[object_idx]);
        let found = ReadObject {
            first_slot: span.first_slot.triangles,
            triangle_count: span.count.triangles,
            first_rank: span.first_rank,
            mask: object.mask,
            mesh: &object.shape,
            rows: object.shape.soup(),
            transform: object.world_from_object.as_ref(),
        };
        self.last = Some(found);
        found
    }
}

impl ReadObject<'_> {
    /// Whether a slot is one of the object's.
    #[inline(always)]
    const fn has(&self, slot: u32) -> bool {
        (slot as usize).wrapping_sub(self.first_slot) < self.triangle_count
    }

    #[inline(always)]
    const fn rank(&self, slot: u32) -> u32 {
        (self.first_rank + slot as usize - self.first_slot) as u32
    }

    #[inline(always)]
    fn ask_for(&self, slots: &[u32]) {
        let triangle_idx = |slot: u32| slot as usize - self.first_slot;
        if let Some(rows) = self.rows {
            slots.iter().for_each(|&slot| prefetch(&rows[triangle_idx(slot)]));
        } else {
            let triangles = self.mesh.triangles();
            slots.iter().for_each(|&slot| prefetch(&triangles[triangle_idx(slot)]));
        }
    }

    /// Triangles of the object, in its own space.
    #[inline(always)]
    fn copy_rows(&self, slots: &[u32], rows: &mut [TriangleRow]) {
        let triangle_idx = |slot: u32| slot as usize - self.first_slot;
        if let Some(from) = self.rows {
            for (row, &slot) in rows.iter_mut().zip(slots) {
                *row = from[triangle_idx(slot)];
            }
        } else {
            for (row, &slot) in rows.iter_mut().zip(slots) {
                *row = row_of(self.mesh.corners(triangle_idx(slot)));
            }
        }
    }

    /// A triangle of the object, in the world.
    fn row_in_world(&self, slot: u32) -> TriangleRow {
        let corners = self.mesh.corners(slot as usize - self.first_slot);
        row_of(match self.transform {
            Some(transform) => corners.map(|corner| transform_point(transform, corner)),
            None => corners,
        })
    }
}

#[inline(always)]
const fn row_of([a, b, c]: [Vec3; 3]) -> TriangleRow {
    [a.x, a.y, a.z, b.x, b.y, b.z, c.x, c.y, c.z]
}
