use proptest::prelude::*;

use super::super::aligned_rays::{AlignedRays, face_axes};
use super::super::cone_sphere::{SLACK, SphereBlock};
use super::super::neighbours::Neighbours;
use super::super::ray_beams::{BoxCorners, beam_crosses};
use super::super::ray_lanes::RayLanes;
use super::super::ray_sphere::{SphereRays, intersect_sphere};
use super::super::ray_triangle::{ShearedRay, TriangleBlock, intersect_block};
use super::super::triangle_boxes::{
    around_spheres, around_triangles, sphere_boxes, triangle_corners,
};
use super::super::{SimdLevel, SimdMask, dispatch};
use super::*;
use crate::{Ray, Sphere};

const LANE: usize = 6;

/// Where the accepting test hits, if it does.
fn hit_triangle(ray: &Ray, corners: [Vec3; 3]) -> Option<f32> {
    let mut block = TriangleBlock::EMPTY;
    block.set(LANE, corners);
    dispatch!(SimdLevel::best().level(), simd => {
        let active = mask32x16::splat(simd, true);
        let hits = intersect_block(simd, &ShearedRay::new(ray), &block, active);
        hits.accepted.test(LANE).then(|| hits.t[LANE])
    })
}

fn hit_sphere(ray: &Ray, sphere: &Sphere) -> Option<f32> {
    let mut rays = SphereRays::EMPTY;
    rays.set(LANE, ray);
    dispatch!(SimdLevel::best().level(), simd => {
        let active = mask32x16::splat(simd, true);
        let (accepted, t) = intersect_sphere(simd, &rays, sphere, active);
        accepted.test(LANE).then(|| t[LANE])
    })
}

/// What is in the boxes.
#[derive(Clone, Copy, Debug)]
enum Content {
    Triangle([Vec3; 3]),
    Sphere(Sphere),
}

/// As leaves of a tree have it.
#[expect(clippy::large_enum_variant, reason = "there is one at a time")]
enum Leaf {
    Triangles(TriangleBlock),
    Spheres(SphereBlock),
}

impl Content {
    /// In all lanes.
    fn leaf(&self) -> Leaf {
        match *self {
            Self::Triangle(corners) => {
                let mut triangles = TriangleBlock::EMPTY;
                (0..16).for_each(|lane| triangles.set(lane, corners));
                Leaf::Triangles(triangles)
            }
            Self::Sphere(sphere) => {
                let mut spheres = SphereBlock::EMPTY;
                (0..16).for_each(|lane| spheres.set(lane, &sphere));
                Leaf::Spheres(spheres)
            }
        }
    }
}

impl Leaf {
    /// The box around all.
    #[inline(always)]
    fn bounds<S: Simd>(&self, simd: S) -> BoxBounds {
        match self {
            Self::Triangles(triangles) => around_triangles(simd, triangles),
            Self::Spheres(spheres) => around_spheres(simd, spheres),
        }
    }

    /// The boxes around each, as beams ask about them.
    #[inline(always)]
    fn corners<S: Simd>(&self, simd: S, axes: [usize; 3]) -> BoxCorners<S> {
        match self {
            Self::Triangles(triangles) => triangle_corners(simd, triangles, axes),
            Self::Spheres(spheres) => BoxCorners::of(&sphere_boxes(simd, spheres, axes)),
        }
    }
}

/// Whether the box in the middle of larger bounds is crossed, at every level; levels may differ.
fn crossed(ray: &Ray, content: Content, room: &BoxBounds) -> Vec<bool> {
    let leaf = content.leaf();
    let at_level = |level: SimdLevel| {
        dispatch!(level.level(), simd => {
            let bounds = leaf.bounds(simd);
            let mut block = BoxBlock::ZERO;
            block.set(LANE, &bounds);
            // As a node of a tree has it.
            let mut parent = block;
            parent.set(0, &bounds);
            parent.pad(1);
            parent.set(LANE, &parent.around(simd));
            let (origin, prepared, axes, crosses_all) = prepare(simd, ray, &bounds.union(room));
            let is_crossed =
                |boxes: &BoxLanes<_>| crosses(simd, origin, &prepared, boxes).test(LANE);
            let crosses_own = match &leaf {
                Leaf::Triangles(_) => true,
                Leaf::Spheres(spheres) => is_crossed(&sphere_boxes(simd, spheres, axes)),
            };
            let [block, parent] = [block, parent].map(|block| block.load(simd, axes));
            crosses_all && crosses_own && is_crossed(&block) && is_crossed(&parent)
        })
    };
    SimdLevel::available().into_iter().map(at_level).collect()
}

