//! glTF 2.0, as `.gltf` with its buffers beside it or inside, or as `.glb`.
//!
//! Read: nodes, the default scene's instances, triangles (lists, strips, fans, with or without
//! indices), skins, morph targets, clips with all three interpolations, materials ([`material`]
//! says how they are mapped), base-colour textures, vertex colours, cameras, and
//! `KHR_lights_punctual`. Objects are numbered by node, then by primitive; a mesh on several
//! nodes is loaded once and shared.
//!
//! **Source.** Khronos, "glTF 2.0 Specification", 2021, and the extensions it names.
//!
//! **Departures.** Light is unitless: candela and lux are taken as radiant intensity and
//! irradiance. Samplers are ignored; textures wrap. Normal, occlusion and emissive textures are
//! ignored. Points and lines are not drawn.
//!
//! **Invariants.** The `gltf` crate's own readers reach `unreachable!` or index out of bounds on
//! some wrong input, so this module takes only its JSON types and their validation; `document`
//! checks first what the validation trusts, and `accessor` reads nothing that it has not checked.

mod accessor;
mod animation;
mod buffers;
mod document;
mod influences;
mod light_camera;
mod material;
mod mesh;
mod node;
mod skin;
mod textures;

#[cfg(test)]
mod tests;

use gltf::json::root::Index;
use rayflock_scene::{NodeIdx, Scene, SceneObject, Shape};

use crate::ImportError;
use crate::job::Job;
use accessor::Accessors;
use mesh::{MeshLibrary, Primitive};

/// Reads a `.gltf` or `.glb` file; its first bytes say which.
pub(crate) fn load(bytes: Vec<u8>, job: &mut Job<'_>) -> Result<Scene, ImportError> {
    let (root, blob) = document::parse(&bytes, job)?;
    drop(bytes);
    let buffers = buffers::load(&root, blob, job)?;
    let accessors = Accessors::new(&root, &buffers, job.file);
    let hierarchy = node::load(&root, job)?;

    let mut scene = Scene { name: job.name(), nodes: hierarchy.nodes, ..Scene::default() };
    material::load(&root, &buffers, &mut scene, job)?;
    add_objects(&accessors, &hierarchy.drawn, &mut scene, job)?;
    scene.clips = animation::load(&accessors, &mut scene.nodes, job)?;
    light_camera::load(&root, &hierarchy.drawn, &mut scene, job)?;
    Ok(scene)
}

/// An object for each primitive of each node's mesh.
fn add_objects(
    accessors: &Accessors<'_>,
    drawn: &[NodeIdx],
    scene: &mut Scene,
    job: &mut Job<'_>,
) -> Result<(), ImportError> {
    let root = accessors.root;
    let mut library = MeshLibrary::default();
    let mut skins = skin::SkinLibrary::default();
    for &node_idx in drawn {
        let node = &root.nodes[node_idx.0 as usize];
        let Some(mesh) = node.mesh else { continue };
        let mesh_name = root.meshes[mesh.value()].name.as_ref();
        let name = node.name.as_ref().or(mesh_name).cloned();
        let name = name.unwrap_or_else(|| format!("node {}", node_idx.0));
        for (primitive_idx, primitive) in library.primitives(mesh, accessors, job)? {
            let name = match primitive_idx {
                0 => name.clone(),
                _ => format!("{name}.{primitive_idx}"),
            };
            let key = (mesh.value(), *primitive_idx);
            let shape = shape(primitive, node.skin, key, accessors, &mut skins, job)?;
            scene.objects.push(SceneObject { name, node: Some(node_idx), mask: u32::MAX, shape });
        }
    }
    Ok(())
}

/// What a primitive is on a node with or without a skin.
fn shape(
    primitive: &Primitive,
    skin: Option<Index<gltf::json::Skin>>,
    key: (usize, usize),
    accessors: &Accessors<'_>,
    skins: &mut skin::SkinLibrary,
    job: &mut Job<'_>,
) -> Result<Shape, ImportError> {
    let skin = match (skin, &primitive.influences) {
        (Some(skin), Some(influences)) => {
            Some(skins.bind(skin, key, influences, primitive, accessors)?)
        }
        (Some(_), None) => {
            let message = "the node has a skin, but there are no JOINTS_0 and WEIGHTS_0; the mesh \
                           moves with its node";
            job.warn(&primitive.element, message);
            None
        }
        (None, _) => None,
    };
    if skin.is_none() && primitive.targets.is_empty() {
        return Ok(Shape::Fixed(primitive.surface.clone()));
    }
    let (rest, targets) = (primitive.surface.clone(), primitive.targets.clone());
    Ok(Shape::Deformed { rest, targets, skin })
}

/// How messages call a part of the file: its kind, its position and its name.
fn label(kind: &str, idx: usize, name: Option<&String>) -> String {
    match name {
        Some(name) if !name.is_empty() => format!("{kind} {idx} \"{name}\""),
        _ => format!("{kind} {idx}"),
    }
}
