//! From triangles of corners to a mesh whose vertices have one of everything.
//!
//! A vertex of the mesh is a position with one texture coordinate and one normal. Its order is
//! that of the file: first the positions that the object uses, in the order of their `v` lines,
//! each with the texture coordinate and normal that it is first seen with; then a duplicate for
//! each other combination, in the order in which faces name them.
//!
//! **Invariants.** The order depends on the indices in the faces alone, not on any coordinate.
//! So files of one topology, such as the shapes of a face rig, load to meshes that can be
//! interpolated vertex by vertex.

use std::collections::HashMap;

use glam::{Vec2, Vec3};

use super::parse::{Corner, Group, NONE, ObjFile};
use crate::mesh_parts::{MeshParts, prim_materials};

/// The mesh of a group, and the position that each of its vertices has.
pub(super) fn mesh_parts(file: &ObjFile, group: &Group) -> (MeshParts, Vec<u32>) {
    let mut vertices = Vertices::of(group);
    let triangles: Vec<[u32; 3]> =
        group.triangles.iter().map(|corners| corners.map(|corner| vertices.add(corner))).collect();
    let corners: Vec<Corner> = vertices.finish();

    let position = |corner: &Corner| file.positions[corner.position as usize];
    let normal = |corner: &Corner| match corner.normal {
        NONE => Vec3::ZERO,
        idx => file.normals[idx as usize],
    };
    let uv = |corner: &Corner| match corner.uv {
        NONE => Vec2::ZERO,
        idx => file.uvs[idx as usize],
    };
    let has_normals = corners.iter().any(|corner| corner.normal != NONE);
    let has_uvs = corners.iter().any(|corner| corner.uv != NONE);
    let points = corners.iter().map(|corner| corner.position).collect();
    let parts = MeshParts {
        positions: corners.iter().map(position).collect(),
        normals: if has_normals { corners.iter().map(normal).collect() } else { Vec::new() },
        uvs: if has_uvs { corners.iter().map(uv).collect() } else { Vec::new() },
        colors: match file.colors.as_slice() {
            [] => Vec::new(),
            colors => corners.iter().map(|corner| colors[corner.position as usize]).collect(),
        },
        materials: prim_materials(&group.materials),
        triangles,
    };
    (parts, points)
}

/// Numbers the combinations that corners name.
struct Vertices {
    /// The positions in use, ascending.
    used: Vec<u32>,
    /// For each of `used`, the combination it was first seen with.
    first: Vec<Option<Corner>>,
    others: Vec<Corner>,
    other_idxs: HashMap<Corner, u32>,
}

impl Vertices {
    fn of(group: &Group) -> Self {
        let mut used: Vec<u32> =
            group.triangles.iter().flatten().map(|corner| corner.position).collect();
        used.sort_unstable();
        used.dedup();
        let first = vec![None; used.len()];
        Self { used, first, others: Vec::new(), other_idxs: HashMap::new() }
    }

    fn add(&mut self, corner: Corner) -> u32 {
        let Ok(idx) = self.used.binary_search(&corner.position) else {
            unreachable!("`used` holds the positions of all corners")
        };
        if *self.first[idx].get_or_insert(corner) == corner {
            return idx as u32;
        }
        *self.other_idxs.entry(corner).or_insert_with(|| {
            self.others.push(corner);
            (self.used.len() + self.others.len() - 1) as u32
        })
    }

    /// The combinations in order.
    fn finish(self) -> Vec<Corner> {
        // Every used position was added with some corner.
        self.first.into_iter().flatten().chain(self.others).collect()
    }
}
