//! The primitives of a frame in world space, on the device.
//!
//! A primitive lies where its rank says, ignored ones with a mask that no ray sees. What has not
//! changed since the frame before is neither written nor sent anew. Frames with more primitives
//! than a binding may hold are cut into parts, which batches meet one after the other.
//!
//! **Cost.** 48 bytes a primitive, on either side.

use std::ops::Range;

use rayflock_engine::{Budget, CommitStats, EngineError};
use rayflock_geom::{
    FrameChanges, Geometry, GeometryObject, ObjectChange, ObjectId, PrimId, is_degenerate_triangle,
    transform_point, transform_sphere,
};
use rayon::prelude::*;
use tracing::debug_span;
use wgpu::{Buffer, BufferUsages};

use crate::GpuContext;
use crate::buffer::GrowingBuffer;
use crate::layout::{DevicePrimitive, SPHERE, TRIANGLE};

/// Primitives in a part: 96 of the 128 MiB that a binding may hold.
pub(crate) const PART_PRIMS: usize = 1 << 21;

/// Primitives that one task writes at least.
const PRIMS_PER_TASK: usize = 1024;

/// Primitives of a frame.
#[derive(Debug, Default)]
pub(crate) struct PrimitiveStore {
    geometry: Geometry,
    /// One an object.
    spans: Vec<Span>,
    /// By rank.
    prims: Vec<DevicePrimitive>,
    parts: Vec<GrowingBuffer>,
    /// With the last commit.
    sent_bytes: u64,
}

/// The ranks of one object.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Span {
    object_id: ObjectId,
    ranks: Range<usize>,
}

/// Primitives that one binding holds.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Part<'a> {
    pub(crate) buffer: &'a Buffer,
    pub(crate) count: usize,
}

impl Part<'_> {
    /// Bytes of the primitives.
    pub(crate) const fn bytes(&self) -> usize {
        self.count * size_of::<DevicePrimitive>()
    }
}

impl PrimitiveStore {
    /// Makes `geometry` the current frame, and sends what changed.
    ///
    /// # Errors
    /// [`EngineError::Unsupported`] when there are user primitives; the frame is empty then.
    pub(crate) fn commit(
        &mut self,
        context: &GpuContext,
        geometry: &Geometry,
        changes: &FrameChanges,
        engine: &str,
    ) -> Result<CommitStats, EngineError> {
        self.commit_but(context, geometry, changes, engine, |_| false)
    }

    /// The same, but nothing is written of objects that changed and that `elsewhere`, given their
    /// place, claims: a stage will do so.
    ///
    /// # Errors
    /// As [`Self::commit`].
    pub(crate) fn commit_but(
        &mut self,
        context: &GpuContext,
        geometry: &Geometry,
        changes: &FrameChanges,
        engine: &str,
        mut elsewhere: impl FnMut(usize) -> bool,
    ) -> Result<CommitStats, EngineError> {
        let _span = debug_span!("send_primitives").entered();
        let has_users =
            |object: &GeometryObject| object.shape.user().is_some_and(|user| !user.is_empty());
        if geometry.objects().iter().any(has_users) {
            *self = Self::default();
            let (engine, what) = (engine.to_owned(), "user primitives".to_owned());
            return Err(EngineError::Unsupported { engine, what });
        }
        let is_same_layout = self.assign_spans(geometry);
        self.reserve_parts(context);
        self.sent_bytes = 0;
        let mut stats = CommitStats { prim_count: self.prims.len(), ..CommitStats::default() };
        for (idx, object) in geometry.objects().iter().enumerate() {
            // A wrong hint does no harm: meshes are immutable, and compared by identity.
            let is_claimed = changes.get(object.id) == ObjectChange::Unchanged;
            let before = || self.geometry.objects().get(idx);
            if is_same_layout && is_claimed && before().is_some_and(|b| object.is_same(b)) {
                continue;
            }
            let ranks = self.spans[idx].ranks.clone();
            stats.rewritten_count += ranks.len();
            if !elsewhere(idx) {
                self.write_object(ranks.clone(), object);
                self.send(context, ranks);
            }
        }
        self.geometry = geometry.clone();
        Ok(stats)
    }

    /// The frame.
    pub(crate) const fn geometry(&self) -> &Geometry {
        &self.geometry
    }

