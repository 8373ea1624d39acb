//! Gathering with approximate visibility: tiles of points against spheres that stand for geometry.
//!
//! No pair is written down. Points of a run are taken a tile at a time, matte lights a group at a
//! time; sixteen points at once, what a light sends and what spheres let through are multiplied and
//! added up. Highlights of points come on top where they are bright enough to be seen; lights with
//! a highlight of their own, and distant ones, are added pair by pair.
//!
//! **Source**: see [`occluders`](crate::occluders).
//!
//! **Departures** from [`gather`](super::gather): lights are added in an order that keeps neighbours
//! together, and a highlight below [`FAINT`] of its strength is left out.
//!
//! **Invariants**: the picture does not depend on the number of threads.

use std::f32::consts::FRAC_1_PI;

use glam::Vec3;
use rayflock_geom::simd::{LANES, Lanes};
use rayon::prelude::*;
use tracing::debug_span;

use super::gather::{GatherStats, arriving};
use super::{VirtualLights, VisibilityStats};
use crate::occluders::{
    IrradianceBlock, MatteLight, PointTile, SeenLight, ShiningLight, SphereTree, TileSight,
    nearby_order,
};
use crate::wave::{Contribution, LitPoint, ShadedRun};

/// Points of a tile.
const TILE_POINTS: usize = 256;

/// Lights of a group.
const GROUP_LIGHTS: usize = 16;

/// A highlight below this share of its strength is not seen.
const FAINT: f32 = 1.0 / 512.0;

/// Distant lights are taken to be so many times farther away than the scene is large.
const DISTANCE: f32 = 64.0;

/// Lights in groups that are close.
#[derive(Debug, Default)]
pub(crate) struct GroupedLights {
    matte: Vec<ShiningLight>,
}

impl GroupedLights {
    /// Makes these the groups of `lights`.
    pub(crate) fn assign(&mut self, lights: &VirtualLights) {
        let plain = lights.plain();
        let order = nearby_order(&lights.positions()[plain.clone()]);
        self.matte.clear();
        self.matte.extend(order.into_iter().map(|idx| {
            let one = lights.get(plain.start + idx);
            let light =
                MatteLight { position: one.position, normal: one.normal, evenness: one.evenness };
            ShiningLight { light, intensity: one.intensity }
        }));
    }

