//! Reads triangles in the order of the curve, for two leaves at a time.
//!
//! The table has the nine coordinates of a triangle in as many columns, which are nine lines of the
//! cache; a mesh has them in one to four. Rows of the mesh are copied one after the other and then
//! brought into columns by shuffles. Corners are brought into the world by the operation by which
//! the table was written, so they are the same bits.

use glam::{Affine3A, Vec3};
use rayflock_geom::simd::LANES;
use rayflock_geom::simd::triangle_rows::{ROW_COUNT, TriangleRow};
use rayflock_geom::{Mesh, prefetch, transform_point};

use crate::primitives::PrimitiveTable;

/// Triangles of two leaves.
#[derive(Clone, Copy, Debug)]
pub(super) struct StagedTriangles {
    pub(super) rows: [TriangleRow; ROW_COUNT],
    pub(super) masks: [[u32; LANES]; 2],
    pub(super) ranks: [[u32; LANES]; 2],
}

impl StagedTriangles {
    /// Nothing to hit.
    pub(super) const EMPTY: Self =
        Self { rows: [[0.0; 9]; ROW_COUNT], masks: [[0; LANES]; 2], ranks: [[u32::MAX; LANES]; 2] };
}

/// Reads triangles by slots; quickest where most are of the same object as the one before.
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
    /// The triangles, where they are rows already and in world space.
    rows: Option<&'a [TriangleRow]>,
    transform: Option<&'a Affine3A>,
}

impl<'a> TriangleReader<'a> {
    pub(super) const fn new(table: &'a PrimitiveTable) -> Self {
        Self { table, last: None }
    }

    /// Reads the triangles of up to 32 slots, none of them ignored. Where there are fewer, the
    /// first of a leaf is there again, out of sight.
    #[inline(always)]
    pub(super) fn stage(
        &mut self,
        slots: impl ExactSizeIterator<Item = u32>,
        staged: &mut StagedTriangles,
    ) {
        let count = slots.len().min(ROW_COUNT);
        for (idx, slot) in slots.take(count).enumerate() {
            let object = self.object(slot);
            let triangle_idx = slot as usize - object.first_slot;
            staged.rows[idx] = match object.rows {
                Some(rows) => rows[triangle_idx],
                None => object.row(triangle_idx),
            };
            staged.masks[idx / LANES][idx % LANES] = object.mask;
            staged.ranks[idx / LANES][idx % LANES] = (object.first_rank + triangle_idx) as u32;
        }
        for idx in count..ROW_COUNT {
            staged.rows[idx] = staged.rows[idx / LANES * LANES];
            staged.masks[idx / LANES][idx % LANES] = 0;
            staged.ranks[idx / LANES][idx % LANES] = u32::MAX;
        }
    }

    /// Asks for triangles that will be read soon, so that they are in the cache by then.
    #[inline(always)]
    pub(super) fn ask_for(&mut self, slots: &[u32]) {
        for &slot in slots {
            let object = self.object(slot);
            let triangle_idx = slot as usize - object.first_slot;
            match object.rows {
                Some(rows) => prefetch(&rows[triangle_idx]),
                None => prefetch(&object.mesh.triangles()[triangle_idx]),
            }
        }
    }

    /// The object of a slot.
    #[inline(always)]
    fn object(&mut self, slot: u32) -> ReadObject<'a> {
        let slot = slot as usize;
        match self.last {
            Some(last) if slot.wrapping_sub(last.first_slot) < last.triangle_count => last,
            _ => self.find(slot),
        }
    }

    /// Finds the object of a slot.
    #[inline(never)]
    fn find(&mut self, slot: usize) -> ReadObject<'a> {
        let spans = self.table.spans();
        // Objects without triangles begin where the next one does, and lie before it.
        let object_idx = spans.partition_point(|span| span.first_slot.triangles <= slot) - 1;
        let (span, object) = (&spans[object_idx], &self.table.geometry().objects()[object_idx]);
        let (mesh, transform) = (&*object.shape, object.world_from_object.as_ref());
        let found = ReadObject {
            first_slot: span.first_slot.triangles,
            triangle_count: span.count.triangles,
            first_rank: span.first_rank,
            mask: object.mask,
            mesh,
            rows: if transform.is_none() { mesh.soup() } else { None },
            transform,
        };
        self.last = Some(found);
        found
    }
}

impl ReadObject<'_> {
    /// A triangle by its vertices, in world space.
    #[inline(always)]
    fn row(&self, triangle_idx: usize) -> TriangleRow {
        let vertices = self.mesh.vertices();
        let corner = |vertex_idx: u32| -> Vec3 {
            let corner = vertices[vertex_idx as usize];
            self.transform.map_or(corner, |transform| transform_point(transform, corner))
        };
        let [a, b, c] = self.mesh.triangles()[triangle_idx];
        let (a, b, c) = (corner(a), corner(b), corner(c));
        [a.x, a.y, a.z, b.x, b.y, b.z, c.x, c.y, c.z]
    }
}
