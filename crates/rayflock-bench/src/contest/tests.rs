mod fake;

use std::time::Duration;

use super::contestant::Contestant;
use super::entry::Entry;
use super::*;
use crate::map::MapWork;
use crate::peer::embree::EmbreeLibrary;
use crate::record::Judged;
use crate::work::{Definition, RayKind};
use fake::{FakeEngine, Log, Tamper};

/// A small room with a few moving triangles.
fn piece(kind: RayKind, rays: usize) -> Piece {
    let mut definition = Definition::default_map();
    definition.room.cells = [4, 3, 4];
    definition.room.skylight = 2;
    let mut work = MapWork::new(&definition, 40).unwrap();
    work.pieces(rays, &[kind]).remove(0)
}

fn contest(contestants: Vec<Contestant>) -> Contest {
    let entries = contestants.into_iter().map(Entry::of).collect();
    Contest {
        entries,
        reference: None,
        library: None,
        effort: Effort::of_runs(3),
        meter: Meter::default(),
    }
}

fn fake(name: &str, is_own: bool, tamper: Tamper, log: &Log) -> Contestant {
    Contestant::new(
        name,
        "",
        is_own,
        Box::new(FakeEngine::new(name, tamper, log)),
        Meter::default(),
    )
}

fn measure(contest: &mut Contest, piece: &Piece) -> Vec<Cell> {
    contest.measure(piece, &|| false).unwrap().expect("nobody stops it")
}

/// The cells of an engine that answers rightly and of a tampered one.
fn against(kind: RayKind, tamper: Tamper, is_own: bool) -> [Cell; 2] {
    let log = Log::default();
    let engines =
        vec![fake("right", true, Tamper::Nothing, &log), fake("other", is_own, tamper, &log)];
    let cells = measure(&mut contest(engines), &piece(kind, 256));
    cells.try_into().unwrap()
}

#[test]
fn what_answers_nothing_is_compared_with_nothing() {
    let piece = piece(RayKind::Primary, 64);
    let mut cells = Vec::new();
    for is_answering in [true, false] {
        let log = Log::default();
        let first = fake("first", false, Tamper::Misses, &log);
        let first = if is_answering { first } else { first.unanswering() };
        let other = fake("other", true, Tamper::Nothing, &log);
        cells.push(measure(&mut contest(vec![first, other]), &piece));
    }
    let mismatches = |cells: &[Cell]| cells.iter().map(|cell| cell.mismatches).sum::<u64>();
    assert!(mismatches(&cells[0]) > 0, "the first one is what others are compared with");
    assert_eq!(mismatches(&cells[1]), 0);
    assert!(cells[1].iter().all(|cell| cell.total_ms.is_some()), "both are measured");
}

#[test]
fn engines_take_turns_and_every_commit_is_news() {
    let log = Log::default();
    let engines = ["a", "b"].map(|name| fake(name, true, Tamper::Nothing, &log));
    let mut piece = piece(RayKind::Primary, 64);
    piece.phases.truncate(1);
    let cells = measure(&mut contest(engines.into()), &piece);

    let warm_up = ["a", "b"].map(|name| {
        let what = ["commit nothing", "commit 1", "commit before", "commit 1", "trace 64"];
        what.map(|what| format!("{name} {what}")).to_vec()
    });
    let turn = |name, frame| vec![format!("{name} commit {frame}"), format!("{name} trace 64")];
    let turns = [0, 1, 0].into_iter().flat_map(|frame| [turn("a", frame), turn("b", frame)]);
    let expected: Vec<String> = warm_up.into_iter().chain(turns).flatten().collect();
    assert_eq!(log.of(&piece), expected);
    assert_eq!(cells[0].phases[0].rounds, 3);
}

#[test]
fn rounds_of_settling_in_do_not_count() {
    let log = Log::default();
    let mut piece = piece(RayKind::Primary, 64);
    piece.phases.truncate(1);
    let mut contest = contest(vec![fake("a", true, Tamper::Nothing, &log)]);
    contest.effort.settling_rounds = 3;
    contest.effort.settling_time = Duration::from_secs(60);
    let cells = measure(&mut contest, &piece);
    let turns =
        [0, 1, 0, 1, 0, 1, 0].map(|frame| [format!("a commit {frame}"), "a trace 64".to_owned()]);
    assert_eq!(log.of(&piece)[5..], *turns.as_flattened(), "two frames, twice, then three rounds");
    assert_eq!(cells[0].phases[0].rounds, 3);
}

#[test]
fn a_single_frame_comes_after_the_frame_before_each_time() {
    let log = Log::default();
    let mut piece = piece(RayKind::DirShadow, 64);
    piece.phases.truncate(1);
    piece.phases[0].frames.truncate(1);
    measure(&mut contest(vec![fake("a", true, Tamper::Nothing, &log)]), &piece);
    let turn = ["a commit before", "a commit 0", "a trace 64"];
    assert_eq!(log.of(&piece)[5..], turn.repeat(3));
}

#[test]
fn what_is_recorded_adds_up() {
    let [first, _] = against(RayKind::Primary, Tamper::Nothing, true);
    assert_eq!((first.triangles, first.rays, first.kind.as_str()), (40, 256, "primary"));
    assert_eq!((first.scene.as_str(), first.engine.as_str()), ("map", "right"));
    assert_eq!(first.threads, rayon::current_num_threads());
    let names: Vec<&str> = first.phases.iter().map(|phase| phase.name.as_str()).collect();
    assert_eq!(names, ["cloud", "sphere"]);
    let mean = first.phases.iter().map(|phase| phase.total_ms).sum::<f64>() / 2.0;
    assert!((first.total_ms.unwrap() - mean).abs() < 1e-9);
    assert!(first.commit_ms.unwrap() > 0.0 && first.trace_ms.unwrap() > 0.0);
    for phase in &first.phases {
        let [lower, upper] = phase.total_quartiles_ms;
        assert!(lower <= phase.total_ms && phase.total_ms <= upper);
        assert!(phase.counters.triangle_tests > 0 && phase.rays == 256);
    }
    assert!(first.memory_bytes > 0 && first.skipped.is_none());
}

