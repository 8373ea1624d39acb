//! Following a measurement from outside, and stopping it.

use std::time::Duration;

use crate::record::Cell;

/// Follows a measurement of many cells and may stop it.
pub trait Watch: Send + Sync {
    /// Is called when all engines have been measured in a cell.
    fn on_cell(&mut self, progress: &Progress<'_>);

    /// Whether to stop as soon as possible; what is measured so far is kept.
    fn is_stopped(&self) -> bool;
}

/// How far a measurement has come.
#[derive(Clone, Copy, Debug)]
pub struct Progress<'a> {
    /// Cells measured, this one included.
    pub done_count: usize,
    /// All cells.
    pub count: usize,
    /// An estimate of the time left.
    pub time_left: Duration,
    /// What was measured last, a cell an engine.
    pub cells: &'a [Cell],
}

/// Nobody watches.
#[derive(Clone, Copy, Debug, Default)]
pub struct Unwatched;

impl Watch for Unwatched {
    fn on_cell(&mut self, _: &Progress<'_>) {}

    fn is_stopped(&self) -> bool {
        false
    }
}
