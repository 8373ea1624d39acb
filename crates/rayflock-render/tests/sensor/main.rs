//! Sensors where what they see is known in closed form, or found by other means.
#![expect(clippy::unwrap_used, reason = "the helpers of the tests may fail just as the tests may")]

mod agreement;
mod chance;
mod common;
mod glass;
mod known_ranges;
mod moving;
