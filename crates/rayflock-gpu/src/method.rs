//! How an engine on the graphics card finds hits; what is common to all is in [`crate::engine`].

use std::fmt::Debug;
use std::ops::Add;

use rayflock_engine::Budget;

use crate::primitives::PrimitiveStore;
use crate::slots::Run;
use crate::stage_clock::StageClock;
use crate::{GpuContext, GpuError};

/// What is asked about each ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Question {
    /// The nearest hit.
    Closest = 0,
    /// Whether there is any: `QUESTION_OCCLUDED` of `shared/question.wgsl`.
    Occluded = 1,
}

/// Tests that a run of rays took, each in lanes: those without an active ray are counted too.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct TestCounts {
    /// Cones against spheres.
    pub(crate) cones: u64,
    /// Rays against triangles.
    pub(crate) triangles: u64,
    /// Rays against spheres.
    pub(crate) spheres: u64,
    /// Pairs written down for a later stage.
    pub(crate) pairs: u64,
}

impl Add for TestCounts {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            cones: self.cones + other.cones,
            triangles: self.triangles + other.triangles,
            spheres: self.spheres + other.spheres,
            pairs: self.pairs + other.pairs,
        }
    }
}

/// A way to find hits on a device.
pub(crate) trait Method: Debug + Send {
    /// The primitives have changed.
    fn prepare(
        &mut self,
        context: &GpuContext,
        clock: &mut StageClock,
        primitives: &PrimitiveStore,
    );

    /// Replaces entries of `run.hits` by nearer hits; for [`Question::Occluded`] by any.
    ///
    /// # Errors
    /// [`GpuError::Lost`] when the device fails; hits may be missing then.
    fn trace(
        &mut self,
        context: &GpuContext,
        clock: &mut StageClock,
        primitives: &PrimitiveStore,
        run: &mut Run,
        question: Question,
    ) -> Result<TestCounts, GpuError>;

    /// Tells what is held, on either side.
    fn hold(&self, budget: &mut Budget);
}
