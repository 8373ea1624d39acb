//! The shapes between which the triangles move, each of any number of triangles of equal area.
//!
//! A flat face is cut across its longest edge into two parts, whose areas are as the numbers of
//! triangles they still have to become; so any face becomes any number of triangles of the same
//! area. The sphere is cut as a square, then mapped.
//!
//! **Source** of the mapping: P. Clarberg, "Fast Equal-Area Mapping of the (Hemi)Sphere using
//! SIMD", Journal of Graphics Tools 2008, section 2: the square goes to an octahedron's faces,
//! and those to the sphere, areas keeping their ratios. **Departures**: a flat triangle covers
//! less than its piece of the sphere, so the radius is enlarged until the areas add up.

use std::f32::consts::FRAC_PI_4;

use rayflock::prelude::Vec3;

use super::definition::Shapes;
use super::random::Random;

/// The corners of one triangle.
pub(super) type Corners = [Vec3; 3];

/// The area of a triangle.
pub(super) fn area([a, b, c]: Corners) -> f32 {
    0.5 * (b - a).cross(c - a).length()
}

/// Triangles with three equal sides at random places in a ball, turned at random.
pub(super) fn cloud(shapes: &Shapes, count: usize, random: &mut Random) -> Vec<Corners> {
    // An equilateral triangle of circumradius r has the area 3 sqrt(3) / 4 r^2.
    let radius = (shapes.area / count as f32 * 4.0 / 27.0_f32.sqrt()).sqrt();
    let center = Vec3::from(shapes.center);
    let triangle = |_| {
        let middle = center + shapes.cloud_radius * random.in_ball();
        let (right, up) = random.direction().any_orthonormal_pair();
        let turn = random.between(0.0, std::f32::consts::TAU);
        [0.0, 1.0, 2.0].map(|corner| {
            let (sin, cos) = (turn + corner * std::f32::consts::TAU / 3.0).sin_cos();
            middle + radius * (right * cos + up * sin)
        })
    };
    (0..count).map(triangle).collect()
}

/// A pyramid on a square, its bottom included.
pub(super) fn pyramid(shapes: &Shapes, count: usize) -> Vec<Corners> {
    // With the height k edges, the sides have the slant height sqrt(1/4 + k^2) edges.
    let k = shapes.pyramid_height;
    let edge = (shapes.area / (1.0 + 2.0 * (0.25 + k * k).sqrt())).sqrt();
    let (half, half_height) = (0.5 * edge, 0.5 * k * edge);
    let center = Vec3::from(shapes.center);
    let apex = center + Vec3::Y * half_height;
    let base = square(center - Vec3::Y * half_height, half);
    let side = |i: usize| [base[i], base[(i + 1) % 4], apex];
    let [a, b, c, d] = base;
    tessellate(&[[a, b, c], [a, c, d], side(0), side(1), side(2), side(3)], count)
}

/// A level square.
pub(super) fn plane(shapes: &Shapes, count: usize) -> Vec<Corners> {
    let [a, b, c, d] = square(Vec3::from(shapes.center), 0.5 * shapes.area.sqrt());
    tessellate(&[[a, b, c], [a, c, d]], count)
}

/// A ball's surface.
pub(super) fn sphere(shapes: &Shapes, count: usize) -> Vec<Corners> {
    // The eight faces of the octahedron, laid out in the square from -1 to 1.
    let ring = [Vec3::X, Vec3::Z, -Vec3::X, -Vec3::Z];
    let corner = |i: usize| ring[i] + ring[(i + 1) % 4];
    let inner = |i: usize| [Vec3::ZERO, ring[i], ring[(i + 1) % 4]];
    let outer = |i: usize| [corner(i), ring[(i + 1) % 4], ring[i]];
    let faces: Vec<Corners> = (0..4).flat_map(|i| [inner(i), outer(i)]).collect();

    let on_unit: Vec<Corners> =
        tessellate(&faces, count).into_iter().map(|corners| corners.map(on_unit_sphere)).collect();
    let unit_area: f32 = sum(on_unit.iter().map(|&corners| area(corners)));
    let (radius, center) = ((shapes.area / unit_area).sqrt(), Vec3::from(shapes.center));
    on_unit.into_iter().map(|corners| corners.map(|corner| center + radius * corner)).collect()
}

