//! One sphere around each of sixteen blocks of sixteen bounding spheres.
//!
//! As [`Sphere::around_spheres`](crate::Sphere::around_spheres): about the centre of the box around
//! the centres, as large as the farthest sphere reaches. What each block's sixteen lanes have at
//! most is brought into one vector, a lane a block, by halving all of them together.
//!
//! **Cost.** Some 40 operations a block.

use glam::Vec3;

use super::axes::{Axes, dot, splat_axes, subtract};
use super::cone_sphere::{SphereBlock, SphereLanes};
use super::{LANES, Select, Simd, SimdBase, SimdFloat, f32x16};
use crate::sphere::{RADIUS_FACTOR, UNDERFLOW};

/// The spheres around up to sixteen blocks, a lane a block; lanes without a block, and those of
/// blocks that nothing touches, hold a sphere that nothing touches.
#[inline(always)]
pub fn around_blocks<S: Simd>(simd: S, blocks: &[SphereBlock]) -> SphereLanes<S> {
    let center = centers(simd, blocks);
    let radius = reaches(simd, blocks, center);
    let is_empty = radius.simd_lt(f32x16::splat(simd, 0.0));
    let enlarged = radius * f32x16::splat(simd, RADIUS_FACTOR) + f32x16::splat(simd, UNDERFLOW);
    let zero = f32x16::splat(simd, 0.0);
    SphereLanes {
        center: [
            is_empty.select(zero, center[0]),
            is_empty.select(zero, center[1]),
            is_empty.select(zero, center[2]),
        ],
        radius: is_empty.select(f32x16::splat(simd, f32::NEG_INFINITY), enlarged),
    }
}

/// The middle of the box around the centres of each block; anything for an empty block.
#[inline(always)]
fn centers<S: Simd>(simd: S, blocks: &[SphereBlock]) -> Axes<S> {
    let none = f32x16::splat(simd, f32::NEG_INFINITY);
    let half = f32x16::splat(simd, 0.5);
    let mut middle = [none; 3];
    for (axis, middle) in middle.iter_mut().enumerate() {
        let (mut upper, mut lower) = ([none; LANES], [none; LANES]);
        for (idx, block) in blocks.iter().enumerate().take(LANES) {
            let spheres = block.load(simd);
            let counts = spheres.radius.simd_ge(f32x16::splat(simd, 0.0));
            upper[idx] = counts.select(spheres.center[axis], none);
            lower[idx] = counts.select(-spheres.center[axis], none);
        }
        *middle = half * largest_of_each(upper) - half * largest_of_each(lower);
    }
    middle
}

/// How far the spheres of each block reach from `center`; minus infinity for an empty block.
#[inline(always)]
fn reaches<S: Simd>(simd: S, blocks: &[SphereBlock], center: Axes<S>) -> f32x16<S> {
    let none = f32x16::splat(simd, f32::NEG_INFINITY);
    let mut reach = [none; LANES];
    for (idx, block) in blocks.iter().enumerate().take(LANES) {
        let spheres = block.load(simd);
        let middle = Vec3::new(center[0][idx], center[1][idx], center[2][idx]);
        let offset = subtract(spheres.center, splat_axes(simd, middle));
        let counts = spheres.radius.simd_ge(f32x16::splat(simd, 0.0));
        reach[idx] = counts.select(dot(offset, offset).sqrt() + spheres.radius, none);
    }
    largest_of_each(reach)
}

/// The largest lane of each vector: that of vector i in lane i.
#[inline(always)]
fn largest_of_each<S: Simd>(mut vectors: [f32x16<S>; LANES]) -> f32x16<S> {
    let mut count = LANES / 2;
    while count > 0 {
        for idx in 0..count {
            let (even, odd) = vectors[2 * idx].deinterleave(vectors[2 * idx + 1]);
            vectors[idx] = even.max(odd);
        }
        count /= 2;
    }
    vectors[0]
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::super::{SimdLevel, dispatch};
    use super::*;
    use crate::Sphere;

    fn around(level: SimdLevel, blocks: &[SphereBlock]) -> SphereBlock {
        let mut found = SphereBlock::EMPTY;
        dispatch!(level.level(), simd => around_blocks(simd, blocks).store(&mut found));
        found
    }

    fn sphere() -> impl Strategy<Value = Option<Sphere>> {
        let center = prop::array::uniform3(-1.0..1.0_f32);
        let scale = prop_oneof![Just(1.0_f32), Just(1e-20), Just(1e15), Just(1e30)];
        let sphere = (center, 0.0..1.0_f32, scale)
            .prop_map(|(c, r, scale)| Sphere::new(scale * Vec3::from(c), scale * r));
        prop::option::weighted(0.7, sphere)
    }

    proptest! {
        #[test]
        fn spheres_lie_in_the_sphere_around_their_block(
            spheres in prop::collection::vec(prop::collection::vec(sphere(), LANES), 0..=LANES),
        ) {
            let mut blocks = vec![SphereBlock::EMPTY; spheres.len()];
            for (block, spheres) in blocks.iter_mut().zip(&spheres) {
                for (lane, sphere) in spheres.iter().enumerate() {
                    sphere.iter().for_each(|sphere| block.set(lane, sphere));
                }
            }
            for level in SimdLevel::available() {
                let around = around(level, &blocks);
                for (idx, spheres) in spheres.iter().enumerate() {
                    let around = around.get(idx);
                    let is_empty = spheres.iter().all(Option::is_none);
                    prop_assert_eq!(around.radius == f32::NEG_INFINITY, is_empty);
                    for sphere in spheres.iter().flatten() {
                        let offset = sphere.center.as_dvec3() - around.center.as_dvec3();
                        let reach = offset.length() + f64::from(sphere.radius);
                        prop_assert!(reach <= f64::from(around.radius), "{sphere:?} {around:?}");
                    }
                }
                for idx in spheres.len()..LANES {
                    prop_assert_eq!(around.get(idx).radius, f32::NEG_INFINITY);
                }
            }
        }
    }
}
