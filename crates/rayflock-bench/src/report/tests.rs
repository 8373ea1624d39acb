//! Pages, Markdown and CSV of a record made by hand.

use super::{csv, html, markdown};
use crate::record::{Cell, Counters, Judged, Phase, Record};

const SKIPPED: &str = "over 4000 ms a frame after 1/16 of the rays";

fn cell(engine: &str, kind: &str, triangles: usize, rays: u64, times: Option<[f64; 2]>) -> Cell {
    let total = times.map(|[commit, trace]| commit + trace);
    let phase = |name: &str| Phase {
        name: name.to_owned(),
        frame: Some(3),
        rays,
        commit_ms: times.map_or(0.0, |times| times[0]),
        trace_ms: times.map_or(0.0, |times| times[1]),
        total_ms: total.unwrap_or(0.0),
        shade_ms: Some(1.5),
        ..Phase::default()
    };
    Cell {
        triangles,
        rays,
        kind: kind.to_owned(),
        scene: "map".to_owned(),
        engine: engine.to_owned(),
        threads: 2,
        commit_ms: times.map(|times| times[0]),
        trace_ms: times.map(|times| times[1]),
        total_ms: total,
        skipped: total.is_none().then(|| SKIPPED.to_owned()),
        phases: vec![phase("cloud"), phase("sphere")],
        ..Cell::default()
    }
}

/// Two kinds, two numbers of triangles, one of rays, two engines; one cell is skipped, one noisy.
fn record(benchmark: &str) -> Record {
    let mut record = Record::new(benchmark);
    record.machine.cpu = "Fast <CPU> & \"Co\" | 9".to_owned();
    record.versions.insert("embree".to_owned(), "4.4.0".to_owned());
    record.definition = Some("# <script>alert(1)</script>".to_owned());
    for kind in ["primary", "diffuse"] {
        for triangles in [1024, 2048] {
            let embree = cell("embree:best", kind, triangles, 4096, Some([2.0, 4.125]));
            let setting = "low+instances+packets".to_owned();
            record.cells.push(Cell { setting, ..embree });
            let times = (kind == "primary" || triangles == 1024).then_some([0.5, 0.375]);
            record.cells.push(cell("hierarchy", kind, triangles, 4096, times));
        }
    }
    let noisy = &mut record.cells[1];
    (noisy.noisy, noisy.spread, noisy.mismatches) = (true, 0.4, 12);
    noisy.judged = Judged { rays: 12, both_right: 11, only_this: 1, ..Judged::default() };
    noisy.counters = Counters { cone_tests: 4096 * 310, bytes: 4096 * 7, ..Counters::default() };
    record
}

#[test]
fn a_page_tells_the_figures_of_each_cell() {
    let page = html(&record("map")).unwrap();
    let cells: Vec<&str> = page.split("<td class=\"ratio").skip(1).collect();
    assert_eq!(cells.len(), 3);
    for cell in cells {
        let text = cell.split_once('>').map(|(_, text)| text);
        assert!(text.is_some_and(|text| text.starts_with("7.00")), "6.125 / 0.875: {cell}");
    }
    for expected in [
        "hierarchy: commit 0.500 + trace 0.375 = 0.875 ms, spread 40 %",
        "embree:best (low+instances+packets): commit 2.00 + trace 4.12 = 6.12 ms",
        "as fast as Embree in the geometric mean of 3 cells",
        "ahead in 3, behind in 0, skipped in 1",
        "<td class=\"number\">310</td>",
        "4.4.0",
    ] {
        assert!(page.contains(expected), "{expected}\n{page}");
    }
}

#[test]
fn skipped_and_noisy_cells_are_shown_as_such() {
    let page = html(&record("map")).unwrap();
    assert!(page.contains(&format!("hierarchy: skipped, {SKIPPED}\n")), "{page}");
    assert_eq!(page.matches("<td class=\"skipped\"").count(), 1);
    assert_eq!(page.matches("<td class=\"ratio noisy\"").count(), 1);
}

