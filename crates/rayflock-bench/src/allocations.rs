//! How often a piece of work allocates on the heap.
//!
//! A program has one global allocator and a library must not choose it, so the program says how
//! to read its count; without that nothing is counted.
//!
//! All threads are counted, those that have nothing to do with the work included, so take the
//! [`median`] over several rounds. Foreign libraries that do not allocate through Rust (Embree)
//! are not seen.

use std::fmt;

/// Reads how many allocations the program has made.
#[derive(Clone, Copy, Default)]
pub struct AllocationCounter {
    read: Option<fn() -> u64>,
}

impl AllocationCounter {
    /// Counts nothing.
    pub const NONE: Self = Self { read: None };

    /// Counts by `read`, which returns the allocations and reallocations since the program began.
    pub const fn new(read: fn() -> u64) -> Self {
        Self { read: Some(read) }
    }

    /// Does `work`; also returns how often that allocated, `None` where nothing is counted.
    pub fn count<R>(&self, work: impl FnOnce() -> R) -> (R, Option<u64>) {
        let before = self.read.map(|read| read());
        let result = work();
        let after = self.read.map(|read| read());
        (result, after.zip(before).map(|(after, before)| after - before))
    }
}

impl fmt::Debug for AllocationCounter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("AllocationCounter").field("counts", &self.read.is_some()).finish()
    }
}

/// The median of the counts of several rounds, the lower of the middle two; `None` where nothing
/// was counted.
pub fn median(counts: impl IntoIterator<Item = Option<u64>>) -> Option<u64> {
    let mut counts: Vec<u64> = counts.into_iter().flatten().collect();
    counts.sort_unstable();
    counts.get(counts.len().checked_sub(1)? / 2).copied()
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicU64, Ordering};

    use super::*;

    static ALLOCATIONS: AtomicU64 = AtomicU64::new(40);

    #[test]
    fn only_what_happens_within_the_work_is_counted() {
        let counter = AllocationCounter::new(|| ALLOCATIONS.load(Ordering::Relaxed));
        let allocate = |count| ALLOCATIONS.fetch_add(count, Ordering::Relaxed);
        allocate(1);
        assert_eq!(counter.count(|| allocate(5)).1, Some(5));
        allocate(1);
        assert_eq!(counter.count(|| "nothing"), ("nothing", Some(0)));
        assert_eq!(AllocationCounter::NONE.count(|| allocate(5)).1, None);
    }

    #[test]
    fn one_odd_round_does_not_change_the_median() {
        assert_eq!(median([Some(7), Some(900), Some(7)]), Some(7));
        assert_eq!(median([Some(8), Some(6)]), Some(6));
        assert_eq!(median([None, None]), None);
        assert_eq!(median([]), None);
    }
}
