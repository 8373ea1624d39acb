//! What all engines on the graphics card have in common: primitives, slots, answers, and what
//! happens when the device is lost.
//!
//! **Departures** from what the engines on the CPU answer: `t`, `u` and `v` differ within rounding
//! (`docs/algorithms/gpu.md` says by how much); so may the primitive, where two are hit within it,
//! and whether the outline of a mesh is hit.

use std::sync::Arc;
use std::time::Instant;

use rayflock_engine::{Budget, CommitStats, EngineError, RayEngine, TraceStats};
use rayflock_geom::{FrameChanges, Geometry, Hit, Hits, RayBatch};
use tracing::debug_span;

use crate::brute::Brute;
use crate::compute::Compute;
use crate::layout::{DeviceHit, NO_RANK};
use crate::method::{Method, Question};
use crate::primitives::PrimitiveStore;
use crate::raster::Raster;
use crate::slots::{RUN_SLOTS, Run, Slots};
use crate::stage_clock::StageClock;
use crate::standby::Standby;
use crate::subfields::{Config, Subfields};
use crate::{GpuContext, GpuEngineKind, GpuEngineSpec, GpuError};

/// Traces on a graphics device.
#[derive(Debug)]
pub struct GpuEngine {
    kind: GpuEngineKind,
    context: Arc<GpuContext>,
    primitives: PrimitiveStore,
    method: Box<dyn Method>,
    slots: Slots,
    run: Run,
    clock: StageClock,
    /// At work once the device is lost.
    standby: Option<Standby>,
}

impl GpuEngine {
    /// An engine with an empty frame, on a device that others may use as well.
    ///
    /// # Errors
    /// [`GpuError::Lost`] when the device does not take its programs.
    pub fn new(kind: GpuEngineKind, context: &Arc<GpuContext>) -> Result<Self, GpuError> {
        let method: Box<dyn Method> = match kind {
            GpuEngineKind::Brute => Box::new(Brute::new(context)),
            GpuEngineKind::Raster => Box::new(Raster::new(context)),
            GpuEngineKind::Compute => Box::new(Compute::new(context)),
            GpuEngineKind::Subfields => Box::new(Subfields::new(context, Config::default())),
        };
        context.check()?;
        Ok(Self {
            kind,
            context: Arc::clone(context),
            primitives: PrimitiveStore::default(),
            method,
            slots: Slots::default(),
            run: Run::default(),
            clock: StageClock::new(context),
            standby: None,
        })
    }

    /// Opens the adapter of `spec` and makes its engine.
    ///
    /// # Errors
    /// [`GpuError`] when there is no such adapter, or it cannot be used.
    pub fn open(spec: &GpuEngineSpec) -> Result<Self, GpuError> {
        Self::new(spec.kind, &GpuContext::new(spec.adapter)?)
    }

    /// Asks the device about all rays, run by run; `answer` is told when a run is done.
    ///
    /// # Errors
    /// [`GpuError::Lost`] when the device fails; rays may be unanswered then.
    fn trace<A: Answers>(
        &mut self,
        rays: &RayBatch<'_>,
        question: Question,
        answers: &mut A,
    ) -> Result<TraceStats, GpuError> {
        let _span = debug_span!("trace_on_device").entered();
        let mut stats = TraceStats { rays: rays.len() as u64, ..TraceStats::default() };
        self.slots.assign(rays);
        for first_slot in (0..self.slots.len()).step_by(RUN_SLOTS) {
            let (run, slots) = (&mut self.run, &self.slots);
            run.fill(rays, slots, first_slot, &|ray_idx| answers.t_bound(ray_idx));
            let (context, clock) = (&self.context, &mut self.clock);
            let start = Instant::now();
            let counts = self.method.trace(context, clock, &self.primitives, run, question)?;
            clock.collect(context, start)?;
            stats.invalid_rays += run.invalid_count;
            stats.cone_tests += counts.cones;
            stats.triangle_tests += counts.triangles;
            stats.sphere_tests += counts.spheres;
            stats.pairs += counts.pairs;
            for (place, ray_idx) in run.ray_places(slots) {
                answers.take(ray_idx, &run.hits[place], &self.primitives);
            }
        }
        Ok(stats)
    }

