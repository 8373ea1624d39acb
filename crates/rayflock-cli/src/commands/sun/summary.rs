//! What was found, as text, a line each.

use std::fmt::Write;

use super::hours::SunHours;
use super::measure::Effort;
use super::plan::{SunPlan, clock};

/// What is said where there is nothing to add up.
pub(super) const NO_SUN: &str =
    "the sun is never above the horizon in these hours: all hours are 0";

/// The summary for people.
pub(super) fn format(plan: &SunPlan, hours: &SunHours<'_>, effort: &Effort) -> String {
    let mut text = format!("{}\n", plan.input.name);
    let mut line = |name: &str, value: &str| {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "  {name:<10} {value}");
    };
    line("samples", &samples(hours, effort));
    line("days", &days(plan));
    line("sun", &sun(plan, hours));
    let (least, most) = hours.range();
    let (mean, unit) = (hours.mean(), hours.unit());
    line("lit", &format!("{least:.2} to {most:.2} {unit}, mean {mean:.2}"));
    line("took", &took(effort));
    text
}

fn samples(hours: &SunHours<'_>, effort: &Effort) -> String {
    let (count, name) = (hours.hours.len(), hours.sample_name());
    match effort.blind_count {
        0 => format!("{count} {name}"),
        blind => format!("{count} {name}, of which {blind} have no normal and are never lit"),
    }
}

/// Which days and hours: `2024-06-21, 00:00 to 24:00 UTC+02`.
fn days(plan: &SunPlan) -> String {
    let days = &plan.days;
    let range = match days.day_count() {
        1 => days.first.to_string(),
        count => format!("{} to {}, {count} days", days.first, days.last),
    };
    let looked_at = match days.every {
        0..=1 => String::new(),
        every => format!(", looked at every {every} days: {}", days.sampled_day_count()),
    };
    let frames = match plan.frames.count() {
        1 => String::new(),
        count => format!(", {count} frames a day"),
    };
    let (from, to) = (clock(days.from_minute), clock(days.to_minute));
    format!("{range}{looked_at}; {from} to {to} UTC{}{frames}", days.utc_offset)
}

fn sun(plan: &SunPlan, hours: &SunHours<'_>) -> String {
    let days = &plan.days;
    let all = u64::from(days.sampled_day_count()) * u64::from(days.steps_per_day());
    let minutes =
        f64::from(days.to_minute - days.from_minute) / f64::from(days.steps_per_day().max(1));
    let up: f64 = hours.steps.iter().map(|step| step.seconds * hours.hours_per_second).sum();
    let (count, unit) = (hours.steps.len(), hours.unit());
    format!(
        "above the horizon in {count} of {all} steps of {} min: {up:.2} {unit}",
        (minutes * 100.0).round() / 100.0
    )
}

fn took(effort: &Effort) -> String {
    let Effort { ray_count, seconds, .. } = *effort;
    let per_second = ray_count as f64 / seconds.max(f64::MIN_POSITIVE);
    format!("{seconds:.2} s for {ray_count} rays, {:.2} million a second", per_second * 1e-6)
}
