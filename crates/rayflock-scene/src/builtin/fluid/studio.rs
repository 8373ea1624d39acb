//! Where the tank stands: a tiled floor, a metal frame around panes of glass, two lamps.

use glam::{Affine3A, Vec3};

use super::{DARK_TILE, GLASS, LIGHT_TILE, METAL, TANK};
use crate::builtin::surface_builder::SurfaceBuilder;
use crate::{Background, Falloff, Light, LightKind, SurfaceMesh};

/// Half the side of the floor, and how many tiles it has along each side.
const FLOOR: f32 = 7.0;
const TILES: u32 = 28;
/// The floor lies this far below the bottom of the tank.
const BASE: f32 = 0.05;
/// Half the thickness of the frame's bars.
const BAR: f32 = 0.016;

/// A floor of tiles in two colours.
pub(super) fn floor() -> SurfaceMesh {
    let mut builder = SurfaceBuilder::default();
    let size = 2.0 * FLOOR / TILES as f32;
    for row in 0..TILES {
        for column in 0..TILES {
            let corner = |x: u32, z: u32| {
                let along = |count: u32| count as f32 * size - FLOOR;
                Vec3::new(along(column + x), -BASE, along(row + z))
            };
            let corners = [corner(0, 1), corner(1, 1), corner(1, 0), corner(0, 0)];
            let is_light = (row + column) % 2 == 0;
            builder.quad(corners, if is_light { LIGHT_TILE } else { DARK_TILE });
        }
    }
    builder.build()
}

/// The plate under the tank, and bars along its upright edges and around its rim.
pub(super) fn frame() -> SurfaceMesh {
    let mut builder = SurfaceBuilder::default();
    let mut bar = |min: Vec3, max: Vec3| {
        let around = Vec3::splat(BAR);
        builder.block([min - around, max + around], 1, &Affine3A::IDENTITY, METAL);
    };
    bar(Vec3::new(-TANK.x, -BASE + 2.0 * BAR, -TANK.z), TANK.with_y(-BAR - 1e-3));
    for x in [-TANK.x, TANK.x] {
        for z in [-TANK.z, TANK.z] {
            bar(Vec3::new(x, 0.0, z), Vec3::new(x, TANK.y, z));
        }
        bar(Vec3::new(x, TANK.y, -TANK.z), Vec3::new(x, TANK.y, TANK.z));
    }
    for z in [-TANK.z, TANK.z] {
        bar(Vec3::new(-TANK.x, TANK.y, z), Vec3::new(TANK.x, TANK.y, z));
    }
    builder.build()
}

/// The four panes, facing outward; the tank is open.
pub(super) fn panes() -> SurfaceMesh {
    let mut builder = SurfaceBuilder::default();
    let corners = [(-1.0, 1.0), (1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)];
    for side in 0..4 {
        let at = |(x, z): (f32, f32), y: f32| Vec3::new(x * TANK.x, y, z * TANK.z);
        let (left, right) = (corners[side], corners[(side + 1) % 4]);
        let quad = [at(left, 0.0), at(right, 0.0), at(right, TANK.y), at(left, TANK.y)];
        builder.quad(quad, GLASS);
    }
    builder.build()
}

/// A bright hall.
pub(super) fn background() -> Background {
    Background::Gradient {
        zenith: Vec3::new(0.40, 0.52, 0.70),
        horizon: Vec3::new(0.72, 0.76, 0.80),
        ground: Vec3::splat(0.25),
    }
}

/// A lamp high above, so that little lies in the full shadow that glass casts, and a fill.
pub(super) fn lights() -> Vec<Light> {
    let light = |name: &str, position: Vec3, intensity: Vec3| Light {
        name: name.to_owned(),
        node: None,
        kind: LightKind::Point { position, intensity, falloff: Falloff::InverseSquare },
    };
    vec![
        light("key", Vec3::new(-1.6, 6.0, 1.6), Vec3::new(78.0, 73.0, 64.0)),
        light("fill", Vec3::new(4.0, 3.0, 6.0), Vec3::new(30.0, 33.0, 38.0)),
    ]
}
