//! The program `rayflock`, with an allocator that counts.
//!
//! Counting takes two atomic additions an allocation, which is little beside the allocation, and
//! nothing where nothing is allocated.
#![forbid(unsafe_code)]

use std::alloc::System;
use std::process::ExitCode;

use stats_alloc::{INSTRUMENTED_SYSTEM, StatsAlloc};

#[global_allocator]
static ALLOCATOR: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

fn main() -> ExitCode {
    ExitCode::from(rayflock_cli::run(std::env::args_os(), Some(allocation_count)))
}

/// Allocations and reallocations since the program began.
fn allocation_count() -> u64 {
    let stats = ALLOCATOR.stats();
    (stats.allocations + stats.reallocations) as u64
}
