//! What one file puts into one space: the surfaces that become objects of the scene.
//!
//! A part is what a file, included once, draws on one mover. Static transforms are applied as
//! shapes come in, so parts are in the space of their mover.

use std::collections::HashMap;

use glam::{Affine3A, Mat3A, Vec2, Vec3};
use rayflock_geom::{Sphere, similarity_scale, transform_sphere};
use rayflock_scene::VertexKey;

use super::curved;
use super::patch::Patch;
use crate::mesh_parts::MeshParts;

/// What is drawn where and of what.
#[derive(Clone, Copy, Debug)]
pub(super) struct Setting {
    /// From the block's space to that of the part.
    pub(super) part_from_block: Affine3A,
    /// A position in the list of materials.
    pub(super) material: u32,
}

/// The surfaces of a part, by what they become.
#[derive(Debug, Default)]
pub(super) struct Part {
    /// Name of the file, for messages.
    pub(super) name: String,
    /// What carries it: a position in the list of movers.
    pub(super) mover: Option<usize>,
    /// Triangles without and with normals.
    pub(super) flat: Surface,
    pub(super) smooth: Surface,
    pub(super) spheres: Vec<(Sphere, u32)>,
    /// Animated triangles, together where their keys have the same times.
    pub(super) animated: Vec<AnimatedSurface>,
    animated_idxs: HashMap<Vec<u64>, usize>,
}

/// Triangles in the making.
#[derive(Debug, Default)]
pub(super) struct Surface {
    pub(super) parts: MeshParts,
    /// One a triangle.
    pub(super) materials: Vec<u32>,
    /// Whether any triangle has texture coordinates.
    pub(super) is_textured: bool,
}

/// Animated triangles whose keys have the same times.
#[derive(Debug, Default)]
pub(super) struct AnimatedSurface {
    /// Three vertices a triangle.
    pub(super) keys: Vec<VertexKey>,
    /// One a triangle.
    pub(super) materials: Vec<u32>,
}

impl Part {
    pub(super) fn new(name: String, mover: Option<usize>) -> Self {
        Self { name, mover, ..Self::default() }
    }

    pub(super) fn add_patch(&mut self, patch: &Patch, setting: &Setting) {
        let surface = if patch.normals.is_empty() { &mut self.flat } else { &mut self.smooth };
        surface.add(patch, setting);
    }

    /// Adds a sphere; one that is stretched becomes triangles. Returns whether it did.
    pub(super) fn add_sphere(&mut self, sphere: Sphere, setting: &Setting) -> bool {
        if similarity_scale(&setting.part_from_block).is_none() {
            self.smooth.add(&curved::sphere(sphere.center, sphere.radius), setting);
            return true;
        }
        let sphere = transform_sphere(&setting.part_from_block, &sphere);
        self.spheres.push((sphere, setting.material));
        false
    }

    /// Makes triangles of all spheres.
    pub(super) fn flatten_spheres(&mut self) {
        for (sphere, material) in std::mem::take(&mut self.spheres) {
            let setting = Setting { part_from_block: Affine3A::IDENTITY, material };
            self.smooth.add(&curved::sphere(sphere.center, sphere.radius), &setting);
        }
    }

    /// Adds one animated triangle.
    pub(super) fn add_animated(&mut self, triangle: &[VertexKey], setting: &Setting) {
        let times = triangle.iter().map(|key| key.time.to_bits()).collect();
        let surface_idx = *self.animated_idxs.entry(times).or_insert_with(|| {
            let at_time = |key: &VertexKey| VertexKey { time: key.time, ..VertexKey::default() };
            let keys = triangle.iter().map(at_time).collect();
            self.animated.push(AnimatedSurface { keys, materials: Vec::new() });
            self.animated.len() - 1
        });
        let surface = &mut self.animated[surface_idx];
        let place = Placement::new(&setting.part_from_block);
        let order = place.corner_order();
        for (key, corners) in surface.keys.iter_mut().zip(triangle) {
            let positions = order.map(|corner| place.position(corners.positions[corner]));
            let normals = order.map(|corner| place.normal(corners.normals[corner]));
            key.positions.extend(positions);
            key.normals.extend(normals);
        }
        surface.materials.push(setting.material);
    }
}

impl Surface {
    fn add(&mut self, patch: &Patch, setting: &Setting) {
        let place = Placement::new(&setting.part_from_block);
        let first = self.parts.positions.len() as u32;
        self.parts.positions.extend(patch.positions.iter().map(|&p| place.position(p)));
        self.parts.normals.extend(patch.normals.iter().map(|&n| place.normal(n)));
        let missing = patch.positions.len() - patch.uvs.len();
        let uvs = patch.uvs.iter().copied();
        self.parts.uvs.extend(uvs.chain(std::iter::repeat_n(Vec2::ZERO, missing)));
        self.is_textured |= !patch.uvs.is_empty();
        let order = place.corner_order();
        let moved = |triangle: &[u32; 3]| order.map(|corner| first + triangle[corner]);
        self.parts.triangles.extend(patch.triangles.iter().map(moved));
        self.materials.resize(self.parts.triangles.len(), setting.material);
    }
}

/// A transform of positions, normals and sides.
struct Placement {
    transform: Affine3A,
    /// From normals to normals, but for their length.
    normal_matrix: Mat3A,
}

impl Placement {
    fn new(transform: &Affine3A) -> Self {
        let [x, y, z] = [0, 1, 2].map(|axis| transform.matrix3.col(axis));
        // The inverse transpose times the determinant, which a flat matrix has too.
        let cofactors = Mat3A::from_cols(y.cross(z), z.cross(x), x.cross(y));
        let side = if transform.matrix3.determinant() < 0.0 { -1.0 } else { 1.0 };
        Self { transform: *transform, normal_matrix: cofactors * side }
    }

    fn position(&self, position: Vec3) -> Vec3 {
        self.transform.transform_point3(position)
    }

    /// The normal with unit length, if it has any.
    fn normal(&self, normal: Vec3) -> Vec3 {
        (self.normal_matrix * normal).normalize_or_zero()
    }

    /// Mirrored triangles change the order of their corners, so that they keep their outside.
    fn corner_order(&self) -> [usize; 3] {
        if self.transform.matrix3.determinant() < 0.0 { [0, 2, 1] } else { [0, 1, 2] }
    }
}
