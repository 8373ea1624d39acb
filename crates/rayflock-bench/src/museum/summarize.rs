//! From samples to cells: medians over the runs of a frame, means over the frames.

use rayflock::render::RayCounts;

use super::MuseumBench;
use super::contestant::{Contestant, Sample};
use crate::Quartiles;
use crate::contest::{NOISY, mean_counters, named, spread};
use crate::ratio::PICTURE;
use crate::record::{Cell, Counters, Phase, RaysByKind};

/// The cell of one engine: `samples().len() == frames.len() * run_count`, run by run.
pub(super) fn summarize(bench: &MuseumBench, contestant: &Contestant) -> Cell {
    let frame_count = bench.frames.len();
    let samples_of = |idx| contestant.samples().iter().skip(idx).step_by(frame_count);
    let phases = bench.frames.iter().enumerate().map(|(idx, &frame)| {
        let samples: Vec<Sample> = samples_of(idx).copied().collect();
        phase(frame, &samples)
    });
    let phases: Vec<Phase> = phases.collect();

    let mean =
        |value: fn(&Phase) -> f64| phases.iter().map(value).sum::<f64>() / phases.len() as f64;
    let spread = phases.iter().map(spread).fold(0.0, f64::max);
    let memory = contestant.samples().iter().map(|sample| sample.memory_bytes);
    Cell {
        triangles: phases.iter().map(|phase| phase.triangles).max().unwrap_or(0),
        rays: mean(|phase| phase.rays as f64).round() as u64,
        kind: PICTURE.to_owned(),
        scene: bench.name.clone(),
        engine: contestant.name.clone(),
        setting: contestant.setting.clone(),
        threads: rayon::current_num_threads(),
        commit_ms: Some(mean(|phase| phase.commit_ms)),
        trace_ms: Some(mean(|phase| phase.trace_ms)),
        total_ms: Some(mean(|phase| phase.total_ms)),
        spread,
        noisy: spread > NOISY,
        mismatches: phases.iter().map(|phase| phase.mismatches).sum(),
        counters: mean_counters(&phases),
        memory_bytes: memory.max().unwrap_or(0),
        facts: named(&contestant.facts()),
        phases,
        ..Cell::default()
    }
}

/// One frame of one engine. Counts do not depend on the run: the last one's are taken.
fn phase(frame: u32, samples: &[Sample]) -> Phase {
    let Some(last) = samples.last() else { unreachable!("every frame is measured in every run") };
    let quartiles = |value: fn(&Sample) -> f64| Quartiles::of(samples.iter().map(value));
    let total = quartiles(Sample::total_ms);
    Phase {
        name: format!("frame {frame}"),
        frame: Some(frame),
        rounds: samples.len(),
        triangles: last.triangles,
        rays: last.stats.rays.total(),
        rays_by_kind: Some(by_kind(&last.stats.rays)),
        commit_ms: quartiles(|sample| sample.commit_ms).median,
        trace_ms: quartiles(|sample| sample.trace_ms).median,
        total_ms: total.median,
        total_quartiles_ms: [total.lower, total.upper],
        shade_ms: Some(quartiles(|sample| sample.shade_ms).median),
        mismatches: samples.iter().map(|sample| sample.differing_pixels).max().unwrap_or(0),
        counters: Counters::from(&last.stats.trace),
    }
}

fn by_kind(rays: &RayCounts) -> RaysByKind {
    RaysByKind {
        primary: rays.primary,
        shadow: rays.shadow,
        mirror: rays.mirror,
        refraction: rays.refraction,
    }
}
