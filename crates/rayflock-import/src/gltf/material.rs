//! From physically based materials to those of a Whitted renderer.
//!
//! | Ours | From base colour `c`, metalness `m`, roughness `r`, index of refraction `n` |
//! |---|---|
//! | `f0` | `((n - 1) / (n + 1))^2` for what is no metal, `c` for metal, mixed by `m` |
//! | gloss | `(1 - r)^2`: the share of the reflection that is sharp enough for a mirror |
//! | `mirror` | `f0 * gloss`, with Schlick's Fresnel |
//! | `diffuse` | `c * (1 - m * gloss)`: what a rough metal scatters widely counts as diffuse |
//! | `shininess` | `2 / r^4 - 2`, the Blinn exponent of the GGX roughness `r^2`, in 1..=1000 |
//! | `specular` | `f0 * (shininess + 8) / 8`, at most 1: normalised Blinn-Phong |
//! | `transmission` | `c` times the factor of `KHR_materials_transmission`, dielectric Fresnel |
//! | `absorption` | `-ln(colour) / distance` of `KHR_materials_volume` |
//!
//! A metallic-roughness texture counts with its mean. Factors are 1 by default, so without their
//! textures everything would be white metal: a missing colour texture stands for [`MISSING`]
//! grey, a missing metallic-roughness texture for a rough non-metal. `KHR_materials_pbrSpecularGlossiness` gives `c`, `f0` and `1 - r` itself. Blended
//! materials let light straight through in proportion to `1 - alpha`; textured alpha is ignored.
//!
//! **Source.** glTF 2.0, appendix B; Walter et al., "Microfacet Models for Refraction through
//! Rough Surfaces", EGSR 2007 (exponent).

use glam::{Vec3, Vec4};
use gltf::json::extensions::material::Material as Extensions;
use gltf::json::material::{AlphaMode, Material as JsonMaterial};
use gltf::json::validation::Checked;
use gltf::json::{Root, texture::Info};
use rayflock_scene::{Fresnel, Material, MaterialIdx, Scene, TextureIdx};

use super::label;
use super::textures::Images;
use crate::ImportError;
use crate::job::Job;

/// Mean reflectance of a colour texture that cannot be had.
const MISSING: f32 = 0.5;

/// The terms of the table that a surface is described in.
struct Surface {
    base: Vec3,
    alpha: f32,
    base_texture: Option<TextureIdx>,
    f0: Vec3,
    metalness: f32,
    roughness: f32,
}

/// Adds the file's materials and their textures, then one for primitives without a material.
pub(super) fn load(
    root: &Root,
    buffers: &[Vec<u8>],
    scene: &mut Scene,
    job: &mut Job<'_>,
) -> Result<(), ImportError> {
    let mut images = Images::new(root, buffers);
    for (idx, json) in root.materials.iter().enumerate() {
        let element = label("material", idx, json.name.as_ref());
        let material = convert(json, &element, &mut images, job);
        check_finite(&material, &element, job)?;
        scene.materials.push(material);
    }
    let mut primitives = root.meshes.iter().flat_map(|mesh| &mesh.primitives);
    if root.materials.is_empty() || primitives.any(|primitive| primitive.material.is_none()) {
        scene.materials.push(Material { name: "default".to_owned(), ..Material::default() });
    }
    scene.textures = images.into_textures();
    Ok(())
}

/// The material of a primitive.
pub(super) fn material_idx(root: &Root, primitive: &gltf::json::mesh::Primitive) -> MaterialIdx {
    let idx = primitive.material.map_or(root.materials.len(), |material| material.value());
    MaterialIdx(idx as u32)
}

/// The slot that the texture coordinates of a primitive must serve.
pub(super) fn color_slot(json: &JsonMaterial) -> Option<&Info> {
    let glossiness = json.extensions.as_ref().and_then(|all| all.pbr_specular_glossiness.as_ref());
    match glossiness {
        Some(glossiness) => glossiness.diffuse_texture.as_ref(),
        None => json.pbr_metallic_roughness.base_color_texture.as_ref(),
    }
}

fn convert(
    json: &JsonMaterial,
    element: &str,
    images: &mut Images<'_>,
    job: &mut Job<'_>,
) -> Material {
    let none = Extensions::default();
    let extensions = json.extensions.as_ref().unwrap_or(&none);
    let ior = extensions.ior.as_ref().map_or(1.5, |ior| ior.ior.0.max(1.0));
    let surface = surface(json, extensions, ior, images, job);

    let gloss = (1.0 - surface.roughness).powi(2);
    let shininess = (2.0 / surface.roughness.powi(4) - 2.0).clamp(1.0, 1000.0);
    let diffuse = surface.base * (1.0 - surface.metalness * gloss);
    let mut material = Material {
        name: json.name.clone().unwrap_or_default(),
        ambient: diffuse,
        diffuse,
        diffuse_texture: surface.base_texture,
        specular: (surface.f0 * (shininess + 8.0) / 8.0).min(Vec3::ONE),
        shininess,
        mirror: surface.f0 * gloss,
        ior,
        fresnel: Fresnel::Schlick,
        emission: emission(json, extensions, element, job),
        ..Material::default()
    };
    if extensions.unlit.is_some() {
        (material.specular, material.mirror) = (Vec3::ZERO, Vec3::ZERO);
    }
    let transmits = extensions.transmission.as_ref().map_or(0.0, |it| it.transmission_factor.0);
    if transmits > 0.0 {
        make_glass(&mut material, &surface, transmits.min(1.0), extensions);
    } else {
        blend(&mut material, &surface, json, element, job);
    }
    material
}

