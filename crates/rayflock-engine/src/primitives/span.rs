//! Where the primitives of each object lie among ranks and slots.

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

impl ObjectSpan {
    /// Number of primitives.
    pub(crate) const fn prim_count(&self) -> usize {
        self.count.triangles + self.count.spheres + self.count.users
    }
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
            first_rank += count.triangles + count.spheres + count.users;
            next.triangles += count.triangles;
            next.spheres += count.spheres;
            next.users += count.users;
        }
        differs |= self.slot_count != slot_count;
        (self.begin, self.slot_count) = (begin, slot_count);
        differs
    }

    /// The object that holds the primitive of this rank.
    pub(crate) fn span_of_rank(&self, rank: u32) -> &ObjectSpan {
        let after = self.spans.partition_point(|span| span.first_rank <= rank as usize);
        &self.spans[after - 1]
    }
}

fn count_kinds(object: &GeometryObject) -> KindCounts {
    let shape = &object.shape;
    let users = shape.user().map_or(0, |user| user.len());
    KindCounts { triangles: shape.triangles().len(), spheres: shape.spheres().len(), users }
}
