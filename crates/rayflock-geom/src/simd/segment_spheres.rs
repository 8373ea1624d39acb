//! How much light comes from one light to sixteen points, past soft spheres.
//!
//! ```text
//!      light *                      A sphere dims a segment by how near its middle it passes:
//!             \   .-''''-.            all of its opacity within the inner radius,
//!              \ /  .--.  \           nothing beyond the outer radius,
//!               \  | () |  |          linear in the squared distance between them.
//!              / \  '--'  /         What it would dim at an end of the segment does not count,
//!             /   '-....-'          so a sphere that holds an end point is hardly there; nor
//!      point * ---------- plane     does what lies behind the plane of a surface at an end.
//! ```
//!
//! A sphere may be flattened: lengths along one direction count several times, so that it is a
//! disc with a rim, and stands for a patch of a wall without bulging into the room.
//!
//! **Source.** L. Szecsi, *The Hierarchical Ray Engine and Virtual Light Sources* (thesis, chapter
//! 5) for spheres in place of geometry, soft between two radii, and without those of the ends.
//!
//! **Departures.** Linear in the squared distance, which needs no root. A sphere is not left out
//! at once where it begins to hold an end point, but by most of what it would dim there, so that no
//! edges show; one whose centre lies behind an end's surface, as those of that surface itself do, does
//! not count at all.
//! What several spheres take away is added up: most are neighbours that stand for one surface, and
//! where they meet, each covers what the other does not. Multiplied, as if they lay in no relation,
//! they would let through a quarter of the light at each seam, however many there were. Flattened
//! spheres are ours.
//!
//! **Invariants.** Without fused multiply-add, and in one order: the same bits at every level. What
//! is let through lies within 0 and 1, whatever the points. A sphere that a segment does not come
//! within the outer radius of changes no bit, so neither does leaving it out.
//!
//! **Cost.** About 45 operations for each round sphere and sixteen points, and 57 and a division
//! for each flattened one.

use glam::Vec3;

use super::axes::{Axes, dot, load_axes, splat_axes, subtract};
use super::{LANES, Lanes, Select, Simd, SimdBase, SimdMask, f32x16};

/// A sphere counts in full where its centre lies this share of the outer radius above the plane of
/// an end point, and less below. Among 0.02, 0.1, 0.25, 0.5 and 1, with shares of [`AT_END`] of 0.25,
/// 0.5, 0.75 and 1, these two came nearest to what is exact in three built-in scenes.
pub const RISE: f32 = 0.25;

/// The share of what a sphere would dim at an end point that does not count.
pub const AT_END: f32 = 0.75;

/// Less light than this share is none.
pub const DARK: f32 = 1.0 / 512.0;

/// Spheres between two looks at whether any light is left.
const STRIDE: usize = 4;

/// A sphere that stands for geometry.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SoftSphere {
    /// Centre.
    pub center: Vec3,
    /// Up to here from the centre a segment is dimmed by all of the opacity.
    pub inner: f32,
    /// From here on it is not dimmed; larger than `inner`.
    pub outer: f32,
    /// The share of light that the middle takes away, from 0 to 1.
    pub opacity: f32,
    /// Along this direction lengths count `sqrt(1 + l^2)` times, where l is its length; zero for a
    /// round sphere.
    pub flatness: Vec3,
}

impl SoftSphere {
    /// The squared distance of a point from the centre, as it counts for this sphere.
    #[inline(always)]
    pub fn distance_squared(&self, point: Vec3) -> f32 {
        let offset = self.center - point;
        let across = self.flatness.dot(offset);
        offset.length_squared() + across * across
    }

    /// How fast the dimming falls with the squared distance.
    #[inline(always)]
    pub fn slope(&self) -> f32 {
        let width = self.outer * self.outer - self.inner * self.inner;
        self.opacity / width.max(f32::MIN_POSITIVE)
    }
}

