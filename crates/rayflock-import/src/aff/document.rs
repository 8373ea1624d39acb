//! What an AFF file and all that it includes say, before motion is laid over it.
//!
//! Keys may stand anywhere, the interval too; so places, surfaces and keys are collected first and
//! joined by name in the end.

use std::collections::HashMap;

use glam::{Affine3A, Vec3};
use rayflock_scene::{LocalTransform, Material};

use super::keys::Motion;
use super::looks::{Fill, View};
use super::part::Part;
use crate::texture_files::TextureFiles;

/// The content of the files.
#[derive(Debug)]
pub(super) struct Document {
    pub(super) view: Option<View>,
    /// What rays that hit nothing see; black unless the file says otherwise.
    pub(super) background: Vec3,
    /// Light from everywhere; white unless the file says otherwise.
    pub(super) ambient: Vec3,
    pub(super) interval: Option<Interval>,
    pub(super) lights: Vec<LightSource>,
    pub(super) movers: Vec<Mover>,
    pub(super) parts: Vec<Part>,
    part_idxs: HashMap<(usize, Option<usize>), usize>,
    pub(super) materials: Vec<Material>,
    material_idxs: HashMap<Fill, u32>,
    pub(super) textures: TextureFiles,
    /// By the name of what they move.
    pub(super) motions: HashMap<String, Motion>,
}

/// The animation's time and how many frames it is cut into.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Interval {
    /// The time of the first frame.
    pub(super) start: f64,
    /// The time of the last frame.
    pub(super) end: f64,
    pub(super) frame_count: usize,
}

/// Something that keys may move: an `x` block, a named light, the camera.
#[derive(Clone, Debug)]
pub(super) struct Mover {
    pub(super) name: String,
    pub(super) place: Place,
    /// Where it is when nothing moves it.
    pub(super) rest: LocalTransform,
}

/// A space: that of a mover, with a static transform on top.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    /// A position in the list of movers; `None` for the world.
    pub(super) mover: Option<usize>,
    pub(super) mover_from_here: Affine3A,
}

impl Place {
    pub(super) const WORLD: Self = Self { mover: None, mover_from_here: Affine3A::IDENTITY };
}

/// A point light.
#[derive(Clone, Debug)]
pub(super) struct LightSource {
    pub(super) name: String,
    /// A position in the list of movers; `None` for the world.
    pub(super) mover: Option<usize>,
    /// In the space of its mover.
    pub(super) position: Vec3,
    pub(super) color: Vec3,
}

impl Document {
    pub(super) fn new() -> Self {
        Self {
            view: None,
            background: Vec3::ZERO,
            ambient: Vec3::ONE,
            interval: None,
            lights: Vec::new(),
            movers: Vec::new(),
            parts: Vec::new(),
            part_idxs: HashMap::new(),
            materials: Vec::new(),
            material_idxs: HashMap::new(),
            textures: TextureFiles::default(),
            motions: HashMap::new(),
        }
    }

    /// What inclusion `file_idx` of the file called `name` draws on a mover.
    pub(super) fn part(&mut self, file_idx: usize, name: &str, mover: Option<usize>) -> &mut Part {
        let part_idx = *self.part_idxs.entry((file_idx, mover)).or_insert_with(|| {
            self.parts.push(Part::new(name.to_owned(), mover));
            self.parts.len() - 1
        });
        &mut self.parts[part_idx]
    }

    /// The position of the material of this fill, which gets the name if it is new.
    pub(super) fn material(&mut self, fill: &Fill, name: &str) -> u32 {
        let materials = &mut self.materials;
        *self.material_idxs.entry(*fill).or_insert_with(|| {
            materials.push(fill.material(name));
            materials.len() as u32 - 1
        })
    }
}
