//! The box around a scene over all of its time.
//!
//! The scene is evaluated at evenly spaced times. What moves between two of them may stick out a
//! little: the box is for framing cameras, not for tracing rays.
//!
//! **Cost.** At most 33 frames, and the bounds of each mesh that is new in one.

use std::sync::Arc;

use rayflock_geom::{Aabb, GeometryObject, Mesh};

use crate::{Evaluator, MotionKind, SceneError};

/// Times at which a scene that moves is looked at, both ends included.
const SAMPLE_COUNT: usize = 33;

impl Evaluator {
    /// The box around everything over the time range, in world space. Looks at 33 times; the frame
    /// that was made last stays as it is.
    ///
    /// # Errors
    /// As [`evaluate`](Self::evaluate).
    pub fn bounds_over_clip(&self) -> Result<Aabb, SceneError> {
        let (first, last) = self.time_range();
        let moves = self.motion_kinds().iter().any(|kind| *kind != MotionKind::Static);
        let sample_count = if moves && last > first { SAMPLE_COUNT } else { 1 };
        let mut probe = self.clone();
        let mut known = vec![None; self.scene().objects.len()];
        let mut bounds = Aabb::EMPTY;
        for sample in 0..sample_count {
            let share = sample as f64 / (SAMPLE_COUNT - 1) as f64;
            // A clip that is over is at its start again: stop just before.
            let time = (first + (last - first) * share).min(last.next_down()).max(first);
            let frame = probe.evaluate(time)?;
            for (object, known) in frame.geometry.objects().iter().zip(&mut known) {
                bounds = bounds.union(&object_bounds(object, known));
            }
        }
        Ok(bounds)
    }
}

/// The box around an object in world space; `known` is the last mesh with its box.
fn object_bounds(object: &GeometryObject, known: &mut Option<(Arc<Mesh>, Aabb)>) -> Aabb {
    let in_object = match known {
        Some((mesh, bounds)) if Arc::ptr_eq(mesh, &object.shape) => *bounds,
        _ => object.shape.bounds(),
    };
    *known = Some((Arc::clone(&object.shape), in_object));
    object.world_from_object.map_or(in_object, |place| in_object.transformed(&place))
}
