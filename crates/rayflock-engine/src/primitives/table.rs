//! The table of primitives, kept from frame to frame.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use glam::Vec3;
use rayflock_geom::simd::cone_sphere::{SLACK, SphereBlock};
use rayflock_geom::simd::ray_triangle::TriangleBlock;
use rayflock_geom::simd::{LANES, Lanes, SimdLevel};
use rayflock_geom::{FrameChanges, Geometry, RayTransform, Sphere, UserPrimitives};
use tracing::debug_span;

use super::ignored::Ignored;
use super::plan::Work;
use super::rank_table::{RankTable, RankedObject};
use super::span::{Layout, ObjectSpan};
use crate::CommitStats;

/// What a test reads of a triangle: three corners, rank and mask.
pub(crate) const TRIANGLE_BYTES: u64 = 44;

/// What a test reads of a sphere: centre and radius, rank and mask.
pub(crate) const SPHERE_BYTES: u64 = 24;

/// All primitives of the committed frame. See the [module](super) for the layout.
#[derive(Debug, Default)]
pub(crate) struct PrimitiveTable {
    pub(super) simd: SimdLevel,
    pub(super) geometry: Geometry,
    pub(super) layout: Layout,
    pub(super) rank_table: RankTable,
    /// One for each object: what this commit has to write.
    pub(super) plan: Vec<Work>,
    /// One for each object: what is to be written of its triangles until they are those of the
    /// committed frame.
    pub(super) pending: Vec<Work>,
    /// One for each object: whether some of its triangles were left out when they were written.
    pub(super) leaves_out: Vec<AtomicBool>,
    /// One for each object: how many of its other primitives are ignored, and why.
    pub(super) others_ignored: Vec<Ignored>,
    /// Corners of the triangle slots; may be stale, or not there yet.
    pub(super) corners: Vec<TriangleBlock>,
    /// Spheres, from slot `layout.begin.spheres` on.
    pub(super) spheres: Vec<Sphere>,
    /// User primitives, from slot `layout.begin.users` on.
    pub(super) users: Vec<UserSlot>,
    /// Bounding spheres of all slots; those of triangles may be stale.
    pub(super) bounds: Vec<SphereBlock>,
    /// One sphere around the bounding spheres of each block, sixteen blocks an entry; may be stale.
    pub(super) block_bounds: Vec<SphereBlock>,
    /// One for each entry of `block_bounds`: whether anything in it was written since.
    pub(super) stale_groups: Vec<bool>,
    pub(super) bounds_are_stale: bool,
    /// Ranks of all slots.
    pub(super) ranks: Vec<[u32; LANES]>,
    /// Object masks of all slots; 0 where there is nothing to hit. Those of triangles may be stale.
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
    /// An empty table, written at the given SIMD level.
    pub(crate) fn new(simd: SimdLevel) -> Self {
        Self { simd, ..Self::default() }
    }

    /// Takes over a frame, writing all but the triangles of objects that differ from the frame
    /// before.
    pub(crate) fn commit(&mut self, geometry: &Geometry, changes: &FrameChanges) -> CommitStats {
        let _span = debug_span!("commit").entered();
        let layout_differs = self.layout.assign(geometry);
        self.plan_work(geometry, changes, layout_differs);
        self.geometry.clone_from(geometry);
        if layout_differs {
            self.begin_layout();
        }
        self.mark_stale_bounds();
        for object_idx in 0..self.plan.len() {
            if self.plan[object_idx] != Work::Nothing {
                self.write_others(object_idx);
            }
        }
        self.slack = self.widest_slack();
        self.commit_stats()
    }

    fn commit_stats(&self) -> CommitStats {
        let spans = self.layout.spans.iter().zip(&self.plan);
        let rewritten = spans.filter(|&(_, &work)| work != Work::Nothing);
        CommitStats {
            prim_count: self.geometry.prim_count(),
            rewritten_count: rewritten.map(|(span, _)| span.prim_count()).sum(),
            ..CommitStats::default()
        }
    }

    fn widest_slack(&self) -> f32 {
        let transforms = self.users.iter().filter_map(|user| user.transform.as_ref());
        transforms.fold(SLACK, |slack, transform| slack.max(SLACK + transform.relative_slack()))
    }

