//! Gathering with approximate visibility: tiles of points against spheres that stand for geometry.
//!
//! ```text
//!   run of points -- share_lookouts --> tiles of lookouts, each for 16, 4 or 1 of the points
//!   tile, 16 lights -- see_tile ------> what each lookout sees of each light
//!                   -- light_blocks --> sixteen points at once: what lights send times that
//! ```
//!
//! No pair is written down but those of a tile's lookouts and a group of lights, which stay in the
//! cache. Lights that face away from the whole tile are done with first.
//!
//! **Source**: see [`occluders`](crate::occluders).
//!
//! **Departures** from [`gather`](super::gather): lights are added in an order that keeps neighbours
//! together, distant lights are only very far away, and see [`light_blocks`](super::light_blocks).
//!
//! **Invariants**: the picture does not depend on the number of threads. Who shares a lookout does
//! depend on which points are shaded together, and so, a little, on the batch limit.

use glam::Vec3;
use rayflock_geom::simd::{LANES, Lanes, Simd, SimdLevel, dispatch};
use rayon::prelude::*;
use tracing::debug_span;

use super::gather::GatherStats;
use super::light_blocks::LitBlock;
use super::light_ways::NearLight;
use super::sphere_visibility::DISTANCE;
use super::{VirtualLights, VisibilityStats};
use crate::occluders::{
    Alike, LookoutTile, SeenLight, SharedLookouts, SphereTree, TileSight, nearby_order,
};
use crate::wave::{Contribution, LitPoint, ShadedRun};

/// Lights of a group.
const GROUP_LIGHTS: usize = 16;

/// Points share a lookout if so many are close, and unit normals within this distance of their mean.
const MOST_SHARING: usize = 16;
const SPREAD: f32 = 0.3;

/// Lights in an order in which neighbours are close, or alike in direction.
#[derive(Debug, Default)]
pub(crate) struct GroupedLights {
    near: Vec<NearLight>,
    /// Which lights are distant.
    distant: Vec<usize>,
}

impl GroupedLights {
    /// Makes these the groups of `lights`.
    pub(crate) fn assign(&mut self, lights: &VirtualLights) {
        let near = 0..lights.distant().start;
        self.near.clear();
        self.near.extend(
            nearby_order(&lights.positions()[near])
                .into_iter()
                .map(|light_idx| NearLight::new(lights, light_idx, (Vec3::ZERO, 0.0))),
        );
        let distant = lights.distant();
        self.distant.clear();
        self.distant.extend(
            nearby_order(&lights.positions()[distant.clone()])
                .into_iter()
                .map(|idx| distant.start + idx),
        );
    }

    /// Number of lights.
    pub(super) const fn len(&self) -> usize {
        self.near.len() + self.distant.len()
    }

    /// How many of them, the first, are not distant.
    pub(super) const fn near_count(&self) -> usize {
        self.near.len()
    }

    /// The place in `lights` of light `light_idx`, if it is distant.
    pub(super) fn distant(&self, light_idx: usize) -> Option<usize> {
        self.distant.get(light_idx.checked_sub(self.near.len())?).copied()
    }

    /// Light `light_idx`; a distant one is placed as in [`NearLight::new`].
    #[inline]
    pub(super) fn placed(
        &self,
        lights: &VirtualLights,
        light_idx: usize,
        place: (Vec3, f32),
    ) -> NearLight {
        match self.distant(light_idx) {
            Some(idx) => NearLight::new(lights, idx, place),
            None => self.near[light_idx],
        }
    }

    /// Bytes held.
    pub(crate) fn memory_usage(&self) -> usize {
        self.near.capacity() * size_of::<NearLight>() + self.distant.capacity() * size_of::<usize>()
    }
}

/// Gathers the light of `lights`, which are also `grouped`, at all points of `runs`; see
/// [`gather`](super::gather::gather).
pub(crate) fn gather_past_spheres(
    lights: &VirtualLights,
    grouped: &GroupedLights,
    tree: &SphereTree,
    bound: f32,
    runs: &mut [ShadedRun],
) -> GatherStats {
    let _span = debug_span!("gather_past_spheres").entered();
    let all = AllLights { lights, grouped, tree, bound, distance: DISTANCE * lights.reach() };
    let stats = runs.par_iter_mut().map_init(Workspace::default, |workspace, run| {
        let ShadedRun { points, lit, .. } = run;
        all.gather(points, workspace, lit)
    });
    // In order, so that sums are the same with any number of threads.
    let stats: Vec<GatherStats> = stats.collect();
    stats.into_iter().fold(GatherStats::default(), |mut sum, stats| {
        sum.visibility += stats.visibility;
        sum.gathered += stats.gathered;
        sum.lost += stats.lost;
        sum
    })
}

/// What all tiles have in common.
struct AllLights<'a> {
    lights: &'a VirtualLights,
    grouped: &'a GroupedLights,
    tree: &'a SphereTree,
    bound: f32,
    /// Of distant lights.
    distance: f32,
}

/// Working memory of a thread.
#[derive(Debug, Default)]
struct Workspace {
    positions: Vec<Vec3>,
    normals: Vec<Vec3>,
    sharing: SharedLookouts,
    of_tile: TileWorkspace,
}

/// The same for a tile.
#[derive(Debug, Default)]
struct TileWorkspace {
    sight: TileSight,
    blocks: Vec<LitBlock>,
    /// Lights of a group that do not face away.
    lights: Vec<NearLight>,
    seen: Vec<SeenLight>,
    /// What lookouts see of them, sixteen lookouts after another for each light.
    shares: Vec<Lanes>,
}

