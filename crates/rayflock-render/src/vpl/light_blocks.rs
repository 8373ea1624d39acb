//! What a group of near lights adds to blocks of sixteen points.
//!
//! ```text
//!   even light:   diffuse  * cos(point) cos(light) / distance^2 * intensity
//!   highlights:   specular * power      cos(light) / distance^2 * intensity
//! ```
//!
//! A light's own highlight and varnish make its intensity one of each point. The sums of both rows
//! stay in registers from light to light; what the material of a point makes of them is done once,
//! by the caller.
//!
//! **Departures** from [`gather`](super::gather): a highlight below a 512th of its strength is left
//! out.
//!
//! **Invariants.** Without fused multiply-add: the same bits at every level.
//!
//! **Cost.** For sixteen points and a light, about 35 operations and a division; 70 more, with two
//! roots and two divisions, where points have highlights; half of these are left out where all are
//! faint.

use glam::Vec3;
use rayflock_geom::simd::segment_spheres::PointBlock;
use rayflock_geom::simd::{LANES, Lanes, Select, Simd, SimdBase, SimdMask, f32x16};

use super::light_ways::{FAINT, NearLight, Viewed, Way};
use crate::triple::{Triple, dot, load, splat, store};
use crate::wave::LitPoint;

/// Sixteen points, and what has come to them.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(super) struct LitBlock {
    points: PointBlock,
    to_viewer: [Lanes; 3],
    shininess: Lanes,
    /// Whether any point has a highlight.
    is_shiny: bool,
    sums: Sums,
    /// What the bound kept away.
    lost: Sums,
}

/// Light that came to sixteen points, by colour.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C, align(64))]
struct Sums {
    /// To be multiplied by what the points send back evenly.
    even: [Lanes; 3],
    /// To be multiplied by the strength of their highlights.
    shiny: [Lanes; 3],
}

/// What sixteen points send back, by colour.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C, align(64))]
pub(super) struct BlockMaterials {
    diffuse: [Lanes; 3],
    specular: [Lanes; 3],
}

impl BlockMaterials {
    /// Those of up to sixteen points; others send nothing back.
    pub(super) fn new<'a>(points: impl Iterator<Item = &'a LitPoint>) -> Self {
        let mut materials = Self::default();
        for (lane, point) in points.enumerate().take(LANES) {
            for axis in 0..3 {
                materials.diffuse[axis][lane] = point.diffuse[axis];
                materials.specular[axis][lane] = point.specular[axis];
            }
        }
        materials
    }
}

