//! What is accepted is never rejected on a face: not by boxes, edges or depth, at any level.

use glam::{DVec3, Vec3};
use proptest::prelude::*;

use super::axes::Axes;
use super::face::{Face, FaceKind};
use super::face_boxes::SpaceBoxes;
use super::face_triangle::{FaceTriangle, TrianglePlanes, set_up};
use super::ray_triangle::{ShearedRay, TriangleBlock, intersect_block};
use super::{LANES, Lanes, Simd, SimdBase, SimdLevel, SimdMask, dispatch, f32x16, mask32x16};
use crate::Ray;

/// Sixteen rays of a face, and sixteen triangles around points of them.
#[derive(Clone, Debug)]
struct Case {
    face: Face,
    rays: Vec<Ray>,
    block: TriangleBlock,
}

/// Random numbers of one ray and its triangle.
type Draw = ([f32; 3], [f32; 3], f32, [[f32; 3]; 2], [f32; 2], f32);

fn vector(scale: f32) -> impl Strategy<Value = [f32; 3]> {
    prop::array::uniform3(-scale..scale)
}

fn draw() -> impl Strategy<Value = Draw> {
    let size = prop_oneof![Just(1e-4_f32), Just(1e-2), Just(1.0), Just(30.0)];
    // Barycentric coordinates on edges and corners, too.
    let weight = prop_oneof![Just(0.0_f32), 0.0..1.0_f32];
    let edges = prop::array::uniform2(vector(1.0));
    (vector(1.0), vector(1.0), 0.01..20.0_f32, edges, prop::array::uniform2(weight), size)
}

fn case() -> impl Strategy<Value = Case> {
    let draws = prop::collection::vec(draw(), LANES);
    let scale = prop_oneof![Just(1e-3_f32), Just(1.0), Just(1e4)];
    let shift = prop_oneof![Just(0.0_f32), Just(1e2), Just(1e5)];
    let spread = prop_oneof![Just(1e-3_f32), Just(0.2), Just(0.9)];
    (draws, vector(1.0), any::<bool>(), scale, shift, spread).prop_map(
        |(draws, along, is_central, scale, shift, spread)| {
            let along = Vec3::from(along).as_dvec3().normalize_or(DVec3::X);
            let center = Vec3::splat(scale * shift);
            let mut case =
                Case { face: face(along, center), rays: Vec::new(), block: TriangleBlock::EMPTY };
            for (lane, draw) in draws.into_iter().enumerate() {
                let (place, noise, t, edges, weights, size) = draw;
                let bent = (along.as_vec3() + spread * Vec3::from(noise)).normalize_or(Vec3::X);
                let beside = center + 3.0 * scale * Vec3::from(place);
                let (origin, direction) =
                    if is_central { (center, bent) } else { (beside, along.as_vec3()) };
                let ray = Ray::new(origin, direction);
                case.block.set(lane, around(ray.at(scale * t), edges, weights, scale * size));
                case.rays.push(ray);
            }
            if !is_central {
                let reach = case.rays.iter().map(|ray| ray.origin.distance(center));
                case.face.kind = FaceKind::Parallel { reach: reach.fold(0.0, f32::max) };
            }
            case
        },
    )
}

/// A face across `along`, for rays that share an origin.
fn face(along: DVec3, center: Vec3) -> Face {
    let first = along.any_orthonormal_vector();
    let rows = [first, along.cross(first), along].map(DVec3::as_vec3);
    Face { kind: FaceKind::Central, center, rows }
}

/// A triangle with a point at these barycentric coordinates.
fn around(point: Vec3, edges: [[f32; 3]; 2], [u, v]: [f32; 2], size: f32) -> [Vec3; 3] {
    let [a, b] = edges.map(|edge| size * Vec3::from(edge));
    let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
    let first = point - u * a - v * b;
    [first, first + a, first + b]
}

