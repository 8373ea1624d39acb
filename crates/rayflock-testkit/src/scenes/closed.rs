//! Meshes that enclose a volume: no ray may leave them from inside.

use std::collections::HashMap;

use glam::{DVec3, Vec3};

use super::mesh;
use crate::Rng;
use rayflock_geom::Mesh;

/// A closed, convex surface around the origin, with vertices that neighbours share.
#[derive(Clone, Debug, PartialEq)]
pub struct ClosedMesh {
    /// Corners.
    pub vertices: Vec<Vec3>,
    /// Faces.
    pub triangles: Vec<[u32; 3]>,
}

impl ClosedMesh {
    /// The cube from -1 to 1.
    pub fn cube() -> Self {
        let corner = |bits: u8| {
            let side = |axis: u8| if bits & (1 << axis) == 0 { -1.0 } else { 1.0 };
            Vec3::new(side(0), side(1), side(2))
        };
        let quads =
            [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let halves = |[a, b, c, d]: [u32; 4]| [[a, b, c], [a, c, d]];
        Self {
            vertices: (0..8).map(corner).collect(),
            triangles: quads.into_iter().flat_map(halves).collect(),
        }
    }

    /// A regular tetrahedron within the cube from -1 to 1.
    pub fn tetrahedron() -> Self {
        let vertices = vec![
            Vec3::new(1.0, 1.0, 1.0),
            Vec3::new(-1.0, -1.0, 1.0),
            Vec3::new(-1.0, 1.0, -1.0),
            Vec3::new(1.0, -1.0, -1.0),
        ];
        Self { vertices, triangles: vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]] }
    }

    /// A unit sphere of `20 * 4^level` triangles.
    pub fn icosphere(level: u32) -> Self {
        let golden = 0.5 * (1.0 + 5.0_f32.sqrt());
        let ring = [(-1.0, golden), (1.0, golden), (-1.0, -golden), (1.0, -golden)];
        let vertices = (0..3).flat_map(|axis| {
            ring.map(|(a, b)| a * Vec3::AXES[axis] + b * Vec3::AXES[(axis + 1) % 3])
        });
        let mut sphere = Self {
            vertices: vertices.map(Vec3::normalize).collect(),
            triangles: hull_of_icosahedron(),
        };
        for _ in 0..level {
            sphere = sphere.split_at_edges();
        }
        sphere
    }

    /// Every face split in four at the middles of its edges, which are pushed out to the unit
    /// sphere.
    fn split_at_edges(&self) -> Self {
        let mut vertices = self.vertices.clone();
        let mut middles = HashMap::new();
        let mut middle = |a: u32, b: u32| {
            *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                let between = vertices[a as usize] + vertices[b as usize];
                vertices.push(between.normalize());
                vertices.len() as u32 - 1
            })
        };
        let triangles = self.triangles.iter().flat_map(|&[a, b, c]| {
            let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
            [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
        });
        let triangles = triangles.collect();
        Self { vertices, triangles }
    }

    /// Up to `count` faces, one after the other, split at a point so near one of their edges that
    /// a needle remains there. Rounding may fold the surface at a needle of a needle; it still
    /// encloses what is not near it. No face is left without area, because those are ignored by
    /// definition and so would be holes.
    pub fn with_needles(mut self, rng: &mut Rng, count: usize) -> Self {
        for _ in 0..count {
            let face = rng.below(self.triangles.len());
            let [a, b, c] = self.triangles[face];
            let [pa, pb, pc] = [a, b, c].map(|corner| self.vertices[corner as usize]);
            let height = rng.power_of_ten(-6, -2);
            let point = pa.lerp(pb, rng.between(0.1, 0.9)).lerp(pc, height);
            if [[pa, pb], [pb, pc], [pc, pa]].into_iter().any(|[p, q]| is_flat(p, q, point)) {
                continue;
            }
            let added = self.vertices.len() as u32;
            self.vertices.push(point);
            self.triangles[face] = [a, b, added];
            self.triangles.extend([[b, c, added], [c, a, added]]);
        }
        self
    }

    /// This surface, scaled by `size` and then moved to `center`, rounded to `f32`.
    pub fn placed(mut self, center: Vec3, size: f32) -> Self {
        for vertex in &mut self.vertices {
            *vertex = center + size * *vertex;
        }
        self
    }

    /// The surface as a mesh.
    pub fn mesh(&self) -> Mesh {
        mesh(self.vertices.clone(), self.triangles.clone())
    }

    /// Whether every edge is used by exactly two faces, once in each direction.
    pub fn is_closed(&self) -> bool {
        let mut uses: HashMap<(u32, u32), i32> = HashMap::new();
        for &[a, b, c] in &self.triangles {
            for edge in [(a, b), (b, c), (c, a)] {
                *uses.entry(edge).or_default() += 1;
            }
        }
        uses.iter().all(|(&(a, b), &count)| count == 1 && uses.get(&(b, a)) == Some(&1))
    }
}

