//! How much time measuring may take.

use std::time::{Duration, Instant};

/// How long a cell is measured, and when an engine is too slow for it.
///
/// First come rounds that do not count, for engines that learn or improve what they keep: as many
/// as `settling_rounds`, but an engine begins none when it has taken `settling_time`.
///
/// A phase gets `usual_rounds`, unless they would take longer than `phase_time`; then fewer, down
/// to `min_rounds`. Where frames are so short that they take less than `short_time`, rounds go on
/// until that has passed, up to `max_rounds`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Effort {
    /// Rounds before those that count.
    pub settling_rounds: usize,
    /// After this, the next round counts.
    pub settling_time: Duration,
    /// Rounds a phase at least, unless `cell_time` is over.
    pub min_rounds: usize,
    /// Rounds of frames that are neither very short nor very long.
    pub usual_rounds: usize,
    /// Rounds a phase at most.
    pub max_rounds: usize,
    /// What the rounds of a phase may take.
    pub phase_time: Duration,
    /// What the rounds of a phase take at least.
    pub short_time: Duration,
    /// An engine that traces longer than this is skipped.
    pub frame_limit: Duration,
    /// What looking for Embree's best settings may take.
    pub screen_time: Duration,
    /// No further round is begun that is expected to end after this.
    pub cell_time: Duration,
}

impl Effort {
    /// What a record needs.
    pub const FULL: Self = Self {
        settling_rounds: 8,
        settling_time: Duration::from_millis(500),
        min_rounds: 4,
        usual_rounds: 16,
        max_rounds: 1000,
        phase_time: Duration::from_millis(2000),
        short_time: Duration::from_millis(500),
        frame_limit: Duration::from_millis(2500),
        screen_time: Duration::from_millis(5000),
        cell_time: Duration::from_secs(18),
    };

    /// What an impression needs.
    pub const QUICK: Self = Self {
        settling_rounds: 8,
        settling_time: Duration::from_millis(500),
        min_rounds: 4,
        usual_rounds: 8,
        max_rounds: 200,
        phase_time: Duration::from_millis(500),
        short_time: Duration::from_millis(150),
        frame_limit: Duration::from_millis(1000),
        screen_time: Duration::from_millis(1500),
        cell_time: Duration::from_secs(4),
    };

    /// Exactly `run_count` rounds a phase, however long they take.
    pub const fn of_runs(run_count: usize) -> Self {
        let for_ever = Duration::from_secs(1 << 20);
        Self {
            settling_rounds: 0,
            settling_time: Duration::ZERO,
            min_rounds: run_count,
            usual_rounds: run_count,
            max_rounds: run_count,
            phase_time: for_ever,
            short_time: Duration::ZERO,
            frame_limit: Duration::from_secs(10),
            screen_time: Self::FULL.screen_time,
            cell_time: for_ever,
        }
    }

    /// The same with time to settle in first.
    pub const fn settled(self) -> Self {
        let Self { settling_rounds, settling_time, .. } = Self::FULL;
        Self { settling_rounds, settling_time, ..self }
    }

    /// Whether a phase ends after `round_count` rounds in `elapsed`, the last of which took
    /// `last`; `remaining` is what is left of the cell's time for this phase.
    pub(super) fn is_over(
        &self,
        round_count: usize,
        elapsed: Duration,
        last: Duration,
        remaining: Duration,
    ) -> bool {
        if round_count == 0 {
            return false;
        }
        if last > remaining || round_count >= self.max_rounds {
            return true;
        }
        let enough = round_count >= self.usual_rounds && elapsed >= self.short_time;
        enough || (round_count >= self.min_rounds && elapsed + last > self.phase_time)
    }
}

/// The time of one cell.
#[derive(Clone, Copy, Debug)]
pub(super) struct Clock {
    end: Instant,
}

impl Clock {
    /// Starts now.
    pub(super) fn start(effort: &Effort) -> Self {
        Self { end: Instant::now() + effort.cell_time }
    }

    /// What is left for one of `count` things that are still to be done.
    pub(super) fn share(&self, count: usize) -> Duration {
        self.end.saturating_duration_since(Instant::now()) / count.max(1) as u32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MS: Duration = Duration::from_millis(1);
    const PLENTY: Duration = Duration::from_secs(60);

    /// Rounds that fit when each takes `round`.
    fn rounds(round: Duration, cell: Duration) -> usize {
        let effort = Effort::FULL;
        (0..)
            .find(|&count| {
                let elapsed = round * count;
                effort.is_over(count as usize, elapsed, round, cell.saturating_sub(elapsed))
            })
            .unwrap() as usize
    }

    #[test]
    fn short_frames_get_many_rounds_and_long_ones_few() {
        assert_eq!(rounds(MS / 10, PLENTY), Effort::FULL.max_rounds);
        assert_eq!(rounds(MS, PLENTY), 500);
        assert_eq!(rounds(50 * MS, PLENTY), Effort::FULL.usual_rounds);
        assert_eq!(rounds(250 * MS, PLENTY), 8);
        assert_eq!(rounds(900 * MS, PLENTY), Effort::FULL.min_rounds);
    }

    #[test]
    fn when_the_time_of_the_cell_is_over_one_round_must_do() {
        assert_eq!(rounds(900 * MS, 2 * 900 * MS), 2);
        assert_eq!(rounds(900 * MS, Duration::ZERO), 1);
    }
}
