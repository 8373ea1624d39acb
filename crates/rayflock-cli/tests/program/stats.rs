//! `--stats` and `--plot`.

use serde_json::Value;

use crate::Workplace;

#[test]
fn stats_have_every_field_of_the_contract() {
    let work = Workplace::new();
    work.run_quietly(
        "render builtin:cornell --size 16x12 --frames 2..4 --threads 2 --stats s.json -o x.gif",
    );
    let stats: Value = serde_json::from_slice(&work.read("s.json")).unwrap();
    assert_eq!(stats["engine"], "auto");
    assert_eq!(stats["threads"], 2);
    assert_eq!(stats["size"], serde_json::json!([16, 12]));
    assert!(stats["simd"].is_string());
    assert!(stats["triangles"].as_u64().unwrap() > 10);
    let frames = stats["frames"].as_array().unwrap();
    let numbers: Vec<_> = frames.iter().map(|frame| frame["frame"].as_u64().unwrap()).collect();
    assert_eq!(numbers, [2, 3, 4]);
    for frame in frames {
        for field in ["update_ms", "trace_ms", "shade_ms", "total_ms"] {
            assert!(frame[field].as_f64().unwrap() >= 0.0, "{field}");
        }
        for field in [
            "triangles",
            "cone_tests",
            "box_tests",
            "triangle_tests",
            "pairs",
            "bytes",
            "allocations",
            "memory_bytes",
        ] {
            assert!(frame[field].is_u64(), "{field}");
        }
        assert_eq!(frame["rays"]["primary"], 16 * 12);
        for kind in ["shadow", "mirror", "refraction"] {
            assert!(frame["rays"][kind].as_u64().unwrap() > 0, "{kind}");
        }
        let stages = &frame["stages"];
        assert_eq!(stages["primary"]["rays"], frame["rays"]["primary"]);
        assert_eq!(stages["shadow"]["rays"], frame["rays"]["shadow"]);
        let tests =
            ["primary", "secondary", "shadow"].map(|stage| &stages[stage]["triangle_tests"]);
        let sum: u64 = tests.into_iter().map(|tests| tests.as_u64().unwrap()).sum();
        assert_eq!(frame["triangle_tests"], sum);
        let part = |field: &str| frame[field].as_f64().unwrap();
        let sum = part("update_ms") + part("trace_ms") + part("shade_ms");
        assert!(sum <= part("total_ms") + 0.1, "the parts are within the whole");
    }
}

#[test]
fn the_graph_has_title_axes_and_legend() {
    let work = Workplace::new();
    let render = "render builtin:cornell --size 8x6 --frames 0..3";
    work.run_quietly(&format!("{render} --plot p.svg -o x.gif"));
    work.run_quietly(&format!("{render} --plot p.html -o x.gif"));
    let svg = String::from_utf8(work.read("p.svg")).unwrap();
    for text in ["builtin:cornell", "time per frame (ms)", "frame", "render:", "update:"] {
        assert!(svg.contains(text), "{text}");
    }
    let html = String::from_utf8(work.read("p.html")).unwrap();
    assert!(
        html.starts_with("<!DOCTYPE html>") && html.contains("<svg") && html.contains("median")
    );
    assert!(!html.contains("<script"), "the page needs nothing else");
}
