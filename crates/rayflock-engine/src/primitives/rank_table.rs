//! Leads from ranks back to ids.
//!
//! The object of a rank lies between those of the first rank of its bucket and of the next
//! bucket's: a table of buckets of sixteen ranks leaves a step or two of a binary search, however
//! many objects there are.
//!
//! **Cost.** A quarter byte a primitive, 8 bytes an object; written when the layout changes.

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

#[derive(Clone, Copy, Debug)]
struct RankedObject {
    first_rank: u32,
    object_id: ObjectId,
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
            let first_rank = span.first_rank as u32;
            self.objects.push(RankedObject { first_rank, object_id: span.object_id });
        }
        if end > 0 {
            self.buckets.push(self.objects.len() as u32 - 1);
        }
    }

    /// The ids of a rank that a primitive has.
    #[inline(always)]
    pub(super) fn ids(&self, rank: u32) -> (ObjectId, PrimId) {
        let bucket = (rank >> BUCKET_BITS) as usize;
        let (first, last) = (self.buckets[bucket] as usize, self.buckets[bucket + 1] as usize);
        let mut object = &self.objects[first];
        if first < last {
            let among = &self.objects[first..=last];
            object = &among[among.partition_point(|object| object.first_rank <= rank) - 1];
        }
        (object.object_id, PrimId(rank - object.first_rank))
    }

    /// Bytes held.
    pub(super) fn memory_usage(&self) -> usize {
        self.objects.capacity() * size_of::<RankedObject>() + 4 * self.buckets.capacity()
    }
}
