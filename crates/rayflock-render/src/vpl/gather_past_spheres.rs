//! Gathering with approximate visibility: tiles of points against spheres that stand for geometry.
//!
//! No pair is written down. Points of a run are taken a tile at a time, lights a group at a time;
//! sixteen points at once, what a light sends and what spheres let through are multiplied and added
//! up. Highlights of points and lights come on top where they are bright enough to be seen; lights
//! under varnish are added pair by pair.
//!
//! **Source**: see [`occluders`](crate::occluders).
//!
//! **Departures** from [`gather`](super::gather): lights are added in an order that keeps neighbours
//! together, a highlight below [`FAINT`] of its strength is left out, and distant lights are only
//! very far away.
//!
//! **Invariants**: the picture does not depend on the number of threads.

use std::f32::consts::FRAC_1_PI;

use glam::Vec3;
use rayflock_geom::simd::{LANES, Lanes};
use rayon::prelude::*;
use tracing::debug_span;

use super::gather::{GatherStats, arriving};
use super::sphere_visibility::DISTANCE;
use super::{Lobe, VirtualLight, VirtualLights, VisibilityStats};
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

/// Lights in an order in which neighbours are close, or alike in direction.
#[derive(Debug, Default)]
pub(crate) struct GroupedLights {
    /// What matte surfaces and points send.
    matte: Vec<ShiningLight>,
    /// The highlight of each, if it has one.
    lobes: Vec<Option<Lobe>>,
    /// Unit directions to distant lights, and irradiances.
    distant: Vec<(Vec3, Vec3)>,
    /// Places of the others.
    others: Vec<usize>,
}

impl GroupedLights {
    /// Makes these the groups of `lights`.
    pub(crate) fn assign(&mut self, lights: &VirtualLights) {
        self.matte.clear();
        self.lobes.clear();
        self.distant.clear();
        self.others.clear();
        let near = 0..lights.distant().start;
        for light_idx in nearby_order(&lights.positions()[near]) {
            let lobe = lights.lobe(light_idx).copied();
            if lobe.is_some_and(|lobe| lobe.varnish != 0.0) {
                self.others.push(light_idx);
                continue;
            }
            let VirtualLight { position, normal, evenness, intensity } = lights.get(light_idx);
            let light = MatteLight { position, normal, evenness };
            self.matte.push(ShiningLight { light, intensity });
            self.lobes.push(lobe);
        }
        let distant = lights.distant();
        self.distant.extend(nearby_order(&lights.positions()[distant.clone()]).into_iter().map(
            |idx| {
                let light_idx = distant.start + idx;
                (lights.positions()[light_idx], lights.intensities()[light_idx])
            },
        ));
    }

