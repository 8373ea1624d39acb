//! One mesh a frame, each with a topology of its own: file sequences, fluids, fracture.
//!
//! **Cost.** Memory for all meshes; time for a binary search a frame.

use crate::key_times::{check_times, key_at};
use crate::{AnimatedMesh, MotionKind, SceneError, SurfaceMesh};

/// A mesh that is replaced by another at each of a list of times.
#[derive(Clone, Debug)]
pub struct MeshSequence {
    /// In seconds, strictly increasing.
    times: Vec<f64>,
    /// What is shown from each time on.
    meshes: Vec<SurfaceMesh>,
}

impl MeshSequence {
    /// The mesh that is each of `keys` from its time in seconds until the next; the first also
    /// before. Empty meshes show nothing.
    ///
    /// # Errors
    /// [`SceneError::Empty`] without keys, [`SceneError::KeyTime`] when times do not increase.
    pub fn new(keys: Vec<(f64, SurfaceMesh)>) -> Result<Self, SceneError> {
        check_times("mesh sequence", keys.iter().map(|(time, _)| *time))?;
        let (times, meshes) = keys.into_iter().unzip();
        Ok(Self { times, meshes })
    }

    /// The mesh that is frame `i` of `meshes` at time `i / frame_rate`.
    ///
    /// # Errors
    /// As [`new`](Self::new), when there are no meshes or the rate is no positive number.
    pub fn at_frame_rate(meshes: Vec<SurfaceMesh>, frame_rate: f64) -> Result<Self, SceneError> {
        let timed = meshes.into_iter().enumerate();
        Self::new(timed.map(|(frame, mesh)| (frame as f64 / frame_rate, mesh)).collect())
    }
}

impl AnimatedMesh for MeshSequence {
    fn time_range(&self) -> (f64, f64) {
        (self.times[0], self.times[self.times.len() - 1])
    }

    fn motion(&self) -> MotionKind {
        let same_topology = |pair: &[SurfaceMesh]| pair[1].mesh.has_topology_of(&pair[0].mesh);
        if self.meshes.len() == 1 {
            MotionKind::Static
        } else if self.meshes.windows(2).all(same_topology) {
            MotionKind::Deforming
        } else {
            MotionKind::Topology
        }
    }

    fn at(&self, time: f64) -> Result<SurfaceMesh, String> {
        Ok(self.meshes[key_at(&self.times, time)].clone())
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::Vec3;
    use rayflock_geom::Mesh;

    use super::*;
    use crate::MaterialIdx;

    fn mesh(triangle_count: usize) -> SurfaceMesh {
        let triangles = vec![[0, 1, 2]; triangle_count];
        let mesh = Mesh::from_triangles(vec![Vec3::ZERO, Vec3::X, Vec3::Y], triangles).unwrap();
        SurfaceMesh::new(mesh, MaterialIdx(0))
    }

    #[test]
    fn each_mesh_stays_until_the_next() {
        let sequence = MeshSequence::new(vec![(0.0, mesh(3)), (1.0, mesh(0)), (2.0, mesh(5))]);
        let sequence = sequence.unwrap();
        let count = |time| sequence.at(time).unwrap().mesh.prim_count();
        assert_eq!([-1.0, 0.0, 0.99, 1.0, 2.0, 7.0].map(count), [3, 3, 3, 0, 5, 5]);
        assert_eq!(sequence.motion(), MotionKind::Topology);
    }

    #[test]
    fn frame_times_meet_their_keys_however_they_are_rounded() {
        let rate = 24.0;
        let sequence = MeshSequence::at_frame_rate((0..200).map(mesh).collect(), rate).unwrap();
        for frame in 0..200 {
            for time in [frame as f64 / rate, frame as f64 * (1.0 / rate)] {
                assert_eq!(sequence.at(time).unwrap().mesh.prim_count(), frame);
            }
        }
    }

    #[test]
    fn meshes_that_share_their_triangles_deform() {
        let first = mesh(1);
        let moved = first.mesh.with_vertices(vec![Vec3::ZERO; 3]).unwrap();
        let second = SurfaceMesh { mesh: Arc::new(moved), ..first.clone() };
        let sequence = MeshSequence::new(vec![(0.0, first.clone()), (1.0, second)]).unwrap();
        assert_eq!(sequence.motion(), MotionKind::Deforming);
        assert_eq!(MeshSequence::new(vec![(0.0, first)]).unwrap().motion(), MotionKind::Static);
    }

    #[test]
    fn times_must_increase() {
        assert!(MeshSequence::new(vec![]).is_err());
        assert!(MeshSequence::at_frame_rate(vec![mesh(1), mesh(1)], 0.0).is_err());
        assert!(MeshSequence::at_frame_rate(vec![mesh(1), mesh(1)], -1.0).is_err());
    }
}
