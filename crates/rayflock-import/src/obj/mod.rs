//! Wavefront OBJ with MTL: polygons in named groups, with materials by face.
//!
//! Objects are the names of `o` and `g`; faces of one name are one object wherever they stand.
//! Polygons are cut into fans from their first corner. Coordinates keep +Y up; texture
//! coordinates have their origin at the bottom left and are flipped. Vertex colours
//! (`v x y z r g b`) are taken for sRGB; a fourth coordinate, which matters to rational curves
//! only, is ignored. Lines, points and free-form surfaces are not drawn.
//!
//! **Source.** Wavefront Technologies, "Object Files (.obj)" and "MTL material format",
//! Advanced Visualizer appendix B1, 1995.
//!
//! **Departures.** The parser is our own because messages must name the line, vertices must keep
//! the order of the file ([`assemble`] says why), one object may have many materials, and no
//! input may make it panic.

mod assemble;
mod mtl;
mod parse;
mod statement;

#[cfg(test)]
mod tests;

use std::collections::HashMap;

use rayflock_scene::{Material, Scene, Shape};

use crate::ImportError;
use crate::job::{Job, Looks};
use crate::mesh_parts::VertexPoints;
use crate::texture_files::TextureFiles;
use parse::ObjFile;

/// Reads an OBJ file and the MTL files beside it.
pub(crate) fn load(bytes: Vec<u8>, job: &mut Job<'_>) -> Result<Scene, ImportError> {
    load_with_points(bytes, job).map(|(scene, _)| scene)
}

/// Reads an OBJ file like [`load`], and tells which `v` each vertex has.
pub(crate) fn load_with_points(
    bytes: Vec<u8>,
    job: &mut Job<'_>,
) -> Result<(Scene, VertexPoints), ImportError> {
    let mut file = parse::parse(&bytes, job)?;
    drop(bytes);
    let mut scene = Scene { name: job.name(), ..Scene::default() };
    add_materials(&file, &mut scene, job);
    let mut objects = Vec::new();
    let mut points = VertexPoints { count: file.positions.len(), of_vertices: Vec::new() };
    for group in std::mem::take(&mut file.groups) {
        let name = if group.name.is_empty() { job.name() } else { group.name.clone() };
        let element = format!("object \"{name}\"");
        let (parts, points_of_group) = assemble::mesh_parts(&file, &group);
        objects.push((name, Shape::Fixed(parts.build(&element, job)?)));
        points.of_vertices.extend(points_of_group);
    }
    job.add_upright(&mut scene, objects);
    Ok((scene, points))
}

/// Adds a material for each name in the file, at the same position.
fn add_materials(file: &ObjFile, scene: &mut Scene, job: &mut Job<'_>) {
    if job.looks == Looks::Names {
        let named = |name: &String| Material { name: name.clone(), ..Material::default() };
        scene.materials = file.material_names.iter().map(named).collect();
        return;
    }
    let mut library = HashMap::new();
    for name in &file.libraries {
        match job.read_neighbour(name) {
            Ok(bytes) => mtl::parse(name, &bytes, &mut library, job),
            Err(reason) => {
                job.warn("mtllib", format!("{reason}; its materials are light grey"));
            }
        }
    }
    let mut textures = TextureFiles::default();
    let mut unknown = Vec::new();
    for name in &file.material_names {
        let material = match library.get(name) {
            Some(definition) => definition.material(name, &mut textures, job),
            None => {
                unknown.push(name.as_str());
                Material { name: name.clone(), ..Material::default() }
            }
        };
        scene.materials.push(material);
    }
    // Faces before any `usemtl` have no name, and of missing libraries was told already.
    unknown.retain(|name| !name.is_empty());
    if !unknown.is_empty() && !library.is_empty() {
        let names = unknown.join(", ");
        job.warn("usemtl", format!("no MTL file defines {names}; they are light grey"));
    }
    scene.textures = textures.textures;
}
