//! Tests of the engines on a graphics device.
//!
//! They run on every adapter that there is, software ones included. Without any they say so and
//! pass, unless `RAYFLOCK_GPU_ADAPTERS` says how many there must be.

mod agreement;
mod device;
mod loss;
mod pictures;
mod scenes;
mod stats;
