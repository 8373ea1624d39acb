//! Sixteen triangles in registers: to world space, which of them have an area, and the spheres
//! around them.

use glam::{Affine3A, Vec3};

use super::axes::{Axes, dot, load_axes, splat_axes, store_axes, subtract};
use super::cone_sphere::SphereLanes;
use super::ray_triangle::TriangleBlock;
use super::{LANES, Select, Simd, SimdBase, SimdFloat, SimdMask, f32x16, mask32x16};
use crate::is_degenerate_triangle;
use crate::sphere::{RADIUS_FACTOR, UNDERFLOW};

/// More than what rounding takes off a coordinate of a normal in `f32`, relative to the sum of the
/// magnitudes of its products: four units for each (one for either factor, one for the product and
/// one for the difference), with a margin of sixteen. It also covers summing the three axes.
const NORMAL_ERROR: f32 = 1.0 / (1 << 18) as f32;

/// More than what underflow of those products takes off.
const NORMAL_UNDERFLOW: f32 = 1e-35;

/// Sixteen triangles: a vector for each axis of each corner.
#[derive(Clone, Copy, Debug)]
pub struct TriangleLanes<S: Simd> {
    /// Corners, then axes.
    pub corners: [[f32x16<S>; 3]; 3],
}

impl<S: Simd> TriangleLanes<S> {
    /// The triangles of a block.
    #[inline(always)]
    pub fn load(simd: S, block: &TriangleBlock) -> Self {
        let [a, b, c] = &block.corners;
        Self { corners: [load_axes(simd, a), load_axes(simd, b), load_axes(simd, c)] }
    }

    /// Writes all lanes of a block.
    #[inline(always)]
    pub fn store(&self, block: &mut TriangleBlock) {
        for (axes, columns) in self.corners.iter().zip(&mut block.corners) {
            store_axes(axes, columns);
        }
    }

    /// The images of all corners, the same in every bit as by
    /// [`transform_point`](crate::transform_point).
    #[inline(always)]
    pub fn transformed(&self, simd: S, world_from_object: &Affine3A) -> Self {
        let [a, b, c] = self.corners;
        let place = Placement::new(simd, world_from_object);
        Self { corners: [place.image(a), place.image(b), place.image(c)] }
    }

    /// Which triangles certainly have an area and finite corners. What [`is_degenerate_triangle`]
    /// ignores never counts as certain; needles may not either.
    #[inline(always)]
    pub fn certainly_solid(&self, simd: S) -> mask32x16<S> {
        let [a, b, c] = self.corners;
        let (normal, size) = cross_with_size(subtract(b, a), subtract(c, a));
        let length = (normal[0].abs() + normal[1].abs()) + normal[2].abs();
        let size = (size[0] + size[1]) + size[2];
        let error = size * f32x16::splat(simd, NORMAL_ERROR);
        // NaN is not greater, and what is infinite makes the error infinite or NaN too.
        length.simd_gt(error + f32x16::splat(simd, NORMAL_UNDERFLOW))
    }

    /// Which triangles are not ignored, as by [`is_degenerate_triangle`].
    #[inline(always)]
    pub fn solid(&self, simd: S) -> mask32x16<S> {
        let certain = self.certainly_solid(simd);
        if certain.all_true() { certain } else { self.ask_doubtful(simd, certain) }
    }

    #[inline(never)]
    fn ask_doubtful(&self, simd: S, certain: mask32x16<S>) -> mask32x16<S> {
        let mut block = TriangleBlock::EMPTY;
        self.store(&mut block);
        let is_solid = |lane: &usize| !is_degenerate_triangle(block.get(*lane));
        let doubtful = |lane: &usize| certain.to_bitmask() & (1 << lane) == 0;
        let solid = (0..LANES).filter(doubtful).filter(is_solid);
        let solid = solid.fold(certain.to_bitmask(), |solid, lane| solid | (1 << lane));
        mask32x16::from_bitmask(simd, solid)
    }

