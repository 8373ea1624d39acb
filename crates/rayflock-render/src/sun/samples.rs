//! Points of surfaces at which hours of sun are told.

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::WorldMesh;
use crate::shading::surface_point::{area_normal, slack};

/// Where hours of sun are told.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Sampling {
    /// At the centroid of each triangle.
    #[default]
    Faces,
    /// At each vertex, whose normal is that of its triangles, weighted by area.
    Vertices,
}

/// A point of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SunSample {
    /// On the surface, in world space.
    pub position: Vec3,
    /// Outward, of unit length, in world space; zero where there is none: for a triangle without
    /// area, a vertex that no triangle uses, or one whose triangles face opposite ways.
    pub normal: Vec3,
    /// How far off the surface rays start.
    pub(crate) slack: f32,
}

impl SunSample {
    /// Whether the sample can be lit at all.
    pub fn has_normal(&self) -> bool {
        self.normal != Vec3::ZERO
    }
}

/// Replaces `samples` by those of `mesh`, in the order of its triangles or vertices.
pub(crate) fn sample_surface(mesh: &WorldMesh, sampling: Sampling, samples: &mut Vec<SunSample>) {
    match sampling {
        Sampling::Faces => {
            let sample = |triangle: &[u32; 3]| sample_face(mesh.corners(*triangle));
            mesh.triangles().par_iter().map(sample).collect_into_vec(samples);
        }
        Sampling::Vertices => sample_vertices(mesh, samples),
    }
}

fn sample_face(corners: [Vec3; 3]) -> SunSample {
    let [a, b, c] = corners;
    SunSample {
        position: (a + b + c) / 3.0,
        normal: area_normal(corners).normalize_or_zero().as_vec3(),
        slack: slack(largest_coordinate(corners)),
    }
}

fn sample_vertices(mesh: &WorldMesh, samples: &mut Vec<SunSample>) {
    let mut sums = vec![(DVec3::ZERO, 0.0_f32); mesh.vertices().len()];
    for triangle in mesh.triangles() {
        let corners = mesh.corners(*triangle);
        let (normal, largest) = (area_normal(corners), largest_coordinate(corners));
        // One that is ignored by engines must not spoil its neighbours.
        if normal.is_finite() {
            for vertex_idx in triangle {
                let sum = &mut sums[*vertex_idx as usize];
                *sum = (sum.0 + normal, sum.1.max(largest));
            }
        }
    }
    samples.clear();
    samples.extend(mesh.vertices().iter().zip(sums).map(|(position, (normal, largest))| {
        let normal = normal.normalize_or_zero().as_vec3();
        SunSample { position: *position, normal, slack: slack(largest) }
    }));
}

fn largest_coordinate(corners: [Vec3; 3]) -> f32 {
    corners.iter().fold(0.0, |largest, corner| corner.abs().max_element().max(largest))
}
