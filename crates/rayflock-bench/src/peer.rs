//! Engines of others, so that every claim is a ratio on the same work in the same run.
//!
//! | Peer | What it is | Use it when |
//! |---|---|---|
//! | [`embree`] | Embree 4, a library loaded when the program runs | you want the opponent |
//! | [`obvhs`] | a library of hierarchies in pure Rust | you want a second opinion with nothing to install |
//! | `floor` | none: reads and writes what every engine has to | you want to know what is left to gain |
//!
//! Peers are [`RayEngine`](rayflock::engine::RayEngine)s, so that all that is measured goes through one door. What their own users
//! would not pay, bringing our columns into their layout and back, is done in passes of its own and
//! told as `conversion_ns`; benchmarks subtract it.
//!
//! Peers agree with our engines within the error of their arithmetic, not to the bit, and say where
//! they do not answer at all: see each one's departures.

mod behind;
pub mod embree;
mod error;
pub(crate) mod floor;
pub mod obvhs;

pub use error::PeerError;
