//! The facts as text, a line each.

use std::fmt::Write;

use super::report::{ObjectReport, Report};

/// Objects listed one by one; the rest is counted.
const MAX_LISTED: usize = 12;

/// The report for people.
pub(super) fn format(report: &Report) -> String {
    let mut text = format!("{}\n", report.input);
    let mut line = |name: &str, value: &str| {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "  {name:<10} {value}");
    };
    line("objects", &objects(report));
    line("triangles", &format!("{} on {} vertices", report.triangles, report.vertices));
    if report.spheres > 0 {
        line("spheres", &report.spheres.to_string());
    }
    line("materials", &format!("{}, textures {}", report.materials, report.textures));
    clips(report).iter().for_each(|clip| line("clip", clip));
    line("frames", &frames(report));
    line("bounds", &bounds(report));
    line("cameras", &cameras(report));
    line("lights", &lights(report));
    motion(report).iter().for_each(|motion| line("motion", motion));
    report.warnings.iter().for_each(|warning| line("warning", warning));
    text
}

fn objects(report: &Report) -> String {
    let count = |motion: &str| report.objects.iter().filter(|o| o.motion == motion).count();
    let kinds = ["static", "rigid", "deforming", "topology"].map(|motion| (count(motion), motion));
    let kinds: Vec<_> = kinds
        .iter()
        .filter(|(count, _)| *count > 0)
        .map(|(count, motion)| format!("{count} {}", motion_words(motion)))
        .collect();
    match kinds.as_slice() {
        [] => "none: pictures show the background".to_owned(),
        _ => format!("{} ({})", report.objects.len(), kinds.join(", ")),
    }
}

fn motion_words(motion: &str) -> &str {
    if motion == "topology" { "changing topology" } else { motion }
}

fn clips(report: &Report) -> Vec<String> {
    let line = |clip: &super::report::ClipReport| {
        let mark = if clip.chosen { " (chosen)" } else { "" };
        format!("\"{}\": {:.3} s, {} channels{mark}", clip.name, clip.seconds, clip.channels)
    };
    report.clips.iter().map(line).collect()
}

fn frames(report: &Report) -> String {
    let [first, last] = report.frames;
    let then = match (report.finite, last) {
        (true, _) => "and no more",
        (false, 0) => "shows everything: nothing moves",
        (false, _) => "show the motion once",
    };
    format!("{first}..{last} at {} a second {then}", report.frame_rate)
}

fn bounds(report: &Report) -> String {
    report.bounds.as_ref().map_or_else(
        || "none".to_owned(),
        |bounds| {
            let corner = |[x, y, z]: [f32; 3]| format!("({x:.3}, {y:.3}, {z:.3})");
            format!("{} to {}", corner(bounds.min), corner(bounds.max))
        },
    )
}

fn cameras(report: &Report) -> String {
    let names = report.cameras.iter().map(|c| format!("\"{}\" ({})", c.name, c.projection));
    joined(&names.collect::<Vec<_>>(), "none: the whole motion is framed")
}

fn lights(report: &Report) -> String {
    let names = report.lights.iter().map(|light| format!("\"{}\" ({})", light.name, light.kind));
    joined(
        &names.collect::<Vec<_>>(),
        "none: a key light and a sky are added, unless surfaces emit",
    )
}

fn joined(names: &[String], none: &str) -> String {
    match names.len() {
        0 => none.to_owned(),
        count if count > MAX_LISTED => {
            format!("{}, and {} more", names[..MAX_LISTED].join(", "), count - MAX_LISTED)
        }
        _ => names.join(", "),
    }
}

/// The objects that move, one a line.
fn motion(report: &Report) -> Vec<String> {
    let moving: Vec<&ObjectReport> =
        report.objects.iter().filter(|object| object.motion != "static").collect();
    let line = |object: &&ObjectReport| {
        let ObjectReport { name, motion, primitives } = object;
        format!("\"{name}\": {}, {primitives} primitives", motion_words(motion))
    };
    let mut lines: Vec<String> = moving.iter().take(MAX_LISTED).map(line).collect();
    if moving.len() > MAX_LISTED {
        lines.push(format!("and {} objects more (--json lists all)", moving.len() - MAX_LISTED));
    }
    lines
}
