//! From samples to cells: medians over the runs of a frame, means over the frames.

use rayflock::render::RayCounts;

use super::MuseumBench;
use super::contestant::{Contestant, Sample};
use crate::Quartiles;
use crate::contest::{named, of_frame, of_phases};
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
    let memory = contestant.samples().iter().map(|sample| sample.memory_bytes);
    Cell {
        kind: PICTURE.to_owned(),
        scene: bench.name.clone(),
        engine: contestant.name.clone(),
        setting: contestant.setting.clone(),
        memory_bytes: memory.max().unwrap_or(0),
        facts: named(&contestant.facts()),
        ..of_phases(phases.collect())
    }
}

/// One frame of one engine. Counts do not depend on the run: the last one's are taken.
fn phase(frame: u32, samples: &[Sample]) -> Phase {
    let Some(last) = samples.last() else { unreachable!("every frame is measured in every run") };
    let times = |sample: &Sample| [sample.commit_ms, sample.trace_ms];
    let shade = Quartiles::of(samples.iter().map(|sample| sample.shade_ms));
    Phase {
        triangles: last.triangles,
        rays: last.stats.rays.total(),
        rays_by_kind: Some(by_kind(&last.stats.rays)),
        shade_ms: Some(shade.median),
        mismatches: samples.iter().map(|sample| sample.differing_pixels).max().unwrap_or(0),
        counters: Counters::from(&last.stats.trace),
        ..of_frame(frame, &samples.iter().map(times).collect::<Vec<_>>())
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
