//! `bench map`, `bench scaling` and `bench scene`.

use serde_json::Value;

use crate::{Run, Workplace};

/// Arguments that make a benchmark short and independent of Embree.
const OURS: &str = "--engines hierarchy,brute --threads 2 --quick --json b.json";

/// Where Embree is not.
const NO_EMBREE: &str = "--embree-lib missing.so";

fn cells(work: &Workplace) -> Vec<Value> {
    let record: Value = serde_json::from_slice(&work.read("b.json")).expect("JSON");
    for field in ["machine", "commit", "date", "cells"] {
        assert!(!record[field].is_null(), "{field}: {record}");
    }
    record["cells"].as_array().expect("a list").clone()
}

fn succeeds(work: &Workplace, words: &str) -> Run {
    let run = work.run(words);
    assert_eq!(run.code, 0, "{words}: {}", run.stderr);
    run
}

#[test]
fn bench_map_measures_each_cell_with_each_engine() {
    let work = Workplace::new();
    let run =
        succeeds(&work, &format!("bench map --triangles 30,60 --rays 64 --kind primary,ao {OURS}"));
    for words in ["primary, brute: times as fast as", "ao, brute", "30 triangles", "64 rays"] {
        assert!(run.stdout.contains(words), "{words}: {}", run.stdout);
    }
    assert!(run.stderr.contains("30 x 64 primary: hierarchy"), "{}", run.stderr);
    let cells = cells(&work);
    assert_eq!(cells.len(), 2 * 2 * 2);
    for cell in &cells {
        let fields = [&cell["scene"], &cell["threads"], &cell["mismatches"], &cell["rays"]];
        assert_eq!(fields, [&Value::from("map"), &2.into(), &0.into(), &64.into()]);
        assert!(cell["counters"]["allocations"].is_u64(), "{cell}");
        let phases = cell["phases"].as_array().unwrap();
        assert!(phases.len() == 2 && phases[0]["name"] == "cloud", "{cell}");
    }
}

#[test]
fn bench_map_reads_a_definition() {
    let work = Workplace::new();
    let built_in = include_str!("../../../../../bench/definitions/map.toml");
    work.write("d.toml", built_in.replace("\"1K\", \"16K\", \"64K\", \"256K\", \"1M\"", "12"));
    succeeds(&work, &format!("bench map --definition d.toml --rays 16 --kind lidar {OURS}"));
    assert!(cells(&work).iter().all(|cell| cell["triangles"] == 12));

    work.write("d.toml", "triangles = 5");
    let run = work.run("bench map --definition d.toml --engines hierarchy");
    assert!(run.code == 2 && run.stderr.contains("d.toml"), "{}", run.stderr);
}

#[test]
fn bench_scaling_tells_slopes() {
    let work = Workplace::new();
    let counts = "--triangles 10,20,40 --rays 16,32 --fixed-triangles 20 --fixed-rays 16";
    let run = succeeds(&work, &format!("bench scaling {counts} --kind primary {OURS}"));
    assert!(run.stdout.contains("against triangles"), "{}", run.stdout);
    let threads: Vec<_> = cells(&work).iter().map(|cell| cell["threads"].clone()).collect();
    assert!(threads.contains(&1.into()) && threads.contains(&2.into()), "{threads:?}");
}

#[test]
fn bench_scene_measures_kinds_of_rays_over_frames() {
    let work = Workplace::new();
    let run = succeeds(
        &work,
        "bench scene builtin:cornell --frames 3..4 --size 16x12 --runs 2 --threads 2 \
         --engines brute,hierarchy --kind primary,dirshadow --json b.json",
    );
    assert!(run.stdout.contains("dirshadow"), "{}", run.stdout);
    let cells = cells(&work);
    assert_eq!(cells.len(), 2 * 2);
    for cell in cells {
        assert_eq!((&cell["rays"], &cell["mismatches"]), (&192.into(), &0.into()), "{cell}");
        let frames = [&cell["phases"][0]["frame"], &cell["phases"][1]["frame"]];
        assert_eq!(frames, [&Value::from(3), &Value::from(4)]);
        assert_eq!(cell["phases"][0]["rounds"], 2);
    }
}

#[test]
fn what_is_wrong_is_named_before_anything_is_measured() {
    let work = Workplace::new();
    work.write("text.so", "no library");
    let cases: [(&str, &[&str]); 11] = [
        ("map --kind shadow", &["\"shadow\"", "pointshadow"]),
        ("map --engines warp", &["\"warp\"", "brute, hierarchy", "embree:best"]),
        ("map --engines embree:fast", &["\"fast\"", "low, medium or refit"]),
        ("map --triangles 1G", &["1G", "K or M"]),
        ("map --rays 0", &["\"0\"", "above 0"]),
        ("map --definition missing.toml", &["missing.toml"]),
        ("map --embree-lib missing.so", &["missing.so", "leave it out of --engines"]),
        ("map --embree-lib text.so", &["text.so"]),
        ("scaling --fixed-rays x", &["\"x\"", "--fixed-rays"]),
        ("scene missing.glb", &["missing.glb"]),
        ("scene builtin:cornell --kind warm", &["\"warm\"", "diffuse"]),
    ];
    for (words, expected) in cases {
        let run = work.run(&format!("bench {words} --json b.json"));
        assert_eq!((run.code, run.stdout.as_str()), (2, ""), "{words}: {}", run.stderr);
        for expected in expected {
            assert!(run.stderr.contains(expected), "{words}: {expected} not in {}", run.stderr);
        }
    }
    let run = work.run(&format!("bench map --engines hierarchy {NO_EMBREE}"));
    assert_eq!(run.code, 2, "a library that was named must be there: {}", run.stderr);
    let run = work.run("bench scene builtin:cornell --engines brute --json missing/b.json");
    assert_eq!(run.code, 1, "{}", run.stderr);
    assert_eq!(work.names(), ["text.so"]);
}
