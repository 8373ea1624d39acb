//! What a call of an engine costs.

use std::ops::Add;
use std::time::{Duration, Instant};

use crate::AllocationCounter;

/// Measures calls.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Meter(pub(super) AllocationCounter);

/// Time and allocations.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Cost {
    /// Wall-clock time.
    pub(super) time: Duration,
    /// How often memory was allocated, where that is counted.
    pub(super) allocations: Option<u64>,
}

impl Meter {
    /// Does `work` and says what it cost.
    pub(super) fn measure<R>(&self, work: impl FnOnce() -> R) -> (R, Cost) {
        let ((result, time), allocations) = self.0.count(|| {
            let start = Instant::now();
            let result = work();
            (result, start.elapsed())
        });
        (result, Cost { time, allocations })
    }
}

impl Cost {
    /// The cost without conversions that an engine's own users would not need.
    pub(super) fn without(self, conversion_ns: u64) -> Self {
        let time = self.time.saturating_sub(Duration::from_nanos(conversion_ns));
        Self { time, ..self }
    }
}

impl Add for Cost {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        let allocations = self.allocations.zip(other.allocations).map(|(a, b)| a + b);
        Self { time: self.time + other.time, allocations }
    }
}
