//! What stands and hangs in the museum: pedestal, barrier, benches and pictures.

use std::f32::consts::TAU;

use glam::{Affine3A, Vec2, Vec3};

use super::super::surface_builder::SurfaceBuilder;
use super::hall::{around_axis, share_of_turn};
use super::materials::{BLOCK, BRASS, LEATHER, MARBLE_RED, ROPE, WOOD, canvas, frame};

/// Height of the pedestal's top: the heap of triangles lies above it.
const PEDESTAL_TOP: f32 = 1.47;

/// Adds the pedestal: a step, a twisted stem and an eight-sided block.
pub(super) fn pedestal(surface: &mut SurfaceBuilder) {
    let step = [(0.72, 0.0), (0.72, 0.1), (0.6, 0.1), (0.6, 0.2), (0.0, 0.2)];
    surface.lathe(&step.map(Vec2::from), 16, &Affine3A::IDENTITY, MARBLE_RED);
    stem(surface);
    let top = PEDESTAL_TOP;
    let block = [
        (0.0, top - 0.13),
        (0.44, top - 0.13),
        (0.52, top - 0.08),
        (0.52, top - 0.02),
        (0.5, top),
        (0.0, top),
    ];
    surface.lathe(&block.map(Vec2::from), 8, &Affine3A::from_rotation_y(TAU / 16.0), BLOCK);
}

/// Adds the stem: its cross-section is a flower of six petals that turns on the way up.
fn stem(surface: &mut SurfaceBuilder) {
    const SEGMENTS: u32 = 36;
    const ROWS: u32 = 14;
    let radius_at = |angle: f32, height: f32| {
        let waist = 0.27 + 0.14 * (2.0 * height - 1.0).powi(2);
        waist * (1.0 + 0.11 * (6.0 * (angle + 1.4 * height)).cos())
    };
    let point = |segment: u32, row: u32| {
        let (angle, height) = (share_of_turn(segment, SEGMENTS), row as f32 / ROWS as f32);
        around_axis(-angle, radius_at(angle, height), 0.2 + height * (PEDESTAL_TOP - 0.33))
    };
    let first = surface.vertex_count();
    for row in 0..=ROWS {
        for segment in 0..=SEGMENTS {
            let along = point(segment + 1, row) - point(segment + SEGMENTS - 1, row);
            let upward = point(segment, (row + 1).min(ROWS)) - point(segment, row.max(1) - 1);
            let normal = along.cross(upward).normalize_or(Vec3::Y);
            surface.vertex(point(segment, row), -normal, Vec2::ZERO);
        }
    }
    surface.grid(first, [SEGMENTS, ROWS], |_, _| BLOCK);
}

/// Adds eight brass posts around the pedestal, with ropes between them.
pub(super) fn barrier(surface: &mut SurfaceBuilder) {
    const POSTS: u32 = 8;
    const RADIUS: f32 = 1.45;
    const HEIGHT: f32 = 0.78;
    let profile = [
        (0.14, 0.0),
        (0.13, 0.025),
        (0.025, 0.05),
        (0.022, HEIGHT),
        (0.045, HEIGHT + 0.04),
        (0.0, HEIGHT + 0.08),
    ];
    for post in 0..POSTS {
        let [here, next] = [post, post + 1].map(|idx| {
            let angle = share_of_turn(idx, POSTS) + TAU / 16.0;
            around_axis(angle, RADIUS, 0.0)
        });
        surface.lathe(&profile.map(Vec2::from), 8, &Affine3A::from_translation(here), BRASS);
        rope(surface, here + HEIGHT * Vec3::Y, next + HEIGHT * Vec3::Y);
    }
}

/// Adds a rope that sags between two points.
fn rope(surface: &mut SurfaceBuilder, from: Vec3, to: Vec3) {
    const PIECES: u32 = 8;
    const SIDES: u32 = 5;
    let side = (to - from).cross(Vec3::Y).normalize_or(Vec3::X);
    let first = surface.vertex_count();
    for piece in 0..=PIECES {
        let share = piece as f32 / PIECES as f32;
        let center = from.lerp(to, share) - 0.22 * (1.0 - (2.0 * share - 1.0).powi(2)) * Vec3::Y;
        for turn in 0..=SIDES {
            let (sin, cos) = share_of_turn(turn, SIDES).sin_cos();
            let normal = cos * side + sin * Vec3::Y;
            surface.vertex(center + 0.022 * normal, normal, Vec2::ZERO);
        }
    }
    surface.grid(first, [SIDES, PIECES], |_, _| ROPE);
}

/// Adds a bench whose long side faces +Z, at the origin of `place`.
pub(super) fn bench(surface: &mut SurfaceBuilder, place: &Affine3A) {
    let mut block = |min: (f32, f32, f32), max: (f32, f32, f32), pieces, material| {
        surface.block([Vec3::from(min), Vec3::from(max)], pieces, place, material);
    };
    block((-0.70, 0.34, -0.21), (0.70, 0.38, 0.21), 1, WOOD);
    for cushion in 0..3 {
        let left = -0.69 + 0.463 * cushion as f32;
        block((left, 0.38, -0.20), (left + 0.45, 0.46, 0.20), 1, LEATHER);
    }
    for x in [-0.62, 0.54] {
        block((x, 0.0, -0.18), (x + 0.08, 0.34, -0.10), 1, WOOD);
        block((x, 0.0, 0.10), (x + 0.08, 0.34, 0.18), 1, WOOD);
    }
}

/// Adds picture `painting` in its frame, on a wall at the origin of `place` that faces +Z.
pub(super) fn picture(surface: &mut SurfaceBuilder, place: &Affine3A, painting: u32) {
    /// Half the size of the canvas, and its place on the wall.
    const HALF: Vec2 = Vec2::new(0.68, 0.85);
    const CENTER: Vec3 = Vec3::new(0.0, 2.35, 0.12);
    // How far the frame's profile lies outside the canvas and before it, from within outward.
    const PROFILE: [(f32, f32); 6] =
        [(0.0, 0.0), (0.01, 0.03), (0.05, 0.03), (0.10, 0.08), (0.14, 0.07), (0.14, -0.12)];
    const SIGNS: [Vec2; 4] =
        [Vec2::new(-1.0, -1.0), Vec2::new(1.0, -1.0), Vec2::new(1.0, 1.0), Vec2::new(-1.0, 1.0)];

    let corner = |side: usize, (outside, before): (f32, f32)| {
        let flat = SIGNS[side % 4] * (HALF + Vec2::splat(outside));
        place.transform_point3(CENTER + flat.extend(before))
    };
    surface.patch([0, 1, 2, 3].map(|side| corner(side, PROFILE[0])), [2, 2], canvas(painting));
    for side in 0..4 {
        for ends in PROFILE.windows(2) {
            let [inner, outer] = [ends[0], ends[1]];
            let corners = [
                corner(side, outer),
                corner(side + 1, outer),
                corner(side + 1, inner),
                corner(side, inner),
            ];
            surface.quad(corners, frame(painting));
        }
    }
}
