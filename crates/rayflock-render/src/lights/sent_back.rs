//! What sixteen points send back of a light, were nothing in the way: [`incident`] and
//! [`reflected`] for all of them at once.
//!
//! **Departures** from these two: the power of a highlight is that of [`power`], off by up to 3e-5
//! of it; everything else is the same to the bit.
//!
//! **Invariants.** Without fused multiply-add, and no lane knows of the others: the same bits at
//! every level, whichever points are neighbours.
//!
//! **Cost.** For sixteen points, about 200 operations, with four divisions and a root; 80 more where
//! any of them has a highlight.
//!
//! [`reflected`]: crate::shading::scatter::reflected

use std::mem::offset_of;

use bytemuck::Zeroable;
use glam::Vec3;
use rayflock_geom::simd::power::power;
use rayflock_geom::simd::{LANES, Lanes, Simd, SimdBase, SimdMask, f32x16, mask32x16};
use rayflock_scene::{Falloff, LightKind};

use super::incident::{MIN_CONE_WIDTH, incident};
use crate::triple::{
    Triple, add, columns_at, dot, is_something, normalized_or_zero, scale, select, splat, store,
    subtract,
};
use crate::wave::LitPoint;

/// Light that leaves sixteen points toward their viewers.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SentBack {
    /// By colour.
    pub(crate) radiance: [Lanes; 3],
    /// A bit for each point that sends anything back.
    pub(crate) lit: u64,
}

/// What up to sixteen `points` send back of `light`.
#[inline(always)]
pub(crate) fn sent_back<S: Simd>(simd: S, light: &LightKind, points: &[LitPoint]) -> SentBack {
    let mut padded;
    let whole = match points.first_chunk() {
        Some(whole) => whole,
        None => {
            padded = [LitPoint::zeroed(); LANES];
            padded[..points.len()].copy_from_slice(points);
            &padded
        }
    };
    let points_mask = (1 << points.len().min(LANES)) - 1;
    let columns = PointColumns::new(simd, whole);
    let arriving = Arriving::new(simd, light, &columns.position);
    let (sent, faces) = columns.reflect(simd, &arriving.to_light);
    let irradiance = &arriving.irradiance;
    let radiance = [sent[0] * irradiance[0], sent[1] * irradiance[1], sent[2] * irradiance[2]];
    let is_lit = arriving.arrives & faces & is_something(simd, &radiance);
    let mut found =
        SentBack { radiance: [[0.0; LANES]; 3], lit: is_lit.to_bitmask() & points_mask };
    store(&radiance, &mut found.radiance);
    found
}

/// Sixteen lit points in registers.
struct PointColumns<S: Simd> {
    position: Triple<S>,
    normal: Triple<S>,
    to_viewer: Triple<S>,
    diffuse: Triple<S>,
    specular: Triple<S>,
    shininess: f32x16<S>,
}

impl<S: Simd> PointColumns<S> {
    #[inline(always)]
    fn new(simd: S, points: &[LitPoint; LANES]) -> Self {
        let [_, shininess, _] =
            columns_at(simd, points, offset_of!(LitPoint, shininess) - size_of::<f32>());
        Self {
            position: columns_at(simd, points, offset_of!(LitPoint, shadow_position)),
            normal: columns_at(simd, points, offset_of!(LitPoint, normal)),
            to_viewer: columns_at(simd, points, offset_of!(LitPoint, to_viewer)),
            diffuse: columns_at(simd, points, offset_of!(LitPoint, diffuse)),
            specular: columns_at(simd, points, offset_of!(LitPoint, specular)),
            shininess,
        }
    }

    /// The share of irradiance along `to_light` that leaves toward the viewers, and which points
    /// face the light.
    #[inline(always)]
    fn reflect(&self, simd: S, to_light: &Triple<S>) -> (Triple<S>, mask32x16<S>) {
        let zero = f32x16::splat(simd, 0.0);
        let cos = dot(self.normal, *to_light);
        let faces = !cos.simd_le(zero);
        let mut sum = scale(&self.diffuse, cos);
        let is_shiny = faces & is_something(simd, &self.specular);
        if is_shiny.any_true() {
            let halfway = normalized_or_zero(simd, &add(&self.to_viewer, to_light));
            let base = dot(self.normal, halfway).max(zero);
            let strength = power(simd, base, self.shininess.max(zero));
            let with_highlight = add(&sum, &scale(&self.specular, strength));
            select(is_shiny, &mut sum, &with_highlight);
        }
        (scale(&sum, f32x16::splat(simd, std::f32::consts::FRAC_1_PI)), faces)
    }
}

/// What a light sends to sixteen places.
struct Arriving<S: Simd> {
    to_light: Triple<S>,
    irradiance: Triple<S>,
    arrives: mask32x16<S>,
}

impl<S: Simd> Arriving<S> {
    #[inline(always)]
    fn new(simd: S, light: &LightKind, position: &Triple<S>) -> Self {
        let one = f32x16::splat(simd, 1.0);
        match *light {
            LightKind::Directional { .. } => {
                // The same everywhere.
                let of_all = incident(light, Vec3::ZERO);
                let to_light = of_all.map_or(Vec3::ZERO, |incident| incident.to_light);
                let irradiance = of_all.map_or(Vec3::ZERO, |incident| incident.irradiance);
                Self::new_where_finite(simd, splat(simd, to_light), splat(simd, irradiance))
            }
            LightKind::Point { position: source, intensity, falloff } => {
                let offset = subtract(splat(simd, source), *position);
                let squared = match falloff {
                    Falloff::InverseSquare => dot(offset, offset),
                    Falloff::Constant => one,
                };
                let irradiance = divided(&splat(simd, intensity), squared);
                Self::new_where_finite(simd, normalized_or_zero(simd, &offset), irradiance)
            }
            LightKind::Spot { position: source, direction, intensity, cos_inner, cos_outer } => {
                let offset = subtract(splat(simd, source), *position);
                let to_light = normalized_or_zero(simd, &offset);
                let axis = splat(simd, -direction.normalize_or_zero());
                let share = cone_share(simd, dot(to_light, axis), cos_inner, cos_outer);
                let full = scale(&splat(simd, intensity), share);
                Self::new_where_finite(simd, to_light, divided(&full, dot(offset, offset)))
            }
        }
    }

