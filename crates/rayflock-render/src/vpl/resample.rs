//! Second stage, with few shadow rays: some lights are chosen for each point and stand for all.
//!
//! Which ones, is a matter of chance, and of what is known before any ray is traced: what each
//! light would send if nothing were in the way, times what is guessed of its visibility. A ray to
//! each chosen light corrects the guess; so the mean over many samples is exactly what a ray to
//! every light would give, however bad the guess is.
//!
//! - `Weight`: lights are chosen in proportion to that product; what a ray finds is divided by it
//!   (importance resampling).
//! - `Difference`: the guess is added up over all lights, and rays sample what is wrong with it (a
//!   control variate).
//! - `Uniform`: all lights alike, to compare with.
//!
//! **Source**: L. Szecsi, thesis, ch. 5, for approximate visibility as an estimate made beforehand;
//! J. Talbot, D. Cline, P. Egbert, *Importance Resampling for Global Illumination*, EGSR 2005; for
//! control variates, J. H. Halton, *A Retrospective and Prospective Survey of the Monte Carlo
//! Method*, SIAM Review 12(1), 1970.
//!
//! **Departures**: every light is a candidate, so that choosing is exact; the numbers that choose
//! are evenly spaced from one random start, so that a bright light is chosen about as often as it
//! should be. Lights are weighed at sixteen points at once, by
//! [`light_blocks`](super::light_blocks).
//!
//! **Cost**: some passes over all pairs of points and lights, and `count` rays a point; eight bytes
//! for each pair of 128 points and all lights, at least.

use glam::Vec3;
use rayflock_geom::simd::{LANES, Lanes, SimdLevel, dispatch};
use rayon::prelude::*;
use tracing::debug_span;

use super::gather::{
    GatherBuffers, GatherStats, LOT, Lot, TILE_PAIRS, add, arrived, collect_points, face, lots_of,
};
use super::light_blocks::{BlockMaterials, LitBlock};
use super::light_ways::NearLight;
use super::sphere_visibility::DISTANCE;
use super::{ChosenBy, ChosenRays, PairTile, PairVisibility, VirtualLights};
use crate::wave::{LitPoint, ShadedRun};

/// A light that is guessed to be hidden is chosen as if this share of it were seen, so that no
/// guess can keep light away. The variance is least with the root of how likely the guess is
/// wrong: here one in ten.
const LEAST_GUESS: f32 = 0.3;

/// What points see of lights: guessed, and by rays.
pub(crate) struct Eyes<'a> {
    /// Is asked about every pair.
    pub(crate) guess: &'a mut dyn PairVisibility,
    /// Is asked about few.
    pub(crate) exact: &'a mut dyn PairVisibility,
}

/// Gathers as [`gather`](super::gather::gather) does in the mean, with `chosen.count` rays a
/// point; `sample_idx` counts the samples of a pixel.
pub(crate) fn gather_chosen(
    lights: &VirtualLights,
    bound: f32,
    (chosen, sample_idx): (ChosenRays, u32),
    eyes: &mut Eyes<'_>,
    runs: &mut [ShadedRun],
    buffers: &mut GatherBuffers,
) -> GatherStats {
    let _span = debug_span!("gather_chosen").entered();
    let mut lots = lots_of(runs);
    let mut stats = GatherStats::default();
    let tile_lots = (TILE_PAIRS / LOT / lights.len().max(1)).max(1);
    for lots in lots.chunks_mut(tile_lots) {
        let GatherBuffers { points, normals, shares, guides } = &mut *buffers;
        collect_points(lots, points, normals);
        let tile = PairTile { points, normals, lights, range: 0..lights.len() };
        if tile.is_empty() {
            continue;
        }
        face(&tile, lots, guides);
        if chosen.by != ChosenBy::Uniform {
            stats.visibility += eyes.guess.multiply(&tile, guides);
        }
        choose(&tile, bound, (chosen, sample_idx), lots, guides, shares);

        // What the guess has, less what the rays will tell of it.
        if chosen.by == ChosenBy::Difference {
            for (guide, share) in guides.iter_mut().zip(&*shares) {
                *guide *= 1.0 - share;
            }
            stats.lost += add(lights, &tile.range, bound, lots, guides);
        }
        stats.visibility += eyes.exact.multiply(&tile, shares);
        stats.lost += add(lights, &tile.range, bound, lots, shares);
    }
    stats.gathered = arrived(&lots);
    stats
}

