//! The plaza of the crowd: paving, a fountain, trees in planters, and houses around.

use std::f32::consts::FRAC_PI_2;

use glam::{Affine3A, Vec2, Vec3};
use rayflock_geom::{Mesh, Sphere};

use crate::builtin::random::Random;
use crate::builtin::surface_builder::SurfaceBuilder;
use crate::builtin::{matte, polished};
use crate::{Fresnel, Material, MaterialIdx, SurfaceMesh};

const PAVING: [MaterialIdx; 4] = [MaterialIdx(0), MaterialIdx(1), MaterialIdx(2), MaterialIdx(3)];
const STONE: MaterialIdx = MaterialIdx(4);
const WATER: MaterialIdx = MaterialIdx(5);
const TRUNK: MaterialIdx = MaterialIdx(6);
const LEAVES: MaterialIdx = MaterialIdx(7);
const WINDOW: MaterialIdx = MaterialIdx(8);
const ROOF: MaterialIdx = MaterialIdx(9);
const FIRST_PLASTER: u32 = 10;
const PLASTERS: [[f32; 3]; 4] =
    [[0.62, 0.45, 0.28], [0.60, 0.52, 0.42], [0.58, 0.34, 0.24], [0.45, 0.47, 0.46]];

/// The materials, in the order of the indices above.
pub(super) fn materials() -> Vec<Material> {
    let mut materials = vec![
        matte("light slab", Vec3::new(0.47, 0.44, 0.39)),
        matte("warm slab", Vec3::new(0.44, 0.38, 0.30)),
        matte("grey slab", Vec3::new(0.36, 0.35, 0.33)),
        polished("dark slab", Vec3::new(0.24, 0.22, 0.21), 0.02),
        matte("stone", Vec3::new(0.58, 0.55, 0.50)),
        Material {
            fresnel: Fresnel::Schlick,
            ..polished("water", Vec3::new(0.06, 0.16, 0.18), 0.12)
        },
        matte("trunk", Vec3::new(0.16, 0.10, 0.06)),
        matte("leaves", Vec3::new(0.13, 0.25, 0.06)),
        polished("window", Vec3::new(0.05, 0.07, 0.09), 0.15),
        matte("roof", Vec3::new(0.34, 0.14, 0.09)),
    ];
    materials.extend(PLASTERS.map(|color| matte("plaster", Vec3::from(color))));
    materials
}

/// The plaza and all that stands on it.
pub(super) fn surface() -> SurfaceMesh {
    let mut builder = SurfaceBuilder::default();
    paving(&mut builder);
    fountain(&mut builder);
    for tree in TREES {
        planter(&mut builder, tree);
    }
    houses(&mut builder);
    builder.build()
}

/// Slabs as far as the houses, in fields of three by three between dark bands.
fn paving(builder: &mut SurfaceBuilder) {
    const HALF_COUNT: i32 = 14;
    const SLAB: f32 = 0.9;
    let mut random = Random::new(11);
    for row in -HALF_COUNT..=HALF_COUNT {
        for column in -HALF_COUNT..=HALF_COUNT {
            let [x, z] = [column, row].map(|idx| SLAB * (idx as f32 - 0.5));
            let dark = row % 4 == 0 || column % 4 == 0;
            let kind = if dark { 3 } else { random.between(0.0, 3.0) as usize };
            let corner = |right: f32, back: f32| Vec3::new(x + right * SLAB, 0.0, z + back * SLAB);
            let corners = [corner(0.0, 1.0), corner(1.0, 1.0), corner(1.0, 0.0), corner(0.0, 0.0)];
            builder.quad(corners, PAVING[kind]);
        }
    }
}

/// A basin, and a bowl on a column that overflows.
fn fountain(builder: &mut SurfaceBuilder) {
    let mut lathe = |profile: &[(f32, f32)], segments: u32, material: MaterialIdx| {
        let profile: Vec<Vec2> = profile.iter().map(|&point| Vec2::from(point)).collect();
        builder.lathe(&profile, segments, &Affine3A::IDENTITY, material);
    };
    let basin = [
        (1.55, 0.0),
        (1.55, 0.10),
        (1.38, 0.12),
        (1.36, 0.42),
        (1.42, 0.46),
        (1.42, 0.52),
        (1.20, 0.52),
        (1.20, 0.05),
    ];
    lathe(&basin, 40, STONE);
    lathe(&[(1.21, 0.42), (0.0, 0.42)], 40, WATER);
    let column =
        [(0.30, 0.05), (0.28, 0.55), (0.14, 0.65), (0.11, 1.0), (0.16, 1.15), (0.45, 1.28)];
    lathe(&column, 20, STONE);
    lathe(&[(0.45, 1.28), (0.66, 1.42), (0.66, 1.46), (0.60, 1.46), (0.60, 1.38)], 28, STONE);
    lathe(&[(0.61, 1.43), (0.0, 1.43)], 28, WATER);
    lathe(
        &[(0.09, 1.38), (0.07, 1.7), (0.13, 1.76), (0.05, 1.82), (0.10, 1.95), (0.0, 2.06)],
        14,
        STONE,
    );
}

