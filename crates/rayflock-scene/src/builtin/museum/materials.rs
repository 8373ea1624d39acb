//! The museum's materials. Mirrored shares are BART's: floor, sculpture and block half, frames
//! from three to six tenths.

use glam::Vec3;

use super::super::{matte, polished};
use super::paintings::PAINTING_COUNT;
use crate::{Fresnel, Material, MaterialIdx, TextureIdx};

pub(super) const SCULPTURE: MaterialIdx = MaterialIdx(0);
pub(super) const BLOCK: MaterialIdx = MaterialIdx(1);
pub(super) const WALL: MaterialIdx = MaterialIdx(2);
pub(super) const STUCCO: MaterialIdx = MaterialIdx(3);
pub(super) const COLUMN: MaterialIdx = MaterialIdx(4);
pub(super) const COFFER: MaterialIdx = MaterialIdx(5);
pub(super) const MARBLE_PALE: MaterialIdx = MaterialIdx(6);
pub(super) const MARBLE_DARK: MaterialIdx = MaterialIdx(7);
pub(super) const MARBLE_RED: MaterialIdx = MaterialIdx(8);
pub(super) const WOOD: MaterialIdx = MaterialIdx(9);
pub(super) const LEATHER: MaterialIdx = MaterialIdx(10);
pub(super) const BRASS: MaterialIdx = MaterialIdx(11);
pub(super) const ROPE: MaterialIdx = MaterialIdx(12);
const FIRST_FRAME: u32 = 13;
const FRAME_KINDS: u32 = 4;

/// The gilding of the frame around painting `painting`.
pub(super) const fn frame(painting: u32) -> MaterialIdx {
    MaterialIdx(FIRST_FRAME + painting % FRAME_KINDS)
}

/// The canvas of painting `painting`.
pub(super) const fn canvas(painting: u32) -> MaterialIdx {
    MaterialIdx(FIRST_FRAME + FRAME_KINDS + painting)
}

/// All materials, in the order of the indices above.
pub(super) fn materials() -> Vec<Material> {
    let mut materials = vec![
        mirror("sculpture", Vec3::new(0.40, 0.25, 0.10), 0.5),
        mirror("block", Vec3::splat(0.10), 0.5),
        matte("wall", Vec3::new(0.13, 0.22, 0.25)),
        matte("stucco", Vec3::new(0.58, 0.54, 0.46)),
        polished("column", Vec3::new(0.56, 0.52, 0.45), 0.04),
        matte("coffer", Vec3::new(0.09, 0.17, 0.27)),
        mirror("pale marble", Vec3::new(0.34, 0.32, 0.27), 0.5),
        mirror("dark marble", Vec3::new(0.03, 0.05, 0.05), 0.5),
        mirror("red marble", Vec3::new(0.24, 0.06, 0.04), 0.5),
        polished("wood", Vec3::new(0.22, 0.10, 0.045), 0.05),
        polished("leather", Vec3::new(0.36, 0.06, 0.06), 0.04),
        mirror("brass", Vec3::new(0.42, 0.29, 0.09), 0.4),
        matte("rope", Vec3::new(0.42, 0.04, 0.06)),
    ];
    let gildings = [(0.45, 0.30, 0.10), (0.30, 0.15, 0.07), (0.38, 0.36, 0.33), (0.42, 0.25, 0.08)];
    for (kind, color) in gildings.into_iter().enumerate() {
        materials.push(mirror("frame", Vec3::from(color), 0.3 + 0.1 * kind as f32));
    }
    for painting in 0..PAINTING_COUNT {
        let diffuse_texture = Some(TextureIdx(painting));
        materials.push(Material { diffuse_texture, ..matte("canvas", Vec3::splat(0.75)) });
    }
    materials
}

/// A surface that mirrors `share` at every angle, tinted a little like its colour.
fn mirror(name: &str, color: Vec3, share: f32) -> Material {
    Material {
        mirror: Vec3::splat(share),
        specular: Vec3::splat(0.5),
        shininess: 50.0,
        fresnel: Fresnel::Constant,
        ..matte(name, color)
    }
}
