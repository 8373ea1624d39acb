//! How much memory reading a file may take, and what it took.

use peak_alloc::PeakAlloc;

#[global_allocator]
static MEMORY: PeakAlloc = PeakAlloc;

/// Bytes that reading any file may take: 64 MiB.
const BASE: usize = 64 << 20;
/// Bytes for each byte of the file.
const RATIO: usize = 50;

/// Calls `read`, and panics when that takes more memory than reading a file of `size` bytes may.
pub(crate) fn assert_within<T>(name: &str, size: usize, read: impl FnOnce() -> T) -> T {
    let (taken, result) = taken_by(read);
    let limit = BASE + RATIO * size;
    assert!(taken <= limit, "{name}: {size} bytes took {taken} bytes, expected at most {limit}");
    result
}

/// The bytes that were held at most while `work` was done, besides those held before. No other
/// thread may be at work.
pub(crate) fn taken_by<T>(work: impl FnOnce() -> T) -> (usize, T) {
    let before = MEMORY.current_usage();
    MEMORY.reset_peak_usage();
    let result = work();
    (MEMORY.peak_usage().saturating_sub(before), result)
}
