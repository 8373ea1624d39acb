//! What primitives look like, on the device: normals, texture coordinates, colours, materials.
//!
//! Attributes lie where the rank of a primitive says, like the primitives themselves. Those of
//! objects that have not changed are neither written nor sent anew.
//!
//! **Cost.** 128 bytes a primitive, on either side.

use std::ops::Range;
use std::sync::Arc;

use glam::{Affine3A, Mat3, Vec2, Vec3};
use rayflock_engine::Budget;
use rayflock_geom::{GeometryObject, Mesh, PrimId};
use rayflock_scene::{SceneFrame, SurfaceAttributes, SurfaceMesh};
use rayon::prelude::*;
use wgpu::Buffer;

use crate::GpuContext;
use crate::buffer::GrowingBuffer;
use crate::layout::Attributes;
use crate::primitives::PrimitiveStore;

/// Primitives whose attributes a binding may hold.
pub(super) const MOST_PRIMS: usize = (128 << 20) / size_of::<Attributes>();

/// As in `frame/attributes.wgsl`.
pub(crate) const HAS_NORMALS: u32 = 1;
pub(crate) const HAS_UVS: u32 = 2;
pub(crate) const IS_MIRRORED: u32 = 4;

/// Attributes of the primitives of a frame.
#[derive(Debug)]
pub(super) struct AttributeStore {
    written: Vec<Written>,
    attributes: Vec<Attributes>,
    buffer: GrowingBuffer,
    /// With the last commit.
    sent_bytes: u64,
}

/// What the attributes of an object were written from.
#[derive(Clone, Debug)]
struct Written {
    ranks: Range<usize>,
    mesh: Arc<Mesh>,
    normals: Arc<[Vec3]>,
    attributes: Arc<SurfaceAttributes>,
    transform: Option<Affine3A>,
    flags: u32,
}

impl Written {
    /// Whether the attributes are the same but for normals.
    fn is_same_but_normals(&self, other: &Self) -> bool {
        self.ranks == other.ranks
            && self.flags == other.flags
            && self.mesh.has_topology_of(&other.mesh)
            && Arc::ptr_eq(&self.attributes, &other.attributes)
    }

    fn is_same(&self, other: &Self) -> bool {
        self.ranks == other.ranks
            && self.transform == other.transform
            && Arc::ptr_eq(&self.mesh, &other.mesh)
            && Arc::ptr_eq(&self.normals, &other.normals)
            && Arc::ptr_eq(&self.attributes, &other.attributes)
    }
}

impl Default for AttributeStore {
    fn default() -> Self {
        let buffer = GrowingBuffer::storage("attributes");
        Self { written: Vec::new(), attributes: Vec::new(), buffer, sent_bytes: 0 }
    }
}

impl AttributeStore {
    /// Writes and sends what changed. The frame has been checked, and `primitives` hold it. A stage
    /// will write the normals of the objects at the places `made`.
    pub(super) fn commit(
        &mut self,
        context: &GpuContext,
        frame: &SceneFrame,
        primitives: &PrimitiveStore,
        made: &[usize],
    ) {
        self.sent_bytes = 0;
        let count = primitives.ranks().last().map_or(0, |ranks| ranks.end);
        let bytes = count.max(1) * size_of::<Attributes>();
        if self.buffer.size() < bytes as u64 {
            self.written.clear();
        }
        self.attributes.resize(count, Attributes::default());
        self.buffer.reserve(context, bytes);
        for ((idx, object), ranks) in
            frame.geometry.objects().iter().enumerate().zip(primitives.ranks())
        {
            let surface = &frame.surfaces[object.id.0 as usize];
            let written = Written {
                ranks,
                mesh: Arc::clone(&surface.mesh),
                normals: Arc::clone(&surface.normals),
                attributes: Arc::clone(&surface.attributes),
                transform: object.world_from_object,
                flags: flags(object, surface),
            };
            let is_made = made.binary_search(&idx).is_ok();
            let is_there = self.written.get(idx).is_some_and(|before| match is_made {
                true => before.is_same_but_normals(&written),
                false => before.is_same(&written),
            });
            if !is_there {
                self.write(context, written.ranks.clone(), object, surface);
            }
            match self.written.get_mut(idx) {
                Some(before) => *before = written,
                None => self.written.push(written),
            }
        }
        self.written.truncate(frame.geometry.objects().len());
    }