    /// Spheres around the triangles, as by [`Sphere::around_triangle`](crate::Sphere); one that
    /// nothing touches where all corners coincide.
    #[inline(always)]
    pub fn spheres(&self, simd: S) -> SphereLanes<S> {
        let [a, b, c] = self.corners;
        let center = box_center(simd, a, b, c);
        let (to_a, to_b, to_c) = (subtract(a, center), subtract(b, center), subtract(c, center));
        let squared = dot(to_a, to_a).max(dot(to_b, to_b)).max(dot(to_c, to_c));
        let enlarged = squared.sqrt() * f32x16::splat(simd, RADIUS_FACTOR);
        let radius = enlarged + f32x16::splat(simd, UNDERFLOW);
        let is_point = coincide(a, b) & coincide(a, c);
        let untouchable = f32x16::splat(simd, f32::NEG_INFINITY);
        SphereLanes { center, radius: is_point.select(untouchable, radius) }
    }
}

/// A transform with each coefficient in all lanes.
struct Placement<S: Simd> {
    axes: [Axes<S>; 3],
    translation: Axes<S>,
}

impl<S: Simd> Placement<S> {
    #[inline(always)]
    fn new(simd: S, world_from_object: &Affine3A) -> Self {
        let m = &world_from_object.matrix3;
        let (x, y, z) = (Vec3::from(m.x_axis), Vec3::from(m.y_axis), Vec3::from(m.z_axis));
        let axes = [splat_axes(simd, x), splat_axes(simd, y), splat_axes(simd, z)];
        let translation = splat_axes(simd, Vec3::from(world_from_object.translation));
        Self { axes, translation }
    }

    /// The operations of `transform_point` in their order, without fused ones.
    #[inline(always)]
    fn image(&self, point: Axes<S>) -> Axes<S> {
        let ([x, y, z], t) = (&self.axes, &self.translation);
        [
            ((x[0] * point[0] + y[0] * point[1]) + z[0] * point[2]) + t[0],
            ((x[1] * point[0] + y[1] * point[1]) + z[1] * point[2]) + t[1],
            ((x[2] * point[0] + y[2] * point[1]) + z[2] * point[2]) + t[2],
        ]
    }
}

/// The centres of the boxes around three points each.
#[inline(always)]
fn box_center<S: Simd>(simd: S, a: Axes<S>, b: Axes<S>, c: Axes<S>) -> Axes<S> {
    let half = f32x16::splat(simd, 0.5);
    let mut center = a;
    for axis in 0..3 {
        let min = a[axis].min(b[axis]).min(c[axis]);
        let max = a[axis].max(b[axis]).max(c[axis]);
        center[axis] = half * min + half * max;
    }
    center
}

/// The vector product, and for each of its coordinates the sum of what its products measure.
#[inline(always)]
fn cross_with_size<S: Simd>(a: Axes<S>, b: Axes<S>) -> (Axes<S>, Axes<S>) {
    let plus = [a[1] * b[2], a[2] * b[0], a[0] * b[1]];
    let minus = [a[2] * b[1], a[0] * b[2], a[1] * b[0]];
    let size = [
        plus[0].abs() + minus[0].abs(),
        plus[1].abs() + minus[1].abs(),
        plus[2].abs() + minus[2].abs(),
    ];
    (subtract(plus, minus), size)
}

