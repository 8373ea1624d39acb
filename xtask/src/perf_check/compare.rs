//! Judges counts by the baseline.

use super::baseline::Baseline;
use super::measure::Counted;

/// By how much a count may grow, as a share: changes that touch other code move registers and
/// layouts a little.
const TOLERANCE: f64 = 0.03;

/// What is said about a case.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Verdict {
    /// Within the tolerance.
    Same,
    /// Fewer by more than the tolerance: good, and worth a new baseline.
    Fewer,
    /// More by more than the tolerance.
    More,
    /// Not in the baseline.
    New,
    /// In the baseline alone.
    Gone,
}

impl Verdict {
    /// What to do when the check fails.
    pub(super) const ADVICE: &'static str = "counts grew by more than 3 %, or cases are not those \
        of the baseline; find out why, or accept them by \"cargo xtask perf-check --update\"";

    /// Whether the check fails for it.
    pub(super) const fn is_failure(self) -> bool {
        matches!(self, Self::More | Self::New | Self::Gone)
    }

    const fn text(self) -> &'static str {
        match self {
            Self::Same => "",
            Self::Fewer => "fewer",
            Self::More => "MORE",
            Self::New => "NEW",
            Self::Gone => "GONE",
        }
    }
}

/// A case with its baseline.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Line {
    /// The case.
    pub(super) name: String,
    before: Option<u64>,
    now: Option<Counted>,
    /// How both compare.
    pub(super) verdict: Verdict,
}

/// Compares each case counted with its baseline; then come those of the baseline alone.
pub(super) fn compare(baseline: Option<&Baseline>, counted: &[Counted]) -> Vec<Line> {
    let before =
        |name: &str| baseline.and_then(|baseline| baseline.instructions.get(name).copied());
    let lines = counted.iter().map(|case| {
        let before = before(&case.name);
        let verdict = before.map_or(Verdict::New, |before| judge(before, case.instructions));
        Line { name: case.name.clone(), before, now: Some(case.clone()), verdict }
    });
    let known = |name: &String| counted.iter().any(|case| case.name == *name);
    let gone = baseline.iter().flat_map(|baseline| &baseline.instructions);
    let gone = gone.filter(|(name, _)| !known(name)).map(|(name, &before)| Line {
        name: name.clone(),
        before: Some(before),
        now: None,
        verdict: Verdict::Gone,
    });
    lines.chain(gone).collect()
}

fn judge(before: u64, now: u64) -> Verdict {
    let (before, now) = (before as f64, now as f64);
    if now > before * (1.0 + TOLERANCE) {
        Verdict::More
    } else if now < before * (1.0 - TOLERANCE) {
        Verdict::Fewer
    } else {
        Verdict::Same
    }
}

/// The comparison as text, a line a case.
pub(super) fn table(lines: &[Line]) -> String {
    let mut text = format!(
        "{:20} {:>13} {:>13} {:>8}  {:>10}\n",
        "case", "baseline", "now", "change", "an item"
    );
    for Line { name, before, now, verdict } in lines {
        let count = |count: Option<u64>| count.map_or("-".to_owned(), |count| count.to_string());
        let change = before.zip(now.as_ref()).map_or("-".to_owned(), |(before, now)| {
            format!("{:+.2} %", 100.0 * (now.instructions as f64 / before as f64 - 1.0))
        });
        let (now, item) = now.as_ref().map_or((None, String::new()), |now| {
            let each = now.instructions as f64 / now.item_count.max(1) as f64;
            (Some(now.instructions), format!("{each:>10.2} for {} {}", now.item_count, now.item))
        });
        let (before, now) = (count(*before), count(now));
        let verdict = verdict.text();
        let line = format!("{name:20} {before:>13} {now:>13} {change:>8}  {item:43} {verdict}");
        text += line.trim_end();
        text.push('\n');
    }
    text
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;

    fn counted(name: &str, instructions: u64) -> Counted {
        Counted {
            name: name.to_owned(),
            simd: "avx2".to_owned(),
            instructions,
            item_count: 100,
            item: "rays".to_owned(),
        }
    }

    fn baseline(counts: &[(&str, u64)]) -> Baseline {
        let counts = counts.iter().map(|&(name, count)| (name.to_owned(), count));
        Baseline {
            simd: "avx2".to_owned(),
            rustc: "rustc 1.95.0".to_owned(),
            instructions: counts.collect::<BTreeMap<_, _>>(),
        }
    }

    fn verdicts(before: &[(&str, u64)], now: &[(&str, u64)]) -> Vec<Verdict> {
        let now: Vec<_> = now.iter().map(|&(name, count)| counted(name, count)).collect();
        let lines = compare(Some(&baseline(before)), &now);
        lines.iter().map(|line| line.verdict).collect()
    }

    #[test]
    fn only_growth_beyond_three_percent_fails() {
        let before = [("x", 100_000)];
        for (now, verdict) in [
            (100_000, Verdict::Same),
            (103_000, Verdict::Same),
            (103_001, Verdict::More),
            (97_000, Verdict::Same),
            (96_999, Verdict::Fewer),
        ] {
            assert_eq!(verdicts(&before, &[("x", now)]), [verdict], "{now}");
        }
        assert!(Verdict::More.is_failure());
        assert!(!Verdict::Same.is_failure() && !Verdict::Fewer.is_failure());
    }

    #[test]
    fn a_case_without_a_baseline_and_one_that_vanished_fail() {
        let found = verdicts(&[("old", 5), ("x", 5)], &[("new", 5), ("x", 5)]);
        assert_eq!(found, [Verdict::New, Verdict::Same, Verdict::Gone]);
        assert!(Verdict::New.is_failure() && Verdict::Gone.is_failure());
        assert_eq!(compare(None, &[counted("x", 5)])[0].verdict, Verdict::New);
    }

    #[test]
    fn a_baseline_of_nothing_is_exceeded_by_anything() {
        assert_eq!(verdicts(&[("x", 0)], &[("x", 1)]), [Verdict::More]);
        assert_eq!(verdicts(&[("x", 0)], &[("x", 0)]), [Verdict::Same]);
    }

    #[test]
    fn the_table_tells_change_and_count_an_item() {
        let lines = compare(Some(&baseline(&[("x", 1000), ("old", 7)])), &[counted("x", 1100)]);
        let text = table(&lines);
        let rows: Vec<_> = text.lines().collect();
        assert_eq!(rows.len(), 3);
        for part in ["1000", "1100", "+10.00 %", "11.00 for 100 rays", "MORE"] {
            assert!(rows[1].contains(part), "{part} in {text}");
        }
        assert!(rows[2].contains("GONE"), "{text}");
    }
}
