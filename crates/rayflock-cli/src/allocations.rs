//! The program's allocator: that of the system, with a count.
//!
//! Counting takes two atomic additions an allocation, which is little beside the allocation, and
//! nothing where nothing is allocated.

use std::alloc::System;

use rayflock_bench::AllocationCounter;
use stats_alloc::{INSTRUMENTED_SYSTEM, StatsAlloc};

#[global_allocator]
static ALLOCATOR: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

/// Counts the allocations of the whole program.
pub(crate) const COUNTER: AllocationCounter = AllocationCounter::new(count);

/// Allocations and reallocations since the program began.
fn count() -> u64 {
    let stats = ALLOCATOR.stats();
    (stats.allocations + stats.reallocations) as u64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_box_is_an_allocation() {
        // Other tests allocate at the same time.
        let (_, counted) = COUNTER.count(|| (0..100).map(Box::new).collect::<Vec<_>>());
        assert!(counted.is_some_and(|counted| counted > 100), "{counted:?}");
    }
}