fn surface(
    json: &JsonMaterial,
    extensions: &Extensions,
    ior: f32,
    images: &mut Images<'_>,
    job: &mut Job<'_>,
) -> Surface {
    let slot = color_slot(json);
    let base_texture = slot.and_then(|info| images.color(info, job));
    let stand_in = if slot.is_some() && base_texture.is_none() { MISSING } else { 1.0 };
    if let Some(glossiness) = &extensions.pbr_specular_glossiness {
        let color = Vec4::from(glossiness.diffuse_factor.0);
        let roughness = (1.0 - glossiness.glossiness_factor.0).clamp(0.0, 1.0);
        let f0 = Vec3::from(glossiness.specular_factor.0);
        // The texture is not read, and beside it a factor of 1 does not stand for a mirror.
        let textured = glossiness.specular_glossiness_texture.is_some();
        let f0 = if textured { 0.04 * f0 } else { f0 };
        let (base, alpha) = (stand_in * color.truncate(), color.w);
        return Surface { base, alpha, base_texture, f0, metalness: 0.0, roughness };
    }
    let pbr = &json.pbr_metallic_roughness;
    let (mut metalness, mut roughness) = (pbr.metallic_factor.0, pbr.roughness_factor.0);
    if let Some(info) = &pbr.metallic_roughness_texture {
        let mean = images.mean(info, job);
        metalness *= mean.map_or(0.0, |mean| mean.z);
        roughness = mean.map_or(1.0, |mean| roughness * mean.y);
    }
    let metalness = metalness.clamp(0.0, 1.0);
    let color = Vec4::from(pbr.base_color_factor.0);
    let (base, alpha) = (stand_in * color.truncate(), color.w);
    let f0 = Vec3::splat(((ior - 1.0) / (ior + 1.0)).powi(2)).lerp(base, metalness);
    Surface { base, alpha, base_texture, f0, metalness, roughness: roughness.clamp(0.0, 1.0) }
}

fn emission(
    json: &JsonMaterial,
    extensions: &Extensions,
    element: &str,
    job: &mut Job<'_>,
) -> Vec3 {
    let factor = Vec3::from(json.emissive_factor.0);
    if factor != Vec3::ZERO && json.emissive_texture.is_some() {
        // Most of such a texture is black; its mean would make the whole surface glow.
        job.warn(element, "emission from a texture is not supported; it is left out");
        return Vec3::ZERO;
    }
    let strength = extensions.emissive_strength.as_ref();
    factor * strength.map_or(1.0, |strength| strength.emissive_strength.0)
}

fn make_glass(material: &mut Material, surface: &Surface, transmits: f32, extensions: &Extensions) {
    let share = transmits * (1.0 - surface.metalness);
    material.transmission = surface.base * share;
    material.diffuse *= 1.0 - share;
    material.ambient = material.diffuse;
    material.fresnel = Fresnel::Dielectric;
    if let Some(volume) = &extensions.volume {
        let color = Vec3::from(volume.attenuation_color.0).clamp(Vec3::splat(1e-6), Vec3::ONE);
        let distance = volume.attenuation_distance.0.max(1e-6);
        material.absorption = -color.map(f32::ln) / distance;
    }
}

fn blend(
    material: &mut Material,
    surface: &Surface,
    json: &JsonMaterial,
    element: &str,
    job: &mut Job<'_>,
) {
    let Checked::Valid(mode) = json.alpha_mode else { return };
    if mode == AlphaMode::Opaque {
        return;
    }
    if material.diffuse_texture.is_some() {
        job.warn(element, "alpha in the texture is not supported; the texture is opaque");
    }
    let alpha = surface.alpha.clamp(0.0, 1.0);
    if mode == AlphaMode::Blend && alpha < 1.0 {
        material.transmission = Vec3::splat(1.0 - alpha);
        material.ior = 1.0;
        material.diffuse *= alpha;
        material.ambient = material.diffuse;
    }
}

fn check_finite(material: &Material, element: &str, job: &Job<'_>) -> Result<(), ImportError> {
    let colors = [
        material.diffuse,
        material.specular,
        material.mirror,
        material.transmission,
        material.absorption,
        material.emission,
    ];
    let sound = |color: &Vec3| color.is_finite() && color.min_element() >= 0.0;
    if colors.iter().all(sound) && material.ior.is_finite() && material.shininess.is_finite() {
        return Ok(());
    }
    Err(job.invalid(
        element,
        "factors that are negative or not finite",
        "finite factors, 0 or more",
    ))
}
