//! The threads that scenes work on.
//!
//! A fork takes one thread into the child: a pool made before has no workers there and would wait
//! for them for ever. So pools know their process, and a child makes its own.

use std::sync::{Arc, Mutex, PoisonError};

use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::errors::Failure;

/// Pools that are kept; more sizes than this at once are made anew each time.
const KEPT: usize = 4;

/// The pools of this process, the one used last at the end.
static POOLS: Mutex<Vec<Pool>> = Mutex::new(Vec::new());

struct Pool {
    process: u32,
    threads: usize,
    pool: Arc<ThreadPool>,
}

/// A pool of this many threads; 0 for one a core.
pub(crate) fn with_threads(threads: usize) -> Result<Arc<ThreadPool>, Failure> {
    let process = std::process::id();
    let mut pools = POOLS.lock().unwrap_or_else(PoisonError::into_inner);
    if pools.iter().any(|pool| pool.process != process) {
        // Dropping them would wake workers that are not here.
        std::mem::forget(std::mem::take(&mut *pools));
    }
    let pool = match pools.iter().position(|pool| pool.threads == threads) {
        Some(place) => pools.remove(place).pool,
        None => Arc::new(start(threads)?),
    };
    if pools.len() == KEPT {
        pools.remove(0);
    }
    pools.push(Pool { process, threads, pool: Arc::clone(&pool) });
    Ok(pool)
}

fn start(threads: usize) -> Result<ThreadPool, Failure> {
    let builder = ThreadPoolBuilder::new().num_threads(threads);
    let builder = builder.thread_name(|idx| format!("rayflock {idx}"));
    builder.build().map_err(|error| Failure::value(format!("cannot start threads: {error}")))
}
