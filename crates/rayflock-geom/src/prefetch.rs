//! Asks for memory before it is needed, so that the processor does not wait for it later.
//!
//! Where a pass reads rows in an order that no cache expects, waiting is most of its work: several
//! hundred cycles a row, and a load that waits holds up what comes after it. A hint does not.
//!
//! No effect on any value; none at all on processors without such a hint.
#![expect(unsafe_code, reason = "the hint is an intrinsic")]

/// Bytes of a line of the cache.
const LINE: usize = 64;

/// Asks for the lines on which a value begins and ends, and for those between.
#[inline(always)]
pub fn prefetch<T>(value: &T) {
    let first = std::ptr::from_ref(value).cast::<u8>();
    for offset in (0..size_of::<T>()).step_by(LINE) {
        prefetch_line(first.wrapping_add(offset));
    }
    prefetch_line(first.wrapping_add(size_of::<T>().saturating_sub(1)));
}

#[cfg(all(target_arch = "x86_64", not(miri)))]
#[inline(always)]
fn prefetch_line(line: *const u8) {
    use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
    // SAFETY: The instruction belongs to SSE, which every x86-64 processor has. It loads nothing
    // that the program sees and cannot fault, whatever the address.
    unsafe { _mm_prefetch::<_MM_HINT_T0>(line.cast()) };
}

#[cfg(not(all(target_arch = "x86_64", not(miri))))]
#[inline(always)]
const fn prefetch_line(_line: *const u8) {}
