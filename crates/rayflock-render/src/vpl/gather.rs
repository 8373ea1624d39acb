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

use std::ops::Range;

use glam::Vec3;
use rayon::prelude::*;
use tracing::debug_span;

use super::{PairTile, PairVisibility, VirtualLights, VisibilityStats};
use crate::shading::scatter::reflected;
use crate::wave::{Contribution, LitPoint, ShadedRun};

/// Pairs of a tile.
const TILE_PAIRS: usize = 1 << 21;

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
    points: Vec<Vec3>,
    shares: Vec<f32>,
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
    let GatherBuffers { points, shares } = buffers;
    points.clear();
    for run in &mut *runs {
        points.extend(run.points.iter().map(|point| point.shadow_position));
        run.lit.clear();
        run.lit.extend(
            run.points
                .iter()
                .map(|point| Contribution { pixel_idx: point.pixel_idx, radiance: Vec3::ZERO }),
        );
    }
    let mut stats = GatherStats::default();
    if points.is_empty() {
        return stats;
    }
    let tile_lights = (TILE_PAIRS / points.len()).clamp(1, lights.len().max(1));
    for start in (0..lights.len()).step_by(tile_lights) {
        let range = start..(start + tile_lights).min(lights.len());
        let tile = PairTile { points, lights, range: range.clone() };
        shares.clear();
        shares.resize(tile.len(), 0.0);
        face(lights, range.start, runs, points.len(), shares);
        stats.visibility += visibility.multiply(&tile, shares);
        stats.lost += add(lights, &range, bound, runs, points.len(), shares);
    }
    let radiances = runs.iter().flat_map(|run| &run.lit).map(|lit| lit.radiance.element_sum());
    stats.gathered = radiances.map(f64::from).filter(|sum| sum.is_finite()).sum();
    stats
}

/// Sets the shares of the pairs that face each other to 1.
fn face(
    lights: &VirtualLights,
    first_light: usize,
    runs: &[ShadedRun],
    point_count: usize,
    shares: &mut [f32],
) {
    shares.par_chunks_mut(point_count).enumerate().for_each(|(row, shares)| {
        let light_idx = first_light + row;
        let points = runs.iter().flat_map(|run| &run.points);
        for (share, point) in shares.iter_mut().zip(points) {
            let pair = Pair::new(lights, light_idx, point);
            *share = if pair.geometry() > 0.0 { 1.0 } else { 0.0 };
        }
    });
}

/// Adds the light of a tile to its points; returns what the bound kept away.
fn add(
    lights: &VirtualLights,
    range: &Range<usize>,
    bound: f32,
    runs: &mut [ShadedRun],
    point_count: usize,
    shares: &[f32],
) -> f64 {
    let mut first = 0;
    let offsets = runs.iter().map(|run| {
        first += run.points.len();
        first - run.points.len()
    });
    let offsets: Vec<usize> = offsets.collect();
    let lost = runs.par_iter_mut().zip(offsets).map(|(run, offset)| {
        let mut lost = 0.0;
        let ShadedRun { points, lit, .. } = run;
        for (row, light_idx) in range.clone().enumerate() {
            let shares = &shares[row * point_count + offset..][..points.len()];
            for ((point, lit), share) in points.iter().zip(&mut *lit).zip(shares) {
                if *share > 0.0 {
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
        self.points.capacity() * size_of::<Vec3>() + self.shares.capacity() * size_of::<f32>()
    }
}
