//! Triangles that have nothing to do with each other.

use glam::Vec3;
use rayflock_geom::{Mesh, Sphere};

use super::mesh;
use crate::Rng;

/// What is odd about the triangles of a soup.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SoupKind {
    /// Nothing: edges of about a tenth of the soup.
    Plain,
    /// Long and thin, down to a millionth of their length.
    Needles,
    /// From a millionth of the soup to a thousand times it.
    MixedSizes,
    /// One in two has no area: repeated or collinear vertices.
    Degenerate,
    /// One in two has a vertex that is NaN or infinite.
    NonFinite,
    /// Faces of a grid of whole numbers, many of them twice: equal `t` everywhere.
    Grid,
}

impl SoupKind {
    /// Every kind.
    pub const ALL: [Self; 6] = [
        Self::Plain,
        Self::Needles,
        Self::MixedSizes,
        Self::Degenerate,
        Self::NonFinite,
        Self::Grid,
    ];
}

/// `count` triangles of one kind in a cube of half the edge `size` around `center`.
pub fn triangle_soup(rng: &mut Rng, kind: SoupKind, count: usize, center: Vec3, size: f32) -> Mesh {
    let corners = (0..count).flat_map(|_| triangle(rng, kind).map(|p| center + size * p));
    let vertices: Vec<Vec3> = corners.collect();
    let triangles: Vec<[u32; 3]> =
        (0..count as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    mesh(vertices, triangles)
}

/// One triangle in the unit cube.
fn triangle(rng: &mut Rng, kind: SoupKind) -> [Vec3; 3] {
    let place = rng.in_cube();
    let scale = match kind {
        SoupKind::MixedSizes => rng.power_of_ten(-6, 3),
        _ => 0.2,
    };
    let plain = [place, place + scale * rng.in_cube(), place + scale * rng.in_cube()];
    match kind {
        SoupKind::Plain | SoupKind::MixedSizes => plain,
        SoupKind::Needles => {
            let along = rng.between(0.0, 1.0);
            let tip = plain[0].lerp(plain[1], along) + rng.power_of_ten(-6, -2) * rng.in_cube();
            [plain[0], plain[1], tip]
        }
        SoupKind::Degenerate => match rng.below(4) {
            0 => [plain[0], plain[1], plain[0]],
            1 => [plain[0], plain[0] + 0.25 * Vec3::X, plain[0] + 0.5 * Vec3::X],
            _ => plain,
        },
        SoupKind::NonFinite => {
            let mut broken = plain;
            if rng.one_in(2) {
                let bad = rng.pick(&[f32::NAN, f32::INFINITY, f32::NEG_INFINITY]);
                broken[rng.below(3)][rng.below(3)] = bad;
            }
            broken
        }
        SoupKind::Grid => grid_face(rng),
    }
}

/// Half of a unit face of a 4 x 4 x 4 grid, scaled into the unit cube.
fn grid_face(rng: &mut Rng) -> [Vec3; 3] {
    let cell = Vec3::new(rng.below(4) as f32, rng.below(4) as f32, rng.below(4) as f32);
    let axis = rng.below(3);
    let (u, v) = (Vec3::AXES[(axis + 1) % 3], Vec3::AXES[(axis + 2) % 3]);
    let corners =
        if rng.one_in(2) { [cell, cell + u, cell + u + v] } else { [cell, cell + u + v, cell + v] };
    corners.map(|corner| 0.5 * corner - Vec3::ONE)
}

/// `count` spheres in a cube around `center`, one in eight of them invalid.
pub fn spheres(rng: &mut Rng, count: usize, center: Vec3, size: f32) -> Vec<Sphere> {
    let mut sphere = || {
        let radius = match rng.below(8) {
            0 => rng.pick(&[0.0, -1.0, f32::NAN, f32::INFINITY]),
            1 => rng.between(0.5, 1.5),
            _ => rng.between(0.01, 0.2),
        };
        Sphere::new(center + size * rng.in_cube(), size * radius)
    };
    (0..count).map(|_| sphere()).collect()
}
