//! How often the program allocates on the heap, where its allocator counts.
//!
//! A library must not choose the allocator, so whoever runs the program says how to read the count.

use std::sync::OnceLock;

static READ: OnceLock<fn() -> u64> = OnceLock::new();

/// From now on, allocations are counted by `read`, unless they are already.
pub(crate) fn count_by(read: Option<fn() -> u64>) {
    if let Some(read) = read {
        READ.get_or_init(|| read);
    }
}

/// What tells the allocations and reallocations since the program began.
pub(crate) fn reader() -> Option<fn() -> u64> {
    READ.get().copied()
}

/// Does `work`; also returns how often that allocated, on all threads, `None` where nothing is
/// counted.
pub(crate) fn counted<R>(work: impl FnOnce() -> R) -> (R, Option<u64>) {
    let read = || reader().map(|read| read());
    let before = read();
    let result = work();
    (result, read().zip(before).map(|(after, before)| after - before))
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicU64, Ordering};

    use super::*;

    static COUNT: AtomicU64 = AtomicU64::new(7);

    #[test]
    fn what_happens_within_the_work_is_counted() {
        assert_eq!(counted(|| 1), (1, None));
        count_by(None);
        count_by(Some(|| COUNT.load(Ordering::Relaxed)));
        assert_eq!(counted(|| COUNT.fetch_add(3, Ordering::Relaxed)), (7, Some(3)));
    }
}