impl LitBlock {
    /// Sixteen points to which nothing has come yet.
    pub(super) fn new<'a>(points: impl Iterator<Item = &'a LitPoint>) -> Self {
        let mut block = Self {
            points: PointBlock::splat(Vec3::ZERO, Vec3::Y),
            to_viewer: [[0.0; LANES], [1.0; LANES], [0.0; LANES]],
            shininess: [0.0; LANES],
            is_shiny: false,
            sums: Sums::default(),
            lost: Sums::default(),
        };
        for (lane, point) in points.enumerate().take(LANES) {
            block.points.set(lane, point.shadow_position, point.normal);
            for (column, value) in block.to_viewer.iter_mut().zip(point.to_viewer.to_array()) {
                column[lane] = value;
            }
            block.shininess[lane] = point.shininess.max(0.0);
            block.is_shiny |= point.specular != Vec3::ZERO;
        }
        block
    }

    /// Position of the point of a lane.
    #[inline]
    pub(super) fn position(&self, lane: usize) -> Vec3 {
        Vec3::from(self.points.position.map(|column| column[lane]))
    }

    /// Which lanes face a light that faces them, the first as the lowest bit.
    #[inline(always)]
    pub(super) fn facing<S: Simd>(&self, simd: S, light: &NearLight) -> u32 {
        let zero = f32x16::splat(simd, 0.0);
        let end = splat(simd, light.position);
        let position = load(simd, &self.points.position);
        let offset = [end[0] - position[0], end[1] - position[1], end[2] - position[2]];
        let mut faces = dot(offset, load(simd, &self.points.normal)).simd_gt(zero);
        if light.evenness <= 0.0 {
            faces &= dot(offset, splat(simd, light.normal)).simd_lt(zero);
        }
        faces.to_bitmask() as u32
    }

    /// The radiance that `point`, which is that of a lane, sends back, and the sum of the colours
    /// of what the bound kept away.
    pub(super) fn radiance(&self, lane: usize, point: &LitPoint) -> (Vec3, f32) {
        let of = |columns: &[Lanes; 3]| Vec3::from(columns.map(|column| column[lane]));
        let sent = |sums: &Sums| point.diffuse * of(&sums.even) + point.specular * of(&sums.shiny);
        let scale = std::f32::consts::FRAC_1_PI;
        (scale * sent(&self.sums), scale * sent(&self.lost).element_sum())
    }

    /// Adds what comes of `lights`; of light i, `shares[i]` is seen. Geometry terms count up to
    /// `bound`.
    #[inline(always)]
    pub(super) fn add<'a, S: Simd>(
        &mut self,
        simd: S,
        lights: &[NearLight],
        shares: impl Iterator<Item = &'a Lanes>,
        bound: f32,
    ) {
        if self.is_shiny {
            self.add_lights::<S, true>(simd, lights, shares, bound);
        } else {
            self.add_lights::<S, false>(simd, lights, shares, bound);
        }
    }

    /// Makes `weights[i]` what each point sends back of light i if it is seen, times pi, the colours
    /// summed up, geometry terms counting up to `bound`; however faint, it is more than 0 where any
    /// light arrives. `weights.len() == lights.len()`.
    #[inline(always)]
    pub(super) fn weigh<S: Simd>(
        &self,
        simd: S,
        materials: &BlockMaterials,
        lights: &[NearLight],
        bound: f32,
        weights: &mut [Lanes],
    ) {
        if self.is_shiny {
            self.weigh_lights::<S, true>(simd, materials, lights, bound, weights);
        } else {
            self.weigh_lights::<S, false>(simd, materials, lights, bound, weights);
        }
    }

    /// The points in registers.
    #[inline(always)]
    fn viewed<S: Simd>(&self, simd: S) -> Viewed<S> {
        let normal = load(simd, &self.points.normal);
        let to_viewer = load(simd, &self.to_viewer);
        Viewed {
            position: load(simd, &self.points.position),
            normal,
            to_viewer,
            cos_viewer: dot(normal, to_viewer),
            shininess: f32x16::from_slice(simd, &self.shininess),
        }
    }

    #[inline(always)]
    fn weigh_lights<S: Simd, const SHINY: bool>(
        &self,
        simd: S,
        materials: &BlockMaterials,
        lights: &[NearLight],
        bound: f32,
        weights: &mut [Lanes],
    ) {
        let bound = f32x16::splat(simd, bound);
        let viewed = self.viewed(simd);
        let diffuse = load(simd, &materials.diffuse);
        let specular = load(simd, &materials.specular);
        for (light, weight) in lights.iter().zip(weights) {
            let way = Way::new::<SHINY>(simd, &viewed, light);
            let terms = way.at_point * way.at_light;
            let sent = way.sent(simd, light, f32::INFINITY);
            let mut sum = terms.min(bound) * dot(diffuse, sent);
            if SHINY && let Some(strength) = way.highlight(simd, &viewed, f32::INFINITY) {
                let all = strength * way.at_light;
                let kept = terms.simd_gt(bound).select(all * bound / terms, all);
                sum += kept * dot(specular, sent);
            }
            sum.store_slice(weight);
        }
    }

    #[inline(always)]
    fn add_lights<'a, S: Simd, const SHINY: bool>(
        &mut self,
        simd: S,
        lights: &[NearLight],
        shares: impl Iterator<Item = &'a Lanes>,
        bound: f32,
    ) {
        let splat = f32x16::splat;
        let (zero, bound) = (splat(simd, 0.0), splat(simd, bound));
        let viewed = self.viewed(simd);
        let mut even = load(simd, &self.sums.even);
        let mut shiny = load(simd, &self.sums.shiny);
        for (light, share) in lights.iter().zip(shares) {
            let way = Way::new::<SHINY>(simd, &viewed, light);
            let terms = way.at_point * way.at_light;
            let share = f32x16::from_slice(simd, share);
            let kept = terms.min(bound) * share;
            if !kept.simd_gt(zero).any_true() {
                continue;
            }
            let sent = way.sent(simd, light, FAINT);
            add(&mut even, kept, &sent);
            let (mut all, mut kept) = (zero, zero);
            if SHINY && let Some(strength) = way.highlight(simd, &viewed, FAINT) {
                all = strength * way.at_light * share;
                // As much is kept as of what is sent back evenly.
                let is_bounded = terms.simd_gt(bound);
                kept = is_bounded.select(all * bound / terms, all);
                add(&mut shiny, kept, &sent);
            }
            if terms.simd_gt(bound).any_true() {
                let lost = (terms - bound).max(zero) * share;
                add_to(simd, &mut self.lost.even, lost, &sent);
                add_to(simd, &mut self.lost.shiny, all - kept, &sent);
            }
        }
        store(&even, &mut self.sums.even);
        store(&shiny, &mut self.sums.shiny);
    }
}

#[inline(always)]
fn add<S: Simd>(sums: &mut Triple<S>, shares: f32x16<S>, sent: &Triple<S>) {
    for (sum, sent) in sums.iter_mut().zip(sent) {
        *sum += shares * *sent;
    }
}

/// The same for sums that are seldom added to.
#[inline(always)]
fn add_to<S: Simd>(simd: S, sums: &mut [Lanes; 3], shares: f32x16<S>, sent: &Triple<S>) {
    let mut values = load(simd, sums);
    add(&mut values, shares, sent);
    store(&values, sums);
}