    /// The engine on the CPU, after a fault.
    fn stand_by(&mut self, fault: &GpuError) -> &mut Standby {
        let geometry = self.primitives.geometry();
        self.standby.get_or_insert_with(|| Standby::take_over(geometry, fault))
    }
}

/// Where answers go.
trait Answers: Sync {
    /// Beyond which hits of a ray are of no interest.
    fn t_bound(&self, ray_idx: usize) -> f32;

    /// Takes what the device found for a ray.
    fn take(&mut self, ray_idx: usize, found: &DeviceHit, primitives: &PrimitiveStore);
}

/// Nearest hits.
struct Nearest<'a, 'b>(&'a mut Hits<'b>);

impl Answers for Nearest<'_, '_> {
    fn t_bound(&self, ray_idx: usize) -> f32 {
        self.0.t[ray_idx]
    }

    fn take(&mut self, ray_idx: usize, found: &DeviceHit, primitives: &PrimitiveStore) {
        if found.rank != NO_RANK {
            let (object_id, prim_id) = primitives.ids(found.rank);
            let &DeviceHit { t, u, v, .. } = found;
            self.0.offer(ray_idx, &Hit { t, u, v, object_id, prim_id });
        }
    }
}

/// Whether there is any hit.
struct Any<'a>(&'a mut [bool]);

impl Answers for Any<'_> {
    fn t_bound(&self, _: usize) -> f32 {
        f32::INFINITY
    }

    fn take(&mut self, ray_idx: usize, found: &DeviceHit, _: &PrimitiveStore) {
        self.0[ray_idx] = found.rank != NO_RANK;
    }
}

impl RayEngine for GpuEngine {
    fn name(&self) -> &str {
        self.kind.name()
    }

    fn commit(
        &mut self,
        geometry: &Geometry,
        changes: &FrameChanges,
    ) -> Result<CommitStats, EngineError> {
        if let Some(standby) = &mut self.standby {
            return standby.commit(geometry, changes);
        }
        let (context, name) = (&self.context, self.kind.name());
        let stats = self.primitives.commit(context, geometry, changes, name)?;
        self.clock.begin_frame();
        self.method.prepare(&self.context, &mut self.clock, &self.primitives);
        Ok(stats)
    }

    fn closest_hit(&mut self, rays: &RayBatch<'_>, hits: &mut Hits<'_>) -> TraceStats {
        assert!(hits.has_len(rays.len()), "every column must have one entry for each ray");
        if let Some(standby) = &mut self.standby {
            return standby.engine.closest_hit(rays, hits);
        }
        match self.trace(rays, Question::Closest, &mut Nearest(hits)) {
            Ok(stats) => stats,
            Err(fault) => self.stand_by(&fault).engine.closest_hit(rays, hits),
        }
    }

    fn occluded(&mut self, rays: &RayBatch<'_>, occluded: &mut [bool]) -> TraceStats {
        assert_eq!(occluded.len(), rays.len(), "there must be one answer for each ray");
        if let Some(standby) = &mut self.standby {
            return standby.engine.occluded(rays, occluded);
        }
        match self.trace(rays, Question::Occluded, &mut Any(occluded)) {
            Ok(stats) => stats,
            Err(fault) => self.stand_by(&fault).engine.occluded(rays, occluded),
        }
    }

    fn memory_usage(&self) -> usize {
        let standby = self.standby.as_ref().map_or(0, |standby| standby.engine.memory_usage());
        self.budget().bytes() as usize + standby
    }

    fn budget(&self) -> Budget {
        let mut budget = self.clock.budget();
        self.primitives.hold(&mut budget);
        self.method.hold(&mut budget);
        budget.hold("staged rays", self.slots.memory_usage() as u64);
        budget.hold("staged rays", self.run.memory_usage() as u64);
        budget
    }

    fn notice(&self) -> Option<&str> {
        self.standby.as_ref().map(|standby| standby.notice.as_str())
    }
}
