//! Writes the primitives of one object into the table.

use std::ops::Range;

use glam::{Affine3A, Vec3};
use rayflock_geom::simd::LANES;
use rayflock_geom::simd::cone_sphere::SphereBlock;
use rayflock_geom::simd::ray_triangle::TriangleBlock;
use rayflock_geom::{
    Mesh, RayTransform, Sphere, is_degenerate_triangle, transform_point, transform_sphere,
};
use rayon::prelude::*;

use super::span::ObjectSpan;
use super::table::{Ignored, PrimitiveTable, UserSlot};

/// Blocks that one task writes at least.
const BLOCKS_PER_TASK: usize = 64;

/// A bounding sphere that nothing touches.
const UNTOUCHABLE: Sphere = Sphere::new(Vec3::ZERO, f32::NEG_INFINITY);

impl PrimitiveTable {
    /// Writes all primitives of object `object_idx`.
    pub(super) fn write_object(&mut self, object_idx: usize) {
        let span = self.layout.spans[object_idx];
        let object = self.geometry.objects()[object_idx].clone();
        let mut ignored = Ignored::default();
        ignored +=
            self.write_triangles(&span, &object.shape, object.world_from_object, object.mask);
        ignored += self.write_spheres(&span, &object.shape, object.world_from_object, object.mask);
        ignored += self.write_users(&span, &object.shape, object.world_from_object, object.mask);
        self.ignored[object_idx] = ignored;
    }

    fn write_triangles(
        &mut self,
        span: &ObjectSpan,
        shape: &Mesh,
        transform: Option<Affine3A>,
        mask: u32,
    ) -> Ignored {
        let slots = span.first_slot.triangles..span.first_slot.triangles + span.count.triangles;
        if slots.is_empty() {
            return Ignored::default();
        }
        let blocks = slots.start / LANES..slots.end.div_ceil(LANES);
        let writer = TriangleWriter { span, shape, transform, mask, slots };
        let columns = self.corners[blocks.clone()]
            .par_iter_mut()
            .zip(&mut self.bounds[blocks.clone()])
            .zip(&mut self.ranks[blocks.clone()])
            .zip(&mut self.masks[blocks.clone()]);
        columns
            .enumerate()
            .with_min_len(BLOCKS_PER_TASK)
            .map(|(idx, (((corners, bounds), ranks), masks))| {
                let mut columns = BlockColumns { corners, bounds, ranks, masks };
                writer.write_block(blocks.start + idx, &mut columns)
            })
            .reduce(Ignored::default, |a, b| a + b)
    }

    fn write_spheres(
        &mut self,
        span: &ObjectSpan,
        shape: &Mesh,
        transform: Option<Affine3A>,
        mask: u32,
    ) -> Ignored {
        let mut ignored = Ignored::default();
        let first_rank = span.first_rank + span.count.triangles;
        for (idx, sphere) in shape.spheres().iter().enumerate() {
            let sphere =
                transform.map_or(*sphere, |transform| transform_sphere(&transform, sphere));
            let slot = span.first_slot.spheres + idx;
            self.spheres[slot - self.layout.begin.spheres] = sphere;
            let mut bound = sphere;
            let mut mask = mask;
            if !sphere.is_valid() {
                ignored += Ignored::of_sphere(&sphere);
                (bound, mask) = (UNTOUCHABLE, 0);
            }
            self.write_slot(slot, first_rank + idx, &bound, mask);
        }
        ignored
    }

    fn write_users(
        &mut self,
        span: &ObjectSpan,
        shape: &Mesh,
        world_from_object: Option<Affine3A>,
        mask: u32,
    ) -> Ignored {
        let Some(primitives) = shape.user() else { return Ignored::default() };
        let mut ignored = Ignored::default();
        let first_rank = span.first_rank + span.count.triangles + span.count.spheres;
        let transform = world_from_object.as_ref().and_then(RayTransform::new);
        for prim_idx in 0..span.count.users {
            let mut bound = primitives.bounding_sphere(prim_idx);
            if let Some(world_from_object) = &world_from_object {
                // A transform without an inverse leaves no extent.
                let flat = Sphere::new(Vec3::ZERO, -1.0);
                bound = transform
                    .map_or(flat, |transform| transform.sphere_in_world(world_from_object, &bound));
            }
            let mut mask = mask;
            if !(bound.center.is_finite() && bound.radius.is_finite() && bound.radius >= 0.0) {
                ignored += Ignored::of_sphere(&bound);
                (bound, mask) = (UNTOUCHABLE, 0);
            }
            let slot = span.first_slot.users + prim_idx;
            let user = UserSlot { primitives: primitives.clone(), prim_idx, transform };
            let user_idx = slot - self.layout.begin.users;
            match self.users.get_mut(user_idx) {
                Some(place) => *place = user,
                None => self.users.push(user),
            }
            self.write_slot(slot, first_rank + prim_idx, &bound, mask);
        }
        ignored
    }

