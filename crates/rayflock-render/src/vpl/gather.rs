//! Second stage: every lit point sums what virtual lights send it.
//!
//! Points are those of a whole wave, behind mirrors and glass included. Lights are taken a tile at
//! a time, so that the pairs of a tile fit a bounded buffer: which pairs face each other is found
//! first, then visibility is asked about all of them at once, then light is added up.
//!
//! **The bound.** Between a point and a light close to it, the geometry term (both cosines over the
//! squared distance) grows beyond all bounds, and the light shows as a bright spot. So the term is
//! cut off at a bound; what that loses is added up and told.
//!
//! **Source**: A. Keller, *Instant Radiosity*, SIGGRAPH 1997; for the bound, T. Kollig and A. Keller,
//! *Illumination in the Presence of Weak Singularities*, MCQMC 2004.
//!
//! **Invariants**: a point's sum is taken in the order of the lights, whatever the tiles and the
//! number of threads.
//!
//! **Cost**: 4 bytes a pair of a tile; two passes over all pairs of points and lights, besides
//! visibility.

use std::f32::consts::FRAC_1_PI;
use std::ops::Range;

use glam::Vec3;
use rayon::prelude::*;
use tracing::debug_span;

use super::{PairTile, PairVisibility, VirtualLight, VirtualLights, VisibilityStats};
use crate::shading::scatter::reflected;
use crate::wave::{Contribution, LitPoint, ShadedRun};

/// Pairs of a tile, unless a single light has more.
pub(super) const TILE_PAIRS: usize = 1 << 21;
/// Points of a lot.
pub(super) const LOT: usize = 128;

/// What gathering found.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct GatherStats {
    /// What visibility took.
    pub(crate) visibility: VisibilityStats,
    /// Radiance that arrived at pixels, summed.
    pub(crate) gathered: f64,
    /// Radiance that the bound kept away, summed.
    pub(crate) lost: f64,
}

/// Working memory, kept from wave to wave.
#[derive(Debug, Default)]
pub(crate) struct GatherBuffers {
    pub(super) points: Vec<Vec3>,
    pub(super) normals: Vec<Vec3>,
    pub(super) shares: Vec<f32>,
    /// A second share of each pair, where few rays stand for all.
    pub(super) guides: Vec<f32>,
}

/// Neighbouring points that one task adds to, and what has arrived at each.
#[derive(Debug)]
pub(super) struct Lot<'a> {
    /// How many points there are in the lots before.
    pub(super) first_point: usize,
    pub(super) points: &'a [LitPoint],
    pub(super) lit: &'a mut [Contribution],
}

/// Gathers the light of `lights` at all points of `runs`, with geometry terms up to `bound`; what
/// arrives is left as `lit` of each run, one entry a point.
pub(crate) fn gather(
    lights: &VirtualLights,
    bound: f32,
    visibility: &mut dyn PairVisibility,
    runs: &mut [ShadedRun],
    buffers: &mut GatherBuffers,
) -> GatherStats {
    let _span = debug_span!("gather").entered();
    let mut lots = lots_of(runs);
    let GatherBuffers { points, normals, shares, .. } = buffers;
    collect_points(&lots, points, normals);
    let mut stats = GatherStats::default();
    let tile_lights = (TILE_PAIRS / points.len().max(1)).clamp(1, lights.len().max(1));
    for start in (0..lights.len()).step_by(tile_lights) {
        let range = start..(start + tile_lights).min(lights.len());
        let tile = PairTile { points, normals, lights, range: range.clone() };
        face(&tile, &lots, shares);
        if !shares.is_empty() {
            stats.visibility += visibility.multiply(&tile, shares);
            stats.lost += add(lights, &range, bound, &mut lots, shares);
        }
    }
    stats.gathered = arrived(&lots);
    stats
}

/// All points of `runs`, nothing arrived yet.
pub(super) fn lots_of(runs: &mut [ShadedRun]) -> Vec<Lot<'_>> {
    let mut point_count = 0;
    let mut lots = Vec::new();
    for ShadedRun { points, lit, .. } in runs {
        lit.clear();
        lit.extend(
            points
                .iter()
                .map(|point| Contribution { pixel_idx: point.pixel_idx, radiance: Vec3::ZERO }),
        );
        for (points, lit) in points.chunks(LOT).zip(lit.chunks_mut(LOT)) {
            lots.push(Lot { first_point: point_count, points, lit });
            point_count += points.len();
        }
    }
    lots
}

