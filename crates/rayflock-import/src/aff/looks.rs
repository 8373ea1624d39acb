//! What things look like and from where: fills, lights, the view.
//!
//! | Ours | From `fm`: ambient, diffuse, specular, `Shine`, `T`, `ior` |
//! |---|---|
//! | `ambient`, `diffuse` | the same |
//! | `specular`, `mirror` | specular: classic ray tracers mirror as much as lights gleam |
//! | `shininess` | four times `Shine`: Blinn's exponent for a highlight as wide as Phong's |
//! | `transmission` | `T`, bent by `ior`; straight through where `ior` is 0 |
//!
//! `f` is NFF's form of the same: a colour times `Kd` is diffuse, `Ks` is specular and colourless,
//! and there is no ambient share. Lights do not fall off with distance; their colour is the
//! intensity that the diffuse share is multiplied with.
//!
//! Colours and shares of fills and the background were chosen on screens, where shades were shown
//! as they were computed, so they are taken for sRGB; light, ambient light too, is taken for
//! linear. What one white light shines on squarely then looks as it did.
//!
//! **Departures.** NFF's surfaces are seen from one side only; ours are from both.

use std::f32::consts::PI;

use glam::{Affine3A, Mat3A, Quat, Vec3};
use rayflock_scene::{Falloff, LightKind, LocalTransform, Material, TextureIdx};

use super::document::Interval;
use super::reader::Reader;
use crate::ImportError;
use crate::texture::linear;

/// Blinn's exponent for each of Phong's.
const BLINN_FROM_PHONG: f32 = 4.0;

/// A fill colour and its texture, as bits, so that equal ones are found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub(super) struct Fill {
    /// Ambient, diffuse, specular.
    colors: [[u32; 3]; 3],
    /// Phong's exponent, transmitted share, index of refraction.
    numbers: [u32; 3],
    texture: Option<TextureIdx>,
}

impl Fill {
    /// Matte white, for shapes before any fill.
    pub(super) fn white() -> Self {
        Self::new([Vec3::ZERO, Vec3::ONE, Vec3::ZERO], [1.0, 0.0, 1.0])
    }

    fn new(colors: [Vec3; 3], numbers: [f32; 3]) -> Self {
        // Negative shares would take light away.
        let bits = |number: f32| number.max(0.0).to_bits();
        let colors = colors.map(|color| color.to_array().map(bits));
        Self { colors, numbers: numbers.map(bits), texture: None }
    }

    /// The same with a texture, or with none.
    pub(super) fn with_texture(self, texture: Option<TextureIdx>) -> Self {
        Self { texture, ..self }
    }

    /// The material of this name.
    pub(super) fn material(&self, name: &str) -> Material {
        let color = |bits: [u32; 3]| Vec3::from(bits.map(f32::from_bits)).map(linear);
        let [ambient, diffuse, specular] = self.colors.map(color);
        let [phong, transmitted, ior] = self.numbers.map(f32::from_bits);
        Material {
            name: name.to_owned(),
            ambient,
            diffuse,
            diffuse_texture: self.texture,
            specular,
            shininess: (BLINN_FROM_PHONG * phong).clamp(1.0, 1000.0),
            mirror: specular.min(Vec3::ONE),
            transmission: Vec3::splat(linear(transmitted).min(1.0)),
            ior: if ior > 0.0 { ior } else { 1.0 },
            ..Material::default()
        }
    }
}

/// Reads `f`: a colour, `Kd`, `Ks`, `Shine`, `T` and the index of refraction.
pub(super) fn read_nff_fill(reader: &mut Reader<'_>) -> Result<Fill, ImportError> {
    let color = reader.vector()?;
    let [kd, ks, phong, transmitted, ior] = reader.numbers()?.map(|number| number as f32);
    let colors = [Vec3::ZERO, kd * color, Vec3::splat(ks)];
    Ok(Fill::new(colors, [phong, transmitted, ior]))
}

