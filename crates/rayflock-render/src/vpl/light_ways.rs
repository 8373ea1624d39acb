//! The ways from sixteen points to a light, and what it sends along them.
//!
//! **Departures** from [`gather`](super::gather): highlights below a 512th of their strength may be
//! left out.
//!
//! **Invariants, cost**: see [`light_blocks`](super::light_blocks).

use glam::Vec3;
use rayflock_geom::simd::power::power;
use rayflock_geom::simd::{Select, Simd, SimdBase, SimdFloat, SimdMask, f32x16};

use super::{Lobe, VirtualLight, VirtualLights};
use crate::triple::{Triple, dot, splat};

/// The logarithm of 512: a power is below one over that where one minus its base, times its
/// exponent, exceeds this.
pub(super) const FAINT: f32 = 9.0 * std::f32::consts::LN_2;

/// A light at a place in the scene.
#[derive(Clone, Copy, Debug)]
pub(super) struct NearLight {
    pub(super) position: Vec3,
    /// Of unit length; zero where it has no surface.
    pub(super) normal: Vec3,
    /// Added to the cosine: 0 for a surface, 1 for a point that shines evenly.
    pub(super) evenness: f32,
    /// Radiant intensity along the normal, by colour.
    pub(super) intensity: Vec3,
    pub(super) lobe: Option<Lobe>,
}

impl NearLight {
    /// Light `light_idx`; a distant one is placed `distance` away from `center`, where it sends
    /// about what it does from afar. Geometry terms of distant lights have no bound.
    pub(super) fn new(
        lights: &VirtualLights,
        light_idx: usize,
        (center, distance): (Vec3, f32),
    ) -> Self {
        let VirtualLight { position, normal, evenness, intensity } = lights.get(light_idx);
        if lights.is_distant(light_idx) {
            let (position, intensity) =
                (center + distance * position, intensity * (distance * distance));
            return Self { position, normal, evenness, intensity, lobe: None };
        }
        let lobe = lights.lobe(light_idx).copied();
        Self { position, normal, evenness, intensity, lobe }
    }
}

/// Sixteen points in registers.
pub(super) struct Viewed<S: Simd> {
    pub(super) position: Triple<S>,
    pub(super) normal: Triple<S>,
    pub(super) to_viewer: Triple<S>,
    /// The cosine toward the viewer.
    pub(super) cos_viewer: f32x16<S>,
    pub(super) shininess: f32x16<S>,
}

/// The ways from sixteen points to a light.
pub(super) struct Way<S: Simd> {
    offset: Triple<S>,
    /// The squared distance, and one over it.
    squared: f32x16<S>,
    inverse: f32x16<S>,
    /// 0 where nobody needs it.
    distance: f32x16<S>,
    /// Cosines at both ends, not below 0, over the distance.
    pub(super) at_point: f32x16<S>,
    pub(super) at_light: f32x16<S>,
    /// The cosine at the light's surface times the distance.
    facing: f32x16<S>,
    /// The same of the point.
    rise: f32x16<S>,
}

impl<S: Simd> Way<S> {
    #[inline(always)]
    pub(super) fn new<const SHINY: bool>(simd: S, points: &Viewed<S>, light: &NearLight) -> Self {
        let (zero, one) = (f32x16::splat(simd, 0.0), f32x16::splat(simd, 1.0));
        let end = splat(simd, light.position);
        let offset =
            [end[0] - points.position[0], end[1] - points.position[1], end[2] - points.position[2]];
        let squared = dot(offset, offset);
        let is_needed = SHINY || light.evenness != 0.0 || light.lobe.is_some();
        let distance = if is_needed { squared.sqrt() } else { zero };
        let inverse = one / squared.max(f32x16::splat(simd, f32::MIN_POSITIVE));
        let rise = dot(offset, points.normal);
        let facing = zero - dot(offset, splat(simd, light.normal));
        let evenly = facing + distance * f32x16::splat(simd, light.evenness);
        let at_point = rise.max(zero) * inverse;
        let at_light = evenly.max(zero) * inverse;
        Self { offset, squared, inverse, distance, at_point, at_light, facing, rise }
    }

    /// The intensity of the light toward each point over the cosine there, by colour.
    #[inline(always)]
    pub(super) fn sent(&self, simd: S, light: &NearLight, faint: f32) -> Triple<S> {
        let plain = splat(simd, light.intensity);
        let Some(lobe) = &light.lobe else { return plain };
        let (zero, one) = (f32x16::splat(simd, 0.0), f32x16::splat(simd, 1.0));
        let mut let_out = one;
        if lobe.varnish != 0.0 {
            let least = f32x16::splat(simd, f32::MIN_POSITIVE);
            let sideways = (one - self.facing / self.distance.max(least)).max(zero);
            let squared = sideways * sideways;
            let_out = one - f32x16::splat(simd, lobe.varnish) * (squared * squared * sideways);
        }
        // Halfway between the ways to the source and to the point.
        let along = dot(self.offset, splat(simd, lobe.to_source));
        let of_source = f32x16::splat(simd, light.normal.dot(lobe.to_source));
        let halfway = of_source * self.distance + self.facing;
        let length = self.squared - self.distance * along;
        let shininess = f32x16::splat(simd, lobe.shininess);
        let strength = halfway_power(simd, (halfway, length), shininess, faint).unwrap_or(zero);
        let highlight = splat(simd, lobe.highlight);
        [
            plain[0] * let_out + highlight[0] * strength,
            plain[1] * let_out + highlight[1] * strength,
            plain[2] * let_out + highlight[2] * strength,
        ]
    }

    /// How strong the highlights of the points are over the distance to the light; `None` where
    /// all are faint.
    #[inline(always)]
    pub(super) fn highlight(&self, simd: S, points: &Viewed<S>, faint: f32) -> Option<f32x16<S>> {
        let zero = f32x16::splat(simd, 0.0);
        let along = dot(self.offset, points.to_viewer);
        let halfway = points.cos_viewer * self.distance + self.rise;
        let length = self.squared + self.distance * along;
        let strength = halfway_power(simd, (halfway, length), points.shininess, faint)?;
        let per_distance = strength * (self.distance * self.inverse);
        Some(self.rise.simd_gt(zero).select(per_distance, zero))
    }
}

/// The power of a cosine: that of the vector halfway between two ways. `product` is that of the
/// normal and the sum of both, one of them of unit length and the other as long as the distance,
/// times the distance; `length` half the squared length of that sum. `None` where all are faint.
#[inline(always)]
fn halfway_power<S: Simd>(
    simd: S,
    (product, length): (f32x16<S>, f32x16<S>),
    shininess: f32x16<S>,
    faint: f32,
) -> Option<f32x16<S>> {
    let least = f32x16::splat(simd, f32::MIN_POSITIVE);
    let one = f32x16::splat(simd, 1.0);
    let cos = product / (length + length).max(least).sqrt();
    let is_seen = (shininess * (one - cos)).simd_le(f32x16::splat(simd, faint));
    if !is_seen.any_true() {
        return None;
    }
    Some(is_seen.select(power(simd, cos, shininess), f32x16::splat(simd, 0.0)))
}
