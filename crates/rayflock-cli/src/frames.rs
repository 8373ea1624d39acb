//! Which frames to render.

use std::fmt;
use std::str::FromStr;

/// Frames from `first` to `last`, both included.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct FrameRange {
    /// The first frame, counted from 0.
    pub(crate) first: u32,
    /// The last frame; `first <= last`.
    pub(crate) last: u32,
}

impl FrameRange {
    /// The first `count` frames, one at least.
    pub(crate) const fn first_frames(count: u32) -> Self {
        Self { first: 0, last: count.saturating_sub(1) }
    }

    /// Number of frames.
    pub(crate) fn count(self) -> u64 {
        u64::from(self.last - self.first) + 1
    }

    /// The frames in order.
    pub(crate) fn iter(self) -> impl Iterator<Item = u32> {
        self.first..=self.last
    }

    /// The frame that is shown during a part, when the frames are shared out evenly among
    /// `part_count` equal parts, one at least; `part_idx < part_count`. The first frame is shown in
    /// the first part; where frames are more than parts, some are left out.
    pub(crate) fn at_part(self, part_idx: u32, part_count: u32) -> u32 {
        let offset = u64::from(part_idx) * self.count() / u64::from(part_count.max(1));
        self.first.saturating_add(u32::try_from(offset).unwrap_or(u32::MAX)).min(self.last)
    }

    /// The frames in the middle of `part_count` equal parts; all frames where they are fewer.
    #[cfg(feature = "bench")]
    pub(crate) fn spread(self, part_count: u64) -> Vec<u32> {
        let parts = part_count.min(self.count());
        let middle = |part: u64| (2 * part + 1) * self.count() / (2 * parts);
        let offset = |part| u32::try_from(middle(part)).unwrap_or(u32::MAX);
        (0..parts).map(|part| self.first.saturating_add(offset(part))).collect()
    }
}

impl FromStr for FrameRange {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (first, last) = text.split_once("..").unwrap_or((text, text));
        let (Ok(first), Ok(last)) = (first.parse(), last.parse()) else {
            return Err("expected A..B or a single frame, counted from 0, as in 0..47".to_owned());
        };
        if first > last {
            return Err(format!("the range is empty; expected {last}..{first}"));
        }
        Ok(Self { first, last })
    }
}

impl fmt::Display for FrameRange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}..{}", self.first, self.last)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_include_both_ends() {
        let range: FrameRange = "3..7".parse().unwrap();
        assert_eq!(range.count(), 5);
        assert_eq!(range.iter().collect::<Vec<_>>(), [3, 4, 5, 6, 7]);
        assert_eq!("9".parse(), Ok(FrameRange { first: 9, last: 9 }));
        assert_eq!("0..4294967295".parse::<FrameRange>().unwrap().count(), 1 << 32);
    }

    #[cfg(feature = "bench")]
    #[test]
    fn a_few_frames_spread_over_a_range_lie_in_the_middle_of_equal_parts() {
        let spread = |text: &str, parts| text.parse::<FrameRange>().unwrap().spread(parts);
        assert_eq!(spread("0..99", 5), [10, 30, 50, 70, 90]);
        assert_eq!(spread("7..9", 5), [7, 8, 9]);
        assert_eq!(spread("4..4", 5), [4]);
        assert_eq!(spread("0..4294967295", 2), [1 << 30, 3 << 30]);
    }

    #[test]
    fn frames_are_shared_out_evenly_among_parts() {
        let shown = |text: &str, parts: u32| -> Vec<u32> {
            let range: FrameRange = text.parse().unwrap();
            (0..parts).map(|part| range.at_part(part, parts)).collect()
        };
        assert_eq!(shown("4..5", 6), [4, 4, 4, 5, 5, 5]);
        assert_eq!(shown("0..2", 4), [0, 0, 1, 2]);
        assert_eq!(shown("10..19", 4), [10, 12, 15, 17]);
        assert_eq!(shown("7", 3), [7, 7, 7]);
        assert_eq!(shown("0..4294967295", 2), [0, 1 << 31]);
    }

    #[test]
    fn what_is_no_range_is_told_what_to_write() {
        for text in ["", "..", "1..", "..1", "-1..2", "a..b", "1..2..3", "1.5", "4294967296"] {
            let message = text.parse::<FrameRange>().unwrap_err();
            assert!(message.contains("as in 0..47"), "{text}: {message}");
        }
        let message = "7..3".parse::<FrameRange>().unwrap_err();
        assert_eq!(message, "the range is empty; expected 3..7");
    }
}
