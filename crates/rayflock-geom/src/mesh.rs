//! Meshes: shared, immutable columns of primitives.

use std::sync::Arc;

use glam::{DVec3, Vec3};

use crate::{Aabb, GeometryError, PrimId, Sphere, UserPrimitives};

/// The primitives of one object, in object space.
///
/// Primitive ids count triangles first, then spheres, then user primitives. A shared mesh never
/// changes; a deformed one is another mesh that shares its triangles ([`Mesh::with_vertices`]).
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    vertices: Vec<Vec3>,
    triangles: Arc<[[u32; 3]]>,
    /// Whether triangle i has the vertices 3 i, 3 i + 1 and 3 i + 2.
    is_soup: bool,
    spheres: Vec<Sphere>,
    user: Option<Arc<dyn UserPrimitives>>,
}

/// What a [`PrimId`] stands for, with its position in the column of its kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PrimKind {
    /// `mesh.triangles()[i]`.
    Triangle(usize),
    /// `mesh.spheres()[i]`.
    Sphere(usize),
    /// User primitive `i`.
    User(usize),
}

impl Mesh {
    /// A triangle mesh.
    ///
    /// # Errors
    /// [`GeometryError::VertexIndex`] when a triangle names a vertex that is not there.
    pub fn from_triangles(
        vertices: Vec<Vec3>,
        triangles: impl Into<Arc<[[u32; 3]]>>,
    ) -> Result<Self, GeometryError> {
        let triangles = triangles.into();
        let mut is_soup = true;
        for (triangle_idx, corners) in triangles.iter().enumerate() {
            is_soup &= (0..3).all(|corner| corners[corner] as usize == 3 * triangle_idx + corner);
            for &vertex_idx in corners {
                if vertex_idx as usize >= vertices.len() {
                    let vertex_count = vertices.len();
                    return Err(GeometryError::VertexIndex {
                        triangle_idx,
                        vertex_idx,
                        vertex_count,
                    });
                }
            }
        }
        Ok(Self { vertices, triangles, is_soup, ..Self::default() })
    }

    /// A mesh of spheres only.
    pub fn from_spheres(spheres: Vec<Sphere>) -> Self {
        Self { spheres, ..Self::default() }
    }

    /// A mesh of user primitives only.
    pub fn from_user(user: Arc<dyn UserPrimitives>) -> Self {
        Self { user: Some(user), ..Self::default() }
    }

    /// This mesh with other spheres.
    pub fn with_spheres(mut self, spheres: Vec<Sphere>) -> Self {
        self.spheres = spheres;
        self
    }

    /// This mesh with other user primitives.
    pub fn with_user(mut self, user: Arc<dyn UserPrimitives>) -> Self {
        self.user = Some(user);
        self
    }

    /// This mesh with its vertices moved; the triangles are shared, not copied.
    ///
    /// # Errors
    /// [`GeometryError::VertexCount`] when the number of vertices differs.
    pub fn with_vertices(&self, vertices: Vec<Vec3>) -> Result<Self, GeometryError> {
        if vertices.len() != self.vertices.len() {
            let (found, expected) = (vertices.len(), self.vertices.len());
            return Err(GeometryError::VertexCount { found, expected });
        }
        let (spheres, user) = (self.spheres.clone(), self.user.clone());
        let triangles = Arc::clone(&self.triangles);
        Ok(Self { vertices, triangles, is_soup: self.is_soup, spheres, user })
    }

    /// Vertex positions.
    pub fn vertices(&self) -> &[Vec3] {
        &self.vertices
    }

    /// Vertex positions, to be moved before the mesh is shared (or in a copy of the caller's own:
    /// [`Arc::make_mut`]). The triangles stay.
    pub fn vertices_mut(&mut self) -> &mut [Vec3] {
        &mut self.vertices
    }

    /// Vertex indices of each triangle.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// The corners of all triangles in order, nine coordinates a triangle, if that is how the
    /// vertices lie: triangle i is `[3 * i, 3 * i + 1, 3 * i + 2]`.
    pub fn soup(&self) -> Option<&[[f32; 9]]> {
        let coordinates: &[f32] = bytemuck::cast_slice(&self.vertices);
        self.is_soup.then(|| &coordinates.as_chunks().0[..self.triangles.len()])
    }

    /// Spheres.
    pub fn spheres(&self) -> &[Sphere] {
        &self.spheres
    }

    /// User primitives, if any.
    pub fn user(&self) -> Option<&Arc<dyn UserPrimitives>> {
        self.user.as_ref()
    }

    /// Number of primitives of all kinds.
    pub fn prim_count(&self) -> usize {
        let user_count = self.user.as_ref().map_or(0, |user| user.len());
        self.triangles.len() + self.spheres.len() + user_count
    }

    /// What `prim_id` stands for.
    #[inline]
    pub fn prim_kind(&self, prim_id: PrimId) -> PrimKind {
        let idx = prim_id.0 as usize;
        let (triangle_count, sphere_count) = (self.triangles.len(), self.spheres.len());
        if idx < triangle_count {
            PrimKind::Triangle(idx)
        } else if idx < triangle_count + sphere_count {
            PrimKind::Sphere(idx - triangle_count)
        } else {
            PrimKind::User(idx - triangle_count - sphere_count)
        }
    }

