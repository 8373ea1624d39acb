//! The table of primitives, kept from frame to frame.

use std::sync::Arc;

use glam::Vec3;
use rayflock_geom::simd::cone_sphere::{SLACK, SphereBlock};
use rayflock_geom::simd::ray_triangle::TriangleBlock;
use rayflock_geom::simd::{LANES, Lanes};
use rayflock_geom::{
    FrameChanges, Geometry, GeometryObject, Hit, ObjectChange, PrimId, RayTransform, Sphere,
    UserPrimitives,
};

use super::span::{Layout, ObjectSpan};
use crate::CommitStats;
use crate::packet::Nearest;

/// What a test reads of a triangle: three corners, rank and mask.
pub(crate) const TRIANGLE_BYTES: u64 = 44;

/// What a test reads of a sphere: centre and radius, rank and mask.
pub(crate) const SPHERE_BYTES: u64 = 24;

/// All primitives of the committed frame. See the [module](super) for the layout.
#[derive(Debug, Default)]
pub(crate) struct PrimitiveTable {
    pub(super) geometry: Geometry,
    pub(super) layout: Layout,
    /// One for each object: what its last writing ignored.
    pub(super) ignored: Vec<Ignored>,
    /// Corners of the triangle slots.
    pub(super) corners: Vec<TriangleBlock>,
    /// Spheres, from slot `layout.begin.spheres` on.
    pub(super) spheres: Vec<Sphere>,
    /// User primitives, from slot `layout.begin.users` on.
    pub(super) users: Vec<UserSlot>,
    /// Bounding spheres of all slots.
    pub(super) bounds: Vec<SphereBlock>,
    /// One sphere around the bounding spheres of each block, sixteen blocks an entry.
    pub(super) block_bounds: Vec<SphereBlock>,
    /// Ranks of all slots.
    pub(super) ranks: Vec<[u32; LANES]>,
    /// Object masks of all slots; 0 where there is nothing to hit.
    pub(super) masks: Vec<[u32; LANES]>,
    slack: f32,
}

/// A user primitive and the way into its object's space.
#[derive(Clone, Debug)]
pub(crate) struct UserSlot {
    pub(crate) primitives: Arc<dyn UserPrimitives>,
    pub(crate) prim_idx: usize,
    /// `None` when the object is in world space.
    pub(crate) transform: Option<RayTransform>,
}

/// Primitives that were left out, and why.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Ignored {
    pub(super) non_finite: usize,
    pub(super) degenerate: usize,
}

