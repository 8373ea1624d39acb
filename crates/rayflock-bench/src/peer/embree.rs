//! Embree 4 as an engine: the opponent, used in every way its experts would.
//!
//! The library is loaded when the program runs ([`EmbreeLibrary`]); nothing of it is needed to
//! build. How it is used is a [`Setting`]. The stages, in the order of a frame: `write` brings
//! objects into shared buffers, `moving`, `group` and `world` decide which geometry and scene they
//! belong to and have Embree build, `rays` brings a batch into Embree's layout and hits back, `trace` calls
//! Embree. `layout` says how things lie in memory, `ffi` is the only module with unsafe code.
//!
//! **Source.** I. Wald, S. Woop, C. Benthin, G. Johnson, M. Ernst, "Embree: A Kernel Framework for
//! Efficient CPU Ray Tracing", SIGGRAPH 2014; the headers and manual of Embree 4.
//!
//! **Departures** from what our engines answer:
//! - `t`, `u` and `v` differ within the error of Embree's arithmetic; ties are broken by chance;
//!   edges are watertight only with [`Setting::robust`].
//! - Embree's interval is open at `t_min`: what lies exactly there is not hit.
//! - Denormal numbers are zeros.
//! - There are no user primitives.
//! - Embree takes coordinates beyond 1.8e18 for invalid.
//!
//! **Cost.** What Embree needs, and outside of the time that is charged to it, a copy of all
//! positions that changed and of all rays.

mod engine;
mod ffi;
mod group;
mod layout;
mod library;
mod moving;
mod rays;
mod setting;
mod trace;
mod world;
mod write;

pub use engine::EmbreeEngine;
pub use library::EmbreeLibrary;
pub use setting::{Build, Layout, Quality, Setting, Traversal, Width};