fn is_flat(a: Vec3, b: Vec3, c: Vec3) -> bool {
    let [a, b, c] = [a, b, c].map(Vec3::as_dvec3);
    (b - a).cross(c - a) == DVec3::ZERO
}

/// The 20 faces: three vertices each of which is a neighbour of the two others, turned outward.
fn hull_of_icosahedron() -> Vec<[u32; 3]> {
    let golden = 0.5 * (1.0 + 5.0_f32.sqrt());
    let ring = [(-1.0, golden), (1.0, golden), (-1.0, -golden), (1.0, -golden)];
    let corners: Vec<Vec3> = (0..3)
        .flat_map(|axis| ring.map(|(a, b)| a * Vec3::AXES[axis] + b * Vec3::AXES[(axis + 1) % 3]))
        .collect();
    let near = |a: usize, b: usize| corners[a].distance_squared(corners[b]) < 4.5;
    let mut faces = Vec::new();
    for a in 0..12 {
        for b in a + 1..12 {
            for c in b + 1..12 {
                if near(a, b) && near(b, c) && near(c, a) {
                    let out = corners[a].dot(corners[b].cross(corners[c])) > 0.0;
                    let face = if out { [a, b, c] } else { [a, c, b] };
                    faces.push(face.map(|corner| corner as u32));
                }
            }
        }
    }
    faces
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_mesh_is_closed_and_turned_outward() {
        let meshes = [ClosedMesh::cube(), ClosedMesh::tetrahedron(), ClosedMesh::icosphere(2)];
        for (mesh, faces) in meshes.iter().zip([12, 4, 320]) {
            assert!(mesh.is_closed());
            assert_eq!(mesh.triangles.len(), faces);
            let out = |[a, b, c]: [u32; 3]| {
                let [a, b, c] = [a, b, c].map(|corner| mesh.vertices[corner as usize].as_dvec3());
                a.dot(b.cross(c)) > 0.0
            };
            assert!(mesh.triangles.iter().all(|&face| out(face)), "{faces} faces");
        }
    }

    #[test]
    fn needles_leave_no_hole() {
        let far = ClosedMesh::cube().placed(Vec3::splat(1000.0), 1.0);
        for mesh in [ClosedMesh::tetrahedron(), far] {
            let faces = mesh.triangles.len();
            let mesh = mesh.with_needles(&mut Rng::new(1), 50);
            assert!(mesh.is_closed());
            assert!(mesh.triangles.len() > faces + 50);
            let corners = |face: [u32; 3]| face.map(|corner| mesh.vertices[corner as usize]);
            let flat = |face| matches!(corners(face), [a, b, c] if is_flat(a, b, c));
            assert!(!mesh.triangles.iter().any(|&face| flat(face)));
        }
    }

    #[test]
    fn a_hole_is_noticed() {
        let mut mesh = ClosedMesh::cube();
        mesh.triangles.pop();
        assert!(!mesh.is_closed());
    }
}
