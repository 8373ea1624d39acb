//! One suite for every engine: each test runs on every engine, at every SIMD level of the
//! machine, with one and with two threads.
#![forbid(unsafe_code)]
#![expect(clippy::unwrap_used, reason = "the tests' helpers may fail just as the tests may")]

mod auto;
mod cases;
mod counters;
mod engines;
mod groups;
mod nesting;
mod oracle;
mod same_answer;
mod stats;
mod subfields;
mod watertight;
