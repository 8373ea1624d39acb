//! One suite for every engine: each test runs on every engine, at every SIMD level of the
//! machine, with one and with two threads.

mod cases;
mod engines;
mod oracle;
mod same_answer;
mod stats;
mod watertight;