#[test]
fn pages_need_nothing_from_elsewhere() {
    for benchmark in ["map", "museum", "scene", "scaling", "spheres"] {
        let page = html(&record(benchmark)).unwrap();
        for outside in ["http:", "https:", "src=", "href=", "url(", "@import", "<script", "<link"] {
            assert!(!page.contains(outside), "{benchmark}: {outside}");
        }
        assert!(page.contains("prefers-color-scheme: dark"));
    }
}

#[test]
fn names_are_escaped() {
    let mut record = record("scene");
    for cell in &mut record.cells {
        cell.scene = "<b>a & b</b>.glb".to_owned();
    }
    for benchmark in ["map", "museum", "scene", "scaling", "spheres"] {
        record.benchmark = benchmark.to_owned();
        let page = html(&record).unwrap();
        assert!(page.contains("Fast &lt;CPU&gt; &amp; "), "{benchmark}");
        assert!(page.contains("&lt;script&gt;alert(1)"), "{benchmark}");
        assert!(!page.contains("<b>"), "{benchmark}");
    }
}

#[test]
fn the_museum_has_curves_and_frames_a_second() {
    let page = html(&record("museum")).unwrap();
    for expected in ["<svg role=\"img\"", "var(--series-0)", "currentColor", "hierarchy: update"] {
        assert!(page.contains(expected), "{expected}");
    }
    assert!(!page.contains("#0102") && !page.contains("#0103"), "colours that stand for others");
    assert!(page.contains("<strong>421</strong>"), "1000 / (0.875 + 1.5)");
}

#[test]
fn records_of_nothing_and_of_one_engine_have_pages() {
    for benchmark in ["map", "museum", "scene", "scaling", "spheres", "unknown"] {
        let mut record = record(benchmark);
        record.cells.retain(|cell| cell.engine == "hierarchy");
        assert!(html(&record).unwrap().contains("hierarchy"), "{benchmark}");
        record.cells.clear();
        html(&record).unwrap();
        assert!(!markdown(&record).is_empty());
        assert_eq!(csv(&record).lines().count(), 1);
    }
}

#[test]
fn csv_has_a_row_for_each_cell_and_engine() {
    let record = record("map");
    let text = csv(&record);
    let mut reader = ::csv::Reader::from_reader(text.as_bytes());
    let heading = reader.headers().unwrap().clone();
    let column = |name: &str| heading.iter().position(|found| found == name).unwrap();
    let rows: Vec<_> = reader.records().map(Result::unwrap).collect();
    assert_eq!(rows.len(), record.cells.len());
    let value = |row: usize, name: &str| &rows[row][column(name)];
    assert_eq!((value(0, "ratio"), value(1, "ratio")), ("", "7"));
    assert_eq!((value(0, "setting"), value(0, "total_ms")), ("low+instances+packets", "6.125"));
    assert_eq!((value(1, "mismatches"), value(1, "judged_only_this")), ("12", "1"));
    assert_eq!((value(7, "total_ms"), value(7, "ratio"), value(7, "skipped")), ("", "", SKIPPED));
}

#[test]
fn markdown_has_means_then_all_cells() {
    let text = markdown(&record("map"));
    for expected in [
        "**hierarchy** is 7.00 times as fast as Embree in the geometric mean of 3 cells",
        "| rays | T = 1K | T = 2K | all |\n|---|---:|---:|---:|\n",
        "| primary | **7.00** (7.00..7.00) | **7.00** (7.00..7.00) | **7.00** (7.00..7.00) |\n",
        "| diffuse | **7.00** (7.00..7.00) | – | **7.00** (7.00..7.00) |\n",
        "hierarchy, primary:\n\n| triangles | R = 4K |\n|---|---:|\n| 1K | 7.00 ~ |\n| 2K | 7.00 |\n",
        "| 2K | – |\n",
        "Fast &lt;CPU> & \"Co\" \\| 9",
    ] {
        assert!(text.contains(expected), "{expected}\n{text}");
    }
}
