//! Reads single triangles in any order.
//!
//! The table has the nine coordinates of a triangle in as many columns, nine lines of the cache; a
//! mesh has them in one to four. Corners are brought into the world by the operation by which the
//! table was written, so they are the same bits.

use glam::Vec3;
use rayflock_geom::{GeometryObject, transform_point};

use crate::primitives::{ObjectSpan, PrimitiveTable};

/// Reads corners by slots; quickest where most are of the same object as the one before.
#[derive(Debug)]
pub(super) struct CornerReader<'a> {
    table: &'a PrimitiveTable,
    /// The object of the slot that was read last.
    last: Option<(&'a ObjectSpan, &'a GeometryObject)>,
}

impl<'a> CornerReader<'a> {
    pub(super) const fn new(table: &'a PrimitiveTable) -> Self {
        Self { table, last: None }
    }

    /// The corners of a slot that holds a triangle which is not ignored, in world space.
    #[inline(always)]
    pub(super) fn read(&mut self, slot: u32) -> [Vec3; 3] {
        let slot = slot as usize;
        let is_here = |(span, _): &(&ObjectSpan, _)| span.triangle_slots().contains(&slot);
        let (span, object) = match self.last.filter(is_here) {
            Some(last) => last,
            None => self.find(slot),
        };
        let corners = object.shape.corners(slot - span.first_slot.triangles);
        match &object.world_from_object {
            Some(transform) => corners.map(|corner| transform_point(transform, corner)),
            None => corners,
        }
    }

    /// Finds the object of a slot.
    #[inline(never)]
    fn find(&mut self, slot: usize) -> (&'a ObjectSpan, &'a GeometryObject) {
        let spans = self.table.spans();
        let after = spans.partition_point(|span| span.first_slot.triangles <= slot);
        // Objects without triangles begin where the next one does.
        let found = (&spans[after - 1], &self.table.geometry().objects()[after - 1]);
        self.last = Some(found);
        found
    }
}
