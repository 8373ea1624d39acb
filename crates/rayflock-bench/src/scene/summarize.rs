//! From samples to a record: medians over the runs of a frame, means over the frames.

use rayflock::render::RayCounts;

use super::SceneBench;
use super::contestant::{Contestant, Sample};
use super::record::{Cell, Machine, Phase, RaysByKind, Record};
use crate::Quartiles;

/// Summarizes what was measured: `samples().len() == frames.len() * run_count` for each engine,
/// run by run.
pub(super) fn summarize(bench: &SceneBench, contestants: &[Contestant]) -> Record {
    let mut cells: Vec<Cell> = Vec::with_capacity(contestants.len());
    for contestant in contestants {
        let cell = cell(bench, contestant, cells.first());
        cells.push(cell);
    }
    let version = env!("CARGO_PKG_VERSION");
    Record { version, machine: Machine::here(), run_count: bench.run_count, cells }
}

/// The cell of one engine; `first` is that of the first engine, if this is another.
fn cell(bench: &SceneBench, contestant: &Contestant, first: Option<&Cell>) -> Cell {
    let frame_count = bench.frames.len();
    let samples_of = |idx| contestant.samples().iter().skip(idx).step_by(frame_count);
    let phases = (0..frame_count).map(|idx| {
        let samples: Vec<Sample> = samples_of(idx).copied().collect();
        phase(bench.frames[idx], &samples, first.map(|first| &first.phases[idx]))
    });
    let phases: Vec<Phase> = phases.collect();

    let mean =
        |value: fn(&Phase) -> f64| phases.iter().map(value).sum::<f64>() / phases.len() as f64;
    let (total_ms, rays) = (mean(|phase| phase.total_ms), mean(|phase| phase.rays as f64));
    let spread = |phase: &Phase| {
        let [lower, upper] = phase.total_quartiles_ms;
        Quartiles { lower, median: phase.total_ms, upper }.spread()
    };
    Cell {
        scene: bench.name.clone(),
        engine: contestant.engine().name(),
        threads: rayon::current_num_threads(),
        size: bench.size,
        triangles: phases.iter().map(|phase| phase.triangles).max().unwrap_or(0),
        rays,
        rays_by_kind: RaysByKind {
            primary: mean(|phase| phase.rays_by_kind.primary),
            shadow: mean(|phase| phase.rays_by_kind.shadow),
            mirror: mean(|phase| phase.rays_by_kind.mirror),
            refraction: mean(|phase| phase.rays_by_kind.refraction),
        },
        commit_ms: mean(|phase| phase.commit_ms),
        trace_ms: mean(|phase| phase.trace_ms),
        total_ms,
        ratio: ratio(total_ms, first.map(|first| first.total_ms)),
        spread: Quartiles::of(phases.iter().map(spread)).median,
        triangle_tests_per_ray: per_ray(mean(|phase| phase.triangle_tests as f64), rays),
        cone_tests_per_ray: per_ray(mean(|phase| phase.cone_tests as f64), rays),
        differing_pixels: phases.iter().map(|phase| phase.differing_pixels).sum(),
        phases,
    }
}

/// One frame of one engine. Counts do not depend on the run: the last one's are taken.
fn phase(frame: u32, samples: &[Sample], first: Option<&Phase>) -> Phase {
    let Some(last) = samples.last() else { unreachable!("every frame is measured in every run") };
    let quartiles = |value: fn(&Sample) -> f64| Quartiles::of(samples.iter().map(value));
    let total = quartiles(Sample::total_ms);
    Phase {
        frame,
        triangles: last.triangles,
        rays: last.stats.rays.total(),
        rays_by_kind: by_kind(&last.stats.rays),
        commit_ms: quartiles(|sample| sample.commit_ms).median,
        trace_ms: quartiles(|sample| sample.trace_ms).median,
        total_ms: total.median,
        total_quartiles_ms: [total.lower, total.upper],
        ratio: ratio(total.median, first.map(|first| first.total_ms)),
        triangle_tests: last.stats.trace.triangle_tests,
        cone_tests: last.stats.trace.cone_tests,
        memory_bytes: last.memory_bytes,
        differing_pixels: samples.iter().map(|sample| sample.differing_pixels).sum(),
    }
}

fn by_kind(rays: &RayCounts) -> RaysByKind {
    RaysByKind {
        primary: rays.primary as f64,
        shadow: rays.shadow as f64,
        mirror: rays.mirror as f64,
        refraction: rays.refraction as f64,
    }
}

/// `total_ms` as a multiple of the first engine's; 1 for the first engine itself.
fn ratio(total_ms: f64, first_ms: Option<f64>) -> f64 {
    first_ms.filter(|&first_ms| first_ms > 0.0).map_or(1.0, |first_ms| total_ms / first_ms)
}

fn per_ray(tests: f64, rays: f64) -> f64 {
    if rays > 0.0 { tests / rays } else { 0.0 }
}