    /// Writes the sphere around each block of slots.
    pub(super) fn bound_blocks(&mut self) {
        let groups = self.block_bounds.par_iter_mut().zip(self.bounds.par_chunks(LANES));
        groups.with_min_len(BLOCKS_PER_TASK / LANES).for_each(|(group, blocks)| {
            for (lane, block) in blocks.iter().enumerate() {
                group.set(lane, &sphere_around_block(block));
            }
        });
    }

    fn write_slot(&mut self, slot: usize, rank: usize, bound: &Sphere, mask: u32) {
        let (block, lane) = (slot / LANES, slot % LANES);
        self.bounds[block].set(lane, bound);
        self.ranks[block][lane] = rank as u32;
        self.masks[block][lane] = mask;
    }
}

/// A sphere around the bounding spheres of a block.
fn sphere_around_block(block: &SphereBlock) -> Sphere {
    let sphere = |lane: usize| Sphere::new(block.center_of(lane), block.radius[lane]);
    let touchable = (0..LANES).map(sphere).filter(|sphere| sphere.radius >= 0.0);
    Sphere::around_spheres(touchable).unwrap_or(UNTOUCHABLE)
}

/// Writes the triangles of one object, block by block.
struct TriangleWriter<'a> {
    span: &'a ObjectSpan,
    shape: &'a Mesh,
    transform: Option<Affine3A>,
    mask: u32,
    slots: Range<usize>,
}

/// One block of each column.
struct BlockColumns<'a> {
    corners: &'a mut TriangleBlock,
    bounds: &'a mut SphereBlock,
    ranks: &'a mut [u32; LANES],
    masks: &'a mut [u32; LANES],
}

impl TriangleWriter<'_> {
    /// Writes the lanes of a block that belong to the object.
    fn write_block(&self, block_idx: usize, columns: &mut BlockColumns<'_>) -> Ignored {
        let mut ignored = Ignored::default();
        let first_slot = block_idx * LANES;
        let from = self.slots.start.max(first_slot);
        let to = self.slots.end.min(first_slot + LANES);
        for slot in from..to {
            let (lane, triangle_idx) = (slot - first_slot, slot - self.span.first_slot.triangles);
            let mut corners = self.shape.corners(triangle_idx);
            if let Some(transform) = &self.transform {
                corners = corners.map(|corner| transform_point(transform, corner));
            }
            let mut bound = Sphere::around_triangle(corners[0], corners[1], corners[2]);
            let mut mask = self.mask;
            if is_degenerate_triangle(corners) {
                ignored += Ignored::of_triangle(corners);
                (corners, bound, mask) = ([Vec3::ZERO; 3], UNTOUCHABLE, 0);
            }
            columns.corners.set(lane, corners);
            columns.bounds.set(lane, &bound);
            columns.ranks[lane] = (self.span.first_rank + triangle_idx) as u32;
            columns.masks[lane] = mask;
        }
        ignored
    }
}

impl Ignored {
    fn of_triangle(corners: [Vec3; 3]) -> Self {
        Self::one(corners.iter().all(|corner| corner.is_finite()))
    }

    fn of_sphere(sphere: &Sphere) -> Self {
        Self::one(sphere.center.is_finite() && sphere.radius.is_finite())
    }

    fn one(finite: bool) -> Self {
        Self { non_finite: usize::from(!finite), degenerate: usize::from(finite) }
    }
}

impl std::ops::Add for Ignored {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            non_finite: self.non_finite + other.non_finite,
            degenerate: self.degenerate + other.degenerate,
        }
    }
}

impl std::ops::AddAssign for Ignored {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}