/// Where trees stand.
const TREES: [Vec2; 6] = [
    Vec2::new(-7.6, -4.6),
    Vec2::new(-4.2, -6.6),
    Vec2::new(4.0, -6.7),
    Vec2::new(7.7, -4.4),
    Vec2::new(-8.4, 0.8),
    Vec2::new(8.5, 1.0),
];

fn planter(builder: &mut SurfaceBuilder, at: Vec2) {
    let place = Affine3A::from_translation(Vec3::new(at.x, 0.0, at.y));
    let rim = [(0.75, 0.0), (0.75, 0.4), (0.62, 0.4), (0.62, 0.3), (0.0, 0.3)];
    builder.lathe(&rim.map(Vec2::from), 8, &place, STONE);
    let trunk = [(0.13, 0.25), (0.10, 1.2), (0.08, 2.3), (0.0, 2.6)];
    builder.lathe(&trunk.map(Vec2::from), 8, &place, TRUNK);
}

/// The crowns of the trees: clusters of spheres.
pub(super) fn crowns() -> SurfaceMesh {
    const LEAF_BALLS: usize = 26;
    let mut random = Random::new(5);
    let mut spheres = Vec::new();
    for tree in TREES {
        for _ in 0..LEAF_BALLS {
            let offset = random.direction() * Vec3::new(0.75, 0.62, 0.75);
            let center = Vec3::new(tree.x, 2.55, tree.y) + offset;
            spheres.push(Sphere::new(center, random.between(0.28, 0.5)));
        }
    }
    SurfaceMesh::new(Mesh::from_spheres(spheres), LEAVES)
}

/// Rows of houses behind and on both sides.
fn houses(builder: &mut SurfaceBuilder) {
    let mut random = Random::new(2);
    for (turn, distance) in [(0.0, 10.5), (FRAC_PI_2, 12.0), (-FRAC_PI_2, 12.0)] {
        let row = Affine3A::from_rotation_y(turn)
            * Affine3A::from_translation(Vec3::new(0.0, 0.0, -distance));
        let mut left = -13.0;
        let mut plaster = random.between(0.0, 4.0) as u32;
        while left < 13.0 {
            let (width, floors) = (random.between(3.2, 4.8), random.between(2.0, 4.0) as u32);
            plaster = (plaster + 1 + random.between(0.0, 3.0) as u32) % PLASTERS.len() as u32;
            house(
                builder,
                &row,
                left,
                [width, floors as f32],
                MaterialIdx(FIRST_PLASTER + plaster),
            );
            left += width;
        }
    }
}

/// A house whose front lies at `z == 0` of `row`: `size` is its width and its number of floors.
fn house(
    builder: &mut SurfaceBuilder,
    row: &Affine3A,
    left: f32,
    [width, floors]: [f32; 2],
    plaster: MaterialIdx,
) {
    const FLOOR_HEIGHT: f32 = 2.3;
    const PITCH: f32 = 1.1;
    let (right, top) = (left + width, FLOOR_HEIGHT * floors + 0.4);
    builder.block([Vec3::new(left, 0.0, -4.0), Vec3::new(right, top, 0.0)], 2, row, plaster);
    builder.block([Vec3::new(left, top, -4.0), Vec3::new(right, top + 0.12, 0.15)], 1, row, STONE);
    let roof = |x: f32, y: f32, z: f32| row.transform_point3(Vec3::new(x, y, z));
    let eaves = top + 0.12;
    builder.quad(
        [
            roof(left, eaves, 0.15),
            roof(right, eaves, 0.15),
            roof(right, eaves + PITCH, -2.0),
            roof(left, eaves + PITCH, -2.0),
        ],
        ROOF,
    );

    // Windows stand out of the wall by a hand's breadth, in frames of stone.
    let columns = (width / 1.25) as u32;
    for floor in 0..floors as u32 {
        for column in 0..columns {
            let x = left + width * (column as f32 + 0.5) / columns as f32;
            let y = 0.75 + FLOOR_HEIGHT * floor as f32;
            let around = |half: f32, margin: f32, depth: f32| {
                [
                    Vec3::new(x - half, y - margin, -0.1),
                    Vec3::new(x + half, y + 1.2 + margin, depth),
                ]
            };
            builder.block(around(0.37, 0.07, 0.05), 1, row, STONE);
            builder.block(around(0.30, 0.0, 0.06), 1, row, WINDOW);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn crowns_hang_over_their_planters() {
        let crowns = crowns();
        for sphere in crowns.mesh.spheres() {
            let at = Vec2::new(sphere.center.x, sphere.center.z);
            assert!(TREES.iter().any(|tree| tree.distance(at) < 1.0));
            assert!(sphere.center.y - sphere.radius > 1.2);
        }
    }
}
