//! From loose columns to a mesh: the checks that all formats share.

use std::sync::Arc;

use glam::{Vec2, Vec3};
use rayflock_geom::{Mesh, is_degenerate_triangle};
use rayflock_scene::{MaterialIdx, PrimMaterials, SurfaceAttributes, SurfaceMesh};

use crate::ImportError;
use crate::job::Job;

/// A triangle mesh as a file gives it. `normals`, `uvs` and `colors` are empty or have one entry
/// a position.
#[derive(Debug, Default)]
pub(crate) struct MeshParts {
    pub(crate) positions: Vec<Vec3>,
    pub(crate) triangles: Vec<[u32; 3]>,
    pub(crate) normals: Vec<Vec3>,
    pub(crate) uvs: Vec<Vec2>,
    pub(crate) colors: Vec<Vec3>,
    pub(crate) materials: PrimMaterials,
}

/// Which of the points in a file each vertex has, for caches that move points.
#[derive(Debug)]
pub(crate) struct VertexPoints {
    /// Number of points.
    pub(crate) count: usize,
    /// A point a vertex, less than `count`, object by object.
    pub(crate) of_vertices: Vec<u32>,
}

impl MeshParts {
    /// The mesh, with a warning for what will be ignored and for what was mended.
    ///
    /// Positions that are not finite stay, so that ids keep their meaning; engines ignore their
    /// triangles.
    pub(crate) fn build(
        mut self,
        element: &str,
        job: &mut Job<'_>,
    ) -> Result<SurfaceMesh, ImportError> {
        let mesh = Mesh::from_triangles(std::mem::take(&mut self.positions), self.triangles)
            .map_err(|error| job.invalid(element, error.to_string(), "indices in range"))?;
        warn_of_ignored(&mesh, element, job);
        mend_normals(&mesh, &mut self.normals, element, job);
        mend(&mut self.uvs, |uv| uv.is_finite(), Vec2::ZERO, (element, "texture coordinates"), job);
        mend(&mut self.colors, |c| c.is_finite(), Vec3::ONE, (element, "colours"), job);
        let (uvs, colors, materials) = (self.uvs, self.colors, self.materials);
        let attributes = Arc::new(SurfaceAttributes { uvs, colors, materials });
        Ok(SurfaceMesh { mesh: Arc::new(mesh), normals: self.normals.into(), attributes })
    }
}

/// The material of each primitive, as positions in a scene's list; uniform where all are the same.
pub(crate) fn prim_materials(materials: &[u32]) -> PrimMaterials {
    match materials {
        [first, rest @ ..] if rest.iter().any(|material| material != first) => {
            PrimMaterials::PerPrim(materials.iter().map(|&idx| MaterialIdx(idx)).collect())
        }
        [first, ..] => PrimMaterials::Uniform(MaterialIdx(*first)),
        [] => PrimMaterials::default(),
    }
}

/// Counts what engines will ignore: triangles without area or with a corner that is not finite.
fn warn_of_ignored(mesh: &Mesh, element: &str, job: &mut Job<'_>) {
    let bad_vertices = mesh.vertices().iter().filter(|vertex| !vertex.is_finite()).count();
    if bad_vertices > 0 {
        job.warn(
            element,
            format!("{bad_vertices} vertices are not finite; their triangles are ignored"),
        );
    }
    let flat = |&idx: &usize| {
        let corners = mesh.corners(idx);
        corners.iter().all(|corner| corner.is_finite()) && is_degenerate_triangle(corners)
    };
    let flat_count = (0..mesh.triangles().len()).filter(flat).count();
    if flat_count > 0 {
        job.warn(element, format!("{flat_count} triangles have no area; they are ignored"));
    }
}

/// Gives every normal unit length; those that have none come from the triangles around them, and
/// all do where they belong to another surface.
fn mend_normals(mesh: &Mesh, normals: &mut [Vec3], element: &str, job: &mut Job<'_>) {
    let mut missing_count = 0;
    for normal in normals.iter_mut() {
        // The length of very long vectors overflows, so scale them first.
        *normal = (*normal / normal.abs().max_element()).normalize_or_zero();
        missing_count += usize::from(*normal == Vec3::ZERO);
    }
    if normals.is_empty() {
        return;
    }
    let computed = vertex_normals(mesh);
    if missing_count == 0 && disagree(mesh, normals, &computed) {
        job.warn(element, "the normals are not those of the triangles; they are computed");
        normals.copy_from_slice(&computed);
    }
    if missing_count == 0 {
        return;
    }
    job.warn(element, format!("{missing_count} normals have no direction; they are computed"));
    for (normal, computed) in normals.iter_mut().zip(computed) {
        if *normal == Vec3::ZERO {
            *normal = computed;
        }
    }
}

