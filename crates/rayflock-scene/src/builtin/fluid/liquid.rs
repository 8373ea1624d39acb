//! The surface of the liquid, made anew for each time it is asked for.
//!
//! **Cost.** A third of a million values of the field, in parallel by slices, and about 35,000
//! triangles.

use std::sync::Arc;

use fast_surface_nets::ndshape::{ConstShape, ConstShape3u32};
use fast_surface_nets::{SurfaceNetsBuffer, surface_nets};
use glam::{Vec2, Vec3};
use rayflock_geom::Mesh;
use rayon::prelude::*;

use super::field::Field;
use super::splash::{Jet, jets};
use super::{DURATION, FRAME_RATE, LIQUID};
use crate::{AnimatedMesh, SurfaceMesh};

/// Distance between values of the field.
const SPACING: f32 = 0.02;
/// Numbers of values along x, y and z: those on the outside lie beyond the liquid.
const COUNTS: [u32; 3] = [102, 66, 52];
type Grid = ConstShape3u32<{ COUNTS[0] }, { COUNTS[1] }, { COUNTS[2] }>;
/// Where the first value is.
const ORIGIN: Vec3 = Vec3::new(-1.01, -0.01, -0.51);

/// A liquid with waves and drops.
#[derive(Debug)]
pub(super) struct Liquid {
    jets: Vec<Jet>,
}

impl Liquid {
    pub(super) fn new() -> Self {
        Self { jets: jets() }
    }
}

impl AnimatedMesh for Liquid {
    fn time_range(&self) -> (f64, f64) {
        (0.0, f64::from(DURATION - 1.0 / FRAME_RATE))
    }

    fn at(&self, time: f64) -> Result<SurfaceMesh, String> {
        let time = time as f32;
        let drops = self.jets.iter().filter_map(|jet| jet.drop_at(time)).collect();
        Ok(surface(&values(&Field::new(time, drops))))
    }
}

/// The field at all points of the grid.
fn values(field: &Field) -> Vec<f32> {
    let [x_count, y_count, _] = COUNTS.map(|count| count as usize);
    let mut values = vec![0.0; Grid::USIZE];
    values.par_chunks_mut(x_count * y_count).enumerate().for_each(|(z, slice)| {
        let place = |x: usize, y: usize| ORIGIN + SPACING * Vec3::new(x as f32, y as f32, z as f32);
        let height = |x: usize| field.wave_height(Vec2::new(place(x, 0).x, place(x, 0).z));
        let heights: Vec<f32> = (0..x_count).map(height).collect();
        for (y, row) in slice.chunks_exact_mut(x_count).enumerate() {
            for (x, value) in row.iter_mut().enumerate() {
                *value = field.at(place(x, y), heights[x]);
            }
        }
    });
    values
}

/// The surface on which a field is zero, facing outward.
fn surface(values: &[f32]) -> SurfaceMesh {
    let mut net = SurfaceNetsBuffer::default();
    surface_nets(values, &Grid {}, [0; 3], COUNTS.map(|count| count - 1), &mut net);
    let position = |&cell: &[f32; 3]| ORIGIN + SPACING * Vec3::from(cell);
    let vertices = net.positions.iter().map(position).collect();
    let (triangles, _) = net.indices.as_chunks();
    let Ok(mesh) = Mesh::from_triangles(vertices, triangles) else {
        unreachable!("a net names only its own vertices")
    };
    let normal = |&gradient: &[f32; 3]| Vec3::from(gradient).normalize_or(Vec3::Y);
    let normals = net.normals.iter().map(normal).collect();
    SurfaceMesh { normals, ..SurfaceMesh::new(Arc::new(mesh), LIQUID) }
}

#[cfg(test)]
mod tests {
    use std::collections::HashMap;

    use rayflock_geom::Aabb;

    use super::super::TANK;
    use super::*;

    #[test]
    fn the_surface_is_closed_faces_outward_and_stays_in_the_tank() {
        for time in [0.0, 3.7, 6.25] {
            let surface = Liquid::new().at(time).unwrap();
            let mut edges = HashMap::new();
            for &[a, b, c] in surface.mesh.triangles() {
                for (from, to) in [(a, b), (b, c), (c, a)] {
                    *edges.entry((from, to)).or_insert(0) += 1;
                }
            }
            assert!(edges.iter().all(|(&(a, b), count)| edges.get(&(b, a)) == Some(count)));
            let Aabb { min, max } = surface.mesh.bounds();
            assert!(min.y > 0.0 && min.cmpgt(Vec3::new(-TANK.x, 0.0, -TANK.z)).all());
            assert!(max.cmplt(TANK).all() && max.y > 0.6, "{max}");
            let volume: f32 = (0..surface.mesh.triangles().len())
                .map(|triangle| surface.mesh.corners(triangle))
                .map(|[a, b, c]| a.dot(b.cross(c)) / 6.0)
                .sum();
            let at_rest = 4.0 * TANK.x * TANK.z * 0.46;
            assert!((volume / at_rest - 1.0).abs() < 0.1, "{volume} {at_rest}");
        }
    }

    #[test]
    fn every_frame_has_triangles_of_its_own_and_some_drops_are_free() {
        let liquid = Liquid::new();
        let surfaces: Vec<_> = (90..94).map(|i| liquid.at(f64::from(i) / 24.0).unwrap()).collect();
        for pair in surfaces.windows(2) {
            assert_ne!(pair[0].mesh.triangles(), pair[1].mesh.triangles());
        }
        assert!(part_count(&surfaces[0].mesh) > 1);
    }

    /// Number of connected parts.
    fn part_count(mesh: &Mesh) -> usize {
        let mut leader: Vec<usize> = (0..mesh.vertices().len()).collect();
        let find = |leader: &[usize], mut vertex: usize| {
            while leader[vertex] != vertex {
                vertex = leader[vertex];
            }
            vertex
        };
        for corners in mesh.triangles() {
            let [a, b, c] = corners.map(|corner| find(&leader, corner as usize));
            let first = a.min(b).min(c);
            [a, b, c].iter().for_each(|&part| leader[part] = first);
        }
        (0..leader.len()).filter(|&vertex| leader[vertex] == vertex).count()
    }
}
