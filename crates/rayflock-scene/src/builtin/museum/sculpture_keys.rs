//! The five shapes of the museum's sculpture.
//!
//! Four faces, each cut `n - 1` times into four at the middles of its edges: `4^n` triangles. A
//! triangle `a b c` becomes, in this order,
//!
//! ```text
//!            a
//!           /0\               0: a  ab ac
//!         ab---ac             1: ab b  bc
//!         /1\2/3\             2: ab bc ac
//!        b---bc---c           3: ac bc c
//! ```
//!
//! **Source.** BART's generator of the museum, as its files show it: keys 2 to 4 agree with
//! `museum5` to the rounding of the file. **Departures.** Keys 0 and 1 are regenerated: random
//! triangles with the spread and the median edge of BART's.

use std::f32::consts::TAU;

use glam::Vec3;

use super::super::random::Random;

/// The animation time of each key.
pub const KEY_TIMES: [f64; 5] = [0.0, 1.0, 2.0, 3.0, 4.0];

type Face = [Vec3; 3];

const A: Vec3 = Vec3::new(0.5, 3.0, 0.5);
const B: Vec3 = Vec3::new(-0.5, 3.0, -0.5);
const C: Vec3 = Vec3::new(-0.5, 2.0, 0.5);
const D: Vec3 = Vec3::new(0.5, 2.0, -0.5);
/// Key 2: the faces of a tetrahedron.
const TETRAHEDRON: [Face; 4] = [[A, B, C], [A, C, D], [A, D, B], [C, B, D]];

/// Key 3: the sphere that the tetrahedron is blown up to.
const SPHERE_CENTER: Vec3 = Vec3::new(0.0, 2.5, 0.0);
const SPHERE_RADIUS: f32 = 0.8;

/// Corners that the sails of key 4 share.
const SAIL_SIDE: Vec3 = Vec3::new(-0.25, 2.5, -0.5);
const SAIL_WAIST: Vec3 = Vec3::new(0.75, 2.7, -0.25);
const SAIL_TIP: Vec3 = Vec3::new(1.25, 3.2, 0.55);
const SAIL_TOP: Vec3 = Vec3::new(1.0, 3.8, 0.25);
/// Key 4: the faces folded out to sails.
const SAILS: [Face; 4] = [
    [Vec3::new(0.0, 1.5, 0.0), SAIL_SIDE, SAIL_WAIST],
    [SAIL_SIDE, SAIL_TIP, SAIL_WAIST],
    [SAIL_WAIST, SAIL_TIP, SAIL_TOP],
    [SAIL_TIP, Vec3::new(-0.75, 4.4, -0.6), SAIL_TOP],
];

/// Median edges of keys 0 and 1 in museum5; other sizes scale them with the triangle's side.
const HEAP_EDGE: f32 = 0.0485;
const SWARM_EDGE: f32 = 0.187;

/// The vertices of the sculpture of `museum<n>` at each of [`KEY_TIMES`], three a triangle,
/// `4^n` triangles, in scene units; `None` unless `n` is from 3 to 8.
///
/// Keys 2 to 4 are BART's; keys 0 and 1 are regenerated.
pub fn sculpture_keys(n: u32) -> Option<[Vec<Vec3>; 5]> {
    if !(3..=8).contains(&n) {
        return None;
    }
    let scale = 2.0_f32.powi(5 - n as i32);
    let tetrahedron = subdivide(&TETRAHEDRON, n - 1);
    let project = |&vertex: &Vec3| {
        SPHERE_CENTER + SPHERE_RADIUS * (vertex - SPHERE_CENTER).normalize_or(Vec3::Y)
    };
    let sphere = tetrahedron.iter().map(project).collect();
    let count = tetrahedron.len() / 3;
    let sails = subdivide(&SAILS, n - 1);
    Some([
        heap(count, HEAP_EDGE * scale),
        swarm(count, SWARM_EDGE * scale),
        tetrahedron,
        sphere,
        sails,
    ])
}

fn subdivide(faces: &[Face; 4], levels: u32) -> Vec<Vec3> {
    let mut vertices = Vec::with_capacity(3 * 4_usize.pow(levels + 1));
    for &face in faces {
        push_pieces(face, levels, &mut vertices);
    }
    vertices
}

/// A midpoint does not depend on the order of its ends, so neighbours share theirs to the bit.
fn push_pieces([a, b, c]: Face, levels: u32, vertices: &mut Vec<Vec3>) {
    if levels == 0 {
        vertices.extend([a, b, c]);
        return;
    }
    let [ab, bc, ac] = [a.midpoint(b), b.midpoint(c), a.midpoint(c)];
    for piece in [[a, ab, ac], [ab, b, bc], [ab, bc, ac], [ac, bc, c]] {
        push_pieces(piece, levels - 1, vertices);
    }
}

/// Key 0: triangles that lie about on the block.
fn heap(count: usize, median_edge: f32) -> Vec<Vec3> {
    let mut random = Random::new(0);
    let shapes = scaled_to_median_edge(random_shapes(&mut random, count, 0.25), median_edge);
    let place = |mut shape: Face| {
        let centroid = random.in_disc(0.45) + random.between(1.5, 1.55) * Vec3::Y;
        shape.iter_mut().for_each(|corner| *corner += centroid);
        shape
    };
    shapes.into_iter().flat_map(place).collect()
}

