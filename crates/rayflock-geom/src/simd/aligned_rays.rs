//! Prepares sixteen rays for trees of boxes over triangles.
//!
//! Coordinates are brought into the order kx, ky, kz of the accepting test
//! ([`ray_triangle`](super::ray_triangle)): rays whose directions go through the same face of a
//! cube share it, and boxes and triangles loaded in that order serve all of them.
//!
//! **Invariants.** `shear` has the bits of [`ShearedRay`](super::ray_triangle::ShearedRay).
//!
//! **Cost.** Five divisions and some eighty operations for sixteen rays.

use glam::Vec3;

use super::axes::{Axes, absolute, largest, load_axes, splat_axes, store_axes, subtract};
use super::ray_boxes::{
    BoxBounds, BoxRay, COARSEST_T, LARGEST_DISTANCE, SMALLEST_SIZE, THINNEST, UNDERFLOW,
};
use super::ray_lanes::RayLanes;
use super::{LANES, Lanes, Select, Simd, SimdBase, SimdFloat, SimdMask, f32x16, mask32x16, u32x16};

/// Faces of a cube: two for each axis kz, directions along it first.
pub const FACES: usize = 6;

/// The axes kx, ky, kz of directions through a face.
pub const fn face_axes(face: usize) -> [usize; 3] {
    match face / 2 {
        0 => [1, 2, 0],
        1 => [2, 0, 1],
        _ => [0, 1, 2],
    }
}

/// Whether directions through a face go along the axis kz, not against it.
pub const fn goes_along(face: usize) -> bool {
    face.is_multiple_of(2)
}

/// Sixteen prepared rays as columns; those of lanes that are not active hold anything.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub struct AlignedRays {
    pub(super) origin: [Lanes; 3],
    pub(super) shear: [Lanes; 3],
    pub(super) inverse: [Lanes; 3],
    pub(super) margin: Lanes,
    /// Ends of the interval in multiples of the scaled direction.
    pub(super) t_min: Lanes,
    pub(super) t_max: Lanes,
    pub(super) faces: [u32; LANES],
}

impl AlignedRays {
    /// Prepares rays for boxes within `bounds`; also tells which of the rays may cross that, one
    /// bit a lane. `slack` is relative to the distances at hand, at least
    /// [`SLACK`](super::cone_sphere::SLACK).
    #[inline(always)]
    pub fn prepare<S: Simd>(
        simd: S,
        rays: &RayLanes,
        bounds: &BoxBounds,
        slack: f32,
    ) -> (Self, u64) {
        let splat = f32x16::splat;
        let (origin, direction) = (load_axes(simd, &rays.origin), load_axes(simd, &rays.direction));
        let order = Order::of(direction);
        let (size, ordered) = (order.size, order.apply(direction));
        let shear = [ordered[0] / ordered[2], ordered[1] / ordered[2], ordered[2]];

        // The margin by which boxes must be enlarged; infinite where quotients might be.
        let to_center = absolute(subtract(splat_axes(simd, bounds.center), origin));
        let half_size = splat_axes(simd, bounds.half_size);
        let farthest = largest([
            to_center[0] + half_size[0],
            to_center[1] + half_size[1],
            to_center[2] + half_size[2],
        ]);
        let coarsest = (size * COARSEST_T).max(splat(simd, 1.0)) * UNDERFLOW;
        let plain_margin = splat(simd, slack) * farthest + coarsest;
        let in_range = farthest.simd_le(splat(simd, LARGEST_DISTANCE))
            & size.simd_ge(splat(simd, SMALLEST_SIZE));

        let margin = in_range.select(plain_margin, splat(simd, f32::INFINITY));
        let (t_min, t_max) = (
            f32x16::from_slice(simd, &rays.t_min) * size,
            f32x16::from_slice(simd, &rays.t_max) * size,
        );

        let mut prepared = Self {
            margin: *margin,
            t_min: *t_min,
            t_max: *t_max,
            faces: *order.faces(simd, ordered[2]),
            ..Self::EMPTY
        };
        let to_center = order.apply(subtract(splat_axes(simd, bounds.center), origin));
        let half_size = order.apply(half_size);
        let (mut near, mut far) = (t_min, t_max);
        for (axis, column) in prepared.inverse.iter_mut().enumerate() {
            let inverse = inverse(simd, ordered[axis], size);
            let inverse = in_range.select(inverse, splat(simd, 1.0));
            inverse.store_slice(column);
            let middle = to_center[axis] * inverse;
            let reach = (half_size[axis] + margin) * inverse.abs();
            (near, far) = (near.max(middle - reach), far.min(middle + reach));
        }
        store_axes(&order.apply(origin), &mut prepared.origin);
        store_axes(&shear, &mut prepared.shear);
        (prepared, (!near.simd_gt(far)).to_bitmask())
    }

