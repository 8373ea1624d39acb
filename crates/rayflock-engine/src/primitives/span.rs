//! Where the primitives of each object lie among ranks and slots.

use std::ops::Range;

use rayflock_geom::simd::LANES;
use rayflock_geom::{Geometry, GeometryObject, ObjectId};

/// The place of one object's primitives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct ObjectSpan {
    /// Whose primitives these are.
    pub(crate) object_id: ObjectId,
    /// Rank of the first primitive.
    pub(crate) first_rank: usize,
    /// First slot of each kind.
    pub(crate) first_slot: KindCounts,
    /// Number of primitives of each kind.
    pub(crate) count: KindCounts,
}

/// One number for each kind of primitive.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct KindCounts {
    pub(crate) triangles: usize,
    pub(crate) spheres: usize,
    pub(crate) users: usize,
}

/// The places of all objects, and where each kind of slot begins.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Layout {
    /// Sorted by object id, and so by rank.
    pub(crate) spans: Vec<ObjectSpan>,
    /// First slot of each kind; triangles begin at 0.
    pub(crate) begin: KindCounts,
    /// Number of slots, a multiple of sixteen.
    pub(crate) slot_count: usize,
}

impl ObjectSpan {
    /// Slots of the object's triangles.
    pub(crate) fn triangle_slots(&self) -> Range<usize> {
        self.first_slot.triangles..self.first_slot.triangles + self.count.triangles
    }

    /// Slots of the object's spheres.
    pub(crate) fn sphere_slots(&self) -> Range<usize> {
        self.first_slot.spheres..self.first_slot.spheres + self.count.spheres
    }

    /// Slots of the object's user primitives.
    pub(crate) fn user_slots(&self) -> Range<usize> {
        self.first_slot.users..self.first_slot.users + self.count.users
    }

    /// Number of primitives of all kinds.
    pub(crate) fn prim_count(&self) -> usize {
        self.count.triangles + self.count.spheres + self.count.users
    }
}

impl Layout {
    /// The layout of `geometry`, written into `self` to keep its memory. Returns whether anything
    /// differs from what was there.
    pub(crate) fn assign(&mut self, geometry: &Geometry) -> bool {
        let mut total = KindCounts::default();
        for object in geometry.objects() {
            let count = count_kinds(object);
            total.triangles += count.triangles;
            total.spheres += count.spheres;
            total.users += count.users;
        }
        let padded = |count: usize| count.next_multiple_of(LANES);
        let spheres_begin = padded(total.triangles);
        let users_begin = spheres_begin + padded(total.spheres);
        let begin = KindCounts { triangles: 0, spheres: spheres_begin, users: users_begin };
        let slot_count = users_begin + padded(total.users);

        let mut differs = self.spans.len() != geometry.objects().len() || self.begin != begin;
        let (mut next, mut first_rank) = (begin, 0);
        self.spans.truncate(geometry.objects().len());
        for (idx, object) in geometry.objects().iter().enumerate() {
            let count = count_kinds(object);
            let span = ObjectSpan { object_id: object.id, first_rank, first_slot: next, count };
            if self.spans.get(idx) != Some(&span) {
                differs = true;
                self.spans.truncate(idx);
                self.spans.push(span);
            }
            first_rank += span.prim_count();
            next.triangles += count.triangles;
            next.spheres += count.spheres;
            next.users += count.users;
        }
        differs |= self.slot_count != slot_count;
        (self.begin, self.slot_count) = (begin, slot_count);
        differs
    }

    /// Positions of the objects that may have triangles in `slots`, one slot at least.
    pub(crate) fn objects_of_triangles(&self, slots: Range<usize>) -> Range<usize> {
        let before = |span: &ObjectSpan| span.triangle_slots().end <= slots.start;
        let begun = |span: &ObjectSpan| span.first_slot.triangles < slots.end;
        self.spans.partition_point(before)..self.spans.partition_point(begun)
    }
}

fn count_kinds(object: &GeometryObject) -> KindCounts {
    let shape = &object.shape;
    let users = shape.user().map_or(0, |user| user.len());
    KindCounts { triangles: shape.triangles().len(), spheres: shape.spheres().len(), users }
}
