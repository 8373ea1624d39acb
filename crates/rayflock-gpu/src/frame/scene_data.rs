//! Materials, textures and emitters of a frame, on the device.

use glam::Vec3;
use rayflock_engine::Budget;
use rayflock_render::prepared::{Emitter, EmitterShape, PreparedFrame};
use rayflock_scene::{Fresnel, Material, Scene, Texture};
use wgpu::Buffer;

use crate::GpuContext;
use crate::buffer::GrowingBuffer;
use crate::layout::{DeviceEmitter, SPHERE, TRIANGLE};

/// Texels that a scene may have: those and some materials are what a binding may hold.
pub(super) const MOST_TEXELS: usize = 7 << 20;

/// Entries of a material, as in `frame/shade_surface.wgsl`.
const MATERIAL_ENTRIES: usize = 7;

/// Four numbers.
type Entry = [f32; 4];

/// Materials, textures and emitters.
#[derive(Debug)]
pub(super) struct SceneData {
    materials: Vec<Material>,
    textures: Vec<Texture>,
    entries: GrowingBuffer,
    emitters: GrowingBuffer,
    emitter_count: usize,
}

impl Default for SceneData {
    fn default() -> Self {
        Self {
            materials: Vec::new(),
            textures: Vec::new(),
            entries: GrowingBuffer::storage("materials and textures"),
            emitters: GrowingBuffer::storage("emitters"),
            emitter_count: 0,
        }
    }
}

impl SceneData {
    /// Sends what a frame of `scene` needs, if it is not there yet.
    pub(super) fn commit(&mut self, context: &GpuContext, scene: &Scene, prepared: &PreparedFrame) {
        let same_texels =
            |(a, b): (&Texture, &Texture)| std::sync::Arc::ptr_eq(&a.texels, &b.texels);
        let has_textures = self.textures.len() == scene.textures.len()
            && self.textures.iter().zip(&scene.textures).all(same_texels);
        let is_there = self.entries.size() > 0 && has_textures && self.materials == scene.materials;
        if !is_there {
            self.materials.clone_from(&scene.materials);
            self.textures.clone_from(&scene.textures);
            self.entries.write(context, &self.write_entries());
        }
        let mut sum = 0.0;
        let emitters: Vec<_> =
            prepared.emitters().iter().map(|emitter| write_emitter(emitter, &mut sum)).collect();
        self.emitter_count = emitters.len();
        self.emitters.reserve(context, size_of::<DeviceEmitter>());
        self.emitters.write(context, &emitters);
    }

    /// Materials, then textures, then texels.
    pub(super) fn entries(&self) -> &Buffer {
        self.entries.buffer()
    }

    /// Where textures begin among the entries.
    pub(super) const fn first_texture(&self) -> usize {
        MATERIAL_ENTRIES * self.materials.len()
    }

    pub(super) fn emitters(&self) -> &Buffer {
        self.emitters.buffer()
    }

    pub(super) const fn emitter_count(&self) -> usize {
        self.emitter_count
    }

    /// Whether rays may go on after they hit something.
    pub(super) fn mirrors(&self) -> bool {
        self.materials
            .iter()
            .any(|material| material.fresnel != Fresnel::Constant || material.mirror != Vec3::ZERO)
            || self.transmits()
    }

    /// Whether rays may go on in two directions.
    pub(super) fn transmits(&self) -> bool {
        self.materials.iter().any(|material| material.transmission != Vec3::ZERO)
    }

    /// Tells what is held.
    pub(super) fn hold(&self, budget: &mut Budget) {
        self.entries.hold(budget);
        self.emitters.hold(budget);
    }

    fn write_entries(&self) -> Vec<Entry> {
        let mut entries: Vec<Entry> = self.materials.iter().flat_map(write_material).collect();
        let mut first_texel = entries.len() + self.textures.len();
        for texture in &self.textures {
            // All below 2^24, which floats hold exactly.
            let numbers = [first_texel, texture.width, texture.height, 0];
            entries.push(numbers.map(|number| number as f32));
            first_texel += texture.texels.len();
        }
        let texels = self.textures.iter().flat_map(|texture| texture.texels.iter());
        entries.extend(texels.map(|&[r, g, b]| [r, g, b, 0.0]));
        if entries.is_empty() {
            entries.push(Entry::default());
        }
        entries
    }
}

fn write_material(material: &Material) -> [Entry; MATERIAL_ENTRIES] {
    let fresnel = match material.fresnel {
        Fresnel::Constant => 0.0,
        Fresnel::Schlick => 1.0,
        Fresnel::Dielectric => 2.0,
    };
    let texture = material.diffuse_texture.map_or(0, |idx| idx.0 + 1) as f32;
    let entry = |v: Vec3, w: f32| [v.x, v.y, v.z, w];
    [
        entry(material.ambient, material.shininess),
        entry(material.diffuse, material.ior),
        entry(material.specular, fresnel),
        entry(material.mirror, texture),
        entry(material.transmission, 0.0),
        entry(material.absorption, 0.0),
        entry(material.emission, 0.0),
    ]
}

/// An emitter, with the sum of all weights so far.
fn write_emitter(emitter: &Emitter, sum: &mut f32) -> DeviceEmitter {
    *sum += emitter.weight;
    let (kind, [a, b, c]) = match emitter.shape {
        EmitterShape::Triangle(corners) => (TRIANGLE, corners),
        EmitterShape::Sphere(sphere) => {
            (SPHERE, [sphere.center, Vec3::new(sphere.radius, 0.0, 0.0), Vec3::ZERO])
        }
    };
    DeviceEmitter {
        a: a.to_array(),
        kind,
        b: b.to_array(),
        weight: emitter.weight,
        c: c.to_array(),
        cumulative: *sum,
        radiance: emitter.radiance.to_array(),
        unused: 0,
    }
}
