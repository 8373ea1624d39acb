//! Sorts keyed entries: one parallel pass brings them into parts by the upper bits of their keys,
//! then each part is sorted while it lies in the cache.
//!
//! **Source.** M. Zagha, G. Blelloch, "Radix Sort for Vector Multiprocessors", Supercomputing 1991
//! (count digits a chunk, sum, move), for the parts; within a part the same by a few bits at a
//! time.
//!
//! **Cost.** 16 bytes moved an entry through memory; a part is some hundred entries where keys are
//! spread evenly.

use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

use rayon::prelude::*;
use tracing::debug_span;

/// Entries that are worth a task of their own.
const SMALLEST_CHUNK: usize = 4096;

/// Chunks a thread, so that all finish at about the same time.
const CHUNKS_PER_THREAD: usize = 2;

/// Entries wanted in a part.
const PART_LEN: usize = 256;

/// Bits of the largest digit by which parts are made: places are written to in turn.
const LARGEST_DIGIT: u32 = 12;

/// Bits of the largest digit within a part.
const LARGEST_LOCAL_DIGIT: u32 = 8;

/// Parts up to this length are sorted by comparing.
const SHORT: usize = 48;

/// Sorts entries of a key in the upper half and anything in the lower, keeping its memory.
#[derive(Debug, Default)]
pub(crate) struct KeyedSorter {
    /// Atomic because several tasks write each part of it, at places that are not known to differ
    /// but by arithmetic.
    sorted: Vec<AtomicU64>,
    spare: Vec<AtomicU64>,
    /// How often each digit occurs in each chunk; then where its next entry goes.
    counts: Vec<u32>,
}

/// Bits of an entry.
#[derive(Clone, Copy)]
struct Digit {
    shift: u32,
    bits: u32,
}

impl Digit {
    #[inline(always)]
    fn of(self, entry: u64) -> usize {
        (entry >> self.shift) as usize & ((1 << self.bits) - 1)
    }
}

impl KeyedSorter {
    /// Makes room for entries and hands them out to be written.
    pub(crate) fn entries(&mut self, len: usize) -> &mut [AtomicU64] {
        self.sorted.resize_with(len, AtomicU64::default);
        self.spare.resize_with(len, AtomicU64::default);
        &mut self.sorted
    }

    /// Sorts by the lower `key_bits` of the keys; those above must be 0.
    pub(crate) fn sort(&mut self, key_bits: u32) {
        let _span = debug_span!("sort_keyed").entered();
        let parts = (self.sorted.len() / PART_LEN).checked_ilog2().unwrap_or_default();
        let upper_bits = parts.min(LARGEST_DIGIT).min(key_bits);
        let lower_bits = key_bits - upper_bits;
        if upper_bits > 0 {
            std::mem::swap(&mut self.sorted, &mut self.spare);
            self.scatter(Digit { shift: u32::BITS + lower_bits, bits: upper_bits });
        } else {
            self.counts.clear();
            self.counts.push(self.sorted.len() as u32);
        }
        if lower_bits > 0 {
            // Where the last chunk would write next, the parts end.
            let ends = &self.counts[self.counts.len() - (1 << upper_bits)..];
            sort_parts(&mut self.sorted, &mut self.spare, 0, ends, lower_bits);
        }
    }

    /// The entries; sorted after [`Self::sort`].
    pub(crate) fn sorted(&self) -> &[AtomicU64] {
        &self.sorted
    }

    /// Moves all entries from `spare` to where a digit sends them, in the order in which they
    /// come.
    fn scatter(&mut self, digit: Digit) {
        let Self { sorted, spare, counts } = self;
        let chunks = CHUNKS_PER_THREAD * rayon::current_num_threads();
        let chunk_len = spare.len().div_ceil(chunks).max(SMALLEST_CHUNK);
        counts.clear();
        counts.resize(spare.len().div_ceil(chunk_len) << digit.bits, 0);
        let tasks = counts.par_chunks_mut(1 << digit.bits).zip(spare.par_chunks(chunk_len));
        tasks.for_each(|(counts, entries)| {
            for entry in entries {
                counts[digit.of(entry.load(Relaxed))] += 1;
            }
        });

        // Each digit begins where the one below it ends, each chunk where the one before it does.
        let mut next = 0;
        for value in 0..1 << digit.bits {
            for count in counts[value..].iter_mut().step_by(1 << digit.bits) {
                next += std::mem::replace(count, next);
            }
        }
        let tasks = counts.par_chunks_mut(1 << digit.bits).zip(spare.par_chunks(chunk_len));
        tasks.for_each(|(next, entries)| {
            for entry in entries {
                let entry = entry.load(Relaxed);
                let place = &mut next[digit.of(entry)];
                sorted[*place as usize].store(entry, Relaxed);
                *place += 1;
            }
        });
    }

