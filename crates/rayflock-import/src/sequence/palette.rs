//! Materials by name, and the objects of a frame as one.

use std::collections::HashMap;
use std::sync::Arc;

use glam::{Vec2, Vec3};
use rayflock_geom::{GeometryError, Mesh, PrimId};
use rayflock_scene::{Material, MaterialIdx, PrimMaterials, SurfaceAttributes, SurfaceMesh};

use crate::mesh_parts::vertex_normals;

/// The materials of a sequence by their names.
#[derive(Debug)]
pub(crate) struct Palette {
    by_name: HashMap<String, MaterialIdx>,
    /// For names that are not among them.
    other: MaterialIdx,
}

impl Palette {
    /// The palette of these materials, to which a light grey one without a name is added if there
    /// is none.
    pub(crate) fn new(materials: &mut Vec<Material>) -> Self {
        if !materials.iter().any(|material| material.name.is_empty()) {
            materials.push(Material::default());
        }
        let named = |(idx, material): (u32, &Material)| (material.name.clone(), MaterialIdx(idx));
        let by_name: HashMap<_, _> = (0..).zip(&*materials).map(named).collect();
        let other = by_name.get("").copied().unwrap_or_default();
        Self { by_name, other }
    }

    /// For each of a frame's materials, the one of the sequence.
    pub(crate) fn translate(&self, materials: &[Material]) -> Vec<MaterialIdx> {
        let known = |material: &Material| self.by_name.get(&material.name).copied();
        materials.iter().map(|material| known(material).unwrap_or(self.other)).collect()
    }
}

/// All of `surfaces` as one mesh, one behind the other, with `materials[i]` in place of material
/// i. Attributes that only some have get a neutral value in the others, missing normals come from
/// the triangles.
pub(crate) fn joined(
    surfaces: &[&SurfaceMesh],
    materials: &[MaterialIdx],
) -> Result<SurfaceMesh, GeometryError> {
    let (mesh, normals) = match surfaces {
        [only] => (Arc::clone(&only.mesh), Arc::clone(&only.normals)),
        _ => (Arc::new(joined_mesh(surfaces)?), joined_normals(surfaces)),
    };
    let attributes = Arc::new(SurfaceAttributes {
        uvs: joined_column(surfaces, |attributes| &attributes.uvs, Vec2::ZERO),
        colors: joined_column(surfaces, |attributes| &attributes.colors, Vec3::ONE),
        materials: joined_materials(surfaces, materials),
    });
    Ok(SurfaceMesh { mesh, normals, attributes })
}

fn joined_mesh(surfaces: &[&SurfaceMesh]) -> Result<Mesh, GeometryError> {
    let (mut vertices, mut triangles, mut spheres) = (Vec::new(), Vec::new(), Vec::new());
    for surface in surfaces {
        // A file with room for more vertices than this can count does not fit into memory.
        let first = vertices.len() as u32;
        let shifted = |corners: &[u32; 3]| corners.map(|corner| first + corner);
        triangles.extend(surface.mesh.triangles().iter().map(shifted));
        vertices.extend_from_slice(surface.mesh.vertices());
        spheres.extend_from_slice(surface.mesh.spheres());
    }
    Ok(Mesh::from_triangles(vertices, triangles)?.with_spheres(spheres))
}

fn joined_normals(surfaces: &[&SurfaceMesh]) -> Arc<[Vec3]> {
    if surfaces.iter().all(|surface| surface.normals.is_empty()) {
        return Arc::default();
    }
    let normals = |surface: &&SurfaceMesh| match &*surface.normals {
        [] => vertex_normals(&surface.mesh),
        normals => normals.to_vec(),
    };
    surfaces.iter().flat_map(normals).collect()
}

fn joined_column<T: Copy>(
    surfaces: &[&SurfaceMesh],
    column: impl Fn(&SurfaceAttributes) -> &Vec<T>,
    neutral: T,
) -> Vec<T> {
    if surfaces.iter().all(|surface| column(&surface.attributes).is_empty()) {
        return Vec::new();
    }
    let mut values = Vec::new();
    for surface in surfaces {
        values.extend_from_slice(column(&surface.attributes));
        // Columns are empty or complete.
        if column(&surface.attributes).is_empty() {
            values.resize(values.len() + surface.mesh.vertices().len(), neutral);
        }
    }
    values
}

/// Triangles of all surfaces come first, then spheres, as their ids do.
fn joined_materials(surfaces: &[&SurfaceMesh], materials: &[MaterialIdx]) -> PrimMaterials {
    let (mut of_triangles, mut of_spheres) = (Vec::new(), Vec::new());
    for surface in surfaces {
        let material = |prim: usize| {
            let idx = surface.attributes.materials.get(PrimId(prim as u32));
            materials.get(idx.0 as usize).copied().unwrap_or_default()
        };
        let triangle_count = surface.mesh.triangles().len();
        of_triangles.extend((0..triangle_count).map(material));
        of_spheres.extend((triangle_count..surface.mesh.prim_count()).map(material));
    }
    of_triangles.append(&mut of_spheres);
    match of_triangles.as_slice() {
        [first, rest @ ..] if rest.iter().any(|material| material != first) => {
            PrimMaterials::PerPrim(of_triangles)
        }
        [first, ..] => PrimMaterials::Uniform(*first),
        [] => PrimMaterials::default(),
    }
}