    /// Of all primitives.
    pub(super) fn buffer(&self) -> &Buffer {
        self.buffer.buffer()
    }

    /// The attributes by rank, as the host has written them.
    #[cfg(test)]
    pub(super) fn host(&self) -> &[Attributes] {
        &self.attributes
    }

    /// Tells what is held.
    pub(super) fn hold(&self, budget: &mut Budget) {
        let staged = self.attributes.capacity() * size_of::<Attributes>();
        budget.hold("staged attributes", staged as u64);
        self.buffer.hold(budget);
        budget.sent_bytes += self.sent_bytes;
    }

    fn write(
        &mut self,
        context: &GpuContext,
        ranks: Range<usize>,
        object: &GeometryObject,
        surface: &SurfaceMesh,
    ) {
        let writer = Writer::new(object, surface);
        let attributes = &mut self.attributes[ranks.clone()];
        attributes.par_iter_mut().enumerate().with_min_len(1024).for_each(|(prim_idx, written)| {
            *written = writer.write(prim_idx);
        });
        let offset = ranks.start * size_of::<Attributes>();
        self.buffer.write_at(context, offset, attributes);
        self.sent_bytes += size_of_val(attributes) as u64;
    }
}

/// What the attributes of one object are written from.
struct Writer<'a> {
    surface: &'a SurfaceMesh,
    linear: Mat3,
    normal_from_object: Mat3,
    flags: u32,
}

impl<'a> Writer<'a> {
    fn new(object: &GeometryObject, surface: &'a SurfaceMesh) -> Self {
        let linear = linear(object);
        // The inverse transpose times the determinant.
        let [x, y, z] = [linear.x_axis, linear.y_axis, linear.z_axis];
        let normal_from_object = Mat3::from_cols(y.cross(z), z.cross(x), x.cross(y));
        Self { surface, linear, normal_from_object, flags: flags(object, surface) }
    }

    fn write(&self, prim_idx: usize) -> Attributes {
        let SurfaceMesh { mesh, normals, attributes } = self.surface;
        let material = attributes.materials.get(PrimId(prim_idx as u32)).0;
        let Some(triangle) = mesh.triangles().get(prim_idx) else {
            let axes = [self.linear.x_axis, self.linear.y_axis, self.linear.z_axis];
            return Attributes {
                material,
                ..Attributes::new(axes, [Vec3::ONE; 3], [Vec2::ZERO; 3])
            };
        };
        let corners = triangle.map(|corner| corner as usize);
        let normal = |corner: usize| {
            normals.get(corner).map_or(Vec3::ZERO, |&normal| self.normal_from_object * normal)
        };
        let color = |corner: usize| attributes.colors.get(corner).copied().unwrap_or(Vec3::ONE);
        let uv = |corner: usize| attributes.uvs.get(corner).copied().unwrap_or_default();
        Attributes {
            material,
            flags: self.flags,
            ..Attributes::new(corners.map(normal), corners.map(color), corners.map(uv))
        }
    }
}

/// What the transform of an object does to vectors.
fn linear(object: &GeometryObject) -> Mat3 {
    object.world_from_object.map_or(Mat3::IDENTITY, |transform| {
        let m = transform.matrix3;
        Mat3::from_cols(m.x_axis.into(), m.y_axis.into(), m.z_axis.into())
    })
}

/// The flags of all primitives of an object.
fn flags(object: &GeometryObject, surface: &SurfaceMesh) -> u32 {
    let flag = |is_set: bool, flag: u32| if is_set { flag } else { 0 };
    flag(!surface.normals.is_empty(), HAS_NORMALS)
        | flag(!surface.attributes.uvs.is_empty(), HAS_UVS)
        | flag(linear(object).determinant() < 0.0, IS_MIRRORED)
}