    /// Bytes held.
    pub(crate) fn memory_usage(&self) -> usize {
        8 * (self.sorted.capacity() + self.spare.capacity()) + 4 * self.counts.capacity()
    }
}

/// Sorts parts, in parallel: `ends` are where they end, `first` is where `entries` begin.
fn sort_parts(
    entries: &mut [AtomicU64],
    spare: &mut [AtomicU64],
    first: usize,
    ends: &[u32],
    key_bits: u32,
) {
    if entries.len() > SMALLEST_CHUNK && ends.len() > 1 {
        let (left_ends, right_ends) = ends.split_at(ends.len() / 2);
        let middle = left_ends.last().map_or(0, |&end| end as usize) - first;
        let (left, right) = entries.split_at_mut(middle);
        let (left_spare, right_spare) = spare.split_at_mut(middle);
        rayon::join(
            || sort_parts(left, left_spare, first, left_ends, key_bits),
            || sort_parts(right, right_spare, first + middle, right_ends, key_bits),
        );
        return;
    }
    let mut begin = 0;
    for end in ends.iter().map(|&end| end as usize - first) {
        sort_part(&mut entries[begin..end], &mut spare[begin..end], key_bits);
        begin = end;
    }
}

/// Sorts one part by the lower `key_bits` of the keys; others are the same all over it.
fn sort_part(entries: &mut [AtomicU64], spare: &mut [AtomicU64], key_bits: u32) {
    if entries.len() <= SHORT {
        entries.sort_unstable_by_key(|entry| entry.load(Relaxed));
        return;
    }
    let pass_count = key_bits.div_ceil(LARGEST_LOCAL_DIGIT);
    let bits = key_bits.div_ceil(pass_count);
    for pass in 0..pass_count {
        let digit = Digit { shift: u32::BITS + pass * bits, bits };
        if pass % 2 == 0 {
            move_by(digit, entries, spare);
        } else {
            move_by(digit, spare, entries);
        }
    }
    if pass_count % 2 == 1 {
        for (entry, sorted) in entries.iter_mut().zip(spare) {
            *entry.get_mut() = *sorted.get_mut();
        }
    }
}

/// Moves entries to where one digit sends them, in the order in which they come.
fn move_by(digit: Digit, from: &mut [AtomicU64], to: &mut [AtomicU64]) {
    let mut next = [0_u32; 1 << LARGEST_LOCAL_DIGIT];
    for entry in from.iter_mut() {
        next[digit.of(*entry.get_mut())] += 1;
    }
    let mut place = 0;
    for next in &mut next[..1 << digit.bits] {
        place += std::mem::replace(next, place);
    }
    for entry in from {
        let entry = *entry.get_mut();
        let place = &mut next[digit.of(entry)];
        *to[*place as usize].get_mut() = entry;
        *place += 1;
    }
}

#[cfg(test)]
mod tests {
    use rayflock_testkit::Rng;

    use super::*;

    #[test]
    fn entries_are_sorted_by_key_and_keep_their_order_within_one() {
        let mut rng = Rng::new(42);
        let mut sorter = KeyedSorter::default();
        let cases = [(0, 5), (1, 1), (20, 9), (60, 17), (9000, 10), (30_000, 25), (100, 32)];
        for ((len, bits), is_clustered) in cases.into_iter().flat_map(|c| [(c, false), (c, true)]) {
            let key = |rng: &mut Rng| {
                let shift = if is_clustered && bits > 4 && !rng.one_in(50) { bits - 4 } else { 0 };
                rng.below((1 << bits) >> shift) as u64
            };
            let mut expected: Vec<u64> = (0..len).map(|idx| key(&mut rng) << 32 | idx).collect();
            for (place, entry) in sorter.entries(len as usize).iter_mut().zip(&expected) {
                *place.get_mut() = *entry;
            }
            sorter.sort(bits);
            expected.sort_unstable();
            let sorted = sorter.sorted().iter().map(|entry| entry.load(Relaxed));
            assert!(sorted.eq(expected.iter().copied()), "{len} entries of {bits} bits");
        }
    }
}
