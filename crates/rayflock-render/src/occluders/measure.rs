//! From pieces where they are now to the soft sphere that stands for them.
//!
//! ```text
//!   centre     middle of the pieces, by area
//!   flatness   lateral extent over thickness, for a patch that faces one way
//!   outer      to the farthest corner, as lengths count for a flattened sphere
//!   inner, opacity   so that it covers what the patch covers: see `occluders`
//! ```

use std::f32::consts::PI;

use glam::{DMat3, DVec3, Vec3};
use rayflock_geom::simd::segment_spheres::SoftSphere;
use rayflock_geom::{Aabb, Mesh};

use super::cut_pieces::{Piece, PlacedPiece};
use super::surface_mean::{along, main_line};

/// The inner radius is at most this share of the outer one: an edge has to have some width.
const SHARPEST: f32 = 0.97;

/// A patch is flat where squared cosines to its main line have this mean.
const FACING: f32 = 0.6;

/// Lengths along a flattened sphere's axis count at most so many times.
const FLATTEST: f32 = 8.0;

/// Thicker patches than this share of their extent are round.
const THICK: f32 = 0.6;

/// Covers the rounding of a distance.
const ROUNDING: f32 = 1.0 + 1e-5;

/// What pieces are as a whole.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Measured {
    /// With an opacity of 0 where there is no surface.
    pub(super) sphere: SoftSphere,
    /// Around the pieces.
    pub(super) bounds: Aabb,
}

/// Sums over pieces.
#[derive(Default)]
struct Surface {
    area: f64,
    /// Area vectors: normals as long as their areas.
    facing: DVec3,
    /// Products of normals with themselves, by area.
    lines: DMat3,
    moment: DVec3,
}

/// Measures pieces of `mesh` where its vertices are now.
pub(super) fn measure(mesh: &Mesh, pieces: &[Piece]) -> Measured {
    let (surface, bounds) = sum(mesh, pieces);
    if surface.area <= 0.0 {
        return Measured { sphere: SoftSphere::default(), bounds };
    }
    let center = (surface.moment / surface.area).as_vec3();
    let (area, lid) = (surface.area as f32, surface.facing.length() as f32);
    let (line, share) = main_line(&(surface.lines * (1.0 / surface.area)).as_mat3());
    let flatness = match share >= FACING {
        true => flatness(mesh, pieces, center, line),
        false => Vec3::ZERO,
    };
    let round = SoftSphere { center, inner: 0.0, outer: 0.0, opacity: 1.0, flatness };
    let outer = reach(mesh, pieces, &round) * ROUNDING;
    let is_round = flatness == Vec3::ZERO;
    let covered = match is_round {
        true => 0.25 * (area + lid),
        false => covered_across(mesh, pieces, line),
    };
    Measured { sphere: covering(covered, SoftSphere { outer, ..round }), bounds }
}

/// The sphere with the inner radius and the opacity that make it cover as much of a plane.
fn covering(covered: f32, sphere: SoftSphere) -> SoftSphere {
    // A soft disc covers pi (inner^2 + outer^2) / 2 times its opacity.
    let outer_squared = sphere.outer * sphere.outer;
    let inner_squared = 2.0 * covered / PI - outer_squared;
    if inner_squared > 0.0 {
        let inner = inner_squared.sqrt().min(SHARPEST * sphere.outer);
        return SoftSphere { inner, opacity: 1.0, ..sphere };
    }
    let opacity = 2.0 * covered / (PI * outer_squared).max(f32::MIN_POSITIVE);
    SoftSphere { inner: 0.0, opacity: opacity.min(1.0), ..sphere }
}

fn placed(mesh: &Mesh, pieces: &[Piece]) -> impl Iterator<Item = PlacedPiece> {
    pieces.iter().filter_map(|piece| piece.placed(mesh))
}

fn sum(mesh: &Mesh, pieces: &[Piece]) -> (Surface, Aabb) {
    let (mut surface, mut bounds) = (Surface::default(), Aabb::EMPTY);
    for piece in placed(mesh, pieces) {
        let area = f64::from(piece.area());
        surface.area += area;
        surface.moment += area * piece.middle().as_dvec3();
        surface.lines += area * along(piece.normal()).as_dmat3();
        match piece {
            PlacedPiece::Triangle(corners) => {
                let [a, b, c] = corners;
                surface.facing += 0.5 * (b - a).cross(c - a).as_dvec3();
                bounds =
                    corners.into_iter().fold(bounds, |bounds, corner| bounds.including(corner));
            }
            PlacedPiece::Ball(ball) => {
                bounds = bounds.including(ball.center - ball.radius);
                bounds = bounds.including(ball.center + ball.radius);
            }
        }
    }
    (surface, bounds)
}

