//! The frames of a set of arrays.

use std::sync::Arc;

use glam::Vec3;
use rayflock_geom::{Mesh, Sphere};
use rayflock_scene::{FrameSource, MaterialIdx, MotionKind, SurfaceMesh};

use super::rows::Rows;
use crate::ImportError;
use crate::job::Job;

/// Triangles and spheres, frame by frame.
#[derive(Debug)]
pub(super) struct ArrayFrames {
    /// `None` where nothing differs from frame to frame.
    frame_count: Option<usize>,
    vertices: Rows<Vec3>,
    triangles: Triangles,
    centers: Rows<Vec3>,
    radii: FrameRadii,
}

/// The triangles of each frame.
#[derive(Debug)]
enum Triangles {
    /// Shared by the meshes of all frames.
    Same(Arc<[[u32; 3]]>),
    Framed(Rows<[u32; 3]>),
}

/// The radii of spheres.
#[derive(Debug)]
pub(super) enum FrameRadii {
    /// One for all.
    All(f32),
    /// As many as there are centres in each frame.
    Each(Rows<f32>),
}

impl ArrayFrames {
    /// Checks that the arrays have as many frames, and that triangles have their vertices.
    pub(super) fn new(
        vertices: Rows<Vec3>,
        triangles: Rows<[u32; 3]>,
        centers: Rows<Vec3>,
        radii: FrameRadii,
        job: &Job<'_>,
    ) -> Result<Self, ImportError> {
        let counts = [
            ("vertices", vertices.frame_count()),
            ("triangles", triangles.frame_count()),
            ("centers", centers.frame_count()),
        ];
        let mut counts = counts.iter().filter_map(|(name, count)| Some((*name, (*count)?)));
        let first = counts.next();
        if let Some((first_name, first_count)) = first
            && let Some((name, count)) = counts.find(|(_, count)| *count != first_count)
        {
            let found = format!("{first_count} frames of {first_name}, {count} of {name}");
            return Err(job.invalid("arrays", found, "as many of each"));
        }
        let frame_count = first.map(|(_, count)| count);
        check_corners(frame_count.unwrap_or(1), &vertices, &triangles, job)?;
        let triangles = match triangles {
            Rows::Same(triangles) => Triangles::Same(triangles.into()),
            framed @ Rows::Framed { .. } => Triangles::Framed(framed),
        };
        Ok(Self { frame_count, vertices, triangles, centers, radii })
    }

    /// Whether nothing differs from frame to frame.
    pub(super) fn is_static(&self) -> bool {
        self.frame_count.is_none()
    }

    fn spheres(&self, frame_idx: usize) -> Vec<Sphere> {
        let centers = self.centers.frame(frame_idx).iter();
        match &self.radii {
            FrameRadii::All(radius) => {
                centers.map(|&center| Sphere::new(center, *radius)).collect()
            }
            FrameRadii::Each(radii) => {
                let radii = radii.frame(frame_idx);
                centers.zip(radii).map(|(&center, &radius)| Sphere::new(center, radius)).collect()
            }
        }
    }
}

impl FrameSource for ArrayFrames {
    fn frame_count(&self) -> usize {
        self.frame_count.unwrap_or(1)
    }

    fn motion(&self) -> MotionKind {
        let same_spheres = match &self.centers {
            Rows::Same(_) => true,
            framed @ Rows::Framed { .. } => {
                let mut counts = framed.iter().map(<[Vec3]>::len);
                let first = counts.next();
                counts.all(|count| Some(count) == first)
            }
        };
        match &self.triangles {
            Triangles::Same(_) if same_spheres => MotionKind::Deforming,
            _ => MotionKind::Topology,
        }
    }

    fn load(&self, frame_idx: usize) -> Result<SurfaceMesh, String> {
        let vertices = self.vertices.frame(frame_idx).to_vec();
        let triangles = match &self.triangles {
            Triangles::Same(triangles) => Arc::clone(triangles),
            Triangles::Framed(framed) => Arc::from(framed.frame(frame_idx)),
        };
        let mesh = Mesh::from_triangles(vertices, triangles).map_err(|error| error.to_string())?;
        Ok(SurfaceMesh::new(mesh.with_spheres(self.spheres(frame_idx)), MaterialIdx(0)))
    }
}

/// Checks that the triangles of each frame have their vertices.
fn check_corners(
    frame_count: usize,
    vertices: &Rows<Vec3>,
    triangles: &Rows<[u32; 3]>,
    job: &Job<'_>,
) -> Result<(), ImportError> {
    let highest = |frame_idx| triangles.frame(frame_idx).as_flattened().iter().max().copied();
    // Looked at once where all frames share them.
    let shared = triangles.frame_count().is_none().then(|| highest(0));
    for frame_idx in 0..frame_count {
        let vertex_count = vertices.frame(frame_idx).len();
        let highest = shared.unwrap_or_else(|| highest(frame_idx));
        let Some(highest) = highest.filter(|&highest| highest as usize >= vertex_count) else {
            continue;
        };
        let found = match highest {
            u32::MAX => format!("a negative or too large number in frame {frame_idx}"),
            _ => format!("vertex {highest} in frame {frame_idx}"),
        };
        let expected = format!("less than {vertex_count}, the number of its vertices");
        return Err(job.invalid("array \"triangles\"", found, expected));
    }
    Ok(())
}