/// Whether `normals` cannot belong to the mesh, as after an export that turned only the
/// positions: at the corners of triangles, they make more than 53 degrees on average (a cosine of
/// 0.6; 0.5 would be chance) with the lines along which `computed` lie. Smooth normals of coarse
/// meshes stay within 40 degrees, and inverted ones on the line.
fn disagree(mesh: &Mesh, normals: &[Vec3], computed: &[Vec3]) -> bool {
    let corners = mesh.triangles().as_flattened();
    let cosines = corners.iter().map(|&corner| {
        let corner = corner as usize;
        f64::from(normals[corner].dot(computed[corner]).abs())
    });
    cosines.sum::<f64>() < 0.6 * corners.len() as f64
}

/// The mean normal of the triangles around each vertex, by area; +Y where there are none.
pub(crate) fn vertex_normals(mesh: &Mesh) -> Vec<Vec3> {
    let mut sums = vec![Vec3::ZERO; mesh.vertices().len()];
    for (triangle_idx, corners) in mesh.triangles().iter().enumerate() {
        let [a, b, c] = mesh.corners(triangle_idx);
        let normal = (b - a).cross(c - a);
        if normal.is_finite() {
            corners.iter().for_each(|&corner| sums[corner as usize] += normal);
        }
    }
    sums.into_iter().map(|sum| sum.normalize_or(Vec3::Y)).collect()
}

/// Replaces values that are no numbers.
fn mend<T: Copy>(
    column: &mut [T],
    is_finite: impl Fn(&T) -> bool,
    substitute: T,
    (element, what): (&str, &str),
    job: &mut Job<'_>,
) {
    let mut count = 0;
    for value in column.iter_mut().filter(|value| !is_finite(value)) {
        *value = substitute;
        count += 1;
    }
    if count > 0 {
        job.warn(element, format!("{count} {what} are not finite; they are replaced"));
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::{LoadOptions, Reporter};

    fn build(parts: MeshParts) -> (Result<SurfaceMesh, ImportError>, Vec<String>) {
        let (options, mut reporter) = (LoadOptions::default(), Reporter::new());
        let file = Path::new("a.obj");
        let mut job = Job::new(file, &options, &mut reporter);
        let mesh = parts.build("object 0", &mut job);
        (mesh, reporter.warnings().iter().map(|warning| warning.message.clone()).collect())
    }

    #[test]
    fn what_is_ignored_is_counted_and_kept() {
        let positions = vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::NAN];
        let triangles = vec![[0, 1, 2], [0, 1, 1], [0, 1, 3]];
        let (mesh, warnings) = build(MeshParts { positions, triangles, ..Default::default() });
        assert_eq!(mesh.unwrap().mesh.triangles().len(), 3);
        assert_eq!(warnings.len(), 2, "{warnings:?}");
        assert!(warnings[0].starts_with("1 vertices") && warnings[1].starts_with("1 triangles"));
    }

    #[test]
    fn normals_get_unit_length_or_come_from_the_triangles() {
        let positions = vec![Vec3::ZERO, Vec3::X, Vec3::Y];
        let normals = vec![Vec3::new(0.0, 0.0, 3e38), Vec3::NAN, Vec3::ZERO];
        let triangles = vec![[0, 1, 2]];
        let parts = MeshParts { positions, triangles, normals, ..Default::default() };
        let (mesh, warnings) = build(parts);
        assert_eq!(*mesh.unwrap().normals, [Vec3::Z; 3]);
        assert!(warnings[0].starts_with("2 normals"));
    }

    #[test]
    fn normals_of_another_surface_are_replaced_and_inverted_ones_kept() {
        for (given, expected) in [(Vec3::X, Vec3::Z), (Vec3::NEG_Z, Vec3::NEG_Z)] {
            let positions = vec![Vec3::ZERO, Vec3::X, Vec3::Y];
            let (triangles, normals) = (vec![[0, 1, 2]], vec![given; 3]);
            let parts = MeshParts { positions, triangles, normals, ..Default::default() };
            let (mesh, warnings) = build(parts);
            assert_eq!(*mesh.unwrap().normals, [expected; 3]);
            assert_eq!(warnings.len(), usize::from(given != expected));
        }
    }

    #[test]
    fn an_index_out_of_range_is_an_error() {
        let (mesh, _) = build(MeshParts { triangles: vec![[0, 0, 0]], ..Default::default() });
        let message = mesh.unwrap_err().to_string();
        assert!(message.contains("object 0") && message.contains("triangle 0 names vertex 0"));
    }
}
