//! The museum's sculpture as a function of time.

use std::sync::Arc;

use glam::Vec3;
use rayflock_geom::Mesh;

use super::Interval;
use super::materials::SCULPTURE;
use super::sculpture_keys::{KEY_TIMES, sculpture_keys};
use crate::{SurfaceMesh, VertexFrames, VertexKey};

/// The sculpture of `museum<n>`, whose triangles move in straight lines from key to key, and rest
/// before the first and after the last; `None` unless `n` is from 3 to 8.
pub(super) fn build(n: u32, interval: Interval) -> Option<VertexFrames> {
    let keys = sculpture_keys(n)?;
    let triangle_count = (keys[0].len() / 3) as u32;
    let triangles: Vec<[u32; 3]> =
        (0..triangle_count).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    let Ok(heap) = Mesh::from_triangles(keys[0].clone(), triangles) else {
        unreachable!("three vertices a triangle")
    };
    let key = |(time, positions): (f64, Vec<Vec3>)| VertexKey {
        time: time - interval.first,
        positions,
        normals: Vec::new(),
    };
    let keys = KEY_TIMES.into_iter().zip(keys).map(key).collect();
    let Ok(frames) = VertexFrames::new(&SurfaceMesh::new(Arc::new(heap), SCULPTURE), keys) else {
        unreachable!("the times increase, and all keys have as many vertices")
    };
    Some(frames)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::AnimatedMesh;

    const MUSEUM5: Interval = Interval { first: -1.0, last: 5.0 };

    #[test]
    fn it_rests_outside_its_range_and_keeps_its_triangles() {
        let sculpture = build(3, MUSEUM5).unwrap();
        assert_eq!(sculpture.time_range(), (1.0, 5.0));
        let at = |time| sculpture.at(time).unwrap().mesh;
        assert!(Arc::ptr_eq(&at(0.0), &at(1.0)));
        assert!(Arc::ptr_eq(&at(5.0), &at(1e300)));
        assert!(at(2.5).has_topology_of(&at(0.0)) && at(9.0).has_topology_of(&at(0.0)));
    }

    #[test]
    fn it_passes_through_its_keys_in_straight_lines() {
        let (sculpture, keys) = (build(3, MUSEUM5).unwrap(), sculpture_keys(3).unwrap());
        let vertex = |time| sculpture.at(time).unwrap().mesh.vertices()[7];
        for (key, positions) in (0..5).zip(&keys) {
            assert_eq!(vertex(1.0 + f64::from(key)), positions[7]);
        }
        let middle = keys[2][7].midpoint(keys[3][7]);
        assert!(vertex(3.5).abs_diff_eq(middle, 1e-6));
    }
}
