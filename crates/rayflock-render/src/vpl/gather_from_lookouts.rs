//! Gathering with exact visibility from few points: neighbours share what one of them sees.
//!
//! ```text
//!   run of points -- share_lookouts --> cells: sixteen lookouts, each of up to 64 points
//!   cell, light   -- facing ----------> one point of each lookout, another for each light
//!   light         -- engine: occluded -> which of these see it, a bit each
//!   cell          -- light_blocks ----> sixteen points at once: what lights send that are seen
//! ```
//!
//! How bright a light is, and what the surface makes of it, stays each point's own; only whether it
//! is seen is shared. Which point of a lookout looks changes from light to light, so that edges of
//! shadows, wrong by up to the size of a group, are so in other ways for each light, and little of
//! that is left in the sum. A point that faces away from the light does not look if another does not.
//!
//! **Source.** G. Nichols, J. Shopf, C. Wyman, "Hierarchical Image-Space Radiosity for Interactive
//! Global Illumination", EGSR 2009, for indirect light at as many places as it needs; A. Keller and
//! W. Heidrich, "Interleaved Sampling", EGWR 2001, for neighbours that look at different lights.
//!
//! **Departures.** Only visibility is shared, and all lights are seen by all.
//!
//! **Invariants**: the picture does not depend on the number of threads. Who shares a lookout does
//! depend on which points are shaded together, and so, a little, on the batch limit.
//!
//! **Cost**: a ray for each lookout and light that face each other; two bytes for sixteen of them.

use glam::Vec3;
use rayflock_engine::RayEngine;
use rayflock_geom::RayOrder;
use rayflock_geom::simd::{LANES, Lanes, SimdLevel, dispatch};
use rayon::prelude::*;
use tracing::debug_span;

use super::gather::GatherStats;
use super::gather_past_spheres::GroupedLights;
use super::light_blocks::LitBlock;
use super::light_ways::NearLight;
use super::lookout_cells::{Cell, LookoutCells};
use super::shadow_segments::{ShadowSegments, Start};
use super::sphere_visibility::DISTANCE;
use super::{LookoutSettings, VirtualLights, VisibilityStats};
use crate::occluders::Alike;
use crate::stats::StageStats;
use crate::wave::{ShadedRun, Shared};

/// Points that share a lookout lie within this share of the scene's diagonal of their middle.
const REACH: f32 = 0.05;

/// Their unit normals lie within this distance of their mean: of a figure, those of one side.
const SPREAD: f32 = 1.2;

/// Lights whose rays are one batch: toward a single one there are too few to keep threads busy.
const LIGHTS_AT_ONCE: usize = 32;

/// So many points of a lookout are asked whether they face a light.
const TRIES: usize = 6;

/// From one of these to the next, in the order along a curve; shares no factor with their number.
const STRIDE: usize = 5;

/// Gathers; memory is kept from wave to wave.
#[derive(Debug, Default)]
pub(crate) struct LookoutGatherer {
    runs: Vec<LookoutCells>,
    /// Of lights, one by one, and of some together.
    rays: Vec<LookoutRays>,
    batch: LookoutRays,
    /// Which lookouts see which lights: for each light all cells, a bit a lookout.
    seen: Vec<u16>,
}

/// The lights of a picture, as all cells see them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SeenLights<'a> {
    pub(crate) lights: &'a VirtualLights,
    /// The same.
    pub(crate) grouped: &'a GroupedLights,
    /// Up to which geometry terms count.
    pub(crate) bound: f32,
}

/// Rays toward lights, and whose they are.
#[derive(Debug, Default)]
struct LookoutRays {
    segments: ShadowSegments,
    /// Cells, counted through all runs and again for each light, times sixteen, and the lane.
    lookouts: Vec<u32>,
}