/// A soft sphere made ready for segments, as seen from one light.
#[derive(Clone, Copy, Debug)]
pub struct Blocker {
    center: Vec3,
    /// The dimming that a distance of zero would have, were it not bounded.
    peak: f32,
    slope: f32,
    opacity: f32,
    /// What it would dim at the light.
    at_light: f32,
    /// How much of it counts at the light.
    share: f32,
    /// Heights times this are shares.
    per_height: f32,
    flatness: Vec3,
    /// From the centre to the light, and that along the flatness.
    to_light: Vec3,
    light_across: f32,
}

impl Blocker {
    /// The sphere, seen from nowhere yet.
    #[inline(always)]
    pub fn new(sphere: &SoftSphere) -> Self {
        let slope = sphere.slope();
        Self {
            center: sphere.center,
            peak: sphere.outer * sphere.outer * slope,
            slope,
            opacity: sphere.opacity,
            at_light: 0.0,
            share: 1.0,
            per_height: 1.0 / (RISE * sphere.outer),
            flatness: sphere.flatness,
            to_light: Vec3::ZERO,
            light_across: 0.0,
        }
    }

    /// Whether the sphere is flattened.
    #[inline(always)]
    pub fn is_flat(&self) -> bool {
        self.flatness != Vec3::ZERO
    }

    /// The same as seen from a light with a surface `normal`, or `Vec3::ZERO` for a light without;
    /// `None` where it dims nothing of that light.
    #[inline(always)]
    pub fn toward(&self, light: Vec3, normal: Vec3) -> Option<Self> {
        let to_light = light - self.center;
        let light_across = self.flatness.dot(to_light);
        let squared = to_light.length_squared() + light_across * light_across;
        let at_light = AT_END * (self.peak - squared * self.slope).max(0.0).min(self.opacity);
        let share = match normal == Vec3::ZERO {
            true => 1.0,
            false => (-normal.dot(to_light) * self.per_height).clamp(0.0, 1.0),
        };
        (share > 0.0).then_some(Self { at_light, share, to_light, light_across, ..*self })
    }
}

/// Sixteen points that light comes to, as columns.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub struct PointBlock {
    /// Positions by axis.
    pub position: [Lanes; 3],
    /// Normals of unit length by axis, on the side that is seen.
    pub normal: [Lanes; 3],
}

impl PointBlock {
    /// Sixteen times the same point.
    pub fn splat(position: Vec3, normal: Vec3) -> Self {
        let columns = |v: Vec3| v.to_array().map(|coordinate| [coordinate; LANES]);
        Self { position: columns(position), normal: columns(normal) }
    }

    /// Writes one point.
    #[inline(always)]
    pub fn set(&mut self, lane: usize, position: Vec3, normal: Vec3) {
        for axis in 0..3 {
            self.position[axis][lane] = position[axis];
            self.normal[axis][lane] = normal[axis];
        }
    }
}

/// The share of light from `light` that comes past blockers to each of sixteen points. All are
/// seen from that light; the `flat` ones are asked after the `round` ones.
#[inline(always)]
pub fn let_through<S: Simd>(
    simd: S,
    points: &PointBlock,
    light: Vec3,
    round: &[Blocker],
    flat: &[Blocker],
) -> f32x16<S> {
    let segments = Segments::new(simd, points, light);
    let (zero, dark) = (f32x16::splat(simd, 0.0), f32x16::splat(simd, DARK));
    let mut through = f32x16::splat(simd, 1.0);
    for blockers in round.chunks(STRIDE) {
        for blocker in blockers {
            through -= segments.taken_by::<false>(simd, blocker);
        }
        if !through.simd_gt(dark).any_true() {
            return zero;
        }
    }
    for blockers in flat.chunks(STRIDE) {
        for blocker in blockers {
            through -= segments.taken_by::<true>(simd, blocker);
        }
        if !through.simd_gt(dark).any_true() {
            return zero;
        }
    }
    // As if nothing had been left out above.
    through.simd_gt(dark).select(through, zero)
}

/// Sixteen segments from points to one light.
struct Segments<S: Simd> {
    origin: Axes<S>,
    normal: Axes<S>,
    /// Squared lengths, and one over them.
    squared: f32x16<S>,
    inverse: f32x16<S>,
}