    /// Bytes held.
    pub(crate) fn memory_usage(&self) -> usize {
        self.matte.capacity() * size_of::<ShiningLight>()
            + self.lobes.capacity() * size_of::<Option<Lobe>>()
            + self.distant.capacity() * size_of::<(Vec3, Vec3)>()
            + self.others.capacity() * size_of::<usize>()
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
    /// Distant lights as the tile sees them.
    placed: Vec<ShiningLight>,
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
        workspace.begin(points);
        let tests_before = workspace.sight.tests();
        let matte = self.grouped.matte.chunks(GROUP_LIGHTS);
        for (group, lobes) in matte.zip(self.grouped.lobes.chunks(GROUP_LIGHTS)) {
            self.gather_group(points, (group, lobes), self.bound, workspace);
        }
        for distant in self.grouped.distant.chunks(GROUP_LIGHTS) {
            let mut placed = std::mem::take(&mut workspace.placed);
            let (center, distance) = (workspace.tile.center(), DISTANCE * self.lights.reach());
            placed.clear();
            placed.extend(distant.iter().map(|&(to_light, irradiance)| ShiningLight {
                light: MatteLight {
                    position: center + distance * to_light,
                    normal: Vec3::ZERO,
                    evenness: 1.0,
                },
                intensity: irradiance * (distance * distance),
            }));
            self.gather_group(points, (&placed, &[]), f32::INFINITY, workspace);
            workspace.placed = placed;
        }
        let mut lost = self.gather_others(points, workspace);

        let Workspace { sums, highlights, sight, .. } = workspace;
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

    /// Gathers from lights that are close to each other; `lobes` are their highlights, or none.
    fn gather_group(
        &self,
        points: &[LitPoint],
        (group, lobes): (&[ShiningLight], &[Option<Lobe>]),
        bound: f32,
        workspace: &mut Workspace,
    ) {
        let Workspace { tile, sight, sums, highlights, .. } = workspace;
        let has_highlights = points.iter().any(|point| point.specular != Vec3::ZERO)
            || lobes.iter().any(Option::is_some);
        if !has_highlights {
            return sight.gather(self.tree, tile, group, bound, sums, |_, _, _| {});
        }
        sight.gather(self.tree, tile, group, bound, sums, |light_idx, block_idx, through| {
            let (light, lobe) = (&group[light_idx], lobes.get(light_idx).copied().flatten());
            let first = LANES * block_idx;
            let lanes = points[first..].iter().zip(&mut highlights[first..]).zip(through);
            for ((point, sum), through) in lanes {
                if *through > 0.0 && (lobe.is_some() || point.specular != Vec3::ZERO) {
                    *sum += *through * shine(point, light, lobe.as_ref(), bound);
                }
            }
        });
    }

    /// Gathers from lights under varnish; returns what the bound kept away.
    fn gather_others(&self, points: &[LitPoint], workspace: &mut Workspace) -> f64 {
        let Workspace { tile, sight, highlights, .. } = workspace;
        let mut lost = 0.0;
        for &light_idx in &self.grouped.others {
            let VirtualLight { position, normal, .. } = self.lights.get(light_idx);
            let light = SeenLight { position, normal };
            sight.see(self.tree, tile, &[light], |_, block_idx, through| {
                let first = LANES * block_idx;
                let lanes = points[first..].iter().zip(&mut highlights[first..]).zip(through);
                for ((point, sum), through) in lanes.filter(|(_, through)| **through > 0.0) {
                    let (radiance, beyond) = arriving(self.lights, light_idx, point, self.bound);
                    if radiance.is_finite() {
                        *sum += *through * radiance;
                        lost += f64::from(*through * beyond);
                    }
                }
            });
        }
        lost
    }
}

impl Workspace {
    /// Makes the tile that of `points`, with nothing gathered yet.
    fn begin(&mut self, points: &[LitPoint]) {
        self.positions.clear();
        self.normals.clear();
        self.positions.extend(points.iter().map(|point| point.shadow_position));
        self.normals.extend(points.iter().map(|point| point.normal));
        self.tile.assign(&self.positions, &self.normals);
        self.sums.clear();
        self.sums.resize(points.len().div_ceil(LANES), IrradianceBlock::default());
        self.highlights.clear();
        self.highlights.resize(points.len(), Vec3::ZERO);
    }
}

/// What highlights of a point and of a light add to what both send evenly.
fn shine(point: &LitPoint, shining: &ShiningLight, lobe: Option<&Lobe>, bound: f32) -> Vec3 {
    let ShiningLight { light, intensity } = shining;
    let offset = light.position - point.shadow_position;
    let to_light = offset.normalize_or_zero();
    let cos_point = point.normal.dot(to_light);
    let cos_light = light.evenness - light.normal.dot(to_light);
    if cos_point <= 0.0 || cos_light <= 0.0 {
        return Vec3::ZERO;
    }
    let of_point = match point.specular == Vec3::ZERO {
        true => 0.0,
        false => highlight(point.normal, point.to_viewer, to_light, point.shininess),
    };
    let of_light = match lobe {
        None => Vec3::ZERO,
        Some(lobe) => {
            lobe.highlight * highlight(light.normal, lobe.to_source, -to_light, lobe.shininess)
        }
    };
    if of_point == 0.0 && of_light == Vec3::ZERO {
        return Vec3::ZERO;
    }
    // (diffuse cos + specular) (intensity + highlight) without diffuse cos intensity.
    let squared = offset.length_squared();
    let specular = point.specular * of_point;
    let sent_back = specular * (*intensity + of_light) + point.diffuse * cos_point * of_light;
    let geometry = cos_point * cos_light / squared;
    let kept = if geometry > bound { bound / geometry } else { 1.0 };
    sent_back * (cos_light * kept * FRAC_1_PI / squared)
}

/// The strength of a highlight between two directions; 0 where it is faint.
fn highlight(normal: Vec3, to_one: Vec3, to_other: Vec3, shininess: f32) -> f32 {
    let cos = normal.dot((to_one + to_other).normalize_or_zero());
    // At least minus the logarithm of the cosine's power.
    let is_faint = shininess * (1.0 - cos) > -FAINT.ln();
    if is_faint { 0.0 } else { cos.max(0.0).powf(shininess.max(0.0)) }
}
