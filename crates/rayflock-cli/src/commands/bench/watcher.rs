//! Shows how a benchmark comes along, and stops it when the user wants to.

use rayflock_bench::contest::{Progress as Course, Watch};
use rayflock_bench::map;

use crate::failure::{Blame, Failure};
use crate::interrupt::Interrupt;
use crate::progress::Progress;

/// A bar with the time left, a line a cell, and an ear for Ctrl-C.
#[derive(Debug)]
pub(super) struct Watcher {
    progress: Progress,
    interrupt: Interrupt,
    done_count: usize,
    count: usize,
}

impl Watcher {
    /// Watches over `count` cells.
    pub(super) fn new(activity: &str, count: usize) -> Result<Self, Failure> {
        let interrupt = Interrupt::listen().blame_output()?;
        let progress = Progress::of_cells(activity, count as u64);
        Ok(Self { progress, interrupt, done_count: 0, count })
    }

    /// Takes the bar away, and says so if the user stopped the benchmark.
    pub(super) fn finish(self) -> Result<(), Failure> {
        self.progress.finish();
        if !self.interrupt.is_raised() {
            return Ok(());
        }
        let Self { done_count, count, .. } = self;
        Err(Failure::Interrupted(format!("stopped after {done_count} of {count} cells")))
    }
}

impl Watch for Watcher {
    fn on_cell(&mut self, course: &Course<'_>) {
        (self.done_count, self.count) = (course.done_count, course.count);
        self.progress.say(format_args!("{}", map::one_line(course.cells)));
        self.progress.advance_with(course.time_left);
    }

    fn is_stopped(&self) -> bool {
        self.interrupt.is_raised()
    }
}