/// Prepares a ray for boxes within some bounds; also tells its origin in the order of its axes, and
/// whether it may cross the bounds.
#[inline(always)]
fn prepare<S: Simd>(simd: S, ray: &Ray, bounds: &BoxBounds) -> (Vec3, BoxRay, [usize; 3], bool) {
    let rays = RayLanes {
        origin: ray.origin.to_array().map(|coordinate| [coordinate; 16]),
        direction: ray.direction.to_array().map(|coordinate| [coordinate; 16]),
        t_min: [ray.t_min; 16],
        t_max: [ray.t_max; 16],
    };
    let (prepared, crossing) = AlignedRays::prepare(simd, &rays, bounds, SLACK);
    let axes = face_axes(prepared.face(LANE));
    (prepared.origin(LANE), prepared.box_ray(LANE), axes, crossing & (1 << LANE) != 0)
}

/// Whether the beam around the ray and fifteen others, of which each lies a little farther off by
/// `apart`, crosses the box around what a leaf holds and the box around each, at every level. True
/// where they make no beam.
fn beam_crosses_content(ray: &Ray, apart: [Vec3; 2], content: Content, room: &BoxBounds) -> bool {
    let mut rays = RayLanes {
        origin: [[0.0; 16]; 3],
        direction: [[0.0; 16]; 3],
        t_min: [ray.t_min; 16],
        t_max: [ray.t_max; 16],
    };
    for lane in 0..16 {
        let steps = (lane as f32 - LANE as f32) * 0.01;
        let (origin, direction) = (ray.origin + steps * apart[0], ray.direction + steps * apart[1]);
        for axis in 0..3 {
            rays.origin[axis][lane] = origin[axis];
            rays.direction[axis][lane] = direction[axis];
        }
    }
    let leaf = content.leaf();
    SimdLevel::available().into_iter().all(|level| {
        dispatch!(level.level(), simd => {
            let bounds = leaf.bounds(simd);
            let neighbours = Neighbours::of(simd, &rays);
            let slopes = neighbours.slopes(simd, neighbours.face(LANE));
            let axes = face_axes(slopes.face());
            let mut block = BoxBlock::ZERO;
            block.set(LANE, &bounds);
            // The ray itself is the first of its kind.
            let lanes = rays.states(simd).0 & (u64::MAX << LANE);
            let lanes = neighbours.alike(simd, lanes, f32::INFINITY) | 1 << LANE;
            let beam = neighbours.beam(simd, &slopes, lanes, &bounds.union(room), SLACK);
            beam.is_none_or(|beam| {
                let boxes = BoxCorners::of(&block.load(simd, axes));
                let own = leaf.corners(simd, axes);
                beam_crosses(simd, &beam, &boxes).test(LANE)
                    && beam_crosses(simd, &beam, &own).test(LANE)
            })
        })
    })
}

/// Bounds of something else, as they might lie around a box.
fn room(a: Vec3, b: Vec3) -> BoxBounds {
    BoxBounds::between(a.min(b), a.max(b))
}

/// A ray that reaches just as far as `t`.
fn reaching(ray: &Ray, t: f32) -> Ray {
    Ray { t_min: t, t_max: t, ..*ray }
}

fn vector() -> impl Strategy<Value = Vec3> {
    let coordinate = prop_oneof![4 => -2.0..2.0_f32, 1 => Just(0.0_f32), 1 => Just(1.0_f32)];
    prop::array::uniform3(coordinate).prop_map(Vec3::from)
}

/// Coordinates of very different sizes, zeros of both signs included.
fn uneven_vector() -> impl Strategy<Value = Vec3> {
    let exponent = prop_oneof![2 => Just(0), 2 => -12..-6_i32, 1 => -40..0_i32];
    let coordinate = prop_oneof![
        6 => (-2.0..2.0_f32, exponent).prop_map(|(x, e)| x * 10.0_f32.powi(e)),
        1 => Just(0.0_f32),
        1 => Just(-0.0_f32),
    ];
    prop::array::uniform3(coordinate).prop_map(Vec3::from)
}

fn scale() -> impl Strategy<Value = f32> {
    prop_oneof![4 => Just(0), 2 => -6..6_i32, 1 => -36..36_i32].prop_map(|e| 10.0_f32.powi(e))
}

