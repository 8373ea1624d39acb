//! How far a measurement of many cells has come, and how long it will take.

use std::time::Instant;

use super::watch::Progress;
use crate::record::Cell;

/// Cells of which is known how long they take in relation to each other.
#[derive(Debug)]
pub(crate) struct Course {
    start: Instant,
    done_count: usize,
    count: usize,
    done_weight: f64,
    weight: f64,
}

impl Course {
    /// A course of cells of so many triangles and rays.
    pub(crate) fn new(sizes: impl IntoIterator<Item = (usize, usize)>) -> Self {
        let weights = sizes.into_iter().map(|(triangles, rays)| weight(triangles, rays));
        let (count, weight) =
            weights.fold((0, 0.0), |(count, sum), weight| (count + 1, sum + weight));
        Self { start: Instant::now(), done_count: 0, count, done_weight: 0.0, weight }
    }

    /// One more cell is done.
    pub(crate) fn advance<'a>(
        &mut self,
        triangles: usize,
        rays: usize,
        cells: &'a [Cell],
    ) -> Progress<'a> {
        self.done_count += 1;
        self.done_weight += weight(triangles, rays);
        let left = (self.weight / self.done_weight - 1.0).max(0.0);
        let time_left = self.start.elapsed().mul_f64(left);
        Progress { done_count: self.done_count, count: self.count, time_left, cells }
    }
}

/// How long a cell takes, in some unit: short frames get a fixed time, long ones at least some
/// rounds.
fn weight(triangles: usize, rays: usize) -> f64 {
    let share = |count: usize| count as f64 / f64::from(1 << 20);
    1.0 + 2.0 * share(triangles) + 4.0 * share(rays)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_cell_leaves_no_time() {
        let sizes = [(1 << 10, 1 << 12), (1 << 20, 1 << 20)];
        let mut course = Course::new(sizes);
        let first = course.advance(sizes[0].0, sizes[0].1, &[]);
        assert_eq!((first.done_count, first.count), (1, 2));
        let last = course.advance(sizes[1].0, sizes[1].1, &[]);
        assert_eq!(last.done_count, 2);
        assert!(last.time_left.as_secs_f64() < 1e-6, "{last:?}");
    }
}
