//! What surfaces look like, in the terms of a Whitted renderer.

use std::sync::Arc;

use glam::Vec3;

/// Position of a material in [`Scene::materials`](crate::Scene::materials).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct MaterialIdx(pub u32);

/// Position of a texture in [`Scene::textures`](crate::Scene::textures).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct TextureIdx(pub u32);

/// A surface: diffuse, with a highlight, a mirror and a transmitting part. Colours are linear
/// sRGB.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Name in the file, for messages.
    pub name: String,
    /// Share of ambient light that is sent back.
    pub ambient: Vec3,
    /// Share of light that is scattered (Lambert).
    pub diffuse: Vec3,
    /// Multiplies `diffuse` and `ambient`, by the surface's texture coordinates.
    pub diffuse_texture: Option<TextureIdx>,
    /// Strength of the Blinn-Phong highlight of lights.
    pub specular: Vec3,
    /// Exponent of the highlight.
    pub shininess: f32,
    /// Share of light mirrored at normal incidence; grazing rays see more (Schlick) where
    /// `fresnel` says so.
    pub mirror: Vec3,
    /// Share of light let through, refracted by `ior`.
    pub transmission: Vec3,
    /// Index of refraction inside, relative to outside.
    pub ior: f32,
    /// Absorption inside a transmitting solid, per scene unit (Beer-Lambert).
    pub absorption: Vec3,
    /// How mirror and transmission depend on the angle.
    pub fresnel: Fresnel,
    /// Light sent out, as radiance; a surface that emits is a light.
    pub emission: Vec3,
}

/// How the mirrored share depends on the angle of incidence.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Fresnel {
    /// Not at all, as in classic Whitted and BART scenes.
    #[default]
    Constant,
    /// Schlick's approximation from `mirror` at normal incidence (metals, varnish). Where `mirror`
    /// is below 4 %, the least of any smooth surface, it stands for a rough one and rises less.
    Schlick,
    /// The equations of a dielectric with `ior`, whatever `mirror` says: what is not mirrored is
    /// transmitted (glass).
    Dielectric,
}

impl Default for Material {
    /// Light grey, diffuse.
    fn default() -> Self {
        Self {
            name: String::new(),
            ambient: Vec3::splat(0.7),
            diffuse: Vec3::splat(0.7),
            diffuse_texture: None,
            specular: Vec3::ZERO,
            shininess: 32.0,
            mirror: Vec3::ZERO,
            transmission: Vec3::ZERO,
            ior: 1.5,
            absorption: Vec3::ZERO,
            fresnel: Fresnel::Constant,
            emission: Vec3::ZERO,
        }
    }
}

/// An image to look up, shared between scenes. Wraps around in both directions.
#[derive(Clone, Debug, PartialEq)]
pub struct Texture {
    /// Name in the file, for messages.
    pub name: String,
    /// Pixels a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Linear sRGB, rows from the top; `texels.len() == width * height`. Texture coordinate
    /// (0, 0) is the top left corner, as in glTF.
    pub texels: Arc<[[f32; 3]]>,
}

/// What rays that hit nothing see.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Background {
    /// One radiance everywhere.
    Uniform(Vec3),
    /// From the horizon upward to the zenith and downward to the ground.
    Gradient {
        /// Straight up.
        zenith: Vec3,
        /// Level.
        horizon: Vec3,
        /// Straight down.
        ground: Vec3,
    },
}

impl Default for Background {
    fn default() -> Self {
        Self::Uniform(Vec3::ZERO)
    }
}
