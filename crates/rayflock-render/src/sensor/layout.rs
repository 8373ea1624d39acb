//! Which beams fire together, where they belong in a picture, and when their turn comes.

use std::ops::Range;

use rayflock_geom::RayOrder;

/// The lines of a pattern: beams that fire together, one line after the other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Layout {
    pub(crate) beam_count: usize,
    /// Beams of a line; the last one may have fewer.
    pub(crate) line_len: usize,
    pub(crate) lines: Lines,
    /// Time from the first line to where one after the last would be; 0 where all fire at once.
    pub(crate) seconds: f64,
}

/// What lines are in the picture of a pattern.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Lines {
    /// From left to right, each from top to bottom.
    Columns,
    /// From top to bottom, each from left to right.
    Rows,
    /// Nothing: beams have a number and no neighbours above or below.
    Bursts,
}

impl Layout {
    pub(crate) fn line_count(&self) -> usize {
        self.beam_count.div_ceil(self.line_len)
    }

    /// Row and column of a beam.
    pub(crate) fn place(&self, beam_idx: usize) -> (u32, u32) {
        let (line, in_line) =
            ((beam_idx / self.line_len) as u32, (beam_idx % self.line_len) as u32);
        match self.lines {
            Lines::Columns => (in_line, line),
            Lines::Rows => (line, in_line),
            Lines::Bursts => (0, beam_idx as u32),
        }
    }

    /// The time steps that there are unless fewer are asked for.
    pub(crate) fn most_steps(&self) -> usize {
        if self.seconds > 0.0 { self.line_count() } else { 1 }
    }

    /// The beams of step `step_idx` of `step_count`.
    pub(crate) fn beams_of_step(&self, step_idx: usize, step_count: usize) -> Range<usize> {
        let lines = self.lines_of_step(step_idx, step_count);
        lines.start * self.line_len..(lines.end * self.line_len).min(self.beam_count)
    }

    /// When step `step_idx` of `step_count` is, in seconds after the start of the sweep: in the
    /// middle between its first and its last line.
    pub(crate) fn time_of_step(&self, step_idx: usize, step_count: usize) -> f64 {
        let lines = self.lines_of_step(step_idx, step_count);
        let middle = 0.5 * (lines.start + lines.end.saturating_sub(1)) as f64;
        middle / self.line_count() as f64 * self.seconds
    }

    /// How the beams of a step lie to each other.
    pub(crate) fn order(&self, beams: &Range<usize>) -> RayOrder {
        match self.lines {
            Lines::Bursts => RayOrder::Coherent,
            Lines::Columns | Lines::Rows => RayOrder::Image {
                width: self.line_len,
                height: beams.len() / self.line_len,
                tile: 0,
            },
        }
    }

    fn lines_of_step(&self, step_idx: usize, step_count: usize) -> Range<usize> {
        let line_count = self.line_count();
        let first_line = |step_idx: usize| step_idx * line_count / step_count;
        first_line(step_idx)..first_line(step_idx + 1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const COLUMNS: Layout =
        Layout { beam_count: 40, line_len: 4, lines: Lines::Columns, seconds: 0.1 };

    #[test]
    fn every_beam_is_in_one_step() {
        let bursts = Layout { beam_count: 39, lines: Lines::Bursts, ..COLUMNS };
        for layout in [COLUMNS, bursts] {
            for step_count in 1..=10 {
                let steps = (0..step_count).flat_map(|idx| layout.beams_of_step(idx, step_count));
                assert!(steps.eq(0..layout.beam_count), "{step_count}");
            }
        }
    }

    #[test]
    fn steps_are_in_the_middle_of_their_lines() {
        let times = |step_count| -> Vec<f64> {
            (0..step_count).map(|idx| COLUMNS.time_of_step(idx, step_count)).collect()
        };
        assert_eq!(times(10)[3], 0.03);
        assert!((times(2)[1] - 0.07).abs() < 1e-12 && (times(1)[0] - 0.045).abs() < 1e-12);
        let global = Layout { seconds: 0.0, ..COLUMNS };
        assert_eq!((global.most_steps(), global.time_of_step(0, 1)), (1, 0.0));
    }

    #[test]
    fn lines_are_columns_rows_or_nothing() {
        assert_eq!(COLUMNS.place(6), (2, 1));
        assert_eq!(Layout { lines: Lines::Rows, ..COLUMNS }.place(6), (1, 2));
        assert_eq!(Layout { lines: Lines::Bursts, ..COLUMNS }.place(6), (0, 6));
    }
}
