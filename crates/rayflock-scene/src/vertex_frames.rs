//! Meshes whose vertices are keyed one by one: point caches, simulated cloth, animated triangles.
//!
//! **Invariants.** The meshes of all times share their triangles.
//!
//! **Cost.** Memory for the vertices of each key; time linear in vertices, none at a key.

use std::sync::Arc;

use glam::Vec3;
use rayflock_geom::Mesh;

use crate::blend::blended;
use crate::key_times::{check_times, key_at, span_at};
use crate::{AnimatedMesh, KeySpan, MotionKind, SceneError, SurfaceAttributes, SurfaceMesh};

/// A mesh of one topology whose vertices move linearly from key to key.
#[derive(Clone, Debug)]
pub struct VertexFrames {
    /// In seconds, strictly increasing.
    times: Vec<f64>,
    /// The mesh at each time; all share their triangles.
    meshes: Vec<Arc<Mesh>>,
    /// The normals at each time: all as long as there are vertices, or all empty.
    normals: Vec<Arc<[Vec3]>>,
    attributes: Arc<SurfaceAttributes>,
}

/// Where the vertices of a mesh are at a time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct VertexKey {
    /// The time in seconds.
    pub time: f64,
    /// A position a vertex.
    pub positions: Vec<Vec3>,
    /// A normal a vertex, of unit length; empty for flat triangles.
    pub normals: Vec<Vec3>,
}

impl VertexFrames {
    /// The mesh whose triangles and attributes are those of `topology`, with vertices as `keys`
    /// say. The vertices and normals of `topology` are not used.
    ///
    /// # Errors
    /// [`SceneError::Empty`] without keys, [`SceneError::KeyTime`] when times do not increase,
    /// [`SceneError::Length`] when a key has another number of positions than `topology` has
    /// vertices, or normals for some vertices or some keys only.
    pub fn new(topology: &SurfaceMesh, keys: Vec<VertexKey>) -> Result<Self, SceneError> {
        check_times("vertex frames", keys.iter().map(|key| key.time))?;
        let vertex_count = topology.mesh.vertices().len();
        let smooth = keys.iter().any(|key| !key.normals.is_empty());
        let mut frames = Self {
            times: Vec::with_capacity(keys.len()),
            meshes: Vec::with_capacity(keys.len()),
            normals: Vec::with_capacity(keys.len()),
            attributes: Arc::clone(&topology.attributes),
        };
        for (key_idx, key) in keys.into_iter().enumerate() {
            let normal_count = if smooth { vertex_count } else { 0 };
            check_length(key_idx, "positions", key.positions.len(), vertex_count)?;
            check_length(key_idx, "normals", key.normals.len(), normal_count)?;
            frames.times.push(key.time);
            frames.meshes.push(Arc::new(topology.mesh.with_vertices(key.positions)?));
            frames.normals.push(key.normals.into());
        }
        Ok(frames)
    }

    /// The mesh of a key, shared.
    fn key(&self, key_idx: usize) -> SurfaceMesh {
        SurfaceMesh {
            mesh: Arc::clone(&self.meshes[key_idx]),
            normals: Arc::clone(&self.normals[key_idx]),
            attributes: Arc::clone(&self.attributes),
        }
    }
}

impl AnimatedMesh for VertexFrames {
    fn time_range(&self) -> (f64, f64) {
        (self.times[0], self.times[self.times.len() - 1])
    }

    fn motion(&self) -> MotionKind {
        if self.times.len() > 1 { MotionKind::Deforming } else { MotionKind::Static }
    }

    fn at(&self, time: f64) -> Result<SurfaceMesh, String> {
        Ok(match self.span_at(time) {
            Some(KeySpan { before, after, share }) if share > 0.0 => {
                blended(&before, &after, share)
            }
            _ => self.key(key_at(&self.times, time)),
        })
    }

    fn span_at(&self, time: f64) -> Option<KeySpan> {
        let (before, share) = span_at(&self.times, time);
        (before + 1 < self.times.len()).then(|| {
            let [before, after] = [before, before + 1].map(|key_idx| self.key(key_idx));
            KeySpan { before, after, share }
        })
    }
}

fn check_length(
    key_idx: usize,
    what: &'static str,
    found: usize,
    expected: usize,
) -> Result<(), SceneError> {
    if found == expected {
        return Ok(());
    }
    let element = format!("key {key_idx} of vertex frames");
    Err(SceneError::Length { element, what, found, expected })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::MaterialIdx;

    fn topology() -> SurfaceMesh {
        let mesh = Mesh::from_triangles(vec![Vec3::ZERO; 3], vec![[0, 1, 2]]).unwrap();
        SurfaceMesh::new(mesh, MaterialIdx(0))
    }

    fn key(time: f64, x: f32, normals: &[Vec3]) -> VertexKey {
        let positions = vec![Vec3::ZERO, Vec3::X * x, Vec3::Y];
        VertexKey { time, positions, normals: normals.to_vec() }
    }

    #[test]
    fn vertices_go_straight_from_key_to_key() {
        let keys = vec![key(1.0, 1.0, &[]), key(3.0, 5.0, &[]), key(4.0, 0.0, &[])];
        let frames = VertexFrames::new(&topology(), keys).unwrap();
        let x = |time| frames.at(time).unwrap().mesh.vertices()[1].x;
        assert_eq!([1.0, 1.5, 3.0, 3.75, 4.0].map(x), [1.0, 2.0, 5.0, 1.25, 0.0]);
        assert_eq!([0.0, 9.0, f64::NAN].map(x), [1.0, 0.0, 1.0]);
    }

    #[test]
    fn all_times_share_triangles_and_keys_share_meshes() {
        let keys = vec![key(0.0, 1.0, &[]), key(1.0, 2.0, &[])];
        let frames = VertexFrames::new(&topology(), keys).unwrap();
        let [a, b, c] = [0.0, 0.5, 0.0].map(|time| frames.at(time).unwrap().mesh);
        assert!(b.has_topology_of(&a) && !Arc::ptr_eq(&a, &b));
        assert!(Arc::ptr_eq(&a, &c));
    }

    #[test]
    fn normals_keep_unit_length() {
        let keys = vec![key(0.0, 1.0, &[Vec3::X; 3]), key(1.0, 1.0, &[Vec3::Y; 3])];
        let frames = VertexFrames::new(&topology(), keys).unwrap();
        let normal = frames.at(0.5).unwrap().normals[2];
        assert!(normal.distance(Vec3::new(1.0, 1.0, 0.0).normalize()) < 1e-6);
    }

    #[test]
    fn keys_that_do_not_fit_are_errors() {
        let message = |keys| VertexFrames::new(&topology(), keys).unwrap_err().to_string();
        assert_eq!(message(vec![]), "vertex frames has no keys");
        let times = message(vec![key(1.0, 0.0, &[]), key(1.0, 0.0, &[])]);
        assert_eq!(times, "vertex frames: key 1 has the time 1, expected a later time than before");
        let short = VertexKey { positions: vec![Vec3::ZERO; 2], ..VertexKey::default() };
        assert_eq!(message(vec![short]), "key 0 of vertex frames has 2 positions, expected 3");
        let some = message(vec![key(0.0, 0.0, &[Vec3::X; 3]), key(1.0, 0.0, &[])]);
        assert_eq!(some, "key 1 of vertex frames has 0 normals, expected 3");
    }
}