/// The triangles as the face's kernels hand them on, with their least and largest y; `None` for
/// those said to be out of reach.
#[inline(always)]
fn place<S: Simd>(simd: S, case: &Case) -> [Option<(FaceTriangle, [f32; 2])>; LANES] {
    let load = |column: &Lanes| f32x16::from_slice(simd, column);
    let [a, b, c] = &case.block.corners;
    let axes = |corner: &[Lanes; 3]| [load(&corner[0]), load(&corner[1]), load(&corner[2])];
    let corners: [Axes<S>; 3] = [axes(a), axes(b), axes(c)];
    let placed = case.face.project_triangles(simd, &corners);
    let mut written = [FaceTriangle::EMPTY; LANES];
    let [x0, x1, y0, y1] = placed.bounds;
    set_up(simd, &placed).store([x0, x1], &mut written);
    std::array::from_fn(|lane| {
        if placed.placed.test(lane) {
            Some((written[lane], [y0[lane], y1[lane]]))
        } else if placed.behind.test(lane) {
            None
        } else {
            let reach = case.face.place_triangle(case.block.get(lane))?;
            Some((FaceTriangle::of(&reach), [reach.bounds[2], reach.bounds[3]]))
        }
    })
}

/// Triangles whose box in space says less than it must.
#[inline(always)]
fn wrongly_boxed<S: Simd>(simd: S, case: &Case) -> Vec<usize> {
    let corners = super::triangle_lanes::TriangleLanes::load(simd, &case.block).corners;
    let placed = case.face.project_triangles(simd, &corners);
    let boxes = SpaceBoxes::around(simd, &corners, case.face.center);
    let boxed = case.face.place_boxes(simd, &boxes);
    let is_wrong = |lane: usize| {
        let (tight, wide) = (placed.bounds, boxed.bounds);
        let within = tight[0][lane] >= wide[0][lane]
            && tight[1][lane] <= wide[1][lane]
            && tight[2][lane] >= wide[2][lane]
            && tight[3][lane] <= wide[3][lane];
        let is_placed = placed.placed.test(lane);
        (boxed.behind.test(lane) && !placed.behind.test(lane))
            || (boxed.certain.test(lane) && is_placed && !within)
    };
    (0..LANES).filter(|&lane| is_wrong(lane)).collect()
}

/// Sides of the cube around the center on which boxes are not as on faces of their own.
#[inline(always)]
fn wrong_sides<S: Simd>(simd: S, case: &Case) -> Vec<(usize, f32)> {
    let corners = super::triangle_lanes::TriangleLanes::load(simd, &case.block).corners;
    let boxes = SpaceBoxes::around(simd, &corners, case.face.center);
    let mut wrong = Vec::new();
    for axis in 0..3 {
        for (sign, found) in [1.0, -1.0].into_iter().zip(boxes.on_sides(simd, axis)) {
            let [x, y, z] = [1, 2, 0].map(|turn| Vec3::AXES[(axis + turn) % 3]);
            let kind = FaceKind::Central;
            let face = Face { kind, center: case.face.center, rows: [x, y, sign * z] };
            let expected = face.place_boxes(simd, &boxes);
            let certain = expected.certain.to_bitmask();
            let is_same = (0..LANES).filter(|lane| certain & (1 << lane) != 0).all(|lane| {
                (0..4).all(|side| found.bounds[side][lane] == expected.bounds[side][lane])
            });
            let is_behind = expected.behind.to_bitmask();
            if !is_same
                || found.certain.to_bitmask() != certain
                || found.behind.to_bitmask() != is_behind
            {
                wrong.push((axis, sign));
            }
        }
    }
    wrong
}

