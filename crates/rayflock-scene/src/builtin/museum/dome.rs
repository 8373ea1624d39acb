//! The museum's dome: rings of coffers, each a stucco border around a sunken panel, and a round
//! opening at the top.

use glam::{Affine3A, Vec2, Vec3};

use super::super::surface_builder::SurfaceBuilder;
use super::hall::{around_axis, share_of_turn};
use super::materials::{COFFER, STUCCO};

const SECTORS: u32 = 24;
const RINGS: u32 = 5;
/// Height of the dome's sphere, squeezed, above its foot.
const RISE: f32 = 2.9;
/// The part of a quarter turn that the rings of coffers take; the rest is the opening.
const OPENING_ANGLE: f32 = 1.22;
/// How far a panel lies behind its border.
const DEPTH: f32 = 0.13;

/// Adds the dome whose foot has radius `foot.x` and height `foot.y`.
pub(super) fn dome(surface: &mut SurfaceBuilder, foot: Vec2) {
    let point = |ring: f32, angle: f32| {
        let (sin, cos) = (OPENING_ANGLE * ring / RINGS as f32).sin_cos();
        around_axis(angle, foot.x * cos, foot.y + RISE * sin)
    };
    for ring in 0..RINGS {
        for sector in 0..SECTORS {
            let [left, right] = [sector + 1, sector].map(|idx| share_of_turn(idx, SECTORS));
            let (low, high) = (ring as f32, ring as f32 + 1.0);
            coffer(
                surface,
                [point(low, left), point(low, right), point(high, right), point(high, left)],
            );
        }
    }

    // A collar around the opening.
    let (sin, cos) = OPENING_ANGLE.sin_cos();
    let rim = Vec2::new(foot.x * cos, foot.y + RISE * sin);
    let collar = [rim + Vec2::new(0.0, 0.35), rim];
    surface.lathe(&collar, SECTORS, &Affine3A::IDENTITY, STUCCO);
}

/// Adds a coffer between four corners, counter-clockwise as seen from the hall.
fn coffer(surface: &mut SurfaceBuilder, corners: [Vec3; 4]) {
    let center = corners.iter().sum::<Vec3>() / 4.0;
    let normal = (corners[2] - corners[0]).cross(corners[3] - corners[1]).normalize_or(Vec3::Y);
    let rim = corners.map(|corner| center.lerp(corner, 0.78));
    let panel = corners.map(|corner| center.lerp(corner, 0.62) - DEPTH * normal);
    for side in 0..4 {
        let next = (side + 1) % 4;
        surface.quad([corners[side], corners[next], rim[next], rim[side]], STUCCO);
        surface.quad([rim[side], rim[next], panel[next], panel[side]], STUCCO);
    }
    surface.quad(panel, COFFER);
}
