//! Few, large and thin triangles: seen edge-on, by long directions, with hits near the ends of
//! intervals.

use glam::Vec3;
use rayflock_geom::{FrameChanges, Geometry, GeometryObject, Mesh, ObjectId, RayBatch};
use rayflock_testkit::Rng;

use crate::agreement::Bench;
use crate::device::engines;

/// Half the sides of a hall.
const HALL: Vec3 = Vec3::new(9.0, 4.0, 28.0);

/// The hall, and boards across it that are a thousandth as wide as long.
fn hall() -> Geometry {
    let corner = |bits: u32| {
        let side = |bit: u32| if bits >> bit & 1 == 0 { -1.0 } else { 1.0 };
        HALL * Vec3::new(side(0), side(1), side(2))
    };
    let mut vertices: Vec<_> = (0..8).map(corner).collect();
    let faces =
        [[0, 1, 3, 2], [4, 5, 7, 6], [0, 1, 5, 4], [2, 3, 7, 6], [0, 2, 6, 4], [1, 3, 7, 5]];
    let halves = |[a, b, c, d]: [u32; 4]| [[a, b, c], [a, c, d]];
    let mut triangles: Vec<_> = faces.into_iter().flat_map(halves).collect();
    let mut rng = Rng::new(81);
    for _ in 0..20 {
        let first = vertices.len() as u32;
        let (from, to) = (HALL * rng.in_cube(), HALL * rng.in_cube());
        let width = 1e-3 * from.distance(to);
        vertices.extend([from, to, to + width * rng.on_sphere()]);
        triangles.push([first, first + 1, first + 2]);
    }
    let mesh = Mesh::from_triangles(vertices, triangles).unwrap();
    Geometry::new(vec![GeometryObject::new(ObjectId(0), mesh)]).unwrap()
}

/// A ray in the hall: origin, direction, and the end of its interval.
fn ray(rng: &mut Rng, idx: usize) -> (Vec3, Vec3, f32) {
    let (mut from, mut to) = (HALL * rng.in_cube(), HALL * rng.in_cube());
    if idx.is_multiple_of(2) {
        // Along a wall, just off its plane or in it.
        let (axis, off) = (rng.below(3), rng.pick(&[0.0, 1e-6, 1e-4, 1e-2]));
        from[axis] = HALL[axis] * (1.0 - off);
        to[axis] = HALL[axis] * (1.0 + rng.pick(&[0.0, 1e-6, -1e-6]) * off);
    }
    let length = rng.pick(&[1e-4, 0.03, 1.0, 28.8, 1e5]);
    let direction = length * (to - from).normalize();
    let reach = from.distance(to) / length;
    (from, direction, reach * rng.pick(&[0.5, 0.999, 1.001, 3.0]))
}

#[test]
fn walls_are_hit_from_everywhere() {
    let geometry = hall();
    let mut rng = Rng::new(82);
    let rays: Vec<_> = (0..1500).map(|idx| ray(&mut rng, idx)).collect();
    let origins: Vec<_> = rays.iter().map(|ray| ray.0).collect();
    let directions: Vec<_> = rays.iter().map(|ray| ray.1).collect();
    let ends: Vec<_> = rays.iter().map(|ray| ray.2).collect();
    let all = RayBatch::new(&origins, &directions).unwrap();
    let ending = all.with_interval(0.0, &ends).unwrap();
    // One that was missed once: a large triangle straight ahead.
    let ahead = RayBatch::new(Vec3::new(-1.52, -0.89, -25.07), Vec3::new(0.0065, 0.838, 28.77));
    let ahead = ahead.unwrap().with_interval(0.0, 12.8).unwrap();
    for mut engine in engines() {
        let mut bench = Bench::new(&geometry);
        bench.commit_to(&mut engine, &FrameChanges::all());
        for batch in [&all, &ending, &ahead] {
            bench.compare(&mut engine, batch);
        }
    }
}
