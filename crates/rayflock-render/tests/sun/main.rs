//! Hours of sun where they are known in closed form.
#![expect(clippy::unwrap_used, reason = "the helpers of the tests may fail just as the tests may")]

mod agreement;
mod common;
mod motion;
mod obstacles;
mod open_sky;