impl LookoutGatherer {
    /// Gathers the light of all `lights` at all points of `runs`, with `engine` to see; see
    /// [`gather`](super::gather::gather). Tells what tracing took as well.
    pub(crate) fn gather(
        &mut self,
        engine: &mut dyn RayEngine,
        lights: SeenLights<'_>,
        settings: LookoutSettings,
        runs: &mut [ShadedRun],
    ) -> (GatherStats, StageStats) {
        let _span = debug_span!("gather_from_lookouts").entered();
        let reach = REACH * lights.lights.reach();
        let alike = Alike { most: settings.points, reach, spread: SPREAD, by_side: true };
        self.runs.resize_with(runs.len().max(self.runs.len()), LookoutCells::default);
        let cells = self.runs.par_iter_mut().zip(&*runs);
        cells.for_each(|(cells, run)| cells.assign(run, alike));

        let (rays, traced) = self.look(engine, lights, runs.len());
        let mut stats = self.add(lights, runs);
        let point_count: usize = runs.iter().map(|run| run.points.len()).sum();
        let pairs = (point_count * lights.grouped.len()) as u64;
        stats.visibility = VisibilityStats { pairs, rays, tests: 0 };
        (stats, traced)
    }

    /// Has the engine tell which lookouts of the first `run_count` runs see which lights; returns how
    /// many rays that took.
    fn look(
        &mut self,
        engine: &mut dyn RayEngine,
        lights: SeenLights<'_>,
        run_count: usize,
    ) -> (u64, StageStats) {
        let Self { runs, rays, batch, seen } = self;
        let runs = &runs[..run_count];
        let cell_count: usize = runs.iter().map(LookoutCells::len).sum();
        let light_count = lights.grouped.len();
        seen.clear();
        seen.resize(cell_count * light_count, 0);
        rays.resize_with(LIGHTS_AT_ONCE, LookoutRays::default);
        let near_count = lights.grouped.near_count();
        let (mut ray_count, mut traced) = (0, StageStats::default());
        let kinds =
            [(0..near_count, Start::Light), (near_count..light_count, Start::PointOfDistant)];
        for (range, start) in kinds {
            for first in range.clone().step_by(LIGHTS_AT_ONCE) {
                let rays = &mut rays[..LIGHTS_AT_ONCE.min(range.end - first)];
                rays.par_iter_mut().enumerate().for_each(|(idx, rays)| {
                    rays.collect(lights, (idx, first + idx), runs);
                });
                rays.iter_mut().for_each(|rays| batch.append(rays));
                ray_count += batch.lookouts.len() as u64;
                traced += batch.trace(engine, start, &mut seen[first * cell_count..]);
            }
        }
        (ray_count, traced)
    }

    /// Adds the light that is seen, and leaves it with the runs.
    fn add(&mut self, lights: SeenLights<'_>, runs: &mut [ShadedRun]) -> GatherStats {
        let Self { runs: cells_of_runs, seen, .. } = self;
        let cell_count = cells_of_runs[..runs.len()].iter().map(LookoutCells::len).sum();
        let starts = cells_of_runs.iter().scan(0, |next, cells| {
            *next += cells.len();
            Some(*next - cells.len())
        });
        let starts: Vec<usize> = starts.collect();
        let all = runs.par_iter_mut().zip(cells_of_runs).zip(starts);
        let stats = all.map_init(SeenByCell::default, |of_cell, ((run, cells), start)| {
            for (idx, (cell, blocks)) in cells.iter_mut().enumerate() {
                let seen = seen.iter().skip(start + idx).step_by(cell_count);
                of_cell.add(lights, (cell, blocks), seen.copied());
            }
            cells.hand_out(run)
        });
        // In order, so that sums are the same with any number of threads.
        let stats: Vec<GatherStats> = stats.collect();
        stats.into_iter().fold(GatherStats::default(), |mut sum, stats| {
            sum.gathered += stats.gathered;
            sum.lost += stats.lost;
            sum
        })
    }

    /// Bytes held.
    pub(crate) fn memory_usage(&self) -> usize {
        let rays = self
            .rays
            .iter()
            .map(|rays| rays.segments.memory_usage() + rays.lookouts.capacity() * size_of::<u32>());
        self.runs.iter().map(LookoutCells::memory_usage).sum::<usize>()
            + rays.sum::<usize>()
            + self.seen.capacity() * size_of::<u16>()
    }
}

