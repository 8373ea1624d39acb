//! Meshes with what shading needs to know about them.

use std::sync::Arc;

use glam::{Vec2, Vec3};
use rayflock_geom::{Mesh, PrimId};

use crate::MaterialIdx;

/// The primitives of an object and how they look.
#[derive(Clone, Debug)]
pub struct SurfaceMesh {
    /// Primitives, in object space.
    pub mesh: Arc<Mesh>,
    /// A normal a vertex, of unit length, in object space; empty for flat triangles.
    pub normals: Arc<[Vec3]>,
    /// What does not change when the mesh deforms.
    pub attributes: Arc<SurfaceAttributes>,
}

/// Attributes that stay as a mesh deforms.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SurfaceAttributes {
    /// Texture coordinates a vertex; empty for none.
    pub uvs: Vec<Vec2>,
    /// A colour a vertex that multiplies the material's diffuse colour, linear; empty for none.
    pub colors: Vec<Vec3>,
    /// Which primitive is made of what.
    pub materials: PrimMaterials,
}

/// The material of each primitive.
#[derive(Clone, Debug, PartialEq)]
pub enum PrimMaterials {
    /// One for all.
    Uniform(MaterialIdx),
    /// One a primitive, in the order of their ids.
    PerPrim(Vec<MaterialIdx>),
}

impl PrimMaterials {
    /// The material of primitive `prim_id`.
    #[inline]
    pub fn get(&self, prim_id: PrimId) -> MaterialIdx {
        match self {
            Self::Uniform(material) => *material,
            Self::PerPrim(materials) => materials[prim_id.0 as usize],
        }
    }
}

impl Default for PrimMaterials {
    fn default() -> Self {
        Self::Uniform(MaterialIdx::default())
    }
}

impl SurfaceMesh {
    /// A mesh of one material, with flat triangles and no texture.
    pub fn new(mesh: impl Into<Arc<Mesh>>, material: MaterialIdx) -> Self {
        let materials = PrimMaterials::Uniform(material);
        let attributes = SurfaceAttributes { materials, ..SurfaceAttributes::default() };
        Self { mesh: mesh.into(), normals: Arc::default(), attributes: Arc::new(attributes) }
    }
}
