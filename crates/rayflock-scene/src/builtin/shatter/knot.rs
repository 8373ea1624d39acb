//! A trefoil knot of porcelain with two cobalt bands between gold lines.

use std::f32::consts::TAU;

use glam::{Vec2, Vec3};

use super::fragments::unshared;
use super::{COBALT, GOLD, PORCELAIN};
use crate::builtin::surface_builder::SurfaceBuilder;
use crate::{MaterialIdx, SurfaceMesh};

/// Pieces along the knot and around its tube.
const LENGTH_PIECES: u32 = 288;
const TUBE_PIECES: u32 = 40;
const TUBE_RADIUS: f32 = 0.27;
/// Size of the curve, and where its middle is.
const SCALE: f32 = 0.43;
const CENTER: Vec3 = Vec3::new(0.0, 1.85, 0.0);
/// How often the pieces wind around the tube; a whole number.
const WINDINGS: f32 = -2.0;
/// A band begins every so many pieces around the tube.
const BAND_PERIOD: u32 = 20;

/// The knot, closed, with three vertices a triangle.
pub(super) fn surface() -> SurfaceMesh {
    let mut builder = SurfaceBuilder::default();
    for ring in 0..=LENGTH_PIECES {
        let along = TAU * (ring % LENGTH_PIECES) as f32 / LENGTH_PIECES as f32;
        let (center, [right, up]) = (curve(along), frame(along));
        for piece in 0..=TUBE_PIECES {
            let around = TAU * (piece % TUBE_PIECES) as f32 / TUBE_PIECES as f32;
            let around = around + WINDINGS * along;
            let normal = around.cos() * right + around.sin() * up;
            builder.vertex(CENTER + center + TUBE_RADIUS * normal, normal, Vec2::ZERO);
        }
    }
    builder.grid(0, [TUBE_PIECES, LENGTH_PIECES], glaze);
    unshared(&builder.build())
}

fn curve(along: f32) -> Vec3 {
    let (sin, cos) = along.sin_cos();
    let (sin2, cos2) = (2.0 * along).sin_cos();
    SCALE * Vec3::new(sin + 2.0 * sin2, cos - 2.0 * cos2, -(3.0 * along).sin())
}

/// Two directions across the tube: away from the middle, which the curve never meets, and the
/// one square to that.
fn frame(along: f32) -> [Vec3; 2] {
    let step = 1e-2;
    let tangent = (curve(along + step) - curve(along - step)).normalize_or(Vec3::X);
    let right = curve(along).reject_from_normalized(tangent).normalize_or(Vec3::X);
    [right, tangent.cross(right)]
}

/// The bands and their lines run along the tube's pieces, which wind.
fn glaze(piece: u32, _ring: u32) -> MaterialIdx {
    match piece % BAND_PERIOD {
        0 | 8 => GOLD,
        1..8 => COBALT,
        _ => PORCELAIN,
    }
}

#[cfg(test)]
mod tests {
    use std::collections::HashMap;

    use super::*;

    #[test]
    fn the_knot_is_closed_to_the_bit() {
        let surface = surface();
        let mut edges = HashMap::new();
        for corners in surface.mesh.vertices().chunks_exact(3) {
            for (from, to) in [(0, 1), (1, 2), (2, 0)] {
                let bits = |corner: usize| corners[corner].to_array().map(f32::to_bits);
                *edges.entry((bits(from), bits(to))).or_insert(0) += 1;
            }
        }
        // Each edge is met once, and once the other way round.
        assert!(edges.iter().all(|(&(a, b), &count)| count == 1 && edges.contains_key(&(b, a))));
        assert_eq!(surface.mesh.triangles().len(), 23_040);
    }

    #[test]
    fn normals_point_outward() {
        let surface = surface();
        for (corners, normals) in
            surface.mesh.vertices().chunks_exact(3).zip(surface.normals.chunks_exact(3))
        {
            let facing = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
            assert!(facing.dot(normals[0]) > 0.0);
        }
    }
}
