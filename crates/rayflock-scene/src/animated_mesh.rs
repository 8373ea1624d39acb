//! Meshes that are functions of time.

use std::fmt::Debug;

use crate::{KeySpan, MotionKind, SurfaceMesh};

/// A mesh that is a function of time.
///
/// What changed between two frames is told by the identity of what the meshes share, never by
/// what an implementation claims: the same `Arc<Mesh>` means that nothing changed, shared
/// triangles ([`Mesh::with_vertices`](rayflock_geom::Mesh::with_vertices)) mean that vertices
/// moved, anything else that the topology changed. So an implementation that shares too little
/// costs time, and none can make an answer wrong.
pub trait AnimatedMesh: Debug + Send + Sync {
    /// The first and last time in seconds at which the mesh changes: before and after, it rests.
    /// Either may be infinite.
    fn time_range(&self) -> (f64, f64);

    /// How the mesh changes over its time range, where that is known without looking: for
    /// information, not for correctness.
    fn motion(&self) -> MotionKind {
        MotionKind::Topology
    }

    /// The mesh at `time` in seconds. It has to be the same each time the same time is asked
    /// for, in any order. [`Evaluator`](crate::Evaluator) asks for times within
    /// [`time_range`](Self::time_range) only, and not twice in a row for the same one.
    ///
    /// # Errors
    /// A message for the user when the mesh cannot be had, such as a file gone or damaged.
    fn at(&self, time: f64) -> Result<SurfaceMesh, String>;

    /// The keys that the mesh at `time` lies between, where it does so: for those who interpolate
    /// themselves what [`at`](Self::at) returns. The same two meshes for the whole span, with the
    /// topology of what `at` returns; spans that have another one are not used.
    fn span_at(&self, _time: f64) -> Option<KeySpan> {
        None
    }
}