impl AllLights<'_> {
    /// Gathers at points; what arrives is left in `lit`, one entry a point.
    fn gather(
        &self,
        points: &[LitPoint],
        workspace: &mut Workspace,
        lit: &mut Vec<Contribution>,
    ) -> GatherStats {
        let Workspace { positions, normals, sharing, of_tile } = workspace;
        positions.clear();
        normals.clear();
        positions.extend(points.iter().map(|point| point.shadow_position));
        normals.extend(points.iter().map(|point| point.normal));
        lit.clear();
        lit.extend(
            points
                .iter()
                .map(|point| Contribution { pixel_idx: point.pixel_idx, radiance: Vec3::ZERO }),
        );
        let tests_before = of_tile.sight.tests();
        let mut stats = GatherStats::default();
        let reach = self.tree.reach_of_lookouts();
        let alike = Alike { most: MOST_SHARING, reach, spread: SPREAD, by_side: false };
        sharing.for_each_tile(positions, normals, alike, |tile| {
            self.gather_tile(tile, points, of_tile);
            hand_out((&of_tile.blocks, &tile.blocks), points, lit, &mut stats);
        });
        stats.visibility = VisibilityStats {
            pairs: (points.len() * self.lights.len()) as u64,
            rays: 0,
            tests: of_tile.sight.tests() - tests_before,
        };
        stats
    }

    /// Adds the light of all lights to the blocks of a tile.
    fn gather_tile(&self, tile: &LookoutTile, points: &[LitPoint], workspace: &mut TileWorkspace) {
        workspace.blocks.clear();
        workspace.blocks.extend(tile.blocks.iter().map(|block| {
            let known = block.iter().filter_map(|&idx| points.get(idx as usize));
            LitBlock::new(known)
        }));
        for group in self.grouped.near.chunks(GROUP_LIGHTS) {
            workspace.gather_group(self.tree, tile, group.iter().copied(), self.bound);
        }
        let center = tile.lookouts.center();
        for group in self.grouped.distant.chunks(GROUP_LIGHTS) {
            let place = (center, self.distance);
            let placed = group.iter().map(|&idx| NearLight::new(self.lights, idx, place));
            workspace.gather_group(self.tree, tile, placed, f32::INFINITY);
        }
    }
}

impl TileWorkspace {
    /// Adds the light of lights that are close to each other.
    fn gather_group(
        &mut self,
        tree: &SphereTree,
        tile: &LookoutTile,
        lights: impl Iterator<Item = NearLight>,
        bound: f32,
    ) {
        let Self { sight, blocks, lights: group, seen, shares } = self;
        group.clear();
        group.extend(lights.filter(|light| {
            let NearLight { position, normal, evenness, .. } = *light;
            !tile.faces_away(&SeenLight { position, normal }, evenness)
        }));
        seen.clear();
        seen.extend(
            group.iter().map(|&NearLight { position, normal, .. }| SeenLight { position, normal }),
        );
        let cell_count = tile.lookouts.len().div_ceil(LANES);
        shares.clear();
        shares.resize(group.len() * cell_count, [0.0; LANES]);
        sight.see(tree, &tile.lookouts, seen, |light_idx, cell_idx, through| {
            shares[light_idx * cell_count + cell_idx] = *through;
        });
        drop_hidden(group, shares, cell_count);
        dispatch!(SimdLevel::best().level(), simd => {
            add_group(simd, (tile.per_lookout, cell_count), group, shares, bound, blocks);
        });
    }
}

/// Hands out what came to the points of blocks, and adds it up; `members` are their places.
pub(super) fn hand_out(
    (blocks, members): (&[LitBlock], &[[u32; LANES]]),
    points: &[LitPoint],
    lit: &mut [Contribution],
    stats: &mut GatherStats,
) {
    for (block, members) in blocks.iter().zip(members) {
        for (lane, &point_idx) in members.iter().enumerate() {
            let Some(point) = points.get(point_idx as usize) else { continue };
            let (radiance, lost) = block.radiance(lane, point);
            let sum = radiance.element_sum();
            if sum.is_finite() {
                stats.gathered += f64::from(sum);
                stats.lost += f64::from(lost);
            }
            lit[point_idx as usize].radiance = radiance;
        }
    }
}

/// Leaves out lights of which nothing is seen, and their shares, which are `cell_count` a light.
fn drop_hidden(group: &mut Vec<NearLight>, shares: &mut Vec<Lanes>, cell_count: usize) {
    let mut kept = 0;
    for light_idx in 0..group.len() {
        let of_light = light_idx * cell_count..(light_idx + 1) * cell_count;
        if shares[of_light.clone()].as_flattened().iter().any(|share| *share > 0.0) {
            group[kept] = group[light_idx];
            shares.copy_within(of_light, kept * cell_count);
            kept += 1;
        }
    }
    group.truncate(kept);
    shares.truncate(kept * cell_count);
}

/// Adds the light of a group to all blocks of a tile.
#[inline(always)]
fn add_group<S: Simd>(
    simd: S,
    (per_lookout, cell_count): (usize, usize),
    group: &[NearLight],
    shares: &[Lanes],
    bound: f32,
    blocks: &mut [LitBlock],
) {
    for (cell_idx, blocks) in blocks.chunks_mut(per_lookout).enumerate() {
        for block in blocks {
            let of_cell = shares.iter().skip(cell_idx).step_by(cell_count.max(1));
            block.add(simd, group, of_cell, bound);
        }
    }
}
