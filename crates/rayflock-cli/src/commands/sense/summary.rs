//! What was found, as text, a line each.

use std::fmt::Write;

use rayflock::render::sensor::Pattern;

use super::plan::SensePlan;
use super::work::Effort;

/// The summary for people.
pub(super) fn format(plan: &SensePlan, effort: &Effort) -> String {
    let mut text = format!("{}\n", plan.input.name);
    let mut line = |name: &str, value: &str| {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "  {name:<10} {value}");
    };
    line("sensor", &sensor(plan));
    line("time", &time(plan, effort));
    line("points", &points(plan, effort));
    if let Some((least, most)) = effort.range {
        let mean = effort.range_sum / effort.point_count as f64;
        line("ranges", &format!("{least:.3} to {most:.3}, mean {mean:.3}"));
    }
    line("took", &took(effort));
    text
}

fn sensor(plan: &SensePlan) -> String {
    let (name, pattern) = (&plan.sensor_name, &plan.sensor.pattern);
    let (rows, columns) = pattern.shape();
    match pattern {
        Pattern::Rosette(_) => format!("{name}, {columns} beams"),
        _ => format!("{name}, {rows} rows x {columns} columns"),
    }
}

fn time(plan: &SensePlan, effort: &Effort) -> String {
    let (sweeps, rate) = (plan.sweeps, plan.sensor.pattern.rate());
    let plural = |count: u64| if count == 1 { "" } else { "s" };
    let (count, steps) = (sweeps.count(), effort.step_count);
    format!(
        "{count} sweep{} from {:.3} s on at {rate} Hz, {steps} time step{} each",
        plural(count),
        plan.start(sweeps.first),
        plural(steps as u64)
    )
}

fn points(plan: &SensePlan, effort: &Effort) -> String {
    let beams = effort.beam_count as u64 * plan.sweeps.count();
    format!("{} from {beams} beams", effort.point_count)
}

fn took(effort: &Effort) -> String {
    let Effort { ray_count, seconds, .. } = *effort;
    let per_second = ray_count as f64 / seconds.max(f64::MIN_POSITIVE);
    format!("{seconds:.2} s for {ray_count} rays, {:.2} million a second", per_second * 1e-6)
}