    /// Bytes held.
    pub(crate) fn memory_usage(&self) -> usize {
        self.matte.capacity() * size_of::<ShiningLight>()
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
    let all = AllLights { lights, grouped, tree, bound };
    let stats = runs.par_iter_mut().map_init(Workspace::default, |workspace, run| {
        let ShadedRun { points, lit, .. } = run;
        lit.clear();
        let mut stats = GatherStats::default();
        for points in points.chunks(TILE_POINTS) {
            all.gather(points, workspace, lit, &mut stats);
        }
        stats
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
}

/// Working memory of a thread.
#[derive(Debug, Default)]
struct Workspace {
    positions: Vec<Vec3>,
    normals: Vec<Vec3>,
    tile: PointTile,
    sight: TileSight,
    sums: Vec<IrradianceBlock>,
    /// What highlights add, a point each.
    highlights: Vec<Vec3>,
}

impl AllLights<'_> {
    /// Gathers at the points of a tile, and appends what arrives to `lit`.
    fn gather(
        &self,
        points: &[LitPoint],
        workspace: &mut Workspace,
        lit: &mut Vec<Contribution>,
        stats: &mut GatherStats,
    ) {
        let Workspace { positions, normals, tile, sight, sums, highlights } = workspace;
        positions.clear();
        normals.clear();
        positions.extend(points.iter().map(|point| point.shadow_position));
        normals.extend(points.iter().map(|point| point.normal));
        tile.assign(positions, normals);
        sums.clear();
        sums.resize(points.len().div_ceil(LANES), IrradianceBlock::default());
        highlights.clear();
        highlights.resize(points.len(), Vec3::ZERO);
        let tests_before = sight.tests();

        let has_highlights = points.iter().any(|point| point.specular != Vec3::ZERO);
        for group in self.grouped.matte.chunks(GROUP_LIGHTS) {
            match has_highlights {
                true => sight.gather(
                    self.tree,
                    tile,
                    group,
                    self.bound,
                    sums,
                    |light, block, through| {
                        let first = LANES * block;
                        let lanes =
                            points[first..].iter().zip(&mut highlights[first..]).zip(through);
                        for ((point, sum), through) in lanes {
                            *sum += *through * highlight(point, &group[light], self.bound);
                        }
                    },
                ),
                false => sight.gather(self.tree, tile, group, self.bound, sums, |_, _, _| {}),
            }
        }
        let others = self.lights.lobed().chain(self.lights.distant());
        let mut lost = 0.0;
        for light_idx in others {
            let light = self.seen_light(light_idx, tile);
            sight.see(self.tree, tile, &[light], |_, block, through| {
                let first = LANES * block;
                let lanes = points[first..].iter().zip(&mut highlights[first..]).zip(through);
                lost += self.add_others(light_idx, lanes);
            });
        }

        for (idx, (point, highlight)) in points.iter().zip(&*highlights).enumerate() {
            let of = |columns: &[Lanes; 3]| Vec3::from(columns.map(|column| column[idx % LANES]));
            let sent_back = point.diffuse * FRAC_1_PI;
            let block = &sums[idx / LANES];
            let radiance = sent_back * of(&block.kept) + *highlight;
            lost += f64::from((sent_back * of(&block.lost)).element_sum());
            let sum = f64::from(radiance.element_sum());
            stats.gathered += if sum.is_finite() { sum } else { 0.0 };
            lit.push(Contribution { pixel_idx: point.pixel_idx, radiance });
        }
        stats.lost += lost;
        stats.visibility += VisibilityStats {
            pairs: (points.len() * self.lights.len()) as u64,
            rays: 0,
            tests: sight.tests() - tests_before,
        };
    }

    /// A light as spheres see it.
    fn seen_light(&self, light_idx: usize, tile: &PointTile) -> SeenLight {
        let position = self.lights.positions()[light_idx];
        if self.lights.is_distant(light_idx) {
            let position = tile.center() + DISTANCE * self.lights.reach() * position;
            return SeenLight { position, normal: Vec3::ZERO };
        }
        SeenLight { position, normal: self.lights.normals()[light_idx] }
    }

    /// Adds what a light of any kind sends to sixteen points; returns what the bound kept away.
    fn add_others<'b>(
        &self,
        light_idx: usize,
        lanes: impl Iterator<Item = ((&'b LitPoint, &'b mut Vec3), &'b f32)>,
    ) -> f64 {
        let mut lost = 0.0;
        for ((point, sum), through) in lanes.filter(|(_, through)| **through > 0.0) {
            let (radiance, beyond) = arriving(self.lights, light_idx, point, self.bound);
            if radiance.is_finite() {
                *sum += *through * radiance;
                lost += f64::from(*through * beyond);
            }
        }
        lost
    }
}

/// The highlight of a matte light at a point.
fn highlight(point: &LitPoint, shining: &ShiningLight, bound: f32) -> Vec3 {
    let ShiningLight { light, intensity } = shining;
    let offset = light.position - point.shadow_position;
    let to_light = offset.normalize_or_zero();
    let cos_point = point.normal.dot(to_light);
    let cos_light = light.evenness - light.normal.dot(to_light);
    let halfway = (point.to_viewer + to_light).normalize_or_zero();
    let cos = point.normal.dot(halfway);
    let shininess = point.shininess.max(0.0);
    // The logarithm of the faintest cosine, by its series: no root for each pair.
    let is_faint = shininess * (1.0 - cos) > -FAINT.ln();
    if cos_point <= 0.0 || cos_light <= 0.0 || is_faint || point.specular == Vec3::ZERO {
        return Vec3::ZERO;
    }
    let squared = offset.length_squared();
    let geometry = cos_point * cos_light / squared;
    let kept = if geometry > bound { bound / geometry } else { 1.0 };
    let strength = cos.max(0.0).powf(shininess) * cos_light * kept * FRAC_1_PI / squared;
    point.specular * *intensity * strength
}
