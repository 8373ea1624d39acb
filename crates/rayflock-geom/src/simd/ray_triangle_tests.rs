use glam::Vec3;
use proptest::prelude::*;

use super::super::{SimdLevel, dispatch};
use super::*;

type Answer = Option<[u32; 3]>;

/// The answer of the block kernel at one level.
fn by_block(level: SimdLevel, ray: &Ray, corners: [Vec3; 3], lane: usize) -> Answer {
    let mut block = TriangleBlock::EMPTY;
    block.set(lane, corners);
    let sheared = ShearedRay::new(ray);
    dispatch!(level.level(), simd => {
        let active = mask32x16::splat(simd, true);
        answer(lane, intersect_block(simd, &sheared, &block, active))
    })
}

/// The answer of the packet kernel at one level, with one major axis in all lanes or several.
fn by_packet(level: SimdLevel, ray: &Ray, corners: [Vec3; 3], lane: usize, mixed: bool) -> Answer {
    let sheared = ShearedRay::new(ray);
    let mut packet = RayPacket::EMPTY;
    for other in 0..16 {
        packet.set(other, &ShearedRay { t_max: f32::NEG_INFINITY, ..sheared });
    }
    if mixed {
        packet.major = [0x00f0, 0x0f00];
    }
    packet.set(lane, &sheared);
    dispatch!(level.level(), simd => {
        let active = mask32x16::splat(simd, true);
        answer(lane, intersect_packet(simd, &packet, &corners, active))
    })
}

/// The answer of the block kernel on triangles loaded for the axes of the ray.
fn by_aligned(level: SimdLevel, ray: &Ray, corners: [Vec3; 3], lane: usize) -> Answer {
    let mut block = TriangleBlock::EMPTY;
    block.set(lane, corners);
    let ShearedRay { origin, axes, shear, t_min, t_max } = ShearedRay::new(ray);
    let origin = Vec3::from(axes.map(|axis| origin[axis]));
    dispatch!(level.level(), simd => {
        let block = AlignedBlock::load(simd, &block, axes);
        let active = mask32x16::splat(simd, true);
        let interval = [t_min, t_max];
        answer(lane, intersect_aligned(simd, origin, shear, interval, &block, active))
    })
}

#[inline(always)]
fn answer<S: Simd>(lane: usize, hits: LaneHits<S>) -> Answer {
    let [u, v] = hits.barycentric();
    hits.accepted.test(lane).then(|| [hits.t[lane], u[lane], v[lane]].map(f32::to_bits))
}

/// The answer that all kernels at all levels give; they must agree.
fn hit(ray: &Ray, corners: [Vec3; 3]) -> Option<[f32; 3]> {
    let reference = by_block(SimdLevel::best(), ray, corners, 3);
    for level in SimdLevel::available() {
        assert_eq!(by_block(level, ray, corners, 11), reference, "block at {level}");
        assert_eq!(by_aligned(level, ray, corners, 4), reference, "aligned block at {level}");
        assert_eq!(by_packet(level, ray, corners, 0, false), reference, "packet at {level}");
        assert_eq!(by_packet(level, ray, corners, 15, true), reference, "mixed packet at {level}");
    }
    reference.map(|bits| bits.map(f32::from_bits))
}

const UNIT: [Vec3; 3] = [Vec3::ZERO, Vec3::X, Vec3::Y];

#[test]
fn barycentric_coordinates_follow_the_definition() {
    let ray = Ray::new(Vec3::new(0.25, 0.5, 3.0), -2.0 * Vec3::Z);
    assert_eq!(hit(&ray, UNIT), Some([1.5, 0.25, 0.5]));
    let back = Ray::new(Vec3::new(0.25, 0.5, -3.0), 2.0 * Vec3::Z);
    assert_eq!(hit(&back, UNIT), Some([1.5, 0.25, 0.5]));
}

#[test]
fn corners_edges_and_interval_ends_belong() {
    let down = |x, y| Ray::new(Vec3::new(x, y, 1.0), -Vec3::Z);
    for (x, y) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (0.5, 0.5), (0.5, 0.0), (0.0, 0.5)] {
        let outcome = hit(&Ray { t_min: 1.0, t_max: 1.0, ..down(x, y) }, UNIT);
        assert_eq!(outcome, Some([1.0, x, y]));
    }
    assert_eq!(hit(&down(-1e-30, 0.5), UNIT), None);
    assert_eq!(hit(&Ray { t_max: 0.999, ..down(0.2, 0.2) }, UNIT), None);
    assert_eq!(hit(&Ray { t_min: 1.001, ..down(0.2, 0.2) }, UNIT), None);
    assert_eq!(hit(&Ray::new(Vec3::new(-1.0, 0.0, 0.0), Vec3::X), UNIT), None, "in the plane");
}

