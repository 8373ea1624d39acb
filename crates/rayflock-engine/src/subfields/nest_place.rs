//! Where an object that has subfields of its own is in the world.
//!
//! Its grids are in its own space and hold its triangles as they are there. A ray is taken to
//! that space to find candidates; their corners are taken to the world, by the same operations as
//! those of the table, and the accepting test is made there.
//!
//! **Invariants.** What the accepting test may do to a ray and a triangle in the world is the same
//! in object space but for the scale, so the slack of the grids holds there too. What two roundings
//! add, of the corners in the world and of the ray in object space, is below 16 units (2^-24) of the
//! magnitudes at hand, which `extent` adds to the distances that the slack is a part of: 64 units of
//! them.

use glam::{Affine3A, DAffine3, DMat3, Vec3};
use rayflock_geom::simd::ray_triangle::{LaneHits, TriangleBlock};
use rayflock_geom::simd::triangle_lanes::TriangleLanes;
use rayflock_geom::simd::{LANES, Simd, SimdMask, mask32x16};
use rayflock_geom::{Aabb, Ray, Sphere, similarity_scale, transform_point};

use crate::packet::Nearest;
use crate::primitives::PrimitiveTable;

/// The place of one object.
#[derive(Clone, Debug)]
pub(super) struct NestPlace {
    world_from_object: Option<Affine3A>,
    object_from_world: DAffine3,
    /// A length in object space of which roundings between the spaces are a small part.
    extent: f32,
    /// Slot and rank of the object's first triangle in the table.
    pub(super) first_slot: u32,
    pub(super) first_rank: u32,
    /// Rays see the object iff `ray.mask & mask != 0`.
    pub(super) mask: u32,
    /// A sphere in the world around all triangles.
    pub(super) bound: Sphere,
}

impl NestPlace {
    /// The place of an object whose triangles lie within `bounds` in its own space; `None` when the
    /// transform is not a similarity, or anything is out of range.
    pub(super) fn new(
        world_from_object: Option<Affine3A>,
        bounds: &Aabb,
        [first_slot, first_rank]: [u32; 2],
        mask: u32,
    ) -> Option<Self> {
        let transform = world_from_object.unwrap_or(Affine3A::IDENTITY);
        let scale = similarity_scale(&transform).filter(|scale| scale.is_normal())?;
        let center = transform_point(&transform, bounds.center());
        let radius = 0.5 * scale * bounds.size().length();
        let translation = Vec3::from(transform.translation);
        let magnitude = [center, translation].map(|point| point.abs().element_sum());
        let magnitude = magnitude[0] + magnitude[1] + radius;
        let bound = Sphere::new(center, radius * 1.001 + 1e-5 * magnitude);
        let object_from_world = double(&transform).inverse();
        let extent = magnitude / scale;
        let is_in_range = object_from_world.is_finite() && extent.is_finite() && bound.is_valid();
        is_in_range.then_some(Self {
            world_from_object,
            object_from_world,
            extent,
            first_slot,
            first_rank,
            mask,
            bound,
        })
    }

    /// A ray in the object's space.
    #[inline(always)]
    pub(super) fn ray_in_object(&self, ray: &Ray) -> Ray {
        if self.world_from_object.is_none() {
            return *ray;
        }
        let origin = self.object_from_world.transform_point3(ray.origin.as_dvec3());
        let direction = self.object_from_world.transform_vector3(ray.direction.as_dvec3());
        Ray { origin: origin.as_vec3(), direction: direction.as_vec3(), ..*ray }
    }

    /// A direction in the object's space; the same in every bit as that of a ray.
    pub(super) fn direction_in_object(&self, direction: Vec3) -> Vec3 {
        let ray = Ray::new(Vec3::ZERO, direction);
        self.ray_in_object(&ray).direction
    }

    /// A length in object space of which roundings between the spaces are a small part; zero where
    /// there are none.
    #[inline(always)]
    pub(super) fn extent(&self) -> f32 {
        self.world_from_object.map_or(0.0, |_| self.extent)
    }

    /// Triangles of the object in the world, the same in every bit as those of the table.
    #[inline(always)]
    pub(super) fn triangles_in_world<S: Simd>(
        &self,
        simd: S,
        triangles: &TriangleBlock,
    ) -> TriangleBlock {
        let mut in_world = *triangles;
        if let Some(transform) = &self.world_from_object {
            TriangleLanes::load(simd, triangles).transformed(simd, transform).store(&mut in_world);
        }
        in_world
    }

    /// Keeps the nearest of the triangles that a ray hit, given the positions in the object of all
    /// sixteen. The table says which of them are there: one that has an area in the object may have
    /// none in the world.
    #[inline(always)]
    pub(super) fn offer_lanes<S: Simd>(
        &self,
        simd: S,
        table: &PrimitiveTable,
        mut hits: LaneHits<S>,
        triangle_idx: &[u32; LANES],
        nearest: &mut Nearest,
    ) {
        let accepted = hits.accepted.to_bitmask();
        let mut there = 0;
        for (lane, idx) in triangle_idx.iter().enumerate() {
            let is_hit = accepted & (1 << lane) != 0;
            there |= u64::from(is_hit && table.mask(self.first_slot + idx) != 0) << lane;
        }
        hits.accepted = mask32x16::from_bitmask(simd, there);
        let first_rank = self.first_rank;
        nearest.offer_lanes(&hits, &triangle_idx.map(|idx| idx.wrapping_add(first_rank)));
    }
}

fn double(transform: &Affine3A) -> DAffine3 {
    let m = &transform.matrix3;
    let columns = [m.x_axis, m.y_axis, m.z_axis].map(|axis| Vec3::from(axis).as_dvec3());
    let matrix3 = DMat3::from_cols(columns[0], columns[1], columns[2]);
    DAffine3 { matrix3, translation: Vec3::from(transform.translation).as_dvec3() }
}
