//! `--trace`.

use std::collections::{BTreeMap, BTreeSet};

use serde_json::Value;

use crate::Workplace;

fn events(work: &Workplace, name: &str) -> Vec<Value> {
    serde_json::from_slice(&work.read(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// Names of stages with the number of threads on which they ran, from a Chrome trace in which
/// every stage that begins ends.
fn threads_by_stage(work: &Workplace, name: &str) -> BTreeMap<String, usize> {
    let mut threads: BTreeMap<String, BTreeSet<u64>> = BTreeMap::new();
    let mut open: BTreeMap<u64, Vec<String>> = BTreeMap::new();
    for event in events(work, name) {
        let (Some(name), Some(thread)) = (event["name"].as_str(), event["tid"].as_u64()) else {
            panic!("an event without name or thread: {event}");
        };
        let open = open.entry(thread).or_default();
        if event["ph"] == "B" {
            threads.entry(name.to_owned()).or_default().insert(thread);
            open.push(name.to_owned());
        } else if event["ph"] == "E" {
            assert_eq!(open.pop().as_deref(), Some(name));
        } else {
            assert_eq!((&event["ph"], name), (&Value::from("M"), "thread_name"));
        }
    }
    assert!(open.values().all(Vec::is_empty), "{open:?}");
    threads.into_iter().map(|(name, threads)| (name, threads.len())).collect()
}

#[test]
fn a_render_tells_its_stages_on_every_thread() {
    let work = Workplace::new();
    work.run_quietly(
        "render builtin:cornell --engine hierarchy --size 256x192 --frames 0..3 --threads 2 \
         --trace t.json -o out/",
    );
    let stages = threads_by_stage(&work, "t.json");
    for stage in [
        "frame",
        "evaluate",
        "commit",
        "write_triangles",
        "camera_rays",
        "closest_hit",
        "stream_triangles",
        "trace_bands",
        "arrange",
        "build_tree",
        "refine",
        "offer_hits",
        "shade_surface",
        "shadow_rays",
        "occluded",
        "accumulate",
        "group_rays",
        "write_picture",
    ] {
        assert!(stages.contains_key(stage), "no {stage} in {stages:?}");
    }
    assert_eq!(stages["refine"], 2, "{stages:?}");
    assert_eq!(work.names(), ["out", "t.json"]);
}

#[test]
fn a_benchmark_tells_the_turns_of_engines() {
    let work = Workplace::new();
    let map = "bench map --quick --triangles 64 --rays 64 --kind primary --engines brute,hierarchy";
    work.run(&format!("{map} --trace t.json"));
    let events = events(&work, "t.json");
    for engine in ["brute", "hierarchy"] {
        let is_turn = |event: &Value| {
            event["name"] == "turn"
                && event["args"]["engine"].as_str().is_some_and(|name| name.contains(engine))
        };
        assert!(events.iter().any(is_turn), "{engine}");
    }
}

#[test]
fn a_failed_render_leaves_its_profile_and_a_wrong_path_no_picture() {
    let work = Workplace::new();
    let run = work.run("render builtin:nothing --trace t.json -o x.png");
    assert_eq!(run.code, 2, "{run:?}");
    assert_eq!(threads_by_stage(&work, "t.json"), BTreeMap::new());
    let run = work.run("render builtin:cornell --size 8x6 --trace missing/t.json -o x.png");
    assert_eq!(run.code, 1, "{run:?}");
    assert!(run.stderr.contains("missing/t.json"), "{run:?}");
    assert_eq!(work.names(), ["t.json"]);
}
