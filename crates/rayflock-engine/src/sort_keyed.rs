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

/// Bits of the largest digit by which parts are made: places are written to in turn, and with four
/// times as many a million entries took half as long again (two AVX-512 server cores).
const LARGEST_DIGIT: u32 = 10;

/// Bits of the largest digit within a part.
const LARGEST_LOCAL_DIGIT: u32 = 11;

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
        self.sort_and_count(key_bits, None);
    }

    /// The same, and writes for each key, of which there are two to the power of `key_bits`, how
    /// many entries have a lower one.
    pub(crate) fn sort_and_count(&mut self, key_bits: u32, before: Option<&mut [u32]>) {
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
        // Where the last chunk would write next, the parts end.
        let ends = &self.counts[self.counts.len() - (1 << upper_bits)..];
        let entries = [&mut self.sorted[..], &mut self.spare[..]];
        sort_parts(entries, 0, ends, lower_bits, before);
        if pass_count(lower_bits) % 2 == 1 {
            std::mem::swap(&mut self.sorted, &mut self.spare);
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

/// Passes over a part with so many bits left.
fn pass_count(key_bits: u32) -> u32 {
    key_bits.div_ceil(LARGEST_LOCAL_DIGIT)
}

/// Sorts parts, in parallel: `ends` are where they end, `first` is where `entries` begin. What is
/// sorted lies in `spare` where the number of passes is odd.
fn sort_parts(
    [entries, spare]: [&mut [AtomicU64]; 2],
    first: usize,
    ends: &[u32],
    key_bits: u32,
    before: Option<&mut [u32]>,
) {
    if entries.len() > SMALLEST_CHUNK && ends.len() > 1 {
        let half = ends.len() / 2;
        let (left_ends, right_ends) = ends.split_at(half);
        let middle = left_ends.last().map_or(0, |&end| end as usize) - first;
        let (left, right) = entries.split_at_mut(middle);
        let (left_spare, right_spare) = spare.split_at_mut(middle);
        let (left_before, right_before) =
            before.map(|before| before.split_at_mut(half << key_bits)).unzip();
        rayon::join(
            || sort_parts([left, left_spare], first, left_ends, key_bits, left_before),
            || sort_parts([right, right_spare], first + middle, right_ends, key_bits, right_before),
        );
        return;
    }
    let mut begin = 0;
    let mut counts = before.map(|before| before.chunks_mut(1 << key_bits));
    for end in ends.iter().map(|&end| end as usize - first) {
        let part = [&mut entries[begin..end], &mut spare[begin..end]];
        let before = counts.as_mut().and_then(Iterator::next);
        sort_part(part, first + begin, key_bits, before);
        begin = end;
    }
}

/// Sorts one part by the lower `key_bits` of the keys; others are the same all over it. It begins
/// at `first`.
fn sort_part(
    [mut from, mut to]: [&mut [AtomicU64]; 2],
    first: usize,
    key_bits: u32,
    mut before: Option<&mut [u32]>,
) {
    let whole = Digit { shift: u32::BITS, bits: key_bits };
    if let Some(before) = &mut before {
        begin_digits(whole, from, before);
    }
    let passes = pass_count(key_bits);
    let mut next = [0; 1 << LARGEST_LOCAL_DIGIT];
    if from.len() <= SHORT {
        from.sort_unstable_by_key(|entry| entry.load(Relaxed));
        if passes % 2 == 1 {
            to.iter_mut().zip(from).for_each(|(to, from)| *to.get_mut() = *from.get_mut());
        }
    } else if let (1, Some(before)) = (passes, &before) {
        next[..before.len()].copy_from_slice(before);
        move_by(whole, from, to, &mut next);
    } else {
        let bits = key_bits.div_ceil(passes.max(1));
        for pass in 0..passes {
            let digit = Digit { shift: u32::BITS + pass * bits, bits };
            begin_digits(digit, from, &mut next[..1 << bits]);
            move_by(digit, from, to, &mut next);
            std::mem::swap(&mut from, &mut to);
        }
    }
    before.into_iter().flatten().for_each(|before| *before += first as u32);
}

/// Writes for each value of a digit how many entries have a lower one.
fn begin_digits(digit: Digit, entries: &mut [AtomicU64], before: &mut [u32]) {
    before.fill(0);
    for entry in entries {
        before[digit.of(*entry.get_mut())] += 1;
    }
    let mut sum = 0;
    for before in before {
        sum += std::mem::replace(before, sum);
    }
}

/// Moves entries to where one digit sends them, in the order in which they come.
fn move_by(digit: Digit, from: &mut [AtomicU64], to: &mut [AtomicU64], next: &mut [u32]) {
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
            let mut before = vec![0; if bits < 20 { 1 << bits } else { 0 }];
            sorter.sort_and_count(bits, Some(&mut before[..]).filter(|before| !before.is_empty()));
            expected.sort_unstable();
            let sorted = sorter.sorted().iter().map(|entry| entry.load(Relaxed));
            assert!(sorted.eq(expected.iter().copied()), "{len} entries of {bits} bits");
            for (key, before) in before.into_iter().enumerate() {
                let lower = expected.partition_point(|entry| (entry >> 32) < key as u64);
                assert_eq!(before as usize, lower, "before {key} of {bits} bits");
            }
        }
    }
}