/// Which rays and triangles are accepted but would be rejected.
#[inline(always)]
fn wrongly_rejected<S: Simd>(simd: S, case: &Case) -> Vec<(usize, usize, &'static str)> {
    let mut wrong = Vec::new();
    let placed = place(simd, case);
    for (ray_idx, ray) in case.rays.iter().enumerate() {
        let everywhere = mask32x16::splat(simd, true);
        let hits = intersect_block(simd, &ShearedRay::new(ray), &case.block, everywhere);
        for lane in (0..LANES).filter(|&lane| hits.accepted.test(lane)) {
            // The ray looks nowhere but at the hit: it still counts.
            let points = {
                let splat = |v: Vec3| {
                    [f32x16::splat(simd, v.x), f32x16::splat(simd, v.y), f32x16::splat(simd, v.z)]
                };
                case.face.project_rays(simd, splat(ray.origin), splat(ray.direction))
            };
            if !points.on_face.test(0) {
                continue;
            }
            let t = f32x16::splat(simd, hits.t[lane]);
            let limit = case.face.limit(simd, &points, t);
            let begin = case.face.begin(simd, &points, t);
            let place = [points.x, points.y, limit, begin];
            let Some((triangle, [low, high])) = &placed[lane] else {
                wrong.push((ray_idx, lane, "out of reach"));
                continue;
            };
            // A strip as narrow as can be.
            let (x, y) = (points.x[0], points.y[0]);
            let [x0, x1] = triangle.ends().map(|end| f32x16::splat(simd, end));
            let planes = TrianglePlanes::of_one(simd, triangle);
            let [x0, x1] = planes.clip(simd, [x0, x1], [points.y, points.y]);
            if !(*low <= y && y <= *high && x0[0] <= x && x <= x1[0]) {
                wrong.push((ray_idx, lane, "by its strip"));
            }
            let alone = case.face.place_triangle(case.block.get(lane));
            let is_within = alone.is_some_and(|reach| {
                let [low, high] = reach.clip_y([x, x], [y - 1.0, y + 1.0]);
                let [left, right] = reach.clip_x([y, y], [x - 1.0, x + 1.0]);
                low <= y && y <= high && left <= x && x <= right
            });
            if !is_within {
                wrong.push((ray_idx, lane, "by its column or strip, placed alone"));
            }
            if !triangle.may_hit(simd, place).test(0) {
                wrong.push((ray_idx, lane, "by edges or depth"));
            }
        }
    }
    wrong
}

/// Which rays and triangles are said to hit for certain but are not accepted: with all of the ray
/// before it, and with intervals that begin or end at the hit or right beside it.
#[inline(always)]
fn wrongly_certain<S: Simd>(simd: S, case: &Case) -> Vec<(usize, usize, [f32; 2])> {
    let mut wrong = Vec::new();
    let placed = place(simd, case);
    let everywhere = mask32x16::splat(simd, true);
    for (ray_idx, ray) in case.rays.iter().enumerate() {
        let splat = |v: Vec3| v.to_array().map(|axis| f32x16::splat(simd, axis));
        let points = case.face.project_rays(simd, splat(ray.origin), splat(ray.direction));
        let found = intersect_block(simd, &ShearedRay::new(ray), &case.block, everywhere);
        for lane in (0..LANES).filter(|_| points.on_face.test(0)) {
            let Some((triangle, _)) = &placed[lane] else { continue };
            let t = if found.accepted.test(lane) { found.t[lane] } else { 1.0 };
            let (ends, begins) = ([t, t.next_down(), f32::INFINITY], [0.0, t, t.next_up()]);
            for [t_min, t_max] in begins.iter().flat_map(|&t_min| ends.map(|end| [t_min, end])) {
                let asked = ShearedRay { t_min, t_max, ..ShearedRay::new(ray) };
                let hits = intersect_block(simd, &asked, &case.block, everywhere);
                let interval = [t_min, t_max].map(|t| f32x16::splat(simd, t));
                let [least, most] = case.face.surely(simd, &points, interval);
                let must_hit = triangle.must_hit(simd, [points.x, points.y, least, most]);
                if must_hit.test(0) && !hits.accepted.test(lane) {
                    wrong.push((ray_idx, lane, [t_min, t_max]));
                }
            }
        }
    }
    wrong
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn what_is_certain_is_accepted(case in case()) {
        for level in SimdLevel::available() {
            let wrong = dispatch!(level.level(), simd => wrongly_certain(simd, &case));
            prop_assert!(wrong.is_empty(), "{level}: {wrong:?}");
        }
    }

    #[test]
    fn what_is_accepted_is_never_rejected(case in case()) {
        for level in SimdLevel::available() {
            let wrong = dispatch!(level.level(), simd => wrongly_rejected(simd, &case));
            prop_assert!(wrong.is_empty(), "{level}: {wrong:?}");
        }
    }
}