/// Reads `fm`: three colours, `Shine`, `T` and the index of refraction.
pub(super) fn read_fill(reader: &mut Reader<'_>) -> Result<Fill, ImportError> {
    let colors = [reader.vector()?, reader.vector()?, reader.vector()?];
    Ok(Fill::new(colors, reader.numbers()?.map(|number| number as f32)))
}

/// The light of an `l` of this colour.
pub(super) fn light_kind(position: Vec3, color: Vec3) -> LightKind {
    // Classic shading multiplies colour, share and cosine; ours also divides by pi.
    let intensity = PI * color.max(Vec3::ZERO);
    LightKind::Point { position, intensity, falloff: Falloff::Constant }
}

/// Reads a light's position and, if it has one, its colour.
pub(super) fn read_light(reader: &mut Reader<'_>) -> Result<(Vec3, Vec3), ImportError> {
    let position = reader.vector()?;
    let color = if reader.has_number() { reader.vector()? } else { Vec3::ONE };
    Ok((position, color))
}

/// The view of a `v`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct View {
    pub(super) from: Vec3,
    pub(super) rotation: Quat,
    /// In radians.
    pub(super) vertical_fov: f32,
}

impl View {
    pub(super) fn to_affine(self) -> Affine3A {
        Affine3A::from_rotation_translation(self.rotation, self.from)
    }

    /// The same in parts, which keys can replace.
    pub(super) fn to_parts(self) -> LocalTransform {
        let (translation, rotation, scale) = (self.from, self.rotation, Vec3::ONE);
        LocalTransform::Parts { translation, rotation, scale }
    }
}

/// Reads `v`. `hither` and `resolution` are for programs that clip and that ask no one for a size.
pub(super) fn read_view(reader: &mut Reader<'_>) -> Result<View, ImportError> {
    reader.expect("from")?;
    let from = reader.vector()?;
    reader.expect("at")?;
    let at = reader.vector()?;
    reader.expect("up")?;
    let up = reader.vector()?;
    reader.expect("angle")?;
    let angle = reader.number()?;
    reader.expect("hither")?;
    reader.number()?;
    reader.expect("resolution")?;
    let _size: [f64; 2] = reader.numbers()?;
    if !(angle > 0.0 && angle < 180.0) {
        let found = format!("a view with an angle of {angle}");
        return Err(reader.invalid(found, "an angle between 0 and 180 degrees"));
    }
    let Some(rotation) = look_rotation(at - from, up) else {
        let found = format!("a view from {from} at {at} with {up} upward");
        return Err(reader.invalid(found, "two places, and an upward direction beside their line"));
    };
    Ok(View { from, rotation, vertical_fov: (angle as f32).to_radians() })
}

/// The rotation that makes a camera look along `forward` with `up` upward in the picture.
fn look_rotation(forward: Vec3, up: Vec3) -> Option<Quat> {
    let back = -forward.try_normalize()?;
    let right = up.try_normalize()?.cross(back).try_normalize()?;
    Some(Quat::from_mat3a(&Mat3A::from_cols(right.into(), back.cross(right).into(), back.into())))
}

/// Reads `a`: the times of the first and the last frame, and how many frames there are.
pub(super) fn read_interval(reader: &mut Reader<'_>) -> Result<Interval, ImportError> {
    let [start, end] = reader.numbers()?;
    let count = reader.integer()?;
    let frame_count = usize::try_from(count).unwrap_or(0);
    if frame_count == 0 {
        return Err(reader.invalid(format!("an animation of {count} frames"), "at least one"));
    }
    if end < start || (end == start && frame_count > 1) {
        let found = format!("an animation from {start} to {end}");
        return Err(reader.invalid(found, "an end after the start"));
    }
    Ok(Interval { start, end, frame_count })
}

/// Reads `b`: what rays that hit nothing see.
pub(super) fn read_background(reader: &mut Reader<'_>) -> Result<Vec3, ImportError> {
    Ok(reader.vector()?.max(Vec3::ZERO).map(linear))
}