#[test]
fn conversions_are_not_charged() {
    let [_, other] = against(RayKind::Primary, Tamper::Converts, false);
    assert_eq!(
        (other.commit_ms, other.trace_ms, other.total_ms),
        (Some(0.0), Some(0.0), Some(0.0))
    );
}

#[test]
fn equal_answers_are_no_mismatch_and_small_differences_only_among_ours() {
    for (tamper, is_own, expected) in [
        (Tamper::Nothing, true, false),
        (Tamper::LastBit, false, false),
        (Tamper::LastBit, true, true),
        (Tamper::Farther, false, true),
    ] {
        let [_, other] = against(RayKind::Primary, tamper, is_own);
        assert_eq!(other.mismatches > 0, expected, "{tamper:?} {is_own}");
    }
}

#[test]
fn the_oracle_says_who_is_wrong() {
    let judged = |kind, first: Tamper, second: Tamper| {
        let log = Log::default();
        let engines = vec![fake("first", false, first, &log), fake("second", false, second, &log)];
        let cells = measure(&mut contest(engines), &piece(kind, 256));
        assert_eq!((cells[0].mismatches, cells[0].judged), (0, Judged::default()));
        assert!(cells[1].mismatches > 0 && cells[1].judged.rays > 0, "{kind} {first:?} {second:?}");
        assert!(cells[1].judged.rays <= 64);
        cells[1].judged
    };
    use Tamper::{Farther, Misses, Nothing};
    let all_in = |judged: Judged, count: u64| assert_eq!(judged.rays, count, "{judged:?}");
    for kind in [RayKind::Primary, RayKind::Mirror] {
        let wrong = judged(kind, Nothing, Farther);
        all_in(wrong, wrong.only_reference);
        let right = judged(kind, Farther, Nothing);
        all_in(right, right.only_this);
        let neither = judged(kind, Farther, Misses);
        all_in(neither, neither.neither);
    }
    // Rays from the point light end so near a surface that both answers may be right.
    let wrong = judged(RayKind::DirShadow, Nothing, Tamper::Inverts);
    all_in(wrong, wrong.only_reference);
    let right = judged(RayKind::DirShadow, Tamper::Inverts, Nothing);
    all_in(right, right.only_this);
    let ours = against(RayKind::Primary, Tamper::LastBit, true)[1].judged;
    all_in(ours, ours.both_right);
}

#[test]
fn an_engine_that_is_too_slow_is_skipped_with_a_reason() {
    let log = Log::default();
    for (rays, reason) in [(64, "it took"), (4096, "foretold by 1/16 of the rays")] {
        let mut contest = contest(vec![fake("slow", true, Tamper::Nothing, &log)]);
        contest.effort.frame_limit = Duration::ZERO;
        let cell = measure(&mut contest, &piece(RayKind::Primary, rays)).remove(0);
        let skipped = cell.skipped.unwrap();
        assert!(skipped.starts_with("over 0 ms a frame") && skipped.contains(reason), "{skipped}");
        assert_eq!((cell.total_ms, cell.phases.len()), (None, 0));
    }
}

#[test]
fn engines_that_do_not_do_the_work_are_skipped_and_others_go_on() {
    let log = Log::default();
    let engines = vec![
        fake("picky", false, Tamper::Refuses, &log),
        fake("other", true, Tamper::Nothing, &log),
        fake("lost", false, Tamper::HandsOver, &log),
    ];
    let mut contest = contest(engines);
    for _ in 0..2 {
        let cells = measure(&mut contest, &piece(RayKind::Primary, 64));
        assert!(cells[0].skipped.as_ref().unwrap().contains("does not support rooms"));
        assert!(cells[1].skipped.is_none() && cells[1].mismatches == 0);
        assert_eq!(cells[2].skipped.as_deref(), Some("the device is lost"));
    }
}

#[test]
fn stopping_leaves_the_cell_out() {
    let log = Log::default();
    let mut contest = contest(vec![fake("a", true, Tamper::Nothing, &log)]);
    let piece = piece(RayKind::Primary, 64);
    assert!(contest.measure(&piece, &|| true).unwrap().is_none());
    assert!(contest.measure(&piece, &|| log.lines().len() > 5).unwrap().is_none());
}

#[test]
fn a_contest_without_engines_is_an_error() {
    let error = Contest::new(&Setup::new(Vec::new(), Effort::QUICK)).unwrap_err();
    assert!(error.to_string().contains("no engines"));
}

#[test]
fn the_best_setting_of_embree_is_found_and_named() {
    let library = match EmbreeLibrary::load(None) {
        Ok(library) => library,
        Err(error) => return println!("skipped: {error}"),
    };
    let engines = ["embree:best", "hierarchy"].map(|name| name.parse().unwrap());
    let setup = Setup { library: Some(library), ..Setup::new(engines.into(), Effort::QUICK) };
    let mut contest = Contest::new(&setup).unwrap();
    for kind in [RayKind::Diffuse, RayKind::PointShadow] {
        let cells = measure(&mut contest, &piece(kind, 256));
        assert_eq!(cells[0].engine, "embree:best");
        assert!(cells[0].setting.parse::<crate::peer::embree::Setting>().is_ok(), "{cells:?}");
        assert!(cells.iter().all(|cell| cell.total_ms.is_some()));
    }
}
