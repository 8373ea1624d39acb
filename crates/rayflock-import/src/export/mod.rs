//! Writes the geometry of frames: OBJ, PLY, NumPy frame sets and glTF.
//!
//! A [`FrameMesh`] is everything of one frame in world space; materials, normals and the like are
//! left behind. All formats hold single precision; what is read again is the same in every bit,
//! but for morphs of glTF, which are sums.
//!
//! | Written by | Holds | Use it when |
//! |---|---|---|
//! | [`write_obj`] | triangles, as text | another program wants them |
//! | [`write_ply`] | triangles, or spheres where there are none | a file a frame, small and quick |
//! | [`FrameSet`] | triangles and spheres of all frames | NumPy is at the other end |
//! | [`MorphSet`] | the same triangles in all frames, moving | another program plays animations |
//! | `points::write_points` | points that a sensor told: PLY, PCD, NPZ, CSV (with the feature `points`) | a sweep is to be kept |

mod glb;
mod npz;
mod obj;
mod ply;
#[cfg(feature = "points")]
pub mod points;

#[cfg(test)]
mod tests;

use glam::Vec3;
use rayflock_geom::{Geometry, Sphere, transform_point, transform_sphere};

pub use glb::{MorphError, MorphSet};
pub use npz::FrameSet;
pub use obj::write_obj;
pub use ply::write_ply;

/// The triangles and spheres of one frame, in world space.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FrameMesh {
    /// Positions of vertices.
    pub vertices: Vec<Vec3>,
    /// Positions in `vertices`.
    pub triangles: Vec<[u32; 3]>,
    /// Spheres.
    pub spheres: Vec<Sphere>,
}

impl FrameMesh {
    /// All objects of a geometry, one behind the other. Vertices of meshes without triangles and
    /// user primitives are left out.
    pub fn new(geometry: &Geometry) -> Self {
        let mut frame = Self::default();
        for object in geometry.objects() {
            let (mesh, place) = (&object.shape, object.world_from_object.as_ref());
            let first = frame.vertices.len() as u32;
            let shifted = |corners: &[u32; 3]| corners.map(|corner| first + corner);
            frame.triangles.extend(mesh.triangles().iter().map(shifted));
            if !mesh.triangles().is_empty() {
                let in_world =
                    |vertex: &Vec3| place.map_or(*vertex, |m| transform_point(m, *vertex));
                frame.vertices.extend(mesh.vertices().iter().map(in_world));
            }
            let in_world = |sphere: &Sphere| place.map_or(*sphere, |m| transform_sphere(m, sphere));
            frame.spheres.extend(mesh.spheres().iter().map(in_world));
        }
        frame
    }
}