/// Far from the world's origin, in units of the size of things.
fn offset() -> impl Strategy<Value = f32> {
    prop_oneof![2 => Just(0.0_f32), 1 => Just(30.0_f32), 1 => Just(1e4_f32), 1 => Just(1e6_f32)]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4000))]

    /// Rays at an edge or the inside of a triangle, from near, far and within its plane.
    #[test]
    fn boxes_of_hit_triangles_are_crossed(
        corners in prop::array::uniform3(vector()), flat in prop_oneof![Just(1.0_f32), Just(1e-4)],
        origin in vector(), away in prop_oneof![3 => Just(1.0_f32), 1 => Just(1e3), 1 => Just(1e-3)],
        weights in [0.0..1.0_f32, 0.0..1.0_f32], at_edge in any::<bool>(),
        (scale, length, offset) in (scale(), scale(), offset()),
        others in [vector(), vector()], straight in any::<bool>(), noise in uneven_vector(),
    ) {
        let place = |v: Vec3| scale * (v * Vec3::new(1.0, 1.0, flat) + Vec3::splat(offset));
        let corners = corners.map(place);
        let origin = place(away * origin);
        let along = if at_edge { 0.0 } else { weights[1] };
        let target = corners[0].lerp(corners[1], weights[0]).lerp(corners[2], along);
        let aimed = (target - origin) / scale;
        let direction = length * if straight { aimed } else { aimed + 1e-5 * noise };
        let ray = Ray { t_min: f32::NEG_INFINITY, ..Ray::new(origin, direction) };
        prop_assume!(ray.state() == crate::RayState::Active);
        if let Some(t) = hit_triangle(&ray, corners) {
            let (content, room) = (Content::Triangle(corners), room(place(others[0]), place(others[1])));
            for ray in [ray, reaching(&ray, t), Ray { t_max: t, ..ray }, Ray { t_min: t, ..ray }] {
                let crossed = crossed(&ray, content, &room);
                prop_assert!(crossed.iter().all(|&crossed| crossed), "{ray:?} {corners:?}");
                let apart = [scale * others[0], length * others[1]];
                prop_assert!(beam_crosses_content(&ray, apart, content, &room), "{ray:?}");
            }
        }
    }

    /// Axis-parallel and nearly axis-parallel rays that graze a box of no thickness.
    #[test]
    fn boxes_of_triangles_hit_along_an_axis_are_crossed(
        corners in prop::array::uniform3(vector()), direction in uneven_vector(),
        weights in [0.0..1.0_f32, 0.0..1.0_f32], back in -50.0..50.0_f32,
        (scale, length, offset) in (scale(), scale(), offset()), others in [vector(), vector()],
    ) {
        let place = |v: Vec3| scale * (v + Vec3::splat(offset));
        prop_assume!(direction != Vec3::ZERO);
        let direction = direction / direction.abs().max_element();
        let target = corners[0].lerp(corners[1], weights[0]).lerp(corners[2], weights[1]);
        let origin = place(target - back * direction);
        let ray = Ray { t_min: f32::NEG_INFINITY, ..Ray::new(origin, length * direction) };
        prop_assume!(ray.state() == crate::RayState::Active);
        let corners = corners.map(place);
        if let Some(t) = hit_triangle(&ray, corners) {
            let room = room(place(others[0]), place(others[1]));
            let ray = reaching(&ray, t);
            let content = Content::Triangle(corners);
            let crossed = crossed(&ray, content, &room);
            prop_assert!(crossed.iter().all(|&crossed| crossed), "{ray:?} {corners:?}");
            let apart = [scale * others[0], length * others[1]];
            prop_assert!(beam_crosses_content(&ray, apart, content, &room), "{ray:?}");
        }
    }

    #[test]
    fn boxes_of_hit_spheres_are_crossed(
        origin in vector(), center in vector(), radius in 1e-4..1.0_f32, beside in vector(),
        (scale, length, offset) in (scale(), scale(), offset()), others in [vector(), vector()],
    ) {
        let place = |v: Vec3| scale * (v + Vec3::splat(offset));
        let sphere = Sphere::new(place(center), scale * radius);
        let target = place(center + radius * beside.normalize_or(Vec3::X));
        let origin = place(origin);
        let direction = length / scale * (target - origin);
        let ray = Ray { t_min: f32::NEG_INFINITY, ..Ray::new(origin, direction) };
        prop_assume!(ray.state() == crate::RayState::Active);
        // What the accepting test promises to measure.
        prop_assume!(sphere.radius > 1e-18 && (sphere.center - origin).length() < 1e17);
        if let Some(t) = hit_sphere(&ray, &sphere) {
            let room = room(place(others[0]), place(others[1]));
            let (ray, content) = (reaching(&ray, t), Content::Sphere(sphere));
            let crossed = crossed(&ray, content, &room);
            prop_assert!(crossed.iter().all(|&crossed| crossed), "{ray:?} {sphere:?} at {t}");
            let apart = [scale * others[0], length * others[1]];
            prop_assert!(beam_crosses_content(&ray, apart, content, &room), "{ray:?} {sphere:?}");
        }
    }
}

