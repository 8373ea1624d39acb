//! Plans what has to be written for each object.

use std::sync::atomic::AtomicBool;

use rayflock_geom::{FrameChanges, Geometry, ObjectChange};

use super::table::PrimitiveTable;

/// What has to be written for an object.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Work {
    /// It stands as it is.
    Nothing,
    /// Where its primitives are; all of them are seen as before.
    Corners,
    /// Where they are, and their masks.
    CornersAndMasks,
}

impl PrimitiveTable {
    /// Plans the work for all objects of `geometry`, while the frame before is still the table's,
    /// and adds it to what is still to be done for triangles.
    ///
    /// An object is taken as it was only when `changes` says so *and* it shares its mesh,
    /// transform and mask with the frame before: meshes are immutable, so a wrong hint does no
    /// harm.
    pub(super) fn plan_work(
        &mut self,
        geometry: &Geometry,
        changes: &FrameChanges,
        layout_differs: bool,
    ) {
        let objects = geometry.objects();
        if layout_differs {
            self.plan.clear();
            self.plan.resize(objects.len(), Work::CornersAndMasks);
            self.pending.clear();
            self.pending.extend(objects.iter().map(|object| match object.shape.triangles() {
                [] => Work::Nothing,
                _ => Work::CornersAndMasks,
            }));
            self.leaves_out.clear();
            self.leaves_out.resize_with(objects.len(), AtomicBool::default);
            return;
        }
        // The same layout means the same objects in the same order.
        let pairs = self.geometry.objects().iter().zip(objects);
        let works = self.plan.iter_mut().zip(&mut self.pending);
        for ((before, object), ((work, pending), leaves_out)) in
            pairs.zip(works.zip(&mut self.leaves_out))
        {
            let claimed = changes.get(object.id) == ObjectChange::Unchanged;
            *work = if claimed && object.is_same(before) {
                Work::Nothing
            } else if before.mask == object.mask && !*leaves_out.get_mut() {
                Work::Corners
            } else {
                Work::CornersAndMasks
            };
            if !object.shape.triangles().is_empty() {
                *pending = (*work).max(*pending);
            }
        }
    }
}
