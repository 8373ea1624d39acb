//! Sorts keyed entries by a few bits at a time, in parallel.
//!
//! **Source.** M. Zagha, G. Blelloch, "Radix Sort for Vector Multiprocessors", Supercomputing 1991:
//! count digits a chunk, sum, move.
//!
//! **Cost.** 24 bytes moved an entry and pass; nine bits a pass at most.

use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

use rayon::prelude::*;

/// Entries that are worth a task of their own.
const SMALLEST_CHUNK: usize = 4096;

/// Chunks a thread, so that all finish at about the same time.
const CHUNKS_PER_THREAD: usize = 4;

/// Bits of the largest digit: 512 places are written to in turn.
const LARGEST_DIGIT: u32 = 9;

/// Sorts entries of a key in the upper half and anything in the lower, keeping its memory.
#[derive(Debug, Default)]
pub(super) struct RadixSorter {
    /// Atomic because several tasks write each part of it, at places that are not known to differ
    /// but by arithmetic.
    sorted: Vec<AtomicU64>,
    unsorted: Vec<AtomicU64>,
    /// How often each digit occurs in each chunk; then where its next entry goes.
    counts: Vec<u32>,
}

impl RadixSorter {
    /// Makes room for entries and hands them out to be written.
    pub(super) fn entries(&mut self, len: usize) -> &mut [AtomicU64] {
        self.sorted.resize_with(len, AtomicU64::default);
        self.unsorted.resize_with(len, AtomicU64::default);
        &mut self.sorted
    }

    /// Sorts by the lower `key_bits` of the keys; those above must be 0.
    pub(super) fn sort(&mut self, key_bits: u32) {
        if self.sorted.is_empty() {
            return;
        }
        let pass_count = key_bits.div_ceil(LARGEST_DIGIT).max(1);
        let digit_bits = key_bits.div_ceil(pass_count);
        for pass in 0..pass_count {
            std::mem::swap(&mut self.sorted, &mut self.unsorted);
            self.pass(32 + pass * digit_bits, digit_bits);
        }
    }

    /// The entries; sorted after [`Self::sort`].
    pub(super) fn sorted(&self) -> &[AtomicU64] {
        &self.sorted
    }

    /// Moves all entries to where one digit sends them, in the order in which they come.
    fn pass(&mut self, shift: u32, bits: u32) {
        let Self { sorted, unsorted, counts } = self;
        let chunks = CHUNKS_PER_THREAD * rayon::current_num_threads();
        let chunk_len = unsorted.len().div_ceil(chunks).max(SMALLEST_CHUNK);
        let digit = |entry: u64| (entry >> shift) as usize & ((1 << bits) - 1);
        counts.clear();
        counts.resize(unsorted.len().div_ceil(chunk_len) << bits, 0);
        let tasks = counts.par_chunks_mut(1 << bits).zip(unsorted.par_chunks(chunk_len));
        tasks.for_each(|(counts, entries)| {
            for entry in entries {
                counts[digit(entry.load(Relaxed))] += 1;
            }
        });

        // Each digit begins where the one below it ends, each chunk where the one before it does.
        let mut next = 0;
        for digit in 0..1 << bits {
            for count in counts[digit..].iter_mut().step_by(1 << bits) {
                next += std::mem::replace(count, next);
            }
        }
        let tasks = counts.par_chunks_mut(1 << bits).zip(unsorted.par_chunks(chunk_len));
        tasks.for_each(|(next, entries)| {
            for entry in entries {
                let entry = entry.load(Relaxed);
                let place = &mut next[digit(entry)];
                sorted[*place as usize].store(entry, Relaxed);
                *place += 1;
            }
        });
    }

    /// Bytes held.
    pub(super) fn memory_usage(&self) -> usize {
        8 * (self.sorted.capacity() + self.unsorted.capacity()) + 4 * self.counts.capacity()
    }
}

#[cfg(test)]
mod tests {
    use rayflock_testkit::Rng;

    use super::*;

    #[test]
    fn entries_are_sorted_by_key_and_keep_their_order_within_one() {
        let mut rng = Rng::new(42);
        let mut sorter = RadixSorter::default();
        for (len, bits) in [(0, 5), (1, 1), (20, 9), (9000, 10), (30_000, 25), (100, 32)] {
            let entry = |idx| (rng.below(1 << bits) as u64) << 32 | idx as u64;
            let mut expected: Vec<u64> = (0..len).map(entry).collect();
            for (place, entry) in sorter.entries(len).iter_mut().zip(&expected) {
                *place.get_mut() = *entry;
            }
            sorter.sort(bits);
            expected.sort_unstable();
            let sorted = sorter.sorted().iter().map(|entry| entry.load(Relaxed));
            assert!(sorted.eq(expected.iter().copied()), "{len} entries of {bits} bits");
        }
    }
}