    /// Number of blocks of sixteen slots.
    pub(crate) fn block_count(&self) -> usize {
        self.masks.len()
    }

    /// Number of blocks that hold triangles; they come first.
    pub(crate) fn triangle_block_count(&self) -> usize {
        self.layout.begin.spheres / LANES
    }

    /// The triangles of a block. They have to be written first: [`Self::write_triangles`].
    pub(crate) fn triangle_block(&self, block_idx: usize) -> &TriangleBlock {
        debug_assert!(!self.is_pending(), "triangles are asked for before they are written");
        &self.corners[block_idx]
    }

    /// Bounding spheres of a block. Those of triangles have to be written first:
    /// [`Self::write_bounds`].
    pub(crate) fn bounds(&self, block_idx: usize) -> &SphereBlock {
        let is_current = block_idx >= self.triangle_block_count() || !self.bounds_are_stale;
        debug_assert!(is_current, "bounds of triangles are asked for before they are written");
        &self.bounds[block_idx]
    }

    /// The bounding sphere of a slot.
    #[inline(always)]
    pub(crate) fn bound(&self, slot: u32) -> Sphere {
        self.bounds(slot as usize / LANES).get(slot as usize % LANES)
    }

    /// Whether any primitive is ignored. Triangles have to be written first.
    pub(crate) fn has_ignored(&self) -> bool {
        debug_assert!(!self.is_pending(), "what is ignored is asked for before it is known");
        self.leaves_out.iter().any(|leaves_out| leaves_out.load(Ordering::Relaxed))
            || self.others_ignored.iter().any(|ignored| *ignored != Ignored::default())
    }

    /// Whether triangles are not written yet.
    pub(super) fn is_pending(&self) -> bool {
        self.pending.iter().any(|&pending| pending != Work::Nothing)
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
    /// They have to be written first: [`Self::write_bounds`].
    pub(crate) fn block_bounds(&self) -> &[SphereBlock] {
        debug_assert!(!self.bounds_are_stale, "bounds are asked for before they are written");
        &self.block_bounds
    }

    /// Object masks of a block; 0 for lanes that hold nothing to hit. Triangles have to be written
    /// first.
    pub(crate) fn masks(&self, block_idx: usize) -> &[u32; LANES] {
        &self.masks[block_idx]
    }

    /// Ranks of a block.
    pub(crate) fn ranks(&self, block_idx: usize) -> &[u32; LANES] {
        &self.ranks[block_idx]
    }

    /// The object mask of a slot. Triangles have to be written first.
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

    /// The corners of a slot that holds a triangle. Triangles have to be written first.
    #[inline(always)]
    pub(crate) fn triangle(&self, slot: u32) -> [Vec3; 3] {
        debug_assert!(!self.is_pending(), "a triangle is asked for before it is written");
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

    /// The object of a primitive, by its rank.
    #[inline(always)]
    pub(crate) fn object_of_rank(&self, rank: u32) -> RankedObject {
        self.rank_table.object(rank)
    }

    /// A point that something is near; the origin where there is nothing.
    pub(crate) fn some_point(&self) -> Vec3 {
        let slot = (0..self.block_count() * LANES).find(|&slot| self.mask(slot as u32) != 0);
        let point = slot.map(|slot| match self.kind(slot as u32) {
            SlotKind::Triangle([corner, ..]) => corner,
            SlotKind::Sphere(_) | SlotKind::User(_) => self.bound(slot as u32).center,
        });
        point.filter(|point| point.is_finite()).unwrap_or(Vec3::ZERO)
    }

    /// The SIMD level at which the table is written.
    pub(crate) fn simd(&self) -> SimdLevel {
        self.simd
    }

    /// Bytes held, without the shared meshes.
    pub(crate) fn memory_usage(&self) -> usize {
        self.corners.capacity() * size_of::<TriangleBlock>()
            + self.spheres.capacity() * size_of::<Sphere>()
            + self.users.capacity() * size_of::<UserSlot>()
            + (self.bounds.capacity() + self.block_bounds.capacity()) * size_of::<SphereBlock>()
            + (self.ranks.capacity() + self.masks.capacity()) * size_of::<Lanes>()
            + self.layout.spans.capacity() * size_of::<ObjectSpan>()
            + self.rank_table.memory_usage()
    }
}
