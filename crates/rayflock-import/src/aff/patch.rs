//! A piece of surface as one command gives it, and how it is read.
//!
//! | Command | What it gives |
//! |---|---|
//! | `p`, `pp` | a polygon, flat or with a normal a corner |
//! | `tt`, `ttp` | a triangle with texture coordinates, flat or with a normal a corner |
//! | `m` | a mesh with an index a corner into positions, normals and texture coordinates each |
//! | `tpa` | a triangle with normals at a list of times |

use std::collections::HashMap;

use glam::{Vec2, Vec3};
use rayflock_scene::VertexKey;

use super::reader::Reader;
use crate::ImportError;
use crate::polygon::triangulate;

/// Some triangles of one material.
#[derive(Clone, Debug, Default)]
pub(super) struct Patch {
    pub(super) positions: Vec<Vec3>,
    /// As many as positions, or none for flat triangles.
    pub(super) normals: Vec<Vec3>,
    /// As many as positions, or none.
    pub(super) uvs: Vec<Vec2>,
    pub(super) triangles: Vec<[u32; 3]>,
}

/// Reads a polygon; one of fewer than three corners has no triangles.
pub(super) fn read_polygon(
    reader: &mut Reader<'_>,
    has_normals: bool,
) -> Result<Patch, ImportError> {
    let corner_count = reader.count("corners", if has_normals { 6 } else { 3 })?;
    let mut patch = Patch::default();
    for _ in 0..corner_count {
        patch.positions.push(reader.vector()?);
        if has_normals {
            patch.normals.push(reader.vector()?);
        }
    }
    patch.triangles = triangulate(&patch.positions);
    Ok(patch)
}

/// Reads a triangle with the name of its texture.
pub(super) fn read_textured_triangle(
    reader: &mut Reader<'_>,
    has_normals: bool,
) -> Result<(Patch, String), ImportError> {
    let texture = reader.name("the name of a texture")?;
    let mut patch = Patch { triangles: vec![[0, 1, 2]], ..Patch::default() };
    for _ in 0..3 {
        patch.positions.push(reader.vector()?);
        if has_normals {
            patch.normals.push(reader.vector()?);
        }
        patch.uvs.push(reader.uv()?);
    }
    Ok((patch, texture))
}

/// Reads a mesh and, if it has texture coordinates, the name of its texture.
pub(super) fn read_mesh(reader: &mut Reader<'_>) -> Result<(Patch, Option<String>), ImportError> {
    const EXPECTED: &str = "\"normals\", \"texturecoords\" or \"triangles\"";
    reader.expect("vertices")?;
    let mut mesh =
        IndexedMesh { positions: read_vectors(reader, "vertices")?, ..Default::default() };
    let mut texture = None;
    loop {
        let section = reader.word(EXPECTED)?;
        match section.bytes {
            b"normals" => mesh.normals = Some(read_vectors(reader, "normals")?),
            b"texturecoords" => {
                let count = reader.count("texture coordinates", 2)?;
                texture = Some(reader.name("the name of a texture")?);
                let uvs: Result<Vec<Vec2>, _> = (0..count).map(|_| reader.uv()).collect();
                mesh.uvs = Some(uvs?);
            }
            b"triangles" => return Ok((mesh.read_triangles(reader)?, texture)),
            _ => return Err(reader.wrong(Some(section), EXPECTED)),
        }
    }
}

fn read_vectors(reader: &mut Reader<'_>, what: &str) -> Result<Vec<Vec3>, ImportError> {
    let count = reader.count(what, 3)?;
    (0..count).map(|_| reader.vector()).collect()
}

/// The columns that the corners of a mesh have indices into.
#[derive(Debug, Default)]
struct IndexedMesh {
    positions: Vec<Vec3>,
    normals: Option<Vec<Vec3>>,
    uvs: Option<Vec<Vec2>>,
}

impl IndexedMesh {
    /// Reads the triangles; each combination of indices becomes a vertex.
    fn read_triangles(&self, reader: &mut Reader<'_>) -> Result<Patch, ImportError> {
        let column_count =
            1 + usize::from(self.normals.is_some()) + usize::from(self.uvs.is_some());
        let count = reader.count("triangles", 3 * column_count)?;
        let mut patch = Patch::default();
        let mut vertices = HashMap::new();
        for _ in 0..count {
            let positions = read_indices(reader, "vertices", Some(&self.positions))?;
            let normals = read_indices(reader, "normals", self.normals.as_ref())?;
            let uvs = read_indices(reader, "texture coordinates", self.uvs.as_ref())?;
            let triangle = [0, 1, 2].map(|corner| {
                let combination = [positions[corner], normals[corner], uvs[corner]];
                let vertex = *vertices.entry(combination).or_insert(patch.positions.len() as u32);
                if vertex as usize == patch.positions.len() {
                    self.add_vertex(combination, &mut patch);
                }
                vertex
            });
            patch.triangles.push(triangle);
        }
        Ok(patch)
    }

    fn add_vertex(&self, [position, normal, uv]: [u32; 3], patch: &mut Patch) {
        patch.positions.push(self.positions[position as usize]);
        patch.normals.extend(self.normals.iter().map(|normals| normals[normal as usize]));
        patch.uvs.extend(self.uvs.iter().map(|uvs| uvs[uv as usize]));
    }
}

/// The indices of three corners into a column; 0 where the mesh does not have it.
fn read_indices<T>(
    reader: &mut Reader<'_>,
    what: &str,
    column: Option<&Vec<T>>,
) -> Result<[u32; 3], ImportError> {
    let Some(column) = column else { return Ok([0; 3]) };
    let mut indices = [0; 3];
    for index in &mut indices {
        *index = reader.index(what, column.len())?;
    }
    Ok(indices)
}

/// Reads an animated triangle: keys of a time and three corners with normals.
pub(super) fn read_animated_triangle(
    reader: &mut Reader<'_>,
) -> Result<Vec<VertexKey>, ImportError> {
    let key_count = reader.count("keys", 19)?;
    if key_count == 0 {
        return Err(reader.invalid("0 keys", "at least one key"));
    }
    let mut keys: Vec<VertexKey> = Vec::with_capacity(key_count);
    for _ in 0..key_count {
        let time = reader.number()?;
        if let Some(before) = keys.last().filter(|before| before.time >= time) {
            let found = format!("a key at {time} after one at {}", before.time);
            return Err(reader.invalid(found, "times that increase"));
        }
        let (mut positions, mut normals) = (Vec::with_capacity(3), Vec::with_capacity(3));
        for _ in 0..3 {
            positions.push(reader.vector()?);
            normals.push(reader.vector()?);
        }
        keys.push(VertexKey { time, positions, normals });
    }
    Ok(keys)
}
