//! The museum's hall: a rotunda with eight columns, eight pictures and a coffered dome that is
//! open to the sky. The axis is +Y through the origin, the floor at `y == 0`.

use std::f32::consts::{FRAC_PI_4, FRAC_PI_8, TAU};

use glam::{Affine3A, Vec2, Vec3};

use super::super::surface_builder::SurfaceBuilder;
use super::materials::{COLUMN, MARBLE_DARK, MARBLE_PALE, MARBLE_RED, STUCCO, WALL};
use super::{dome, furniture};
use crate::{MaterialIdx, SurfaceMesh};

/// Radius of the wall's inner face.
pub(super) const WALL_RADIUS: f32 = 6.4;
/// Radius of the circle on which the columns stand.
const COLUMN_CIRCLE: f32 = 5.6;
/// No column, bench or cornice is nearer to the axis than this.
#[cfg(test)]
pub(super) const INNER_RADIUS: f32 = 5.05;
/// Where columns end and the cornice begins.
const CORNICE_FOOT: f32 = 4.55;
/// Where the cornice ends and the dome begins: radius and height.
const CORNICE_TOP: Vec2 = Vec2::new(5.3, 5.1);
/// Columns and pictures each.
const BAY_COUNT: u32 = 8;
const WALL_SEGMENTS: u32 = 64;

/// The hall and all that stands in it, but for the sculpture.
pub(super) fn surface() -> SurfaceMesh {
    let mut surface = SurfaceBuilder::default();
    floor(&mut surface);
    walls(&mut surface);
    for bay in 0..BAY_COUNT {
        column(&mut surface, &at_angle(bay_angle(bay) + FRAC_PI_8, COLUMN_CIRCLE));
        let place = at_angle(bay_angle(bay), WALL_RADIUS);
        furniture::picture(&mut surface, &place, bay);
        if bay % 2 == 0 {
            furniture::bench(&mut surface, &at_angle(bay_angle(bay), COLUMN_CIRCLE - 0.1));
        }
    }
    furniture::barrier(&mut surface);
    furniture::pedestal(&mut surface);
    dome::dome(&mut surface, CORNICE_TOP);
    surface.build()
}

fn bay_angle(bay: u32) -> f32 {
    bay as f32 * FRAC_PI_4
}

/// A place on the circle of `radius` whose +Z points to the axis and whose +X runs to the right
/// as seen from there.
pub(super) fn at_angle(angle: f32, radius: f32) -> Affine3A {
    let turn = Affine3A::from_rotation_y(angle);
    turn * Affine3A::from_translation(Vec3::new(0.0, 0.0, -radius))
}

/// Rings of marble around the pedestal: a checkered field between red bands.
fn floor(surface: &mut SurfaceBuilder) {
    const RINGS: [f32; 11] = [0.0, 0.75, 1.15, 1.65, 2.2, 2.8, 3.45, 4.15, 4.9, 5.15, WALL_RADIUS];
    const SEGMENTS: u32 = 48;
    // Downward as a profile, so that the surface faces up.
    let profile: Vec<Vec2> = RINGS.iter().rev().map(|&radius| Vec2::new(radius, 0.0)).collect();
    surface.lathe_with(&profile, SEGMENTS, &Affine3A::IDENTITY, floor_material);
}

fn floor_material(segment: u32, ring: u32) -> MaterialIdx {
    match ring {
        0 => MARBLE_PALE,
        1 | 8 => MARBLE_RED,
        9 => MARBLE_DARK,
        _ if (segment / 2 + ring).is_multiple_of(2) => MARBLE_PALE,
        _ => MARBLE_DARK,
    }
}

fn walls(surface: &mut SurfaceBuilder) {
    let turned = |surface: &mut SurfaceBuilder, points: &[(f32, f32)], material| {
        let profile: Vec<Vec2> = points.iter().map(|&point| Vec2::from(point)).collect();
        surface.lathe(&profile, WALL_SEGMENTS, &Affine3A::IDENTITY, material);
    };
    // Profiles run downward: the surfaces face the axis.
    let wall = WALL_RADIUS;
    turned(surface, &[(wall, CORNICE_FOOT), (wall, 2.8), (wall, 1.0)], WALL);
    let dado = [(wall, 1.0), (wall - 0.08, 1.0), (wall - 0.08, 0.92), (wall - 0.03, 0.86)];
    turned(surface, &dado, STUCCO);
    turned(
        surface,
        &[(wall - 0.03, 0.86), (wall - 0.03, 0.3), (wall - 0.07, 0.25), (wall - 0.07, 0.0)],
        STUCCO,
    );
    let (top, foot) = (CORNICE_TOP, CORNICE_FOOT);
    let cornice = [
        (top.x, top.y),
        (top.x - 0.2, top.y),
        (top.x - 0.22, top.y - 0.1),
        (top.x - 0.05, top.y - 0.22),
        (top.x - 0.05, foot + 0.1),
        (top.x, foot + 0.1),
        (top.x, foot),
        (wall, foot),
    ];
    turned(surface, &cornice, STUCCO);
}

/// A column with base, swelling shaft and capital.
fn column(surface: &mut SurfaceBuilder, place: &Affine3A) {
    const SEGMENTS: u32 = 14;
    const PROFILE: [(f32, f32); 13] = [
        (0.36, 0.12),
        (0.38, 0.17),
        (0.36, 0.23),
        (0.29, 0.26),
        (0.27, 0.34),
        (0.275, 1.5),
        (0.255, 2.9),
        (0.23, 4.1),
        (0.26, 4.14),
        (0.24, 4.18),
        (0.25, 4.26),
        (0.33, 4.38),
        (0.35, 4.45),
    ];
    surface.lathe(&PROFILE.map(Vec2::from), SEGMENTS, place, COLUMN);
    for (half, ends) in [(0.4, [0.0, 0.12]), (0.4, [4.45, CORNICE_FOOT])] {
        let corners = [Vec3::new(-half, ends[0], -half), Vec3::new(half, ends[1], half)];
        surface.block(corners, 1, place, COLUMN);
    }
}

/// The point at `angle` around the axis, in the direction from which [`at_angle`] starts.
pub(super) fn around_axis(angle: f32, radius: f32, y: f32) -> Vec3 {
    at_angle(angle, radius).transform_point3(Vec3::Y * y)
}

/// The angle of piece `idx` of `count` around the axis.
pub(super) fn share_of_turn(idx: u32, count: u32) -> f32 {
    TAU * (idx % count) as f32 / count as f32
}