/// Key 1: triangles that hang in the air like a swarm.
fn swarm(count: usize, median_edge: f32) -> Vec<Vec3> {
    let mut random = Random::new(1);
    let shapes = scaled_to_median_edge(random_shapes(&mut random, count, 1.0), median_edge);
    let place = |mut shape: Face| {
        let centroid = random.in_disc(0.5) + random.between(1.7, 3.9) * Vec3::Y;
        shape.iter_mut().for_each(|corner| *corner += centroid);
        shape
    };
    shapes.into_iter().flat_map(place).collect()
}

/// Random triangles around the origin, lying flatter the smaller `steepness`.
fn random_shapes(random: &mut Random, count: usize, steepness: f32) -> Vec<Face> {
    let mut shape = || {
        // Three spokes a third of a turn apart, each of its own length, are never in a line.
        let (x, y) = random.direction().any_orthonormal_pair();
        let turn = random.between(0.0, TAU);
        let spokes = [0.0, 1.0, 2.0].map(|third: f32| {
            let (sin, cos) = (turn + third * TAU / 3.0).sin_cos();
            random.between(0.6, 1.4) * (cos * x + sin * y) * Vec3::new(1.0, steepness, 1.0)
        });
        let centroid = (spokes[0] + spokes[1] + spokes[2]) / 3.0;
        spokes.map(|corner| corner - centroid)
    };
    (0..count).map(|_| shape()).collect()
}

fn scaled_to_median_edge(mut shapes: Vec<Face>, median_edge: f32) -> Vec<Face> {
    let scale = median_edge / self::median_edge(&shapes);
    shapes.iter_mut().flatten().for_each(|corner| *corner *= scale);
    shapes
}

fn median_edge(shapes: &[Face]) -> f32 {
    let edges_of = |[a, b, c]: &Face| [a.distance(*b), b.distance(*c), c.distance(*a)];
    let mut edges: Vec<f32> = shapes.iter().flat_map(edges_of).collect();
    edges.sort_by(f32::total_cmp);
    edges[edges.len() / 2]
}

#[cfg(test)]
mod tests {
    use std::collections::HashMap;

    use super::*;

    #[test]
    fn counts_are_powers_of_four() {
        for n in 3..=8 {
            for key in sculpture_keys(n).unwrap() {
                assert_eq!(key.len(), 3 * 4_usize.pow(n));
            }
        }
        assert!(sculpture_keys(2).is_none() && sculpture_keys(9).is_none());
    }

    #[test]
    fn keys_follow_the_recipe() {
        // The second triangle of museum5, as BART's file gives it.
        let keys = sculpture_keys(5).unwrap();
        let expected = [
            (2, [(0.4375, 3.0, 0.4375), (0.375, 3.0, 0.375), (0.375, 2.9375, 0.4375)]),
            (
                3,
                [
                    (0.439978, 3.002831, 0.439978),
                    (0.411597, 3.048795, 0.411597),
                    (0.414657, 2.983766, 0.483766),
                ],
            ),
            (
                4,
                [
                    (-0.015625, 1.5625, -0.03125),
                    (-0.03125, 1.625, -0.0625),
                    (0.03125, 1.6375, -0.046875),
                ],
            ),
        ];
        for (key, corners) in expected {
            for (found, expected) in keys[key][3..6].iter().zip(corners) {
                assert!(found.abs_diff_eq(Vec3::from(expected), 1e-6), "key {key}: {found}");
            }
        }
    }

    #[test]
    fn the_sphere_is_closed() {
        let keys = sculpture_keys(4).unwrap();
        let quantised = |v: &Vec3| (*v * 1e4).round().as_ivec3().to_array();
        let mut edges = HashMap::new();
        for corners in keys[3].chunks_exact(3) {
            for (from, to) in [(0, 1), (1, 2), (2, 0)] {
                let [from, to] = [from, to].map(|corner| quantised(&corners[corner]));
                *edges.entry((from.min(to), from.max(to))).or_insert(0) += 1;
            }
        }
        assert!(edges.values().all(|&count| count == 2));
    }

    #[test]
    fn regenerated_keys_have_the_spread_of_the_originals() {
        for n in 3..=6 {
            let keys = sculpture_keys(n).unwrap();
            let scale = 2.0_f32.powi(5 - n as i32);
            let ranges = [(0.45, 1.5..=1.55, HEAP_EDGE), (0.5, 1.7..=3.9, SWARM_EDGE)];
            for (key, (radius, heights, edge)) in keys.iter().zip(ranges) {
                let faces: Vec<Face> = key.chunks_exact(3).map(|c| [c[0], c[1], c[2]]).collect();
                assert!((median_edge(&faces) / (edge * scale) - 1.0).abs() < 1e-3);
                for [a, b, c] in faces {
                    let centroid = (a + b + c) / 3.0;
                    assert!(centroid.with_y(0.0).length() < radius + 1e-4);
                    assert!(centroid.y > heights.start() - 1e-4);
                    assert!(centroid.y < heights.end() + 1e-4);
                    assert!((b - a).cross(c - a).length() > 1e-6);
                }
            }
        }
    }
}