/// Makes `points` the places of all points of `lots`, and `normals` their normals.
pub(super) fn collect_points(lots: &[Lot<'_>], points: &mut Vec<Vec3>, normals: &mut Vec<Vec3>) {
    normals.clear();
    normals.extend(lots.iter().flat_map(|lot| lot.points).map(|point| point.normal));
    points.clear();
    points.extend(lots.iter().flat_map(|lot| lot.points).map(|point| point.shadow_position));
}

/// The sum of all that has arrived.
pub(super) fn arrived(lots: &[Lot<'_>]) -> f64 {
    let radiances = lots.iter().flat_map(|lot| &*lot.lit).map(|lit| lit.radiance.element_sum());
    radiances.map(f64::from).filter(|sum| sum.is_finite()).sum()
}

/// Makes the shares of the pairs of `tile`, whose points are those of `lots`, 1 where the two face
/// each other and 0 elsewhere.
pub(super) fn face(tile: &PairTile<'_>, lots: &[Lot<'_>], shares: &mut Vec<f32>) {
    shares.clear();
    shares.resize(tile.len(), 0.0);
    let rows = shares.par_chunks_mut(tile.points.len().max(1)).enumerate();
    rows.for_each(|(row, shares)| {
        let light_idx = tile.range.start + row;
        let (light, is_distant) = (tile.lights.get(light_idx), tile.lights.is_distant(light_idx));
        let points = lots.iter().flat_map(|lot| lot.points);
        for (share, point) in shares.iter_mut().zip(points) {
            *share = if faces(&light, is_distant, point) { 1.0 } else { 0.0 };
        }
    });
}

/// Whether light of `light` can reach `point` from above both their surfaces.
#[inline]
fn faces(light: &VirtualLight, is_distant: bool, point: &LitPoint) -> bool {
    if is_distant {
        return point.normal.dot(light.position) > 0.0;
    }
    let offset = light.position - point.shadow_position;
    point.normal.dot(offset) > 0.0 && (light.evenness > 0.0 || light.normal.dot(offset) < 0.0)
}

/// Adds the light of a tile to its points; returns what the bound kept away.
pub(super) fn add(
    lights: &VirtualLights,
    range: &Range<usize>,
    bound: f32,
    lots: &mut [Lot<'_>],
    shares: &[f32],
) -> f64 {
    let point_count = shares.len() / range.len().max(1);
    let first_of_tile = lots.first().map_or(0, |lot| lot.first_point);
    let lost = lots.par_iter_mut().map(|Lot { first_point, points, lit }| {
        let mut lost = 0.0;
        for (row, light_idx) in range.clone().enumerate() {
            let first_pair = row * point_count + *first_point - first_of_tile;
            let shares = &shares[first_pair..][..points.len()];
            for ((point, lit), share) in points.iter().zip(&mut **lit).zip(shares) {
                if *share != 0.0 {
                    let (radiance, beyond) = arriving(lights, light_idx, point, bound);
                    lit.radiance += *share * radiance;
                    lost += f64::from(*share * beyond);
                }
            }
        }
        lost
    });
    // In order, so that the sum is the same with any number of threads.
    lost.collect::<Vec<f64>>().into_iter().sum()
}

/// What light `light_idx`, if nothing is in the way, adds to the radiance of `point`, and the sum
/// of the colours that the bound keeps away.
pub(super) fn arriving(
    lights: &VirtualLights,
    light_idx: usize,
    point: &LitPoint,
    bound: f32,
) -> (Vec3, f32) {
    if point.specular == Vec3::ZERO && lights.plain().contains(&light_idx) {
        return arriving_matte(&lights.get(light_idx), point, bound);
    }
    let pair = Pair::new(lights, light_idx, point);
    let LitPoint { diffuse, specular, shininess, normal, to_viewer, .. } = *point;
    let sent_back = reflected(diffuse, specular, shininess, normal, to_viewer, pair.to_light);
    if lights.is_distant(light_idx) {
        return (sent_back * lights.intensities()[light_idx], 0.0);
    }
    let intensity = lights.intensity_toward(light_idx, -pair.to_light);
    let unbounded = sent_back * intensity * pair.inverse_square;
    let geometry = pair.geometry();
    if geometry <= bound {
        return (unbounded, 0.0);
    }
    let radiance = unbounded * (bound / geometry);
    (radiance, (unbounded - radiance).element_sum())
}

/// The same for what most pairs are: a plain light and a matte point. No root is taken where the
/// light has a normal.
#[inline]
fn arriving_matte(light: &VirtualLight, point: &LitPoint, bound: f32) -> (Vec3, f32) {
    let offset = light.position - point.shadow_position;
    let squared = offset.length_squared();
    let mut along = -light.normal.dot(offset);
    if light.evenness > 0.0 {
        along += light.evenness * squared.sqrt();
    }
    let geometry = point.normal.dot(offset).max(0.0) * along.max(0.0) / (squared * squared);
    let sent_back = point.diffuse * light.intensity * FRAC_1_PI;
    let beyond = (geometry - bound).max(0.0) * sent_back.element_sum();
    (sent_back * geometry.min(bound), beyond)
}

/// A point and a light.
struct Pair {
    /// Of unit length.
    to_light: Vec3,
    /// 1 for distant lights.
    inverse_square: f32,
    cos_point: f32,
    cos_light: f32,
}

impl Pair {
    #[inline]
    fn new(lights: &VirtualLights, light_idx: usize, point: &LitPoint) -> Self {
        let light = lights.get(light_idx);
        let (to_light, inverse_square) = if lights.is_distant(light_idx) {
            (light.position, 1.0)
        } else {
            let offset = light.position - point.shadow_position;
            let inverse_square = offset.length_squared().recip();
            (offset * inverse_square.sqrt(), inverse_square)
        };
        Self {
            to_light,
            inverse_square,
            cos_point: point.normal.dot(to_light).max(0.0),
            cos_light: (light.evenness - light.normal.dot(to_light)).max(0.0),
        }
    }

    /// The geometry term; not positive where the two do not face each other, or are one.
    #[inline]
    fn geometry(&self) -> f32 {
        let geometry = self.cos_point * self.cos_light * self.inverse_square;
        if geometry.is_finite() { geometry } else { 0.0 }
    }
}

impl GatherBuffers {
    /// Bytes held.
    pub(crate) fn memory_usage(&self) -> usize {
        (self.points.capacity() + self.normals.capacity()) * size_of::<Vec3>()
            + (self.shares.capacity() + self.guides.capacity()) * size_of::<f32>()
    }
}