    /// The three corners of triangle `triangle_idx`.
    #[inline]
    pub fn corners(&self, triangle_idx: usize) -> [Vec3; 3] {
        self.triangles[triangle_idx].map(|vertex_idx| self.vertices[vertex_idx as usize])
    }

    /// Whether the mesh is the other one deformed: shared triangles, as many spheres, the same
    /// user primitives.
    pub fn has_topology_of(&self, other: &Self) -> bool {
        let same_user = match (&self.user, &other.user) {
            (None, None) => true,
            (Some(a), Some(b)) => Arc::ptr_eq(a, b),
            _ => false,
        };
        Arc::ptr_eq(&self.triangles, &other.triangles)
            && self.spheres.len() == other.spheres.len()
            && same_user
    }

    /// The box around everything finite in the mesh, vertices that no triangle uses included.
    pub fn bounds(&self) -> Aabb {
        let user =
            self.user.iter().flat_map(|user| (0..user.len()).map(|i| user.bounding_sphere(i)));
        let spheres = self.spheres.iter().copied().chain(user).filter(Sphere::is_valid);
        let corners = spheres.flat_map(|s| [s.center - s.radius, s.center + s.radius]);
        Aabb::around(self.vertices.iter().copied().chain(corners))
    }
}

/// Whether a triangle is ignored: a vertex is not finite, or the area is exactly zero.
///
/// Differences and products are formed in `f64`, where those of `f32` values of like magnitude
/// are exact, so that thin triangles are not taken for degenerate ones.
#[inline(always)]
pub fn is_degenerate_triangle([v0, v1, v2]: [Vec3; 3]) -> bool {
    let [v0, v1, v2] = [v0, v1, v2].map(Vec3::as_dvec3);
    let normal = (v1 - v0).cross(v2 - v0);
    !normal.is_finite() || normal == DVec3::ZERO
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_index_out_of_range_names_the_triangle() {
        let error = Mesh::from_triangles(vec![Vec3::ZERO; 3], vec![[0, 1, 2], [0, 1, 3]]);
        let message = error.unwrap_err().to_string();
        assert_eq!(message, "triangle 1 names vertex 3, but there are 3 vertices");
    }

    #[test]
    fn a_copy_with_moved_vertices_has_the_same_topology() {
        let mesh = Arc::new(Mesh::from_triangles(vec![Vec3::ZERO; 3], vec![[0, 1, 2]]).unwrap());
        let mut moved = Arc::clone(&mesh);
        Arc::make_mut(&mut moved).vertices_mut()[1] = Vec3::X;
        assert_eq!((mesh.vertices()[1], moved.vertices()[1]), (Vec3::ZERO, Vec3::X));
        assert!(moved.has_topology_of(&mesh));
    }

    #[test]
    fn a_soup_is_told_by_its_triangles() {
        let vertices: Vec<_> = (0..7_u8).map(|i| Vec3::splat(f32::from(i))).collect();
        let mesh = |triangles: &[[u32; 3]]| Mesh::from_triangles(vertices.clone(), triangles);
        let soup = mesh(&[[0, 1, 2], [3, 4, 5]]).unwrap();
        let rows = soup.soup().unwrap();
        assert_eq!((rows.len(), rows[1]), (2, [3.0, 3.0, 3.0, 4.0, 4.0, 4.0, 5.0, 5.0, 5.0]));
        let moved = soup.with_vertices(vec![Vec3::ONE; 7]).unwrap();
        assert_eq!(moved.soup().unwrap()[1], [1.0; 9]);
        assert!(mesh(&[[0, 1, 2], [3, 5, 4]]).unwrap().soup().is_none());
        assert!(mesh(&[]).unwrap().soup().unwrap().is_empty());
    }

    #[test]
    fn ids_count_triangles_then_spheres() {
        let mesh = Mesh::from_triangles(vec![Vec3::ZERO; 3], vec![[0, 1, 2]]).unwrap();
        let mesh = mesh.with_spheres(vec![Sphere::new(Vec3::ZERO, 1.0); 2]);
        assert_eq!(mesh.prim_count(), 3);
        assert_eq!(mesh.prim_kind(PrimId(0)), PrimKind::Triangle(0));
        assert_eq!(mesh.prim_kind(PrimId(2)), PrimKind::Sphere(1));
        assert_eq!(mesh.prim_kind(PrimId(3)), PrimKind::User(0));
    }

    #[test]
    fn degenerate_means_not_finite_or_exactly_flat() {
        let thin = [Vec3::ZERO, Vec3::X, Vec3::new(0.5, 1e-38, 0.0)];
        assert!(!is_degenerate_triangle(thin));
        assert!(is_degenerate_triangle([Vec3::ZERO, Vec3::X, 2.0 * Vec3::X]));
        assert!(is_degenerate_triangle([Vec3::ZERO, Vec3::X, Vec3::NAN]));
        assert!(is_degenerate_triangle([Vec3::ZERO, Vec3::X, Vec3::INFINITY]));
    }
}