impl SeenLights<'_> {
    /// Light `light_idx` as it is seen from `cell`.
    fn seen_from(&self, cell: &Cell, light_idx: usize) -> NearLight {
        let place = (cell.center, DISTANCE * self.lights.reach());
        self.grouped.placed(self.lights, light_idx, place)
    }
}

impl LookoutRays {
    /// Makes these the rays of all lookouts of `runs` toward light `light_idx`, which comes after
    /// `lights_before` others of the batch.
    fn collect(
        &mut self,
        lights: SeenLights<'_>,
        (lights_before, light_idx): (usize, usize),
        runs: &[LookoutCells],
    ) {
        let to_light = lights.grouped.distant(light_idx).map(|idx| lights.lights.positions()[idx]);
        let cell_count: usize = runs.iter().map(LookoutCells::len).sum();
        for (cell_idx, (cell, blocks)) in runs.iter().flat_map(LookoutCells::iter).enumerate() {
            let light = lights.seen_from(cell, light_idx);
            let first = (lights_before * cell_count + cell_idx) * LANES;
            let mut rest = cell.lookouts;
            for attempt in 0..TRIES.min(blocks.len()) {
                let block = &blocks[(cell_idx + light_idx + STRIDE * attempt) % blocks.len()];
                let facing =
                    dispatch!(SimdLevel::best().level(), simd => block.facing(simd, &light));
                self.push((block, rest & facing), first, light.position, to_light);
                rest &= !facing;
                if rest == 0 {
                    break;
                }
            }
        }
    }

    /// Adds rays between a light, which is distant where there is a direction `to_light`, and the
    /// points of some lanes of a block. The first lane is lookout `first`.
    fn push(
        &mut self,
        (block, mut lanes): (&LitBlock, u32),
        first: usize,
        light: Vec3,
        to_light: Option<Vec3>,
    ) {
        while lanes != 0 {
            let lane = lanes.trailing_zeros() as usize;
            lanes &= lanes - 1;
            let point = block.position(lane);
            match to_light {
                Some(to_light) => self.segments.push(point, to_light),
                None => self.segments.push(light, point - light),
            }
            self.lookouts.push((first + lane) as u32);
        }
    }

    /// Takes over the rays of `other`.
    fn append(&mut self, other: &mut Self) {
        self.segments.append(&mut other.segments);
        self.lookouts.append(&mut other.lookouts);
    }

    /// Notes which lookouts see the lights, and forgets the rays.
    fn trace(&mut self, engine: &mut dyn RayEngine, start: Start, seen: &mut [u16]) -> StageStats {
        let traced = self.segments.trace(engine, (start, Shared::Nothing), RayOrder::Coherent);
        for (&lookout, occluded) in self.lookouts.iter().zip(self.segments.occluded()) {
            let (cell_idx, lane) = (lookout as usize / LANES, lookout as usize % LANES);
            seen[cell_idx] |= u16::from(!occluded) << lane;
        }
        self.segments.clear();
        self.lookouts.clear();
        traced
    }
}

/// Lights that a cell sees anything of; working memory, one a thread.
#[derive(Debug, Default)]
struct SeenByCell {
    lights: Vec<NearLight>,
    shares: Vec<Lanes>,
}

impl SeenByCell {
    /// Adds all light to the blocks of a cell; bit i of `seen` tells whether lookout i sees a light.
    fn add(
        &mut self,
        lights: SeenLights<'_>,
        (cell, blocks): (&Cell, &mut [LitBlock]),
        mut seen: impl Iterator<Item = u16>,
    ) {
        let near_count = lights.grouped.near_count();
        let parts =
            [(0..near_count, lights.bound), (near_count..lights.grouped.len(), f32::INFINITY)];
        for (range, bound) in parts {
            self.lights.clear();
            self.shares.clear();
            for (light_idx, seen) in range.zip(seen.by_ref()) {
                if seen != 0 {
                    self.lights.push(lights.seen_from(cell, light_idx));
                    self.shares.push(std::array::from_fn(|lane| f32::from((seen >> lane) & 1)));
                }
            }
            dispatch!(SimdLevel::best().level(), simd => {
                for block in &mut *blocks {
                    block.add(simd, &self.lights, self.shares.iter(), bound);
                }
            });
        }
    }
}