/// What pieces cover of a plane across `axis`: all of a sheet, half of what is closed.
fn covered_across(mesh: &Mesh, pieces: &[Piece], axis: Vec3) -> f32 {
    let (mut sum, mut sides) = (0.0_f32, 0.0_f32);
    for piece in placed(mesh, pieces) {
        let side = piece.area() * piece.normal().dot(axis);
        sum += side.abs();
        sides += side;
    }
    0.5 * (sum + sides.abs())
}

/// How much a patch that faces along `axis` can be flattened.
fn flatness(mesh: &Mesh, pieces: &[Piece], center: Vec3, axis: Vec3) -> Vec3 {
    let (mut thickness, mut extent) = (0.0_f32, 0.0_f32);
    for piece in placed(mesh, pieces) {
        let PlacedPiece::Triangle(corners) = piece else { return Vec3::ZERO };
        for corner in corners {
            let offset = corner - center;
            let along = offset.dot(axis);
            thickness = thickness.max(along.abs());
            extent = extent.max((offset - along * axis).length());
        }
    }
    if thickness > THICK * extent || extent <= 0.0 {
        return Vec3::ZERO;
    }
    let times = extent / thickness.max(extent / FLATTEST);
    axis * (times * times - 1.0).sqrt()
}

/// How far the pieces reach from the centre, as lengths count for the sphere.
fn reach(mesh: &Mesh, pieces: &[Piece], sphere: &SoftSphere) -> f32 {
    let of_piece = |piece| match piece {
        PlacedPiece::Triangle(corners) => {
            let squared = corners.map(|corner| sphere.distance_squared(corner));
            squared[0].max(squared[1]).max(squared[2]).sqrt()
        }
        PlacedPiece::Ball(ball) => ball.center.distance(sphere.center) + ball.radius,
    };
    placed(mesh, pieces).map(of_piece).fold(0.0, f32::max)
}

#[cfg(test)]
mod tests {
    use rayflock_geom::Sphere;

    use super::super::cut_pieces::whole_pieces;
    use super::*;

    fn measured(mesh: &Mesh) -> SoftSphere {
        measure(mesh, &whole_pieces(mesh).collect::<Vec<_>>()).sphere
    }

    #[test]
    fn a_ball_is_its_own_sphere() {
        let ball = Sphere::new(Vec3::new(1.0, 2.0, 3.0), 0.5);
        let sphere = measured(&Mesh::from_spheres(vec![ball]));
        assert_eq!((sphere.center, sphere.opacity), (ball.center, 1.0));
        assert!((sphere.outer - 0.5).abs() < 1e-4);
        assert!((sphere.inner - SHARPEST * 0.5).abs() < 1e-4);
    }

    #[test]
    fn a_cube_covers_a_quarter_of_its_surface() {
        let corner =
            |i: u8| Vec3::new(f32::from(i & 1), f32::from(i >> 1 & 1), f32::from(i >> 2 & 1));
        let quads =
            [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let triangles: Vec<_> =
            quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
        let mesh = Mesh::from_triangles((0..8).map(corner).collect(), triangles).unwrap();
        let sphere = measured(&mesh);
        assert!(sphere.center.distance(Vec3::splat(0.5)) < 1e-4);
        assert!((sphere.outer - 0.75_f32.sqrt()).abs() < 1e-3);
        let covered = 0.5 * PI * (sphere.inner.powi(2) + sphere.outer.powi(2)) * sphere.opacity;
        assert!((covered - 6.0 / 4.0).abs() < 1e-3, "{covered}");
    }

    #[test]
    fn a_square_is_a_disc_that_covers_all_of_it() {
        let corners = vec![Vec3::ZERO, Vec3::X, Vec3::X + Vec3::Y, Vec3::Y];
        let mesh = Mesh::from_triangles(corners, vec![[0, 1, 2], [0, 2, 3]]).unwrap();
        let sphere = measured(&mesh);
        assert!((sphere.flatness.z - (FLATTEST * FLATTEST - 1.0).sqrt()).abs() < 1e-3);
        let covered = 0.5 * PI * (sphere.inner.powi(2) + sphere.outer.powi(2)) * sphere.opacity;
        assert!((covered - 1.0).abs() < 1e-3, "{covered}");
    }

    #[test]
    fn nothing_is_no_sphere() {
        let found = measure(&Mesh::default(), &[]);
        assert_eq!((found.sphere.opacity, found.bounds.is_empty()), (0.0, true));
    }
}
