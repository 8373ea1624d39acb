//! Collects the triangles of a procedural surface, each with its material, and a normal a vertex.
//!
//! Flat pieces and smooth pieces share one mesh: where a surface has a crease, its vertices are
//! doubled, in the same place to the bit, so that what should be closed stays closed.

use std::f32::consts::TAU;
use std::sync::Arc;

use glam::{Affine3A, Vec2, Vec3};
use rayflock_geom::Mesh;

use crate::{MaterialIdx, PrimMaterials, SurfaceAttributes, SurfaceMesh};

/// Two pieces of a profile meet smoothly when the cosine between their normals exceeds this.
const SMOOTH_COSINE: f32 = 0.75;

/// A surface in the making.
#[derive(Debug, Default)]
pub(super) struct SurfaceBuilder {
    vertices: Vec<Vec3>,
    normals: Vec<Vec3>,
    uvs: Vec<Vec2>,
    triangles: Vec<[u32; 3]>,
    materials: Vec<MaterialIdx>,
}

impl SurfaceBuilder {
    /// Number of vertices so far: the index of the next one.
    pub(super) fn vertex_count(&self) -> u32 {
        self.vertices.len() as u32
    }

    /// Adds a vertex and tells its index.
    pub(super) fn vertex(&mut self, position: Vec3, normal: Vec3, uv: Vec2) -> u32 {
        self.vertices.push(position);
        self.normals.push(normal);
        self.uvs.push(uv);
        (self.vertices.len() - 1) as u32
    }

    /// Adds a triangle of three added vertices.
    pub(super) fn triangle(&mut self, corners: [u32; 3], material: MaterialIdx) {
        self.triangles.push(corners);
        self.materials.push(material);
    }

    /// Adds a flat quadrangle with its corners counter-clockwise from the lower left, cut into
    /// `columns` times `rows` pieces. Texture coordinates cover it once, upright.
    pub(super) fn patch(
        &mut self,
        [a, b, c, d]: [Vec3; 4],
        [columns, rows]: [u32; 2],
        material: MaterialIdx,
    ) {
        let normal = (c - a).cross(d - b).normalize_or(Vec3::Y);
        let first = self.vertex_count();
        for row in 0..=rows {
            for column in 0..=columns {
                let (u, v) = (column as f32 / columns as f32, row as f32 / rows as f32);
                let position = a.lerp(b, u).lerp(d.lerp(c, u), v);
                self.vertex(position, normal, Vec2::new(u, 1.0 - v));
            }
        }
        self.grid(first, [columns, rows], |_, _| material);
    }

    /// Adds a flat quadrangle with its corners counter-clockwise.
    pub(super) fn quad(&mut self, corners: [Vec3; 4], material: MaterialIdx) {
        self.patch(corners, [1, 1], material);
    }

