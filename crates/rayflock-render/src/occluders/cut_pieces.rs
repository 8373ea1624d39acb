//! Cuts a mesh into pieces small enough to be clustered: triangles or parts of them, and balls.
//!
//! A wall of two triangles needs many spheres, so a triangle that is long for the sphere it will
//! belong to is cut into n x n equal ones. Pieces know where they are on their triangle, not where
//! that is, so that they follow a mesh that bends.

use glam::Vec3;
use rayflock_geom::{Mesh, Sphere};

/// Sides of a triangle are cut into at most so many parts.
const MOST_CUTS: u32 = 64;

/// Pieces that a sphere should have at least, where triangles can be cut.
const PIECES_PER_SPHERE: f32 = 12.0;

/// A part of the surface of a mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Piece {
    /// A part of the triangle between three vertices; the corners as shares of the second and
    /// third vertex.
    Part { triangle_idx: u32, vertices: [u32; 3], corners: [[f32; 2]; 3] },
    /// A sphere of the mesh, or the bounding sphere of a user primitive behind them.
    Ball(u32),
}

/// A piece where it is now, in object space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum PlacedPiece {
    Triangle([Vec3; 3]),
    Ball(Sphere),
}

impl Piece {
    /// Where the piece is; `None` if that is not finite.
    #[inline]
    pub(super) fn placed(&self, mesh: &Mesh) -> Option<PlacedPiece> {
        match *self {
            Self::Part { vertices, corners, .. } => {
                let [a, b, c] = vertices.map(|vertex_idx| mesh.vertices()[vertex_idx as usize]);
                let corner = |[u, v]: [f32; 2]| a + (b - a) * u + (c - a) * v;
                let corners = corners.map(corner);
                let is_finite = corners.iter().all(|corner| corner.is_finite());
                is_finite.then_some(PlacedPiece::Triangle(corners))
            }
            Self::Ball(idx) => {
                let spheres = mesh.spheres();
                let ball = match spheres.get(idx as usize) {
                    Some(sphere) => *sphere,
                    None => mesh.user()?.bounding_sphere(idx as usize - spheres.len()),
                };
                ball.is_valid().then_some(PlacedPiece::Ball(ball))
            }
        }
    }
}

impl PlacedPiece {
    /// The surface, both sides of a triangle counted once.
    pub(super) fn area(&self) -> f32 {
        match self {
            Self::Triangle([a, b, c]) => 0.5 * (b - a).cross(c - a).length(),
            Self::Ball(ball) => 4.0 * std::f32::consts::PI * ball.radius * ball.radius,
        }
    }

    /// Across a triangle, of unit length; zero for a ball, and without area.
    pub(super) fn normal(&self) -> Vec3 {
        match self {
            Self::Triangle([a, b, c]) => (b - a).cross(c - a).normalize_or_zero(),
            Self::Ball(_) => Vec3::ZERO,
        }
    }

    /// The centroid.
    pub(super) fn middle(&self) -> Vec3 {
        match self {
            Self::Triangle([a, b, c]) => (a + b + c) / 3.0,
            Self::Ball(ball) => ball.center,
        }
    }
}

/// The surface of a mesh: triangles and balls.
pub(super) fn surface_area(mesh: &Mesh) -> f32 {
    let areas = whole_pieces(mesh).filter_map(|piece| Some(piece.placed(mesh)?.area()));
    areas.map(f64::from).sum::<f64>() as f32
}

/// All triangles and balls, uncut.
pub(super) fn whole_pieces(mesh: &Mesh) -> impl Iterator<Item = Piece> + '_ {
    let triangles = (0_u32..).zip(mesh.triangles()).map(|(triangle_idx, &vertices)| {
        let corners = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
        Piece::Part { triangle_idx, vertices, corners }
    });
    let ball_count = mesh.prim_count() - mesh.triangles().len();
    triangles.chain((0..ball_count as u32).map(Piece::Ball))
}