    const EMPTY: Self = Self {
        origin: [[0.0; LANES]; 3],
        shear: [[0.0; LANES]; 3],
        inverse: [[0.0; LANES]; 3],
        margin: [0.0; LANES],
        t_min: [0.0; LANES],
        t_max: [0.0; LANES],
        faces: [0; LANES],
    };

    /// The face of a cube that a ray's direction goes through.
    #[inline(always)]
    pub fn face(&self, lane: usize) -> usize {
        self.faces[lane] as usize
    }

    /// The origin of a ray, in the order of its axes.
    #[inline(always)]
    pub fn origin(&self, lane: usize) -> Vec3 {
        Vec3::new(self.origin[0][lane], self.origin[1][lane], self.origin[2][lane])
    }

    /// sx, sy and `d[kz]` of a ray.
    #[inline(always)]
    pub fn shear(&self, lane: usize) -> [f32; 3] {
        [self.shear[0][lane], self.shear[1][lane], self.shear[2][lane]]
    }

    /// A ray as boxes in the order of its axes need it.
    #[inline(always)]
    pub fn box_ray(&self, lane: usize) -> BoxRay {
        BoxRay {
            inverse: [self.inverse[0][lane], self.inverse[1][lane], self.inverse[2][lane]],
            margin: self.margin[lane],
            t_min: self.t_min[lane],
            t_max: self.t_max[lane],
        }
    }
}

/// The inverse of a direction's coordinate in one whose largest, without its sign, is `size`.
#[inline(always)]
pub(super) fn inverse<S: Simd>(simd: S, coordinate: f32x16<S>, size: f32x16<S>) -> f32x16<S> {
    let thinnest = f32x16::splat(simd, THINNEST) * size;
    size / coordinate.abs().max(thinnest).copysign(coordinate)
}

/// The margin of a ray from which nothing is farther away than `farthest`.
#[inline(always)]
pub(super) fn margin(farthest: f32, size: f32, slack: f32) -> f32 {
    slack * farthest + (size * COARSEST_T).max(1.0) * UNDERFLOW
}

/// Which axis is kz, the first of those with the largest coordinate.
#[derive(Clone, Copy)]
pub(super) struct Order<S: Simd> {
    is_z: mask32x16<S>,
    /// Where it is not z.
    is_y: mask32x16<S>,
    /// The largest coordinate, without its sign.
    pub(super) size: f32x16<S>,
}

impl<S: Simd> Order<S> {
    /// The order for these directions.
    #[inline(always)]
    pub(super) fn of(direction: Axes<S>) -> Self {
        let [x, y, z] = absolute(direction);
        let is_y = y.simd_gt(x);
        let of_two = is_y.select(y, x);
        let is_z = z.simd_gt(of_two);
        Self { is_z, is_y, size: is_z.select(z, of_two) }
    }