proptest! {
    #[test]
    fn boxes_of_boxes_contain_those_of_corners(case in case()) {
        for level in SimdLevel::available() {
            let wrong = dispatch!(level.level(), simd => wrongly_boxed(simd, &case));
            prop_assert!(wrong.is_empty(), "{level}: {wrong:?}");
        }
    }

    #[test]
    fn sides_of_a_cube_are_faces(case in case()) {
        for level in SimdLevel::available() {
            let wrong = dispatch!(level.level(), simd => wrong_sides(simd, &case));
            prop_assert!(wrong.is_empty(), "{level}: {wrong:?}");
        }
    }
}

/// Through the middle of a triangle, not beside it; on both kinds of faces.
#[test]
fn hits_far_from_edges_are_certain() {
    let corners = [Vec3::ZERO, Vec3::X, Vec3::Y].map(|corner| corner + Vec3::new(-0.2, -0.2, 5.0));
    let parallel = FaceKind::Parallel { reach: 1.0 };
    for (kind, level) in [FaceKind::Central, parallel]
        .into_iter()
        .flat_map(|kind| SimdLevel::available().into_iter().map(move |level| (kind, level)))
    {
        let mut case = Case {
            face: Face { kind, ..face(DVec3::Z, Vec3::ZERO) },
            rays: Vec::new(),
            block: TriangleBlock::EMPTY,
        };
        case.block.set(0, corners);
        let is_certain = |x: f32, interval: [f32; 2]| {
            dispatch!(level.level(), simd => {
                let splat = |axes: [f32; 3]| axes.map(|axis| f32x16::splat(simd, axis));
                let (place, along) = match kind {
                    FaceKind::Central => ([0.0; 3], [x, 0.0, 5.0]),
                    FaceKind::Parallel { .. } => ([x, 0.0, 0.0], [0.0, 0.0, 5.0]),
                };
                let points = case.face.project_rays(simd, splat(place), splat(along));
                let interval = interval.map(|t| f32x16::splat(simd, t));
                let [least, most] = case.face.surely(simd, &points, interval);
                let (triangle, _) = place_first(simd, &case);
                triangle.must_hit(simd, [points.x, points.y, least, most]).test(0)
            })
        };
        assert!(is_certain(0.0, [0.0, f32::INFINITY]), "{kind:?}");
        assert!(is_certain(0.0, [0.9, 1.1]), "{kind:?}");
        assert!(!is_certain(0.0, [1.1, f32::INFINITY]), "{kind:?}");
        assert!(!is_certain(0.0, [0.0, 0.9]), "{kind:?}");
        assert!(!is_certain(0.9, [0.0, f32::INFINITY]), "{kind:?}");
    }
}

/// The first triangle, which has a place on the face.
#[inline(always)]
fn place_first<S: Simd>(simd: S, case: &Case) -> (FaceTriangle, [f32; 2]) {
    place(simd, case)[0].expect("a triangle in front")
}

#[test]
fn what_lies_beside_or_behind_is_rejected() {
    let mut case = Case {
        face: face(DVec3::Z, Vec3::ZERO),
        rays: vec![Ray::new(Vec3::ZERO, Vec3::Z)],
        block: TriangleBlock::EMPTY,
    };
    let corners = [Vec3::ZERO, Vec3::X, Vec3::Y];
    case.block.set(0, corners.map(|corner| corner + Vec3::new(-0.2, -0.2, 5.0)));
    case.block.set(1, corners.map(|corner| corner + Vec3::new(0.2, 0.2, 5.0)));
    case.block.set(2, corners.map(|corner| corner - 5.0 * Vec3::Z));
    for level in SimdLevel::available() {
        let kept = dispatch!(level.level(), simd => {
            let zero = f32x16::splat(simd, 0.0);
            let infinite = f32x16::splat(simd, f32::INFINITY);
            place(simd, &case).map(|placed| {
                placed.is_some_and(|(placed, _)| {
                    placed.may_hit(simd, [zero, zero, zero, infinite]).test(0)
                })
            })
        });
        assert_eq!(kept[..3], [true, false, false], "{level}");
    }
}