impl<S: Simd> Segments<S> {
    #[inline(always)]
    fn new(simd: S, points: &PointBlock, light: Vec3) -> Self {
        let origin = load_axes(simd, &points.position);
        let direction = subtract(splat_axes(simd, light), origin);
        let least = f32x16::splat(simd, f32::MIN_POSITIVE);
        let squared = dot(direction, direction).max(least);
        let inverse = f32x16::splat(simd, 1.0) / squared;
        Self { origin, normal: load_axes(simd, &points.normal), squared, inverse }
    }

    /// The share of light that one sphere takes away.
    #[inline(always)]
    fn taken_by<const FLAT: bool>(&self, simd: S, blocker: &Blocker) -> f32x16<S> {
        let splat = f32x16::splat;
        let (zero, one) = (splat(simd, 0.0), splat(simd, 1.0));
        let (peak, slope) = (splat(simd, blocker.peak), splat(simd, blocker.slope));
        let opacity = splat(simd, blocker.opacity);

        // Squared lengths: of the segment, and from its origin to the centre; and the product of
        // both ways. The segment is the way to the centre and on to the light.
        let offset = subtract(splat_axes(simd, blocker.center), self.origin);
        let mut at_origin = dot(offset, offset);
        let mut along = dot(offset, splat_axes(simd, blocker.to_light)) + at_origin;
        let (mut squared, mut inverse) = (self.squared, self.inverse);
        if FLAT {
            let across = dot(offset, splat_axes(simd, blocker.flatness));
            let all_across = across + splat(simd, blocker.light_across);
            at_origin += across * across;
            along += across * all_across;
            squared += all_across * all_across;
            inverse = one / squared;
        }

        let nearest = along.max(zero).min(squared);
        let distance = at_origin - nearest * (along + along - nearest) * inverse;
        let dimming = (peak - distance * slope).max(zero).min(opacity);
        let at_point = (peak - at_origin * slope).max(zero).min(opacity);
        let at_ends = at_point * splat(simd, AT_END) + splat(simd, blocker.at_light);
        let counted = (dimming - at_ends).max(zero);
        let height = dot(offset, self.normal) * splat(simd, blocker.per_height);
        let share = height.max(zero).min(one) * splat(simd, blocker.share);
        counted * share
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::super::{SimdLevel, dispatch};
    use super::*;

    /// The same, for one point, sphere by sphere.
    fn plain(
        (point, normal): (Vec3, Vec3),
        (light, light_normal): (Vec3, Vec3),
        spheres: &[SoftSphere],
    ) -> f32 {
        let rise = |sphere: &SoftSphere, end: Vec3, normal: Vec3| {
            let height = normal.dot(sphere.center - end) / (RISE * sphere.outer);
            if normal == Vec3::ZERO { 1.0 } else { height.clamp(0.0, 1.0) }
        };
        let taken = |sphere: &SoftSphere| {
            let dimming = |distance_squared: f32| {
                let (outer, inner) = (sphere.outer.powi(2), sphere.inner.powi(2));
                (outer - distance_squared).clamp(0.0, outer - inner) / (outer - inner)
                    * sphere.opacity
            };
            // In a space where the sphere is round.
            let axis = sphere.flatness.normalize_or_zero();
            let stretch = (1.0 + sphere.flatness.length_squared()).sqrt() - 1.0;
            let round = |v: Vec3| v + stretch * axis.dot(v) * axis;
            let (offset, direction) = (round(sphere.center - point), round(light - point));
            let t = (offset.dot(direction) / direction.length_squared()).clamp(0.0, 1.0);
            let at_ends = dimming(sphere.distance_squared(point))
                + dimming(round(sphere.center - light).length_squared());
            let counted = dimming((offset - t * direction).length_squared()) - AT_END * at_ends;
            let share = rise(sphere, point, normal) * rise(sphere, light, light_normal);
            counted.max(0.0) * share
        };
        (1.0 - spheres.iter().map(taken).sum::<f32>()).max(0.0)
    }

    fn blockers(spheres: &[SoftSphere], light: Vec3, normal: Vec3) -> Vec<Blocker> {
        spheres.iter().filter_map(|sphere| Blocker::new(sphere).toward(light, normal)).collect()
    }

    fn at_every_level(points: &PointBlock, light: Vec3, blockers: &[Blocker]) -> Vec<Lanes> {
        let (flat, round): (Vec<_>, Vec<_>) = blockers.iter().partition(|b| b.is_flat());
        let at_level = |level: SimdLevel| dispatch!(level.level(), simd => *let_through(simd, points, light, &round, &flat));
        SimdLevel::available().into_iter().map(at_level).collect()
    }

    fn vector() -> impl Strategy<Value = Vec3> {
        prop::array::uniform3(-1.0..1.0_f32).prop_map(Vec3::from)
    }

    fn sphere() -> impl Strategy<Value = SoftSphere> {
        let flatness = prop_oneof![Just(Vec3::ZERO), vector().prop_map(|v| 6.0 * v)];
        (vector(), 0.0..0.3_f32, 0.05..0.3_f32, 0.1..1.0_f32, flatness).prop_map(
            |(center, inner, more, opacity, flatness)| {
                let outer = inner + more;
                SoftSphere { center, inner, outer, opacity, flatness }
            },
        )
    }

    proptest! {
        #[test]
        fn lanes_are_what_one_point_after_another_gives(
            points in prop::collection::vec((vector(), vector()), LANES),
            light in vector(), light_normal in vector(), is_bare: bool,
            spheres in prop::collection::vec(sphere(), 0..12),
        ) {
            let unit = |v: Vec3| v.normalize_or(Vec3::Y);
            let light_normal = if is_bare { Vec3::ZERO } else { unit(light_normal) };
            let mut block = PointBlock::splat(Vec3::ZERO, Vec3::Y);
            for (lane, &(point, normal)) in points.iter().enumerate() {
                block.set(lane, point, unit(normal));
            }
            let found = at_every_level(&block, light, &blockers(&spheres, light, light_normal));
            for lanes in &found {
                prop_assert_eq!(lanes.map(f32::to_bits), found[0].map(f32::to_bits));
            }
            for (lane, &(point, normal)) in points.iter().enumerate() {
                let expected = plain((point, unit(normal)), (light, light_normal), &spheres);
                let found = found[0][lane];
                prop_assert!((0.0..=1.0).contains(&found));
                prop_assert!((found - expected).abs() < 3.0 * DARK, "{found} is not {expected}");
            }
        }
    }

    #[test]
    fn neighbours_add_up() {
        let half = SoftSphere {
            center: Vec3::Y,
            inner: 0.2,
            outer: 0.3,
            opacity: 0.5,
            flatness: Vec3::ZERO,
        };
        let (points, light) = (PointBlock::splat(Vec3::ZERO, Vec3::Y), 2.0 * Vec3::Y);
        let through = |count: usize| {
            let blockers = blockers(&vec![half; count], light, Vec3::NEG_Y);
            at_every_level(&points, light, &blockers)[0][0]
        };
        assert_eq!([0, 1, 2, 3].map(through), [1.0, 0.5, 0.0, 0.0]);
    }

    #[test]
    fn a_sphere_shades_what_is_behind_it_and_nothing_else() {
        let (center, flatness) = (Vec3::Y, Vec3::ZERO);
        let sphere = SoftSphere { center, inner: 0.19, outer: 0.2, opacity: 1.0, flatness };
        let light = 2.0 * Vec3::Y;
        let through = |point: Vec3| {
            let points = PointBlock::splat(point, Vec3::Y);
            at_every_level(&points, light, &blockers(&[sphere], light, Vec3::NEG_Y))[0][0]
        };
        assert_eq!(through(Vec3::ZERO), 0.0);
        assert_eq!(through(Vec3::new(0.5, 0.0, 0.0)), 1.0);
        // Between light and sphere, and the light itself.
        assert_eq!(through(1.5 * Vec3::Y), 1.0);
        assert_eq!(through(light), 1.0);
        // Within the sphere.
        assert_eq!(through(0.95 * Vec3::Y), AT_END);
    }
}
