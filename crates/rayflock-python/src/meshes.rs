//! Meshes made of the rows of arrays, which are read once.

use glam::Vec3;
use rayflock::geom::{Mesh, Sphere};

use crate::errors::Failure;

/// A mesh of triangles.
pub(crate) fn triangles(vertices: &[[f32; 3]], triangles: &[[u32; 3]]) -> Result<Mesh, Failure> {
    Ok(Mesh::from_triangles(points(vertices), triangles)?)
}

/// A mesh with other vertices, and with other triangles where some are given. Triangles that are
/// the same as before stay shared, which tells engines that the mesh has deformed only.
pub(crate) fn changed_triangles(
    before: &Mesh,
    vertices: &[[f32; 3]],
    triangles: Option<&[[u32; 3]]>,
) -> Result<Mesh, Failure> {
    if !before.spheres().is_empty() {
        return Err(Failure::value("the object holds spheres: update_spheres changes them"));
    }
    let stays = triangles.is_none_or(|triangles| triangles == before.triangles());
    match triangles {
        Some(triangles) if !stays || vertices.len() != before.vertices().len() => {
            self::triangles(vertices, triangles)
        }
        None if vertices.len() != before.vertices().len() => Err(Failure::value(format!(
            "there are {} vertices, and there were {}: hand over the triangles too, if they are others",
            vertices.len(),
            before.vertices().len()
        ))),
        _ => Ok(before.with_vertices(points(vertices))?),
    }
}

/// Spheres, one for each center; `radii` has one entry for each, or one for all.
pub(crate) fn spheres(centers: &[[f32; 3]], radii: &[f32]) -> Result<Mesh, Failure> {
    let radius = |idx: usize| match radii {
        [radius] => *radius,
        radii => radii[idx],
    };
    if radii.len() != 1 && radii.len() != centers.len() {
        let (radii, centers) = (radii.len(), centers.len());
        return Err(Failure::value(format!("there are {radii} radii for {centers} centers")));
    }
    let spheres =
        centers.iter().enumerate().map(|(idx, &center)| Sphere::new(center.into(), radius(idx)));
    Ok(Mesh::from_spheres(spheres.collect()))
}

/// Spheres at other places, and with other radii where some are given.
pub(crate) fn changed_spheres(
    before: &Mesh,
    centers: &[[f32; 3]],
    radii: Option<&[f32]>,
) -> Result<Mesh, Failure> {
    if before.spheres().is_empty() && before.prim_count() > 0 {
        return Err(Failure::value("the object holds triangles: update changes them"));
    }
    if let Some(radii) = radii {
        return spheres(centers, radii);
    }
    let radii: Vec<_> = before.spheres().iter().map(|sphere| sphere.radius).collect();
    if radii.len() != centers.len() {
        return Err(Failure::value(format!(
            "there are {} centers, and there were {}: hand over the radii too",
            centers.len(),
            radii.len()
        )));
    }
    spheres(centers, &radii)
}

fn points(rows: &[[f32; 3]]) -> Vec<Vec3> {
    rows.iter().copied().map(Vec3::from).collect()
}
