//! Plans what a commit has to write for each object.

use rayflock_geom::{FrameChanges, Geometry, ObjectChange};

use super::ignored::{Ignored, IgnoredCounter};
use super::table::PrimitiveTable;

/// What has to be written for an object.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Work {
    /// It stands as it is.
    Nothing,
    /// Where its primitives are; all of them are seen as before.
    Corners,
    /// Where they are, and their masks.
    CornersAndMasks,
}

impl PrimitiveTable {
    /// Plans the work for all objects of `geometry`, while the frame before is still the table's;
    /// begins to count anew what is ignored of those that change.
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
            self.ignored.clear();
            self.ignored.resize_with(objects.len(), IgnoredCounter::default);
            return;
        }
        // The same layout means the same objects in the same order.
        let pairs = self.geometry.objects().iter().zip(objects);
        for ((before, object), (work, ignored)) in
            pairs.zip(self.plan.iter_mut().zip(&mut self.ignored))
        {
            let claimed = changes.get(object.id) == ObjectChange::Unchanged;
            *work = if claimed && object.is_same(before) {
                Work::Nothing
            } else if before.mask == object.mask && ignored.get() == Ignored::default() {
                Work::Corners
            } else {
                Work::CornersAndMasks
            };
            if *work != Work::Nothing {
                *ignored = IgnoredCounter::default();
            }
        }
    }
}
