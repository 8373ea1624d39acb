//! The mesh that a cache moves.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::Vec3;
use rayflock_geom::GeometryError;
use rayflock_scene::{MaterialIdx, Scene, SurfaceMesh};

use crate::job::Job;
use crate::sequence::{joined, surfaces};
use crate::{ImportError, obj, ply, split_extension};

/// The extensions that are looked for beside a cache, in this order.
const MESH_EXTENSIONS: [&str; 4] = ["obj", "obj.gz", "ply", "ply.gz"];

/// A mesh whose vertices follow the points of a cache.
#[derive(Debug)]
pub(super) struct BaseMesh {
    surface: SurfaceMesh,
    /// The point of each vertex: vertices may lie at one point and differ in other things.
    points: Vec<u32>,
}

/// The mesh beside the cache at `cache`, if there is one.
pub(crate) fn mesh_file(cache: &Path) -> Option<PathBuf> {
    MESH_EXTENSIONS
        .iter()
        .map(|extension| cache.with_extension(extension))
        .find(|file| file.is_file())
}

/// Reads the mesh beside the cache of a job, which must have `point_count` points, and a scene
/// with its materials but without objects.
pub(super) fn load(
    point_count: usize,
    job: &mut Job<'_>,
) -> Result<(BaseMesh, Scene), ImportError> {
    let Some(file) = mesh_file(job.file) else {
        let named = |extension| {
            let file = job.file.with_extension(extension);
            file.file_name().unwrap_or_default().to_string_lossy().into_owned()
        };
        let names = MESH_EXTENSIONS.map(named).join(", ");
        let expected = format!("one of {names} beside the cache");
        return Err(job.invalid("mesh", "none", expected));
    };
    let mut mesh_job = job.of_file(&file);
    let bytes = mesh_job.content()?;
    let (scene, points) = match split_extension(&file).0.as_str() {
        "obj" => obj::load_with_points(bytes, &mut mesh_job)?,
        _ => ply::load_with_points(bytes, &mut mesh_job)?,
    };
    if points.count != point_count {
        let found = format!("{point_count} points");
        let expected = format!("{}, as {} has", points.count, file.display());
        return Err(job.invalid("header", found, expected));
    }
    let materials: Vec<MaterialIdx> = (0..scene.materials.len() as u32).map(MaterialIdx).collect();
    let meshes: Vec<&SurfaceMesh> = surfaces(&scene).collect();
    let surface = joined(&meshes, &materials)
        .map_err(|error| job.invalid("mesh", error.to_string(), "indices in range"))?;
    let base = BaseMesh { surface, points: points.of_vertices };
    Ok((base, Scene { name: job.name(), objects: Vec::new(), nodes: Vec::new(), ..scene }))
}

impl BaseMesh {
    /// The mesh with its vertices at these points.
    pub(super) fn moved(&self, points: &[Vec3]) -> Result<SurfaceMesh, GeometryError> {
        let vertices = self.points.iter().map(|&point| points[point as usize]).collect();
        let mesh = self.surface.mesh.with_vertices(vertices)?;
        let normals = match &*self.surface.normals {
            [] => Arc::default(),
            at_rest => self.normals(at_rest, points),
        };
        let attributes = Arc::clone(&self.surface.attributes);
        Ok(SurfaceMesh { mesh: Arc::new(mesh), normals, attributes })
    }

    /// A normal a vertex: the mean of the triangles around its point, or that at rest where there
    /// are none.
    fn normals(&self, at_rest: &[Vec3], points: &[Vec3]) -> Arc<[Vec3]> {
        let mut sums = vec![Vec3::ZERO; points.len()];
        for corners in self.surface.mesh.triangles() {
            let corners = corners.map(|corner| self.points[corner as usize] as usize);
            let [a, b, c] = corners.map(|corner| points[corner]);
            let normal = (b - a).cross(c - a);
            if normal.is_finite() {
                corners.iter().for_each(|&corner| sums[corner] += normal);
            }
        }
        let normal = |(&point, &at_rest): (&u32, &Vec3)| sums[point as usize].normalize_or(at_rest);
        self.points.iter().zip(at_rest).map(normal).collect()
    }
}