    /// Brings coordinates into the order kx, ky, kz.
    #[inline(always)]
    pub(super) fn apply(self, [x, y, z]: Axes<S>) -> Axes<S> {
        let Self { is_z, is_y, .. } = self;
        [
            is_z.select(x, is_y.select(z, y)),
            is_z.select(y, is_y.select(x, z)),
            is_z.select(z, is_y.select(y, x)),
        ]
    }

    /// The faces of directions with these coordinates along kz.
    #[inline(always)]
    pub(super) fn faces(self, simd: S, along: f32x16<S>) -> u32x16<S> {
        let splat = |face: u32| u32x16::splat(simd, face);
        let axis = self.is_z.select(splat(4), self.is_y.select(splat(2), splat(0)));
        let against = along.simd_lt(f32x16::splat(simd, 0.0));
        axis + against.select(splat(1), splat(0))
    }
}

#[cfg(test)]
mod tests {
    use super::super::ray_triangle::ShearedRay;
    use super::super::{SimdLevel, dispatch};
    use super::*;
    use crate::{Ray, RayState};

    /// Rays with every axis the largest, ties, and all that makes a ray invalid or inactive.
    fn rays() -> Vec<Ray> {
        let odd = [0.0, -0.0, 1.0, -1.0, 2.5, f32::NAN, f32::INFINITY, 1e-40, -3e38];
        let mut rays = Vec::new();
        for x in odd {
            for y in odd {
                for z in odd {
                    rays.push(Ray::new(Vec3::new(1.0, 2.0, 3.0), Vec3::new(x, y, z)));
                }
            }
        }
        let ray = Ray::new(Vec3::ZERO, Vec3::X);
        rays.extend(odd.map(|coordinate| Ray { origin: Vec3::new(0.0, coordinate, 1.0), ..ray }));
        rays.extend(odd.map(|t_min| Ray { t_min, ..ray }));
        rays.extend(odd.map(|t_max| Ray { t_max, ..ray }));
        rays
    }

    #[test]
    fn states_and_shears_are_those_of_single_rays() {
        let bounds = BoxBounds::between(Vec3::NEG_ONE, Vec3::ONE);
        let rays = rays();
        let levels = SimdLevel::available();
        let pieces = levels.iter().flat_map(|&l| rays.chunks(LANES).map(move |chunk| (l, chunk)));
        for (level, chunk) in pieces {
            let mut lanes = RayLanes {
                origin: [[0.0; LANES]; 3],
                direction: [[1.0; LANES]; 3],
                t_min: [0.0; LANES],
                t_max: [0.0; LANES],
            };
            for (lane, ray) in chunk.iter().enumerate() {
                for axis in 0..3 {
                    lanes.origin[axis][lane] = ray.origin[axis];
                    lanes.direction[axis][lane] = ray.direction[axis];
                }
                (lanes.t_min[lane], lanes.t_max[lane]) = (ray.t_min, ray.t_max);
            }
            let ((active, invalid), prepared) = dispatch!(level.level(), simd => {
                (lanes.states(simd), AlignedRays::prepare(simd, &lanes, &bounds, 1e-5).0)
            });
            for (lane, ray) in chunk.iter().enumerate() {
                let (is_active, is_invalid) = (active >> lane & 1 == 1, invalid >> lane & 1 == 1);
                assert_eq!(is_active, ray.state() == RayState::Active, "{level}: {ray:?}");
                assert_eq!(is_invalid, ray.state() == RayState::Invalid, "{level}: {ray:?}");
                if is_active {
                    let ShearedRay { axes, shear, .. } = ShearedRay::new(ray);
                    let face = prepared.face(lane);
                    assert_eq!(face_axes(face), axes, "{level}: {ray:?}");
                    assert_eq!(goes_along(face), shear[2] > 0.0);
                    assert_eq!(prepared.shear(lane).map(f32::to_bits), shear.map(f32::to_bits));
                    assert_eq!(prepared.origin(lane), axes.map(|axis| ray.origin[axis]).into());
                }
            }
        }
    }
}
