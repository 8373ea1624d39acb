//! `bench museum`, and what becomes of records.

use serde_json::Value;

use crate::Workplace;

#[test]
fn bench_museum_compares_engines_frame_by_frame() {
    let work = Workplace::new();
    let run = work.run_quietly(
        "bench museum builtin:cornell --engines brute,hierarchy --size 16x12 --frames 3..4 \
         --runs 2 --threads 2 --json b.json",
    );
    for expected in ["films of hierarchy: the same in every bit", "frames a second"] {
        assert!(run.stdout.contains(expected), "{}", run.stdout);
    }
    let rows = |engine: &str| run.stdout.lines().filter(|line| line.contains(engine)).count();
    assert!(rows("brute") >= 3 && rows("hierarchy") >= 3, "frames and mean: {}", run.stdout);

    let record: Value = serde_json::from_slice(&work.read("b.json")).unwrap();
    assert_eq!(record["benchmark"], "museum");
    let [brute, hierarchy] = &record["cells"].as_array().unwrap()[..] else {
        panic!("two engines: {record}")
    };
    assert_eq!((&brute["engine"], &hierarchy["engine"]), (&"brute".into(), &"hierarchy".into()));
    assert_eq!(brute["rays"], hierarchy["rays"]);
    for cell in [brute, hierarchy] {
        check_cell(cell);
        cell["phases"].as_array().unwrap().iter().for_each(check_phase);
    }
    let tests = |cell: &Value| cell["counters"]["triangle_tests"].as_u64().unwrap();
    assert!(tests(hierarchy) < tests(brute), "the hierarchy saves tests");
}

fn check_cell(cell: &Value) {
    assert_eq!((&cell["threads"], &cell["mismatches"]), (&2.into(), &0.into()));
    let frames = [&cell["phases"][0]["frame"], &cell["phases"][1]["frame"]];
    assert_eq!(frames, [&Value::from(3), &Value::from(4)]);
    assert!(cell["phases"][2].is_null(), "two frames");
}

fn check_phase(phase: &Value) {
    assert_eq!((&phase["rounds"], &phase["rays_by_kind"]["primary"]), (&2.into(), &192.into()));
    let number = |value: &Value| value.as_f64().unwrap_or(f64::NAN);
    let [commit, trace, shade, total] =
        ["commit_ms", "trace_ms", "shade_ms", "total_ms"].map(|field| number(&phase[field]));
    assert!(commit > 0.0 && trace > 0.0 && shade > 0.0 && total >= commit.max(trace), "{phase}");
    let [lower, upper] = [0, 1].map(|idx| number(&phase["total_quartiles_ms"][idx]));
    assert!(lower <= total && total <= upper, "{phase}");
}

#[test]
fn bench_museum_measures_a_few_frames_of_the_whole_motion() {
    let work = Workplace::new();
    work.run_quietly(
        "bench museum builtin:museum3 --depth 1 --engines hierarchy --size 8x6 --runs 1 --json b.json",
    );
    let record: Value = serde_json::from_slice(&work.read("b.json")).unwrap();
    let phases = record["cells"][0]["phases"].as_array().unwrap();
    let frames: Vec<_> = phases.iter().map(|phase| phase["frame"].as_u64().unwrap()).collect();
    assert!(frames.len() == 20 && frames.is_sorted(), "{frames:?}");
    assert!(frames[0] > 0 && frames[19] > 250, "spread over the motion: {frames:?}");
}

#[test]
fn bench_museum_names_what_is_wrong() {
    let work = Workplace::new();
    let cases = [
        ("builtin:cornell --engines brute,warp", "unknown engine \"warp\"; there are: auto, brute"),
        ("builtin:cornell --engines brute,", "unknown engine \"\""),
        ("builtin:cornell --runs 0", "0 is not in 1..=10000"),
        ("builtin:kettle", "no built-in scene is called \"kettle\""),
        ("missing.glb", "missing.glb"),
    ];
    for (words, message) in cases {
        let run = work.run(&format!("bench museum {words} --json b.json"));
        assert_eq!((run.code, run.stdout.as_str()), (2, ""), "{words}");
        assert!(run.stderr.contains(message), "{words}: {}", run.stderr);
    }
    assert!(work.names().is_empty(), "{:?}", work.names());

    let run = work.run("bench museum builtin:cornell --engines brute --json missing/b.json");
    assert_eq!((run.code, run.stdout.as_str()), (1, ""), "{}", run.stderr);
}

#[test]
fn a_record_becomes_a_page_and_tables_then_and_later() {
    let work = Workplace::new();
    work.run_quietly(
        "bench museum builtin:cornell --engines brute,hierarchy --size 8x6 --frames 1..2 --runs 1 \
         --json b.json --html b.html --csv b.csv --markdown b.md",
    );
    let run = work
        .run_quietly("bench report b.json --json c.json --html c.html --csv c.csv --markdown c.md");
    assert!(run.stdout.contains("frames a second"), "{}", run.stdout);
    for extension in ["json", "html", "csv", "md"] {
        let [then, later] = ["b", "c"].map(|name| work.read(&format!("{name}.{extension}")));
        assert!(then == later && !then.is_empty(), "{extension}");
    }
    let page = String::from_utf8(work.read("b.html")).unwrap();
    assert!(page.starts_with("<!DOCTYPE html>") && page.contains("builtin:cornell"), "{page}");
}

#[test]
fn bench_compare_tells_what_has_changed() {
    let work = Workplace::new();
    work.run_quietly(
        "bench museum builtin:cornell --engines brute,hierarchy --size 8x6 --frames 1 --runs 1 \
         --json old.json",
    );
    let text = String::from_utf8(work.read("old.json")).unwrap();
    let mut record: Value = serde_json::from_str(&text).unwrap();
    let total = &mut record["cells"][1]["total_ms"];
    *total = Value::from(total.as_f64().unwrap() / 4.0);
    work.write("new.json", record.to_string());

    let run = work.run_quietly("bench compare old.json new.json");
    for expected in ["2 cells in both", "Most gained", "0.250*"] {
        assert!(run.stdout.contains(expected), "{expected}: {}", run.stdout);
    }
    record["machine"]["cores"] = Value::from(999);
    work.write("other.json", record.to_string());
    let run = work.run_quietly("bench compare old.json other.json");
    assert!(run.stdout.contains("warning: machines differ"), "{}", run.stdout);
}

#[test]
fn bench_compare_names_the_file_that_is_no_record_and_its_line() {
    let work = Workplace::new();
    work.write("bad.json", "{\n  \"benchmark\": 5\n}\n");
    for (words, message) in [
        (
            "compare bad.json bad.json",
            "bad.json: line 2: invalid type: integer `5`, expected a string",
        ),
        ("compare missing.json bad.json", "missing.json: cannot be read"),
        ("report bad.json", "expected a record written by --json"),
    ] {
        let run = work.run(&format!("bench {words}"));
        assert_eq!((run.code, run.stdout.as_str()), (2, ""), "{words}");
        assert!(run.stderr.contains(message), "{words}: {}", run.stderr);
    }
}
