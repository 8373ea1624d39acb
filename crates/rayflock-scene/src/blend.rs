//! Meshes on their way from one shape to another of the same topology.

use std::sync::Arc;

use glam::Vec3;

use crate::SurfaceMesh;

/// `before` with vertices and normals moved by `share` of the way to those of `after`, which has
/// as many vertices. Normals are left alone where `after` has another number of them.
pub(crate) fn blended(before: &SurfaceMesh, after: &SurfaceMesh, share: f32) -> SurfaceMesh {
    let mut surface = before.clone();
    let vertices = Arc::make_mut(&mut surface.mesh).vertices_mut();
    move_towards(vertices, after.mesh.vertices(), share);
    if before.normals.len() == after.normals.len() {
        let normals = Arc::make_mut(&mut surface.normals);
        move_towards(normals, &after.normals, share);
        for (normal, before) in normals.iter_mut().zip(&*before.normals) {
            *normal = normal.normalize_or(*before);
        }
    }
    surface
}

/// Moves `values` by `share` of the way to `targets`.
fn move_towards(values: &mut [Vec3], targets: &[Vec3], share: f32) {
    for (value, target) in values.iter_mut().zip(targets) {
        *value += (*target - *value) * share;
    }
}