/// Makes `pieces` those of `mesh`, for spheres that stand for about `area_per_sphere` each. What is
/// not finite or has no area is left out.
pub(super) fn cut_pieces(mesh: &Mesh, area_per_sphere: f32, pieces: &mut Vec<Piece>) {
    let longest = (2.0 * area_per_sphere / PIECES_PER_SPHERE).sqrt();
    pieces.clear();
    for piece in whole_pieces(mesh) {
        match (piece, piece.placed(mesh)) {
            (_, Some(placed)) if placed.area() <= 0.0 => {}
            (Piece::Part { triangle_idx, vertices, .. }, Some(PlacedPiece::Triangle(corners))) => {
                let cuts = cut_count(corners, longest);
                let part = |corners| Piece::Part { triangle_idx, vertices, corners };
                pieces.extend(parts(cuts).map(part));
            }
            (_, Some(_)) => pieces.push(piece),
            (_, None) => {}
        }
    }
}

/// Into how many parts the sides of a triangle are cut, so that none is much longer than `longest`.
fn cut_count([a, b, c]: [Vec3; 3], longest: f32) -> u32 {
    let side = a.distance(b).max(b.distance(c)).max(c.distance(a));
    ((side / longest.max(f32::MIN_POSITIVE)).ceil() as u32).clamp(1, MOST_CUTS)
}

/// The corners of the n x n parts of a triangle whose sides are cut into n.
fn parts(cuts: u32) -> impl Iterator<Item = [[f32; 2]; 3]> {
    let at = move |i: u32, j: u32| [i as f32 / cuts as f32, j as f32 / cuts as f32];
    let upright = move |i, j| [at(i, j), at(i + 1, j), at(i, j + 1)];
    let hanging = move |i, j| [at(i + 1, j + 1), at(i, j + 1), at(i + 1, j)];
    (0..cuts).flat_map(move |j| {
        let row = cuts - j;
        let down = (0..row - 1).map(move |i| hanging(i, j));
        (0..row).map(move |i| upright(i, j)).chain(down)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_cover_their_triangle_once() {
        let corners = vec![Vec3::ZERO, 3.0 * Vec3::X, Vec3::new(0.0, 2.0, 1.0)];
        let mesh = Mesh::from_triangles(corners, vec![[0, 1, 2]]).unwrap();
        let mut pieces = Vec::new();
        cut_pieces(&mesh, surface_area(&mesh) / 20.0, &mut pieces);
        assert!(pieces.len() > 200 && pieces.len() < 1000, "{}", pieces.len());
        let placed: Vec<_> = pieces.iter().map(|piece| piece.placed(&mesh).unwrap()).collect();
        let area: f32 = placed.iter().map(PlacedPiece::area).sum();
        assert!((area / surface_area(&mesh) - 1.0).abs() < 1e-4);
        let one = placed[0].area();
        assert!(placed.iter().all(|piece| (piece.area() / one - 1.0).abs() < 1e-3));
    }

    #[test]
    fn what_has_no_area_or_is_not_finite_is_left_out() {
        let vertices = vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::NAN, 2.0 * Vec3::X];
        let triangles = vec![[0, 1, 2], [0, 1, 3], [0, 1, 4]];
        let balls = vec![Sphere::new(Vec3::ZERO, f32::NAN), Sphere::new(Vec3::Z, 0.5)];
        let mesh = Mesh::from_triangles(vertices, triangles).unwrap().with_spheres(balls);
        let mut pieces = Vec::new();
        cut_pieces(&mesh, 1.0, &mut pieces);
        let of_first = |piece: &Piece| matches!(piece, Piece::Part { triangle_idx: 0, .. });
        assert!(pieces.iter().all(|piece| of_first(piece) || *piece == Piece::Ball(1)));
        assert!(pieces.contains(&Piece::Ball(1)));
    }
}
