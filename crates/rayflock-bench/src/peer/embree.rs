//! Embree 4 as an engine.

mod engine;
mod library;
mod setting;

pub use engine::EmbreeEngine;
pub use library::EmbreeLibrary;
pub use setting::{Build, Layout, Quality, Setting, Traversal, Width};