/// Makes `shares` the inverse of how likely each pair was chosen, over the number of rays, and 0
/// where it was not.
fn choose(
    tile: &PairTile<'_>,
    bound: f32,
    (chosen, sample_idx): (ChosenRays, u32),
    lots: &[Lot<'_>],
    guides: &[f32],
    shares: &mut Vec<f32>,
) {
    shares.clear();
    shares.resize(tile.len(), 0.0);
    let first_point = lots.first().map_or(0, |lot| lot.first_point);
    let of_lots = lots.par_iter().map_init(Weights::default, |weights, lot| {
        let mut pairs = Vec::new();
        if chosen.by != ChosenBy::Uniform {
            weights.place_lights(tile.lights, lot);
        }
        for (points, block_idx) in lot.points.chunks(LANES).zip(0..) {
            let first_column = lot.first_point - first_point + LANES * block_idx;
            weights.weigh(tile, bound, chosen.by, points, &guides[first_column..]);
            weights.sum_up();
            for (lane, point) in points.iter().enumerate() {
                let [random, ..] = point.seed.unit_4_cube(sample_idx, CHOICE_SET);
                weights.systematic(lane, chosen.count, random, |light_idx, share| {
                    pairs.push((light_idx * tile.points.len() + first_column + lane, share));
                });
            }
        }
        pairs
    });
    for (pair_idx, share) in of_lots.collect::<Vec<_>>().into_iter().flatten() {
        shares[pair_idx] += share;
    }
}

/// Which numbers of a path choose among lights.
const CHOICE_SET: u32 = 63;

/// How much each light weighs at each of sixteen points; working memory of a thread.
#[derive(Debug, Default)]
struct Weights {
    lights: Vec<NearLight>,
    /// A row a light.
    rows: Vec<Lanes>,
    /// Sums of the rows up to and including each.
    sums: Vec<Lanes>,
}

impl Weights {
    /// Brings distant lights to where they are seen from a lot.
    fn place_lights(&mut self, lights: &VirtualLights, lot: &Lot<'_>) {
        let center = lot.points.first().map_or(Vec3::ZERO, |point| point.shadow_position);
        let place = (center, DISTANCE * lights.reach());
        self.lights.clear();
        self.lights.extend((0..lights.len()).map(|idx| NearLight::new(lights, idx, place)));
    }

    /// Weighs all lights at up to sixteen points; `guides` are those of the first light, from the
    /// first of the points on, and those of the others behind them.
    fn weigh(
        &mut self,
        tile: &PairTile<'_>,
        bound: f32,
        by: ChosenBy,
        points: &[LitPoint],
        guides: &[f32],
    ) {
        self.rows.clear();
        self.rows.resize(tile.range.len(), [1.0; LANES]);
        if by == ChosenBy::Uniform {
            return;
        }
        let (block, materials) = (LitBlock::new(points.iter()), BlockMaterials::new(points.iter()));
        let near_count = tile.lights.distant().start;
        let (near, distant) = self.lights.split_at(near_count);
        let (near_rows, distant_rows) = self.rows.split_at_mut(near_count);
        dispatch!(SimdLevel::best().level(), simd => {
            block.weigh(simd, &materials, near, bound, near_rows);
            block.weigh(simd, &materials, distant, f32::INFINITY, distant_rows);
        });
        if by == ChosenBy::Weight {
            for (row, guides) in self.rows.iter_mut().zip(guides.chunks(tile.points.len())) {
                for (weight, guide) in row.iter_mut().zip(&guides[..points.len()]) {
                    *weight *= guide.max(LEAST_GUESS);
                }
            }
        }
    }

    /// Sums weights up; what is not finite counts as 0.
    fn sum_up(&mut self) {
        let mut sum = [0.0; LANES];
        self.sums.clear();
        self.sums.extend(self.rows.iter_mut().map(|row| {
            for (sum, weight) in sum.iter_mut().zip(row) {
                *weight = if weight.is_finite() { weight.max(0.0) } else { 0.0 };
                *sum += *weight;
            }
            sum
        }));
    }

    /// Chooses `count` times for the point of a lane, evenly spaced from `random` in `0..1`, and
    /// tells what each choice stands for.
    fn systematic(&self, lane: usize, count: u32, random: f32, mut tell: impl FnMut(usize, f32)) {
        let total = self.sums.last().map_or(0.0, |sums| sums[lane]);
        if total <= 0.0 || !total.is_finite() {
            return;
        }
        for place in 0..count {
            let wanted = (place as f32 + random) / count as f32 * total;
            // Rounding must choose neither none nor one without weight.
            let found = self.sums.partition_point(|sums| sums[lane] <= wanted);
            let last = self.sums.partition_point(|sums| sums[lane] < total);
            let idx = found.min(last);
            tell(idx, total / (self.rows[idx][lane] * count as f32));
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::super::{VirtualLight, VisibilityStats};
    use super::*;
    use crate::shading::sampling::PathSeed;
    use crate::wave::LitPoint;

    const SAMPLES: u32 = 2048;

    /// Hides some lights; which ones, depends on the number of the light alone.
    #[derive(Debug)]
    struct Hidden(fn(usize) -> bool);

    impl PairVisibility for Hidden {
        fn multiply(&mut self, tile: &PairTile<'_>, shares: &mut [f32]) -> VisibilityStats {
            for (row, shares) in shares.chunks_mut(tile.points.len()).enumerate() {
                if (self.0)(tile.range.start + row) {
                    shares.fill(0.0);
                }
            }
            VisibilityStats::default()
        }
    }

    const TRUTH: Hidden = Hidden(|light_idx| light_idx % 3 == 0);
    /// Wrong about one light in seven.
    const GUESS: Hidden = Hidden(|light_idx| (light_idx % 3 == 0) != (light_idx % 7 == 0));
    const NOTHING: Hidden = Hidden(|_| false);

    fn lights() -> VirtualLights {
        let mut lights = VirtualLights::default();
        let place = |i: u16| {
            let [x, y, z, brightness] = PathSeed::of_walks(7).unit_4_cube(u32::from(i), 0);
            let position = Vec3::new(4.0 * x - 2.0, 0.5 + y, 4.0 * z - 2.0);
            VirtualLight::matte(position, Vec3::NEG_Y, Vec3::splat(brightness * brightness))
        };
        let plain: Vec<VirtualLight> = (0..300).map(place).collect();
        lights.assign(10.0, &plain, &[], &[]);
        lights
    }

    fn run() -> ShadedRun {
        let point = LitPoint {
            shadow_position: Vec3::ZERO,
            normal: Vec3::Y,
            to_viewer: Vec3::Y,
            diffuse: Vec3::ONE,
            specular: Vec3::ZERO,
            shininess: 1.0,
            pixel_idx: 0,
            seed: PathSeed::of_pixel(3, 4),
        };
        ShadedRun { points: vec![point; 3], ..ShadedRun::default() }
    }

    /// Mean and variance of the radiance of one point over many samples.
    fn estimate(by: ChosenBy, mut guess: Hidden, mut exact: Hidden) -> (f64, f64) {
        let (lights, mut runs, mut buffers) = (lights(), [run()], GatherBuffers::default());
        let chosen = ChosenRays { count: 8, by };
        let values: Vec<f64> = (0..SAMPLES)
            .map(|sample_idx| {
                let mut eyes = Eyes { guess: &mut guess, exact: &mut exact };
                let chosen = (chosen, sample_idx);
                gather_chosen(&lights, 4.0, chosen, &mut eyes, &mut runs, &mut buffers);
                f64::from(runs[0].lit[1].radiance.x)
            })
            .collect();
        let mean = values.iter().sum::<f64>() / f64::from(SAMPLES);
        let squares = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>();
        (mean, squares / f64::from(SAMPLES - 1))
    }

    fn sum_over_all_lights() -> f64 {
        let (mut runs, mut buffers) = ([run()], GatherBuffers::default());
        super::super::gather::gather(&lights(), 4.0, &mut { TRUTH }, &mut runs, &mut buffers);
        f64::from(runs[0].lit[1].radiance.x)
    }

    /// How many standard errors a mean is away from the sum over all lights.
    fn deviations((mean, variance): (f64, f64)) -> f64 {
        (mean - sum_over_all_lights()).abs() / (variance / f64::from(SAMPLES)).sqrt()
    }

    #[test]
    fn the_mean_is_the_sum_over_all_lights_however_wrong_the_guess() {
        for by in [ChosenBy::Uniform, ChosenBy::Weight, ChosenBy::Difference] {
            for guess in [GUESS, NOTHING, Hidden(|_| true)] {
                let found = deviations(estimate(by, guess, TRUTH));
                assert!(found < 4.0, "{by:?}: {found} standard errors away");
            }
        }
    }

    #[test]
    fn without_the_ray_that_corrects_it_the_mean_is_wrong() {
        for by in [ChosenBy::Uniform, ChosenBy::Weight, ChosenBy::Difference] {
            let found = deviations(estimate(by, GUESS, NOTHING));
            assert!(found > 10.0, "{by:?}: only {found} standard errors away");
        }
    }

    #[test]
    fn a_guess_takes_most_of_the_variance_away() {
        let (_, uniform) = estimate(ChosenBy::Uniform, NOTHING, TRUTH);
        for by in [ChosenBy::Weight, ChosenBy::Difference] {
            let (_, guided) = estimate(by, GUESS, TRUTH);
            assert!(guided < 0.25 * uniform, "{by:?}: {guided} instead of {uniform}");
        }
        let (_, unguided) = estimate(ChosenBy::Weight, NOTHING, TRUTH);
        let (_, guided) = estimate(ChosenBy::Weight, TRUTH, TRUTH);
        assert!(guided < unguided, "{guided} with a right guess, {unguided} without");
    }
}