#[test]
fn extreme_sizes_are_hit_in_the_middle() {
    for exponent in [-36, -30, -20, 0, 20, 30, 36] {
        let scale = 10.0_f32.powi(exponent);
        let corners = UNIT.map(|corner| scale * corner);
        for length in [1e-30, 1.0, 1e30] {
            let origin = scale * Vec3::new(0.25, 0.25, 1.0);
            let expected = scale / length;
            let outcome = hit(&Ray::new(origin, -length * Vec3::Z), corners);
            if expected.is_finite() && expected > f32::MIN_POSITIVE {
                let [t, u, v] = outcome.unwrap();
                assert!((t / expected - 1.0).abs() < 1e-6, "scale {scale} length {length}: {t}");
                assert!((u - 0.25).abs() < 1e-6 && (v - 0.25).abs() < 1e-6);
            }
        }
    }
}

fn vector() -> impl Strategy<Value = Vec3> {
    let coordinate = prop_oneof![4 => -2.0..2.0_f32, 1 => Just(0.0_f32), 1 => Just(1.0_f32)];
    prop::array::uniform3(coordinate).prop_map(Vec3::from)
}

/// How far the line of the ray passes from the triangle.
fn distance(ray: &Ray, corners: [Vec3; 3]) -> f64 {
    let direction = ray.direction.as_dvec3().normalize();
    let [a, b, c] = corners.map(|corner| {
        let relative = corner.as_dvec3() - ray.origin.as_dvec3();
        relative - relative.dot(direction) * direction
    });
    let edges = [[a, b], [b, c], [c, a]];
    let sides = edges.map(|[from, to]| from.cross(to).dot(direction));
    if sides.iter().all(|&side| side >= 0.0) || sides.iter().all(|&side| side <= 0.0) {
        return 0.0;
    }
    let to_edge = edges.map(|[from, to]| {
        let edge = to - from;
        let along = (-from.dot(edge) / edge.length_squared().max(1e-300)).clamp(0.0, 1.0);
        (from + along * edge).length()
    });
    to_edge.into_iter().fold(f64::INFINITY, f64::min)
}

proptest! {
    /// A ray at an edge that is accepted passes within the perturbation.
    #[test]
    fn accepted_rays_pass_within_the_perturbation(
        origin in vector(), corners in prop::array::uniform3(vector()), along in 0.0..1.0_f32,
    ) {
        let [a, b, _] = corners;
        let direction = a + along * (b - a) - origin;
        prop_assume!(direction.length() > 1e-2);
        let ray = Ray { t_min: f32::NEG_INFINITY, ..Ray::new(origin, direction) };
        if hit(&ray, corners).is_some() {
            let size = corners.map(|corner| (corner - origin).abs().max_element());
            let size = size[0].max(size[1]).max(size[2]);
            let distance = distance(&ray, corners);
            prop_assert!(distance <= f64::from(PERTURBATION * size), "{distance} of {size}");
        }
    }

    #[test]
    fn all_kernels_agree_and_points_reproduce(
        origin in vector(), direction in vector(), corners in prop::array::uniform3(vector()),
    ) {
        prop_assume!(direction != Vec3::ZERO);
        let ray = Ray { t_min: -10.0, ..Ray::new(origin, direction) };
        if let Some([t, u, v]) = hit(&ray, corners) {
            let [a, b, c] = corners;
            let on_triangle = (1.0 - u - v) * a + u * b + v * c;
            let error = (ray.at(t) - on_triangle).length();
            prop_assert!(error < 1e-4 * (1.0 + t.abs()), "{error}");
            prop_assert!(u >= 0.0 && v >= 0.0 && u + v <= 1.0 + 1e-6);
        }
    }

    /// A ray at the edge that two triangles share hits one of them, or both.
    #[test]
    fn shared_edges_leave_no_gap(
        origin in vector(), a in vector(), b in vector(), c in vector(), d in vector(),
        along in 0.01..0.99_f32,
    ) {
        let direction = a + along * (b - a) - origin;
        let normal = (b - a).cross(direction);
        let (left, right) = (normal.dot(c - a), normal.dot(d - a));
        prop_assume!(normal.length() > 1e-2 && direction.length() > 1e-2);
        prop_assume!(left * right < 0.0 && left.abs().min(right.abs()) > 1e-3);
        let ray = Ray { t_min: f32::NEG_INFINITY, ..Ray::new(origin, direction) };
        prop_assert!(hit(&ray, [a, b, c]).is_some() || hit(&ray, [b, a, d]).is_some());
    }
}
