//! A bar with rate and time left on standard error, and nothing when nobody watches it.

use std::fmt::Arguments;
use std::time::Duration;

#[cfg(feature = "bench")]
use indicatif::HumanDuration;
use indicatif::{ProgressBar, ProgressStyle};

use crate::terminal;

/// How far a command has come.
#[derive(Debug)]
pub(crate) struct Progress(ProgressBar);

impl Progress {
    /// A bar for `frame_count` frames of which `done_count` are there already; those do not count
    /// towards the rate.
    pub(crate) fn new(activity: &str, frame_count: u64, done_count: u64) -> Self {
        let template = "{msg} {wide_bar} {pos}/{len} frames, {per_sec}, {eta} left";
        let progress = Self::watched(template, activity, frame_count);
        progress.0.set_position(done_count);
        progress.0.reset_eta();
        progress
    }

    /// A bar for `step_count` steps of something.
    pub(crate) fn of_steps(activity: &str, step_count: u64) -> Self {
        let template = "{msg} {wide_bar} {pos}/{len} steps, {per_sec}, {eta} left";
        Self::watched(template, activity, step_count)
    }

    /// A bar for `cell_count` cells of very different length, whose time left is told by whoever
    /// measures them.
    #[cfg(feature = "bench")]
    pub(crate) fn of_cells(activity: &str, cell_count: u64) -> Self {
        Self::watched("{msg} {wide_bar} {pos}/{len} cells{prefix}", activity, cell_count)
    }

    /// A bar of this look, if somebody watches it.
    fn watched(template: &str, activity: &str, count: u64) -> Self {
        if !terminal::is_watched() {
            return Self(ProgressBar::hidden());
        }
        let style =
            ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar());
        let bar = ProgressBar::new(count).with_style(style).with_message(activity.to_owned());
        bar.enable_steady_tick(Duration::from_millis(250));
        Self(bar)
    }

    /// One more cell is done, and the others will take about so long.
    #[cfg(feature = "bench")]
    pub(crate) fn advance_with(&self, time_left: Duration) {
        self.0.set_prefix(format!(", about {} left", HumanDuration(time_left)));
        self.0.inc(1);
    }

    /// One more frame or step is done.
    pub(crate) fn advance(&self) {
        self.0.inc(1);
    }

    /// Writes a line to standard error without tearing the bar.
    pub(crate) fn say(&self, line: Arguments<'_>) {
        self.0.suspend(|| terminal::say(line));
    }

    /// Takes the bar away.
    pub(crate) fn finish(&self) {
        self.0.finish_and_clear();
    }
}