    /// The primitives, in parts that bindings can hold.
    pub(crate) fn parts(&self) -> impl Iterator<Item = Part<'_>> {
        let counts = self.prims.chunks(PART_PRIMS).map(<[_]>::len);
        let parts = self.parts.iter().zip(counts);
        parts.map(|(part, count)| Part { buffer: part.buffer(), count })
    }

    /// The primitives by rank, as they were sent.
    #[cfg(test)]
    pub(crate) fn host(&self) -> &[DevicePrimitive] {
        &self.prims
    }

    /// How many of them are spheres.
    pub(crate) fn sphere_count(&self) -> usize {
        self.geometry.objects().iter().map(|object| object.shape.spheres().len()).sum()
    }

    /// The ids of a primitive.
    pub(crate) fn ids(&self, rank: u32) -> (ObjectId, PrimId) {
        let rank = rank as usize;
        let idx = self.spans.partition_point(|span| span.ranks.end <= rank);
        let span = &self.spans[idx];
        (span.object_id, PrimId((rank - span.ranks.start) as u32))
    }

    /// Tells what is held, on either side.
    pub(crate) fn hold(&self, budget: &mut Budget) {
        let staged = self.prims.capacity() * size_of::<DevicePrimitive>();
        budget.hold("staged primitives", staged as u64);
        self.parts.iter().for_each(|part| part.hold(budget));
        budget.sent_bytes += self.sent_bytes;
    }

    /// The ranks of each object.
    pub(crate) fn ranks(&self) -> impl Iterator<Item = Range<usize>> {
        self.spans.iter().map(|span| span.ranks.clone())
    }

    /// Gives objects their ranks; returns whether they had the same before.
    fn assign_spans(&mut self, geometry: &Geometry) -> bool {
        let mut end = 0;
        let spans = geometry.objects().iter().map(|object| {
            let begin = end;
            end += object.shape.prim_count();
            let (object_id, ranks) = (object.id, begin..end);
            Span { object_id, ranks }
        });
        let spans: Vec<_> = spans.collect();
        let is_same = self.spans == spans;
        if !is_same {
            self.spans = spans;
            self.prims.resize(end, DevicePrimitive::default());
        }
        is_same
    }

    fn reserve_parts(&mut self, context: &GpuContext) {
        let usage = BufferUsages::STORAGE | BufferUsages::VERTEX;
        let part_count = self.prims.len().div_ceil(PART_PRIMS);
        self.parts.resize_with(part_count, || GrowingBuffer::new("primitives", usage));
        for (part, prims) in self.parts.iter_mut().zip(self.prims.chunks(PART_PRIMS)) {
            part.reserve(context, size_of_val(prims));
        }
    }

    /// Writes the primitives of an object, which have these ranks.
    fn write_object(&mut self, ranks: Range<usize>, object: &GeometryObject) {
        let (first_rank, triangle_count) = (ranks.start, object.shape.triangles().len());
        let prims = self.prims[ranks].par_iter_mut().enumerate();
        prims.with_min_len(PRIMS_PER_TASK).for_each(|(prim_idx, prim)| {
            let written = match prim_idx.checked_sub(triangle_count) {
                None => triangle(object, prim_idx),
                Some(sphere_idx) => sphere(object, sphere_idx),
            };
            *prim = DevicePrimitive { rank: (first_rank + prim_idx) as u32, ..written };
        });
    }

    /// Sends the primitives of these ranks to the device.
    fn send(&mut self, context: &GpuContext, ranks: Range<usize>) {
        let size = size_of::<DevicePrimitive>();
        self.sent_bytes += (ranks.len() * size) as u64;
        for (part_idx, part) in self.parts.iter().enumerate() {
            let begin = part_idx * PART_PRIMS;
            let first = ranks.start.max(begin);
            let end = ranks.end.min(begin + PART_PRIMS);
            if first < end {
                part.write_at(context, (first - begin) * size, &self.prims[first..end]);
            }
        }
    }
}

/// A triangle; a degenerate one is such that no ray sees it.
fn triangle(object: &GeometryObject, triangle_idx: usize) -> DevicePrimitive {
    let corners = object.shape.corners(triangle_idx);
    let placed = |transform| corners.map(|corner| transform_point(transform, corner));
    let corners = object.world_from_object.as_ref().map_or(corners, placed);
    if is_degenerate_triangle(corners) {
        return DevicePrimitive::default();
    }
    let [a, b, c] = corners.map(|corner| corner.to_array());
    DevicePrimitive { a, mask: object.mask, b, kind: TRIANGLE, c, rank: 0 }
}

/// A sphere; one that is not valid is such that no ray sees it.
fn sphere(object: &GeometryObject, sphere_idx: usize) -> DevicePrimitive {
    let sphere = object.shape.spheres()[sphere_idx];
    let placed = |transform| transform_sphere(transform, &sphere);
    let sphere = object.world_from_object.as_ref().map_or(sphere, placed);
    if !sphere.is_valid() {
        return DevicePrimitive::default();
    }
    let (a, b) = (sphere.center.to_array(), [sphere.radius, 0.0, 0.0]);
    DevicePrimitive { a, mask: object.mask, b, kind: SPHERE, ..DevicePrimitive::default() }
}
