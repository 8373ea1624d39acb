//! Leads from ranks back to objects, and so to ids.
//!
//! The object of a rank lies between those of the first rank of its bucket and of the next
//! bucket's: a table of buckets of sixteen ranks leaves a step or two of a binary search, however
//! many objects there are.
//!
//! **Cost.** A quarter byte a primitive, 12 bytes an object; written when the layout changes.

use rayflock_geom::{ObjectId, PrimId};

use super::span::Layout;

/// Ranks in a bucket, as a power of two.
const BUCKET_BITS: u32 = 4;

/// Objects by rank.
#[derive(Clone, Debug, Default)]
pub(super) struct RankTable {
    /// Objects that hold any primitive, in the order of their ranks.
    objects: Vec<RankedObject>,
    /// The object of each bucket's first rank, and after the last bucket the last object.
    buckets: Vec<u32>,
}

/// An object and the ranks of its primitives.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RankedObject {
    pub(crate) first_rank: u32,
    pub(crate) prim_count: u32,
    pub(crate) object_id: ObjectId,
}

impl RankedObject {
    /// No object: it has no rank.
    pub(crate) const NONE: Self = Self { first_rank: 0, prim_count: 0, object_id: ObjectId::NONE };

    /// The ids of one of the object's ranks.
    #[inline(always)]
    pub(crate) fn ids(&self, rank: u32) -> (ObjectId, PrimId) {
        (self.object_id, PrimId(rank - self.first_rank))
    }
}

impl RankTable {
    /// Makes this the table of a layout.
    pub(super) fn assign(&mut self, layout: &Layout) {
        self.objects.clear();
        self.buckets.clear();
        let mut end = 0;
        for span in layout.spans.iter().filter(|span| span.prim_count() > 0) {
            end = span.first_rank + span.prim_count();
            // Buckets whose first rank is the object's.
            self.buckets.resize(end.div_ceil(1 << BUCKET_BITS), self.objects.len() as u32);
            self.objects.push(RankedObject {
                first_rank: span.first_rank as u32,
                prim_count: span.prim_count() as u32,
                object_id: span.object_id,
            });
        }
        if end > 0 {
            self.buckets.push(self.objects.len() as u32 - 1);
        }
    }

    /// The object of a rank that a primitive has.
    #[inline(always)]
    pub(super) fn object(&self, rank: u32) -> RankedObject {
        let bucket = (rank >> BUCKET_BITS) as usize;
        let (first, last) = (self.buckets[bucket] as usize, self.buckets[bucket + 1] as usize);
        if first == last {
            return self.objects[first];
        }
        let among = &self.objects[first..=last];
        among[among.partition_point(|object| object.first_rank <= rank) - 1]
    }

    /// Bytes held.
    pub(super) fn memory_usage(&self) -> usize {
        self.objects.capacity() * size_of::<RankedObject>() + 4 * self.buckets.capacity()
    }
}
