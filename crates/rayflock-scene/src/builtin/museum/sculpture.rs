//! The museum's sculpture as a function of time.

use std::sync::Arc;

use glam::Vec3;
use rayflock_geom::Mesh;

use super::Interval;
use super::materials::SCULPTURE;
use super::sculpture_keys::{KEY_TIMES, sculpture_keys};
use crate::{AnimatedMesh, PrimMaterials, SurfaceAttributes, SurfaceMesh};

/// Triangles that move in straight lines from key to key, and rest before the first and after
/// the last.
#[derive(Debug)]
pub(super) struct Sculpture {
    /// The animation time of second 0.
    first_time: f64,
    keys: [Vec<Vec3>; 5],
    /// The mesh at the first and at the last key: the same one whenever it rests.
    ends: [SurfaceMesh; 2],
}

impl Sculpture {
    /// The sculpture of `museum<n>`; `None` unless `n` is from 3 to 8.
    pub(super) fn new(n: u32, interval: Interval) -> Option<Self> {
        let keys = sculpture_keys(n)?;
        let triangle_count = (keys[0].len() / 3) as u32;
        let triangles: Vec<[u32; 3]> =
            (0..triangle_count).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        let Ok(heap) = Mesh::from_triangles(keys[0].clone(), triangles) else {
            unreachable!("three vertices a triangle")
        };
        let materials = PrimMaterials::Uniform(SCULPTURE);
        let attributes = SurfaceAttributes { materials, ..SurfaceAttributes::default() };
        let heap = SurfaceMesh {
            mesh: Arc::new(heap),
            normals: Arc::default(),
            attributes: Arc::new(attributes),
        };
        let sails = with_vertices(&heap, keys[4].clone());
        Some(Self { first_time: interval.first, keys, ends: [heap, sails] })
    }
}

impl AnimatedMesh for Sculpture {
    fn time_range(&self) -> (f64, f64) {
        (KEY_TIMES[0] - self.first_time, KEY_TIMES[4] - self.first_time)
    }

    fn at(&self, time: f64) -> Result<SurfaceMesh, String> {
        let key_time = time + self.first_time;
        // Keys lie at 0, 1, 2, 3 and 4: the whole part is the key before.
        let (key, share) = (key_time.floor(), key_time.fract() as f32);
        if key_time <= KEY_TIMES[0] || key_time.is_nan() {
            return Ok(self.ends[0].clone());
        }
        if key_time >= KEY_TIMES[4] {
            return Ok(self.ends[1].clone());
        }
        let pair = self.keys[key as usize].iter().zip(&self.keys[key as usize + 1]);
        let vertices = pair.map(|(before, after)| before.lerp(*after, share)).collect();
        Ok(with_vertices(&self.ends[0], vertices))
    }
}

fn with_vertices(surface: &SurfaceMesh, vertices: Vec<Vec3>) -> SurfaceMesh {
    let Ok(mesh) = surface.mesh.with_vertices(vertices) else {
        unreachable!("all keys have as many vertices")
    };
    SurfaceMesh { mesh: Arc::new(mesh), ..surface.clone() }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MUSEUM5: Interval = Interval { first: -1.0, last: 5.0 };

    #[test]
    fn it_rests_outside_its_range_and_keeps_its_triangles() {
        let sculpture = Sculpture::new(3, MUSEUM5).unwrap();
        assert_eq!(sculpture.time_range(), (1.0, 5.0));
        let at = |time| sculpture.at(time).unwrap().mesh;
        assert!(Arc::ptr_eq(&at(0.0), &at(1.0)));
        assert!(Arc::ptr_eq(&at(5.0), &at(1e300)));
        assert!(at(2.5).has_topology_of(&at(0.0)) && at(9.0).has_topology_of(&at(0.0)));
    }

    #[test]
    fn it_passes_through_its_keys_in_straight_lines() {
        let sculpture = Sculpture::new(3, MUSEUM5).unwrap();
        let vertex = |time| sculpture.at(time).unwrap().mesh.vertices()[7];
        for key in 0..5 {
            assert_eq!(vertex(1.0 + key as f64), sculpture.keys[key][7]);
        }
        let middle = sculpture.keys[2][7].midpoint(sculpture.keys[3][7]);
        assert!(vertex(3.5).abs_diff_eq(middle, 1e-6));
    }
}