/// The corners of a level square, in order around it.
fn square(middle: Vec3, half: f32) -> [Vec3; 4] {
    [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
        .map(|(x, z)| middle + half * Vec3::new(x, 0.0, z))
}

/// Adds in double precision: a million small areas.
fn sum(values: impl Iterator<Item = f32>) -> f32 {
    values.map(f64::from).sum::<f64>() as f32
}

/// The point of the unit sphere for a point of the square from -1 to 1 in x and z.
fn on_unit_sphere(at: Vec3) -> Vec3 {
    let (u, v) = (at.x.abs(), at.z.abs());
    let depth = 1.0 - (u + v);
    let r = 1.0 - depth.abs();
    let angle = if r > 0.0 { ((v - u) / r + 1.0) * FRAC_PI_4 } else { 0.0 };
    let radius = r * (2.0 - r * r).max(0.0).sqrt();
    let height = (1.0 - r * r).copysign(depth);
    let (sin, cos) = angle.sin_cos();
    Vec3::new((radius * cos).copysign(at.x), height, (radius * sin).copysign(at.z))
}

/// Cuts `faces` into `count` triangles in all, each face into as many as its area asks for.
fn tessellate(faces: &[Corners], count: usize) -> Vec<Corners> {
    let sums: Vec<f64> = faces
        .iter()
        .scan(0.0, |sum, &face| {
            *sum += f64::from(area(face));
            Some(*sum)
        })
        .collect();
    let total = sums.last().copied().unwrap_or(1.0);
    let mut triangles = Vec::with_capacity(count);
    for (&face, sum) in faces.iter().zip(sums) {
        // The last sum is the total: the shares end with 1.
        let end = (sum / total * count as f64).round() as usize;
        cut(face, end - triangles.len(), &mut triangles);
    }
    triangles
}

/// Adds `count` triangles of equal area that make up `face`.
fn cut(face: Corners, count: usize, triangles: &mut Vec<Corners>) {
    match count {
        0 => (),
        1 => triangles.push(face),
        _ => {
            let lengths = [0, 1, 2].map(|i| (face[(i + 1) % 3] - face[i]).length_squared());
            let longest =
                (0..3).fold(0, |best, i| if lengths[i] > lengths[best] { i } else { best });
            let [a, b, c] = [0, 1, 2].map(|i| face[(longest + i) % 3]);
            let first_count = count / 2;
            let middle = a.lerp(b, first_count as f32 / count as f32);
            cut([c, a, middle], first_count, triangles);
            cut([b, c, middle], count - first_count, triangles);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SHAPES: Shapes = Shapes {
        frames_apart: 32.0,
        area: 60.0,
        center: [1.0, 2.0, 3.0],
        cloud_radius: 3.0,
        pyramid_height: 1.0,
    };
    const COUNTS: [usize; 6] = [1, 16, 1000, 1024, 4099, 16384];

    fn all(count: usize) -> [(&'static str, Vec<Corners>); 4] {
        [
            ("cloud", cloud(&SHAPES, count, &mut Random::new(1))),
            ("pyramid", pyramid(&SHAPES, count)),
            ("sphere", sphere(&SHAPES, count)),
            ("plane", plane(&SHAPES, count)),
        ]
    }

    fn total(triangles: &[Corners]) -> f32 {
        sum(triangles.iter().map(|&corners| area(corners)))
    }

    #[test]
    fn every_shape_has_exactly_as_many_triangles_as_asked_for() {
        for count in COUNTS {
            for (name, triangles) in all(count) {
                assert_eq!(triangles.len(), count, "{name}");
            }
        }
    }

    #[test]
    fn areas_add_up_and_are_nearly_equal() {
        for count in [1000, 1024, 4099, 16384] {
            for (name, triangles) in all(count) {
                assert!((total(&triangles) / 60.0 - 1.0).abs() < 1e-3, "{name}");
                let mean = 60.0 / count as f32;
                let off = |&corners: &Corners| (area(corners) / mean - 1.0).abs();
                let worst = triangles.iter().map(off).fold(0.0, f32::max);
                let allowed = if name == "sphere" { 0.2 } else { 0.05 };
                assert!(worst < allowed, "{name} of {count}: {worst}");
            }
        }
    }

    #[test]
    fn triangles_are_no_slivers() {
        for (name, triangles) in all(16384) {
            for corners in triangles {
                let [a, b, c] = corners;
                let longest = a.distance(b).max(b.distance(c)).max(c.distance(a));
                let height = 2.0 * area(corners) / longest;
                assert!(height > 0.1 * longest, "{name}: {corners:?}");
            }
        }
    }

    #[test]
    fn corners_lie_where_the_shape_is() {
        let center = Vec3::from(SHAPES.center);
        let corners = |triangles: Vec<Corners>| triangles.into_flattened().into_iter();
        for corner in corners(sphere(&SHAPES, 4096)) {
            // 4 pi r^2 = 60; what flat triangles lack makes r a little larger.
            assert!((corner.distance(center) / 2.1851 - 1.0).abs() < 2e-3);
        }
        for corner in corners(plane(&SHAPES, 4096)) {
            let offset = (corner - center).abs();
            assert!(offset.y == 0.0 && offset.max_element() <= 0.5 * 60.0_f32.sqrt() + 1e-5);
        }
        for corner in corners(cloud(&SHAPES, 4096, &mut Random::new(1))) {
            assert!(corner.distance(center) < SHAPES.cloud_radius + 0.12);
        }
    }

    #[test]
    fn the_mapping_of_the_sphere_keeps_areas() {
        // As many triangles in every eighth of the height: zones of equal height have equal area.
        let triangles = sphere(&SHAPES, 16384);
        let radius = (60.0 / (2.0 * std::f32::consts::TAU)).sqrt();
        let mut zones = [0; 8];
        for [a, b, c] in triangles {
            let height = (a.y + b.y + c.y) / 3.0 - SHAPES.center[1];
            zones[((height / radius + 1.0) * 4.0).clamp(0.0, 7.0) as usize] += 1;
        }
        assert!(zones.iter().all(|&count| (1800..2300).contains(&count)), "{zones:?}");
    }

    #[test]
    fn triangles_of_the_cloud_are_equilateral_and_everywhere_in_the_ball() {
        let triangles = cloud(&SHAPES, 16384, &mut Random::new(1));
        let mut inside = 0;
        for [a, b, c] in &triangles {
            let sides = [a.distance(*b), b.distance(*c), c.distance(*a)];
            assert!(sides.iter().all(|side| (side / sides[0] - 1.0).abs() < 1e-3));
            let middle = (a + b + c) / 3.0 - Vec3::from(SHAPES.center);
            inside += usize::from(middle.length() < 0.5 * SHAPES.cloud_radius);
        }
        let share = inside as f32 / triangles.len() as f32;
        assert!((share - 0.125).abs() < 0.01, "{share}");
    }
}