    /// Light that does not arrive where it has no direction, or not finite irradiance.
    #[inline(always)]
    fn new_where_finite(simd: S, to_light: Triple<S>, irradiance: Triple<S>) -> Self {
        let infinity = f32x16::splat(simd, f32::INFINITY);
        let is_finite = irradiance[0].abs().simd_lt(infinity)
            & irradiance[1].abs().simd_lt(infinity)
            & irradiance[2].abs().simd_lt(infinity);
        let arrives = is_finite & is_something(simd, &irradiance) & is_something(simd, &to_light);
        Self { to_light, irradiance, arrives }
    }
}

/// The share of a spot light's intensity, as for a single point.
#[inline(always)]
fn cone_share<S: Simd>(simd: S, cos: f32x16<S>, cos_inner: f32, cos_outer: f32) -> f32x16<S> {
    let splat = f32x16::splat;
    let width = (cos_inner - cos_outer).max(MIN_CONE_WIDTH);
    let share = (cos - splat(simd, cos_outer)) / splat(simd, width);
    let share = share.max(splat(simd, 0.0)).min(splat(simd, 1.0));
    share * share
}

#[inline(always)]
fn divided<S: Simd>(a: &Triple<S>, divisor: f32x16<S>) -> Triple<S> {
    [a[0] / divisor, a[1] / divisor, a[2] / divisor]
}

#[cfg(test)]
mod tests {
    use rayflock_geom::simd::{SimdLevel, dispatch};

    use super::*;
    use crate::shading::sampling::PathSeed;
    use crate::shading::scatter::reflected;

    /// Numbers from -1 to 1, always the same.
    fn vector(set: u32, idx: u32) -> Vec3 {
        let [x, y, z, _] = PathSeed::of_walks(7).unit_4_cube(idx, set);
        2.0 * Vec3::new(x, y, z) - 1.0
    }

    fn point(idx: u32) -> LitPoint {
        let is_shiny = idx.is_multiple_of(3);
        LitPoint {
            shadow_position: if idx == 5 { Vec3::ONE } else { 3.0 * vector(0, idx) },
            normal: vector(1, idx).normalize(),
            to_viewer: vector(2, idx).normalize(),
            diffuse: if idx == 4 { Vec3::ZERO } else { Vec3::new(0.5, 0.6, 0.7) },
            specular: if is_shiny { Vec3::new(0.3, 0.2, 0.1) } else { Vec3::ZERO },
            shininess: 20.0,
            pixel_idx: idx,
            seed: PathSeed::NONE,
        }
    }

    fn lights() -> Vec<LightKind> {
        let (position, direction) = (Vec3::ONE, Vec3::new(0.1, -2.0, 0.3));
        let intensity = Vec3::new(4.0, 2.0, 1.0);
        let lamp = |falloff| LightKind::Point { position, intensity, falloff };
        let spot = |cos_inner, cos_outer| LightKind::Spot {
            position,
            direction,
            intensity,
            cos_inner,
            cos_outer,
        };
        vec![
            lamp(Falloff::InverseSquare),
            lamp(Falloff::Constant),
            spot(0.8, 0.3),
            spot(0.5, 0.5),
            LightKind::Directional { direction, irradiance: intensity },
            LightKind::Directional { direction: Vec3::ZERO, irradiance: intensity },
        ]
    }

    /// What one point sends back, by the definitions.
    fn plain(light: &LightKind, point: &LitPoint) -> Vec3 {
        let LitPoint { shadow_position, normal, to_viewer, diffuse, specular, shininess, .. } =
            *point;
        incident(light, shadow_position).map_or(Vec3::ZERO, |incident| {
            let to_light = incident.to_light;
            reflected(diffuse, specular, shininess, normal, to_viewer, to_light)
                * incident.irradiance
        })
    }

    #[test]
    fn lanes_are_what_one_point_after_another_sends_back() {
        let points: Vec<LitPoint> = (0..77).map(point).collect();
        let mut lit_count = 0;
        for (light, level) in lights()
            .iter()
            .flat_map(|light| SimdLevel::available().into_iter().map(move |level| (light, level)))
        {
            for points in points.chunks(LANES) {
                let found = dispatch!(level.level(), simd => sent_back(simd, light, points));
                for (lane, point) in points.iter().enumerate() {
                    let expected = plain(light, point);
                    let radiance = Vec3::from(found.radiance.map(|column| column[lane]));
                    let is_lit = found.lit >> lane & 1 == 1;
                    assert_eq!(is_lit, expected != Vec3::ZERO, "{light:?} {point:?}");
                    let allowed = if point.specular == Vec3::ZERO { 0.0 } else { 1e-4 };
                    if is_lit {
                        let error = (radiance - expected).abs().max_element();
                        assert!(
                            error <= allowed * expected.max_element(),
                            "{level} {light:?} {point:?}"
                        );
                    }
                    lit_count += u32::from(is_lit);
                }
                assert_eq!(found.lit >> points.len(), 0);
            }
        }
        assert!(lit_count > 100, "hardly any point is lit");
    }
}
