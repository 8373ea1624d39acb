//! Engines.
#![forbid(unsafe_code)]

mod engine;

pub use engine::{CommitStats, EngineError, EngineKind, RayEngine, TraceStats};
