//! Tests of the engines on a graphics device.
//!
//! They run on every adapter that can be used, software ones included. Without any they say so
//! and pass, unless `RAYFLOCK_GPU_ADAPTERS` says how many there must be.
#![forbid(unsafe_code)]
#![expect(clippy::unwrap_used, reason = "the tests' helpers may fail just as the tests may")]

mod agreement;
mod device;
mod frames;
mod loss;
mod pictures;
mod scenes;
mod stats;
mod subfields;
mod walls;