#[test]
fn boxes_beside_behind_and_out_of_reach_are_not_crossed() {
    let down = Ray::new(Vec3::new(0.25, 0.25, 5.0), -2.0 * Vec3::Z);
    let unit = Content::Triangle([Vec3::ZERO, Vec3::X, Vec3::Y]);
    let is_crossed = |ray: Ray| {
        let all = crossed(&ray, unit, &room(Vec3::splat(3.0), Vec3::ONE));
        assert!(all.windows(2).all(|pair| pair[0] == pair[1]));
        all[0]
    };
    assert!(is_crossed(down));
    assert!(is_crossed(Ray { origin: Vec3::new(1.0, 1.0, 5.0), ..down }));
    assert!(!is_crossed(Ray { origin: Vec3::new(1.001, 0.5, 5.0), ..down }));
    assert!(!is_crossed(Ray { direction: Vec3::Z, ..down }));
    assert!(is_crossed(Ray { direction: Vec3::Z, t_min: -6.0, ..down }));
    assert!(!is_crossed(Ray { t_max: 2.49, ..down }));
    assert!(!is_crossed(Ray { t_min: 2.51, ..down }));
}

/// Rays and boxes too large for the arithmetic.
#[test]
fn what_is_out_of_range_is_crossed() {
    let huge = [Vec3::ZERO, 3e38 * Vec3::X, -3e38 * Vec3::Y];
    let unit = [Vec3::ZERO, Vec3::X, Vec3::Y];
    for (corners, origin) in [(huge, Vec3::Z), (unit, 3e38 * Vec3::ONE), (huge, -3e38 * Vec3::ONE)]
    {
        for direction in [Vec3::X, -1e-38 * Vec3::Y, 3e38 * Vec3::ONE] {
            let ray = Ray::new(origin, direction);
            let all = crossed(&ray, Content::Triangle(corners), &BoxBounds::default());
            assert!(all.iter().all(|&crossed| crossed));
        }
    }
}

#[test]
fn a_ray_cut_short_crosses_what_lies_nearer() {
    let mut block = BoxBlock::ZERO;
    let bounds = room(Vec3::new(-1.0, -1.0, 4.0), Vec3::new(1.0, 1.0, 5.0));
    block.set(0, &bounds);
    block.pad(1);
    let ray = Ray::new(Vec3::ZERO, 0.5 * Vec3::Z);
    let (origin, mut prepared, axes, _) =
        dispatch!(SimdLevel::best().level(), simd => prepare(simd, &ray, &bounds));
    let count = |prepared: &BoxRay| {
        dispatch!(SimdLevel::best().level(), simd => {
            let crossed = crosses(simd, origin, prepared, &block.load(simd, axes));
            crossed.to_bitmask().count_ones()
        })
    };
    assert_eq!(count(&prepared), 16);
    let size = 0.5;
    prepared.set_t_max(8.5, size);
    assert_eq!(count(&prepared), 16);
    prepared.set_t_max(7.9, size);
    assert_eq!(count(&prepared), 0);
    assert_eq!(count(&BoxRay::EMPTY), 0);
}

#[test]
fn a_beam_crosses_what_one_of_its_rays_does_and_nothing_beside() {
    let mut rays = RayLanes {
        origin: [[0.0; 16]; 3],
        direction: [[0.0; 16], [0.0; 16], [1.0; 16]],
        t_min: [0.0; 16],
        t_max: [10.0; 16],
    };
    (0..16).for_each(|lane| rays.origin[0][lane] = lane as f32 * 0.1);
    let mut block = BoxBlock::ZERO;
    for (lane, x) in [0.75, 1.7, -0.5].into_iter().enumerate() {
        let middle = Vec3::new(x, 0.0, 5.0);
        block.set(lane, &BoxBounds::between(middle - 0.1, middle + 0.1));
    }
    for level in SimdLevel::available() {
        let crossed = |t_max| {
            dispatch!(level.level(), simd => {
                let bounds = BoxBounds::between(Vec3::splat(-9.0), Vec3::splat(9.0));
                let neighbours = Neighbours::of(simd, &rays);
                let slopes = neighbours.slopes(simd, neighbours.face(0));
                let near = neighbours.alike(simd, 0xffff, 0.85);
                assert_eq!(near, 0x1ff, "rays up to 0.8 from the first");
                assert_eq!(slopes.close(simd, near, 0.0, 1.0), near, "all go one way");
                let mut beam = neighbours.beam(simd, &slopes, 0xffff, &bounds, SLACK).unwrap();
                beam.set_t_max(t_max);
                let boxes = BoxCorners::of(&block.load(simd, face_axes(slopes.face())));
                beam_crosses(simd, &beam, &boxes).to_bitmask() & 7
            })
        };
        assert_eq!((crossed(10.0), crossed(4.8)), (1, 0), "{level}");
    }
}