/// What a slot holds.
#[derive(Clone, Copy, Debug)]
pub(crate) enum SlotKind<'a> {
    /// A triangle, by its corners.
    Triangle([Vec3; 3]),
    /// A sphere.
    Sphere(&'a Sphere),
    /// A user primitive.
    User(&'a UserSlot),
}

impl PrimitiveTable {
    /// Takes over a frame, writing the primitives of objects that differ from the frame before.
    ///
    /// An object is taken as it was only when `changes` says so *and* it shares its mesh,
    /// transform and mask with the frame before: meshes are immutable, so a wrong hint does no
    /// harm.
    pub(crate) fn commit(&mut self, geometry: &Geometry, changes: &FrameChanges) -> CommitStats {
        let before = std::mem::replace(&mut self.geometry, geometry.clone());
        let layout_differs = self.layout.assign(geometry);
        if layout_differs {
            self.resize();
        }
        let (mut rewritten_count, object_count) = (0, geometry.objects().len());
        for idx in 0..object_count {
            let object = &geometry.objects()[idx];
            let unchanged = changes.get(object.id) == ObjectChange::Unchanged
                && before.object(object.id).is_some_and(|before| is_same(before, object));
            if layout_differs || !unchanged {
                self.write_object(idx);
                rewritten_count += object.shape.prim_count();
            }
        }
        if rewritten_count > 0 {
            self.bound_blocks();
        }
        self.slack = self.widest_slack();
        let ignored = self.ignored.iter();
        CommitStats {
            prim_count: geometry.prim_count(),
            non_finite_count: ignored.clone().map(|ignored| ignored.non_finite).sum(),
            degenerate_count: ignored.map(|ignored| ignored.degenerate).sum(),
            rewritten_count,
            conversion_ns: 0,
        }
    }

    /// Makes room for the layout; padding holds nothing to hit.
    fn resize(&mut self) {
        let block_count = self.layout.slot_count / LANES;
        self.corners.resize(self.layout.begin.spheres / LANES, TriangleBlock::EMPTY);
        self.spheres.clear();
        let sphere_slots = self.layout.begin.users - self.layout.begin.spheres;
        self.spheres.resize(sphere_slots, Sphere::default());
        self.users.clear();
        self.bounds.clear();
        self.bounds.resize(block_count, SphereBlock::EMPTY);
        self.block_bounds.clear();
        self.block_bounds.resize(block_count.div_ceil(LANES), SphereBlock::EMPTY);
        self.ranks.resize(block_count, [u32::MAX; LANES]);
        self.masks.clear();
        self.masks.resize(block_count, [0; LANES]);
        self.ignored.clear();
        self.ignored.resize(self.layout.spans.len(), Ignored::default());
    }

    fn widest_slack(&self) -> f32 {
        let transforms = self.users.iter().filter_map(|user| user.transform.as_ref());
        transforms.fold(SLACK, |slack, transform| slack.max(SLACK + transform.relative_slack()))
    }

    /// Number of blocks of sixteen slots.
    pub(crate) fn block_count(&self) -> usize {
        self.bounds.len()
    }

    /// Number of blocks that hold triangles; they come first.
    pub(crate) fn triangle_block_count(&self) -> usize {
        self.corners.len()
    }

    /// The triangles of a block.
    pub(crate) fn triangle_block(&self, block_idx: usize) -> &TriangleBlock {
        &self.corners[block_idx]
    }

    /// Bounding spheres of a block.
    pub(crate) fn bounds(&self, block_idx: usize) -> &SphereBlock {
        &self.bounds[block_idx]
    }

    /// The bounding sphere of a slot.
    #[inline(always)]
    pub(crate) fn bound(&self, slot: u32) -> Sphere {
        let (block, lane) = (&self.bounds[slot as usize / LANES], slot as usize % LANES);
        Sphere::new(block.center_of(lane), block.radius[lane])
    }

    /// Where the primitives of each object lie; one entry for each object of the geometry.
    pub(crate) fn spans(&self) -> &[ObjectSpan] {
        &self.layout.spans
    }

    /// The committed geometry.
    pub(crate) fn geometry(&self) -> &Geometry {
        &self.geometry
    }

    /// Spheres around whole blocks: entry `idx` bounds the sixteen blocks from `16 * idx` on.
    pub(crate) fn block_bounds(&self) -> &[SphereBlock] {
        &self.block_bounds
    }

    /// Object masks of a block; 0 for lanes that hold nothing to hit.
    pub(crate) fn masks(&self, block_idx: usize) -> &[u32; LANES] {
        &self.masks[block_idx]
    }

    /// Ranks of a block.
    pub(crate) fn ranks(&self, block_idx: usize) -> &[u32; LANES] {
        &self.ranks[block_idx]
    }

    /// The object mask of a slot.
    #[inline(always)]
    pub(crate) fn mask(&self, slot: u32) -> u32 {
        self.masks[slot as usize / LANES][slot as usize % LANES]
    }

    /// The rank of a slot.
    #[inline(always)]
    pub(crate) fn rank(&self, slot: u32) -> u32 {
        self.ranks[slot as usize / LANES][slot as usize % LANES]
    }

    /// Slots that hold spheres or user primitives.
    pub(crate) fn other_slots(&self) -> impl Iterator<Item = u32> + '_ {
        let spheres = self.layout.begin.spheres..self.layout.begin.spheres + self.sphere_count();
        let users = self.layout.begin.users..self.layout.begin.users + self.users.len();
        spheres.chain(users).map(|slot| slot as u32)
    }

    fn sphere_count(&self) -> usize {
        self.layout.spans.last().map_or(0, |span| {
            span.first_slot.spheres + span.count.spheres - self.layout.begin.spheres
        })
    }

    /// Whether a slot holds a triangle.
    #[inline(always)]
    pub(crate) fn is_triangle(&self, slot: u32) -> bool {
        (slot as usize) < self.layout.begin.spheres
    }

    /// The corners of a slot that holds a triangle.
    #[inline(always)]
    pub(crate) fn triangle(&self, slot: u32) -> [Vec3; 3] {
        self.corners[slot as usize / LANES].get(slot as usize % LANES)
    }

    /// What a slot holds.
    #[inline(always)]
    pub(crate) fn kind(&self, slot: u32) -> SlotKind<'_> {
        if self.is_triangle(slot) {
            return SlotKind::Triangle(self.triangle(slot));
        }
        let slot = slot as usize;
        if slot < self.layout.begin.users {
            SlotKind::Sphere(&self.spheres[slot - self.layout.begin.spheres])
        } else {
            SlotKind::User(&self.users[slot - self.layout.begin.users])
        }
    }

    /// The slack, relative to distances, by which bounds must be widened.
    pub(crate) fn slack(&self) -> f32 {
        self.slack
    }

    /// The public form of a nearest hit.
    pub(crate) fn hit(&self, nearest: &Nearest) -> Hit {
        if nearest.rank == u32::MAX {
            return Hit::MISS;
        }
        let span: &ObjectSpan = self.layout.span_of_rank(nearest.rank);
        let prim_id = PrimId(nearest.rank - span.first_rank as u32);
        let Nearest { t, u, v, .. } = *nearest;
        Hit { t, u, v, object_id: span.object_id, prim_id }
    }

    /// Bytes held, without the shared meshes.
    pub(crate) fn memory_usage(&self) -> usize {
        self.corners.capacity() * size_of::<TriangleBlock>()
            + self.spheres.capacity() * size_of::<Sphere>()
            + self.users.capacity() * size_of::<UserSlot>()
            + (self.bounds.capacity() + self.block_bounds.capacity()) * size_of::<SphereBlock>()
            + (self.ranks.capacity() + self.masks.capacity()) * size_of::<Lanes>()
            + self.layout.spans.capacity() * size_of::<ObjectSpan>()
    }
}

/// Whether an object is the same as in the frame before.
pub(crate) fn is_same(before: &GeometryObject, now: &GeometryObject) -> bool {
    Arc::ptr_eq(&before.shape, &now.shape)
        && before.mask == now.mask
        && before.world_from_object == now.world_from_object
}