/// Where two points are equal.
#[inline(always)]
fn coincide<S: Simd>(a: Axes<S>, b: Axes<S>) -> mask32x16<S> {
    a[0].simd_eq(b[0]) & a[1].simd_eq(b[1]) & a[2].simd_eq(b[2])
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::super::cone_sphere::SphereBlock;
    use super::super::{SimdLevel, dispatch};
    use super::*;
    use crate::{Sphere, transform_point};

    /// Coordinates of all magnitudes, with many that coincide or are not finite.
    fn coordinate() -> impl Strategy<Value = f32> {
        prop_oneof![
            4 => -1.0..1.0_f32,
            2 => (-2..3_i8).prop_map(f32::from),
            2 => any::<f32>(),
            1 => (-1.0..1.0_f32, -45..38_i32).prop_map(|(x, e)| x * 10.0_f32.powi(e)),
        ]
    }

    fn point() -> impl Strategy<Value = Vec3> {
        prop::array::uniform3(coordinate()).prop_map(Vec3::from)
    }

    /// Triangles of any shape: needles, slivers that miss a line by a rounding unit, points.
    fn triangle() -> impl Strategy<Value = [Vec3; 3]> {
        let on_line = (point(), point(), -2.0..3.0_f32).prop_map(|(a, b, t)| [a, b, a.lerp(b, t)]);
        let needle = (point(), point(), point(), -40..0_i32)
            .prop_map(|(a, b, c, e)| [a, b, b + c * 10.0_f32.powi(e)]);
        prop_oneof![prop::array::uniform3(point()), on_line, needle]
    }

    /// A block of triangles at every level, with what `f` makes of it.
    fn at_every_level<T>(
        triangles: &[[Vec3; 3]],
        f: impl Fn(SimdLevel, &TriangleBlock) -> T,
    ) -> Vec<T> {
        let mut block = TriangleBlock::EMPTY;
        for (lane, corners) in triangles.iter().enumerate() {
            block.set(lane, *corners);
        }
        SimdLevel::available().into_iter().map(|level| f(level, &block)).collect()
    }

    fn same_bits(a: Vec3, b: Vec3) -> bool {
        let same = |(a, b): (f32, f32)| a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan());
        a.to_array().into_iter().zip(b.to_array()).all(same)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2000))]

        #[test]
        fn nothing_degenerate_is_certainly_solid(
            triangles in prop::collection::vec(triangle(), LANES),
        ) {
            let solid = at_every_level(&triangles, |level, block| {
                dispatch!(level.level(), simd => {
                    let triangles = TriangleLanes::load(simd, block);
                    let certain = triangles.certainly_solid(simd).to_bitmask();
                    (certain, triangles.solid(simd).to_bitmask())
                })
            });
            for (certain, solid) in solid {
                for (lane, corners) in triangles.iter().enumerate() {
                    let is_certain = certain & (1 << lane) != 0;
                    let is_degenerate = is_degenerate_triangle(*corners);
                    prop_assert!(!(is_certain && is_degenerate), "{corners:?}");
                    prop_assert_eq!(solid & (1 << lane) != 0, !is_degenerate, "{:?}", corners);
                }
            }
        }

        #[test]
        fn corners_are_transformed_to_the_bit(
            triangles in prop::collection::vec(triangle(), LANES),
            columns in prop::array::uniform4(point()),
        ) {
            let [x, y, z, translation] = columns.map(Into::into);
            let transform = Affine3A::from_cols(x, y, z, translation);
            let images = at_every_level(&triangles, |level, block| {
                let mut image = TriangleBlock::EMPTY;
                dispatch!(level.level(), simd => {
                    let lanes = TriangleLanes::load(simd, block);
                    lanes.transformed(simd, &transform).store(&mut image);
                });
                image
            });
            for image in images {
                for (lane, corners) in triangles.iter().enumerate() {
                    for (found, corner) in image.get(lane).into_iter().zip(corners) {
                        prop_assert!(same_bits(found, transform_point(&transform, *corner)));
                    }
                }
            }
        }

        #[test]
        fn spheres_are_those_of_single_triangles(
            triangles in prop::collection::vec(prop::array::uniform3(
                prop::array::uniform3(-1e3..1e3_f32).prop_map(Vec3::from)), LANES),
        ) {
            let blocks = at_every_level(&triangles, |level, block| {
                let mut spheres = SphereBlock::EMPTY;
                dispatch!(level.level(), simd => {
                    TriangleLanes::load(simd, block).spheres(simd).store(&mut spheres);
                });
                spheres
            });
            for block in blocks {
                for (lane, &[a, b, c]) in triangles.iter().enumerate() {
                    prop_assert_eq!(block.get(lane), Sphere::around_triangle(a, b, c));
                }
            }
        }
    }

    #[test]
    fn most_triangles_are_certainly_solid_whatever_their_size() {
        for scale in [1e-15, 1e-6, 1.0, 1e6, 1e15] {
            let corners = [Vec3::ZERO, Vec3::new(1.0, 0.1, 0.0), Vec3::new(0.0, 1.0, -0.3)];
            let triangles = [corners.map(|corner| scale * corner + scale * Vec3::ONE); LANES];
            let solid = at_every_level(&triangles, |level, block| {
                dispatch!(level.level(), simd => {
                    TriangleLanes::load(simd, block).certainly_solid(simd).to_bitmask()
                })
            });
            assert!(solid.iter().all(|&solid| solid == 0xffff), "scale {scale}");
        }
    }

    #[test]
    fn nothing_touches_a_triangle_without_extent() {
        let spheres = at_every_level(&[[Vec3::ONE; 3]], |level, block| {
            let mut spheres = SphereBlock::EMPTY;
            dispatch!(level.level(), simd => {
                TriangleLanes::load(simd, block).spheres(simd).store(&mut spheres);
            });
            spheres
        });
        assert!(spheres.iter().all(|block| block.radius == [f32::NEG_INFINITY; LANES]));
    }
}