#[cfg(test)]
mod tests {
    use rayflock_geom::simd::{SimdLevel, dispatch};

    use super::super::gather::arriving;
    use super::super::{Lobe, VirtualLight, VirtualLights};
    use super::*;
    use crate::shading::sampling::PathSeed;

    /// Numbers from -1 to 1, always the same.
    fn random(set: u32, idx: u32) -> [f32; 4] {
        PathSeed::of_walks(3).unit_4_cube(idx, set).map(|x| 2.0 * x - 1.0)
    }

    fn direction(set: u32, idx: u32) -> Vec3 {
        let [x, y, z, _] = random(set, idx);
        Vec3::new(x, y, z).normalize_or(Vec3::Y)
    }

    /// Matte points and shiny ones, on a floor.
    fn point(idx: u32, is_shiny: bool) -> LitPoint {
        let [x, z, shininess, _] = random(0, idx);
        LitPoint {
            shadow_position: Vec3::new(x, 0.0, z),
            normal: (0.4 * direction(1, idx) + Vec3::Y).normalize(),
            to_viewer: (direction(2, idx) + Vec3::Y).normalize(),
            diffuse: Vec3::new(0.5, 0.6, 0.7),
            specular: if is_shiny { Vec3::new(0.3, 0.2, 0.1) } else { Vec3::ZERO },
            shininess: 40.0 + 39.0 * shininess,
            pixel_idx: idx,
            seed: PathSeed::of_pixel(0, 0),
        }
    }

    /// Lights above: even ones, those of surfaces, with highlights, and under varnish.
    fn lights() -> VirtualLights {
        let place = |idx: u32| VirtualLight {
            position: direction(3, idx) * 0.5 + 0.6 * Vec3::Y,
            normal: if idx.is_multiple_of(3) { Vec3::ZERO } else { direction(4, idx) },
            evenness: if idx.is_multiple_of(3) { 1.0 } else { 0.0 },
            intensity: Vec3::new(1.0, 0.5, 2.0),
        };
        let lobed = |idx: u32| {
            let light = VirtualLight { normal: direction(4, idx), evenness: 0.0, ..place(idx) };
            let to_source = (direction(5, idx) + light.normal).normalize();
            let varnish = if idx.is_multiple_of(2) { 0.0 } else { 0.8 };
            let highlight = Vec3::new(2.0, 3.0, 1.0);
            (light, Lobe { to_source, highlight, shininess: 20.0, varnish })
        };
        let mut lights = VirtualLights::default();
        let plain: Vec<_> = (0..20).map(place).collect();
        lights.assign(4.0, &plain, &(20..40).map(lobed).collect::<Vec<_>>(), &[]);
        lights
    }

    #[test]
    fn sums_are_those_of_pairs() {
        const BOUND: f32 = 3.0;
        let lights = lights();
        let near: Vec<_> =
            (0..lights.len()).map(|idx| NearLight::new(&lights, idx, (Vec3::ZERO, 0.0))).collect();
        let share = |light_idx: usize, lane: usize| [1.0, 0.0, 0.5][(light_idx + lane) % 3];
        let shares: Vec<Lanes> = (0..near.len())
            .map(|light_idx| std::array::from_fn(|lane| share(light_idx, lane)))
            .collect();
        let mut bounded = 0;
        for is_shiny in [false, true] {
            let points: Vec<_> = (0..13).map(|idx| point(idx, is_shiny && idx % 2 == 0)).collect();
            for level in SimdLevel::available() {
                let mut block = LitBlock::new(points.iter());
                let materials = BlockMaterials::new(points.iter());
                let mut weights = vec![[0.0; LANES]; near.len()];
                dispatch!(level.level(), simd => {
                    block.add(simd, &near, shares.iter(), BOUND);
                    block.weigh(simd, &materials, &near, BOUND, &mut weights);
                });
                for (lane, point) in points.iter().enumerate() {
                    let (mut expected, mut expected_lost) = (Vec3::ZERO, 0.0);
                    for (light_idx, weights) in weights.iter().enumerate() {
                        let (radiance, lost) = arriving(&lights, light_idx, point, BOUND);
                        expected += share(light_idx, lane) * radiance;
                        let weight = weights[lane] * std::f32::consts::FRAC_1_PI;
                        let sum = radiance.element_sum();
                        assert!((weight - sum).abs() < 0.01 * (sum + 1.0), "{weight}, not {sum}");
                        expected_lost += share(light_idx, lane) * lost;
                    }
                    let (found, lost) = block.radiance(lane, point);
                    // Faint highlights are left out.
                    let allowed = 0.01 * expected.max_element();
                    assert!(found.distance(expected) < allowed, "{found} is not {expected}");
                    assert!((lost - expected_lost).abs() < 0.01 * (lost + 1.0), "{lost}");
                    bounded += usize::from(lost > 0.0);
                }
            }
        }
        assert!(bounded > 0, "no light is close enough to be bounded");
    }
}
