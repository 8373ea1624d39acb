//! What Rayflock's tests share: seeded scenes and rays, case files, the independent oracle.
//!
//! | Part | Use it when |
//! |---|---|
//! | [`oracle`] | you want to know whether a hit is right |
//! | [`image_difference()`] | you compare pictures |
//! | [`Rng`] | you need numbers that a seed reproduces |
#![forbid(unsafe_code)]

mod image_difference;
pub mod oracle;
mod rng;

pub use image_difference::{ImageDifference, image_difference};
pub use rng::Rng;
