//! From samples to a cell: medians over the rounds of a phase, means over the phases.

use std::collections::BTreeMap;

use rayflock::engine::Fact;

use super::contestant::{Contestant, PhaseSamples, Sample};
use super::meter::Cost;
use super::piece::{Piece, PiecePhase};
use crate::record::{Cell, Counters, Judged, Phase};
use crate::{Quartiles, allocations};

/// The spread above which a cell is noisy.
pub const NOISY: f64 = 0.1;

/// The cell of an engine that was not measured, for a reason.
pub(super) fn skipped(piece: &Piece, name: &str, reason: String) -> Cell {
    Cell { skipped: Some(reason), ..unmeasured(piece, name) }
}

/// The cell of one engine, after all phases of `piece` or up to the one in which it was skipped.
pub(super) fn summarize(piece: &Piece, contestant: &Contestant) -> Cell {
    let measured = piece.phases.iter().zip(&contestant.phases);
    let measured = measured.filter(|(_, samples)| !samples.samples.is_empty());
    let phases: Vec<Phase> =
        measured.map(|(phase, samples)| summarize_phase(phase, samples)).collect();
    let is_whole = contestant.is_in() && !phases.is_empty();
    let mean = |value: fn(&Phase) -> f64| {
        is_whole.then(|| phases.iter().map(value).sum::<f64>() / phases.len() as f64)
    };
    let spread = if is_whole { phases.iter().map(spread).fold(0.0, f64::max) } else { 0.0 };
    let judged = contestant.phases.iter().map(|phase| phase.judged);
    Cell {
        setting: contestant.setting.clone(),
        commit_ms: mean(|phase| phase.commit_ms),
        trace_ms: mean(|phase| phase.trace_ms),
        total_ms: mean(|phase| phase.total_ms),
        spread,
        noisy: spread > NOISY,
        mismatches: phases.iter().map(|phase| phase.mismatches).sum(),
        judged: judged.fold(Judged::default(), add),
        skipped: contestant.skipped.clone(),
        counters: mean_counters(&phases),
        memory_bytes: contestant.phases.iter().map(|phase| phase.memory_bytes).max().unwrap_or(0),
        facts: contestant.phases.last().map_or_else(Default::default, |phase| named(&phase.facts)),
        phases,
        ..unmeasured(piece, &contestant.name)
    }
}

/// A cell with what its phases, of which there is at least one, have in common: the most
/// triangles, mean times and counts.
pub(crate) fn of_phases(phases: Vec<Phase>) -> Cell {
    let mean =
        |value: fn(&Phase) -> f64| phases.iter().map(value).sum::<f64>() / phases.len() as f64;
    let spread = phases.iter().map(spread).fold(0.0, f64::max);
    Cell {
        triangles: phases.iter().map(|phase| phase.triangles).max().unwrap_or(0),
        rays: mean(|phase| phase.rays as f64).round() as u64,
        threads: rayon::current_num_threads(),
        commit_ms: Some(mean(|phase| phase.commit_ms)),
        trace_ms: Some(mean(|phase| phase.trace_ms)),
        total_ms: Some(mean(|phase| phase.total_ms)),
        spread,
        noisy: spread > NOISY,
        mismatches: phases.iter().map(|phase| phase.mismatches).sum(),
        counters: mean_counters(&phases),
        phases,
        ..Cell::default()
    }
}

/// A frame of an animation as a phase: medians of what each of its rounds took, as milliseconds of
/// commit and trace.
pub(crate) fn of_frame(frame: u32, rounds: &[[f64; 2]]) -> Phase {
    let quartiles = |value: fn(&[f64; 2]) -> f64| Quartiles::of(rounds.iter().map(value));
    let total = quartiles(|[commit, trace]| commit + trace);
    Phase {
        name: format!("frame {frame}"),
        frame: Some(frame),
        rounds: rounds.len(),
        commit_ms: quartiles(|round| round[0]).median,
        trace_ms: quartiles(|round| round[1]).median,
        total_ms: total.median,
        total_quartiles_ms: [total.lower, total.upper],
        ..Phase::default()
    }
}

/// Facts by name.
pub(crate) fn named(facts: &[Fact]) -> BTreeMap<String, f64> {
    facts.iter().map(|fact| (fact.name.to_owned(), fact.value)).collect()
}

/// A cell with nothing measured.
fn unmeasured(piece: &Piece, name: &str) -> Cell {
    let ray_counts = piece.phases.iter().map(ray_count);
    Cell {
        triangles: piece.triangles,
        rays: ray_counts.sum::<u64>() / piece.phases.len().max(1) as u64,
        kind: piece.kind.to_string(),
        scene: piece.scene.clone(),
        engine: name.to_owned(),
        threads: rayon::current_num_threads(),
        ..Cell::default()
    }
}

fn summarize_phase(phase: &PiecePhase, measured: &PhaseSamples) -> Phase {
    let quartiles = |cost: fn(&Sample) -> Cost| {
        Quartiles::of(measured.samples.iter().map(|sample| 1e3 * cost(sample).time.as_secs_f64()))
    };
    let total = quartiles(Sample::total);
    let allocations =
        allocations::median(measured.samples.iter().map(|sample| sample.total().allocations));
    Phase {
        name: phase.name.clone(),
        frame: phase.frame,
        rounds: measured.samples.len(),
        triangles: phase.frames.first().map_or(0, |frame| frame.geometry.prim_count()),
        rays: ray_count(phase),
        commit_ms: quartiles(|sample| sample.commit).median,
        trace_ms: quartiles(|sample| sample.trace).median,
        total_ms: total.median,
        total_quartiles_ms: [total.lower, total.upper],
        mismatches: measured.comparison.mismatches,
        counters: Counters { allocations, ..measured.counters },
        ..Phase::default()
    }
}

fn ray_count(phase: &PiecePhase) -> u64 {
    phase.frames.first().map_or(0, |frame| frame.rays.len() as u64)
}

/// Distance of the outer quartiles of a total as a share of its median.
fn spread(phase: &Phase) -> f64 {
    let [lower, upper] = phase.total_quartiles_ms;
    Quartiles { lower, median: phase.total_ms, upper }.spread()
}

fn add(a: Judged, b: Judged) -> Judged {
    Judged {
        rays: a.rays + b.rays,
        both_right: a.both_right + b.both_right,
        only_this: a.only_this + b.only_this,
        only_reference: a.only_reference + b.only_reference,
        neither: a.neither + b.neither,
    }
}

/// Means over phases.
fn mean_counters(phases: &[Phase]) -> Counters {
    let mean = |count: fn(&Counters) -> u64| {
        let sum: u64 = phases.iter().map(|phase| count(&phase.counters)).sum();
        sum / phases.len().max(1) as u64
    };
    Counters {
        cone_tests: mean(|counters| counters.cone_tests),
        box_tests: mean(|counters| counters.box_tests),
        triangle_tests: mean(|counters| counters.triangle_tests),
        tiles: mean(|counters| counters.tiles),
        pairs: mean(|counters| counters.pairs),
        bytes: mean(|counters| counters.bytes),
        allocations: phases.iter().map(|phase| phase.counters.allocations).max().flatten(),
    }
}
