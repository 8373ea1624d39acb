//! All triangles of a frame as one mesh in world space.

use glam::Vec3;
use rayflock_geom::{Geometry, GeometryObject, transform_point};

use super::SunError;

/// All triangles of a frame as one mesh in world space: objects in the order of their ids, each
/// with all of its vertices.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct WorldMesh {
    vertices: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
}

impl WorldMesh {
    /// The triangles of `geometry`. Those of an object that its transform mirrors are turned over,
    /// so that corners run counter-clockwise as seen from the side that faces outward.
    ///
    /// # Errors
    /// [`SunError::NoTriangles`] and [`SunError::TooManyVertices`].
    pub fn new(geometry: &Geometry) -> Result<Self, SunError> {
        let mut mesh = Self::default();
        for object in geometry.objects() {
            mesh.add(object)?;
        }
        if mesh.triangles.is_empty() { Err(SunError::NoTriangles) } else { Ok(mesh) }
    }

    /// Vertex positions, in world space.
    pub fn vertices(&self) -> &[Vec3] {
        &self.vertices
    }

    /// Vertex indices of each triangle.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// The three corners of a triangle.
    pub(crate) fn corners(&self, triangle: [u32; 3]) -> [Vec3; 3] {
        triangle.map(|vertex_idx| self.vertices[vertex_idx as usize])
    }

    fn add(&mut self, object: &GeometryObject) -> Result<(), SunError> {
        let found = self.vertices.len() + object.shape.vertices().len();
        let too_many = |_| SunError::TooManyVertices { found };
        let first_vertex = u32::try_from(self.vertices.len()).map_err(too_many)?;
        u32::try_from(found).map_err(too_many)?;

        let (vertices, transform) = (object.shape.vertices(), object.world_from_object);
        let mirrors = transform.is_some_and(|transform| transform.matrix3.determinant() < 0.0);
        match transform {
            Some(transform) => {
                let in_world = vertices.iter().map(|vertex| transform_point(&transform, *vertex));
                self.vertices.extend(in_world);
            }
            None => self.vertices.extend_from_slice(vertices),
        }
        self.triangles.extend(object.shape.triangles().iter().map(|triangle| {
            let [a, b, c] = triangle.map(|vertex_idx| first_vertex + vertex_idx);
            if mirrors { [a, c, b] } else { [a, b, c] }
        }));
        Ok(())
    }
}