    /// Adds the six sides of the box from `min` to `max`, placed by `place`, each cut into
    /// `pieces` times `pieces`.
    pub(super) fn block(
        &mut self,
        [min, max]: [Vec3; 2],
        pieces: u32,
        place: &Affine3A,
        material: MaterialIdx,
    ) {
        let corner = |bits: usize| {
            let pick = |axis: usize| if bits & (1 << axis) == 0 { min[axis] } else { max[axis] };
            place.transform_point3(Vec3::new(pick(0), pick(1), pick(2)))
        };
        const SIDES: [[usize; 4]; 6] =
            [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
        for side in SIDES {
            self.patch(side.map(corner), [pieces; 2], material);
        }
    }

    /// Adds the surface that `profile`, pairs of radius and height, sweeps around +Y, placed by
    /// `place`. Seen from outside, the profile runs upward.
    pub(super) fn lathe(
        &mut self,
        profile: &[Vec2],
        segments: u32,
        place: &Affine3A,
        material: MaterialIdx,
    ) {
        self.lathe_with(profile, segments, place, |_, _| material);
    }

    /// Adds a lathed surface whose material depends on the piece: `material(segment, ring)`.
    pub(super) fn lathe_with(
        &mut self,
        profile: &[Vec2],
        segments: u32,
        place: &Affine3A,
        material: impl Fn(u32, u32) -> MaterialIdx,
    ) {
        let normals = profile_normals(profile);
        for (ring, ends) in profile.windows(2).enumerate() {
            let first = self.vertex_count();
            for (end, normal) in ends.iter().zip(normals[ring]) {
                for segment in 0..=segments {
                    // The last point is the first to the bit.
                    let turn = (segment % segments) as f32 / segments as f32;
                    let (sin, cos) = (TAU * turn).sin_cos();
                    let around = |p: Vec2| Vec3::new(p.x * cos, p.y, p.x * sin);
                    let position = place.transform_point3(around(*end));
                    let normal = place.transform_vector3(around(normal)).normalize_or(Vec3::Y);
                    let uv = Vec2::new(segment as f32 / segments as f32, 0.0);
                    self.vertex(position, normal, uv);
                }
            }
            self.ring(first, segments, [ends[0].x > 0.0, ends[1].x > 0.0], |segment| {
                material(segment, ring as u32)
            });
        }
    }

    /// Joins two rows of `segments + 1` vertices that start at `first`; a row that is not `open`
    /// lies in one point.
    fn ring(
        &mut self,
        first: u32,
        segments: u32,
        open: [bool; 2],
        material: impl Fn(u32) -> MaterialIdx,
    ) {
        for segment in 0..segments {
            let [a, b] = [first + segment, first + segment + 1];
            let [d, c] = [a + segments + 1, b + segments + 1];
            if open[0] {
                self.triangle([a, c, b], material(segment));
            }
            if open[1] {
                self.triangle([a, d, c], material(segment));
            }
        }
    }

    /// Joins `(columns + 1) * (rows + 1)` vertices that start at `first` to a grid.
    pub(super) fn grid(
        &mut self,
        first: u32,
        [columns, rows]: [u32; 2],
        material: impl Fn(u32, u32) -> MaterialIdx,
    ) {
        for row in 0..rows {
            for column in 0..columns {
                let a = first + row * (columns + 1) + column;
                let [b, d] = [a + 1, a + columns + 1];
                self.triangle([a, b, d + 1], material(column, row));
                self.triangle([a, d + 1, d], material(column, row));
            }
        }
    }

    /// The finished surface.
    pub(super) fn build(self) -> SurfaceMesh {
        let Ok(mesh) = Mesh::from_triangles(self.vertices, self.triangles) else {
            unreachable!("the builder names only vertices that it has added")
        };
        let materials = PrimMaterials::PerPrim(self.materials);
        let attributes = SurfaceAttributes { uvs: self.uvs, colors: Vec::new(), materials };
        SurfaceMesh {
            mesh: Arc::new(mesh),
            normals: self.normals.into(),
            attributes: Arc::new(attributes),
        }
    }
}

/// The normals of each piece of a profile at its two ends: shared with the neighbour where the
/// profile runs on smoothly.
fn profile_normals(profile: &[Vec2]) -> Vec<[Vec2; 2]> {
    let pieces: Vec<Vec2> =
        profile.windows(2).map(|ends| (ends[0] - ends[1]).perp().normalize_or(Vec2::X)).collect();
    let blend = |piece: Vec2, neighbour: Option<&Vec2>| match neighbour {
        Some(&other) if piece.dot(other) > SMOOTH_COSINE => (piece + other).normalize_or(piece),
        _ => piece,
    };
    let both_ends = |(idx, &piece): (usize, &Vec2)| {
        let before = idx.checked_sub(1).and_then(|before| pieces.get(before));
        [blend(piece, before), blend(piece, pieces.get(idx + 1))]
    };
    pieces.iter().enumerate().map(both_ends).collect()
}
