//! What stands above all sections: what was measured, on what, when.

use std::collections::BTreeSet;

use maud::{Markup, html};

use super::figures::plural;
use crate::record::Record;

/// What a benchmark is called, and what it asks.
pub(super) fn title(record: &Record) -> (String, &'static str) {
    let first_scene = record.cells.first().map_or("", |cell| cell.scene.as_str());
    match record.benchmark.as_str() {
        "map" => (
            "The map".to_owned(),
            "Triangles that all move, every frame anew: what do an update and a batch of rays \
             cost together, for every mix of triangles, rays and kind of ray?",
        ),
        "museum" => (
            format!("The museum: {first_scene}"),
            "The first paper's graph: what do the update and the picture of each frame of an \
             animation cost?",
        ),
        "scaling" => (
            "Scaling".to_owned(),
            "How does the cost of a frame grow with triangles, with rays and with threads?",
        ),
        "scene" => (
            format!("The scene {first_scene}"),
            "What do the frames of an animation cost, by kind of ray?",
        ),
        "spheres" => (
            format!("Virtual lights past spheres: {first_scene}"),
            "How much sooner is indirect light there when spheres stand for geometry, and how \
             wrong is it?",
        ),
        other => (other.to_owned(), "What was measured."),
    }
}

/// The heading of the page.
pub(super) fn heading(record: &Record) -> Markup {
    let (title, question) = title(record);
    let machine = &record.machine;
    let threads: BTreeSet<usize> = record.cells.iter().map(|cell| cell.threads).collect();
    let threads: Vec<String> = threads.iter().map(usize::to_string).collect();
    let versions: Vec<String> =
        record.versions.iter().map(|(name, version)| format!("{name} {version}")).collect();
    let cores = plural(machine.cores, "logical processor", "logical processors");
    html! {
        header {
            p.eyebrow { "Rayflock benchmark" }
            h1 { (title) }
            p.question { (question) }
            dl.facts {
                div { dt { "Processor" } dd { (machine.cpu) ", " (cores) } }
                div { dt { "Memory" } dd { (machine.memory_gib) " GiB" } }
                div { dt { "Kernels" } dd { (machine.simd) " on " (machine.arch) ", " (machine.os) } }
                div { dt { "Threads" } dd { (threads.join(", ")) } }
                div { dt { "Commit" } dd { code { (record.commit) } } }
                div { dt { "Date" } dd { (record.date.replace('T', " ").replace('Z', " UTC")) } }
                div { dt { "Versions" } dd { (versions.join(", ")) } }
            }
        }
    }
}
