//! Whole pictures on the device: Whitted's model as the renderer of the CPU has it, without a way
//! back to the host before the picture is done.
//!
//! Photons come first, where light that mirrors and glass throw is asked for (`photons`). Then, for
//! each band of rows and each sample, wave by wave:
//!
//! 1. **camera_rays**, or **order_wave** for the rays that the wave before left.
//! 2. Scan conversion finds what the rays from the camera hit, the stages of the engine
//!    `gpu:compute` what all others do.
//! 3. **shade_surface** turns hits into light, lit points and the rays of the next wave;
//!    **add_emitted** brings the light to the film.
//! 4. For each light, **shadow_rays** between it and the points, the stages of the engine once more,
//!    and **add_lit**.
//! 5. **gather_photons** and **gather_lights** add what photons bring and what virtual lights send
//!    past spheres, where there are any.
//!
//! **Source.** T. Whitted, "An Improved Illumination Model for Shaded Display", CACM 23(6), 1980; for
//! the rays of a bounce that are written where the next pass reads them, L. Szecsi, "The Hierarchical
//! Ray Engine", WSCG 2006.
//!
//! **Departures** from the renderer of the CPU: sums in `f32`, in any order; what rays from the
//! camera hit is drawn, not traced; each point asks for itself what it sees of virtual lights.
//!
//! **Invariants.** Whatever outgrows its buffer is counted, and read with the picture; then the band
//! is rendered anew with more room, or fewer rows. Nothing is dropped.
//!
//! **Cost.** Some 350 bytes a slot and 20 a pixel; a wait for each band and sample, none for a bounce.

mod attributes;
mod buffers;
mod deform;
mod gather_lights;
mod order_wave;
mod photons;
mod picture;
mod refusal;
mod render_band;
mod scan;
mod scene_data;
mod stages;
mod standby;
#[cfg(test)]
mod tests;
mod trace_log;
mod virtual_lights;

use std::sync::Arc;
use std::time::Instant;

use rayflock_engine::{Budget, CommitStats};
use rayflock_render::prepared::PreparedFrame;
use rayflock_render::{Film, FrameRenderer, FrameStats, RenderError, RenderSettings, View};
use rayflock_scene::{Scene, SceneFrame};
use tracing::debug_span;

use self::attributes::AttributeStore;
#[cfg(test)]
pub(crate) use self::attributes::{HAS_NORMALS, HAS_UVS, IS_MIRRORED};
use self::buffers::FrameBuffers;
#[cfg(test)]
pub(crate) use self::buffers::{FOLLOWED, MIRRORED, SHADOW};
use self::deform::Deformer;
#[cfg(test)]
pub(crate) use self::deform::{INFLUENCE_WORDS, JOINT_WORDS, TARGET_WORDS};
#[cfg(test)]
pub(crate) use self::gather_lights::{BLOCK_SPHERES, SUM_PLACES};
#[cfg(test)]
pub(crate) use self::order_wave::KEY_BITS;
use self::order_wave::WaveOrder;
use self::photons::Photons;
use self::picture::{Band, Picture, Rendered};
use self::refusal::{cannot, lost, refusal, unsupported};
pub use self::scan::PrimaryVisibility;
use self::scan::Scan;
use self::scene_data::SceneData;
use self::stages::FrameStages;
use self::standby::FrameStandby;
use self::trace_log::TraceLog;
use self::virtual_lights::VirtualLightStore;
use crate::compute::Compute;
use crate::method::Method;
use crate::primitives::PrimitiveStore;
use crate::stage_clock::StageClock;
use crate::{AdapterChoice, GpuContext, GpuError};

/// What errors call the renderer.
const NAME: &str = "gpu";

/// Renders frames on a graphics device; what it cannot do, or a lost device, is the CPU's.
#[derive(Debug)]
pub struct GpuRenderer {
    context: Arc<GpuContext>,
    device: DeviceFrame,
    /// The committed frame, if there is one.
    prepared: Option<PreparedFrame>,
    standby: FrameStandby,
}

/// What is on the device.
#[derive(Debug)]
struct DeviceFrame {
    clock: StageClock,
    primitives: PrimitiveStore,
    attributes: AttributeStore,
    deformer: Deformer,
    scene: SceneData,
    compute: Compute,
    wave_order: WaveOrder,
    stages: FrameStages,
    buffers: FrameBuffers,
    primary: PrimaryVisibility,
    scan: Scan,
    photons: Photons,
    log: TraceLog,
    virtual_lights: VirtualLightStore,
    /// Why the device cannot render the committed frame, if it cannot.
    refused: Option<String>,
}

impl GpuRenderer {
    /// A renderer without a frame, on a device that others may use as well.
    ///
    /// # Errors
    /// [`GpuError::Lost`] when the device does not take its programs.
    pub fn new(context: &Arc<GpuContext>) -> Result<Self, GpuError> {
        Self::with_compute(context, Compute::new(context))
    }

    /// A renderer that traces with `compute`.
    fn with_compute(context: &Arc<GpuContext>, compute: Compute) -> Result<Self, GpuError> {
        let device = DeviceFrame {
            clock: StageClock::new(context),
            primitives: PrimitiveStore::default(),
            attributes: AttributeStore::default(),
            deformer: Deformer::new(context),
            scene: SceneData::default(),
            compute,
            wave_order: WaveOrder::new(context),
            stages: FrameStages::new(context),
            buffers: FrameBuffers::new(),
            primary: PrimaryVisibility::default(),
            scan: Scan::new(context),
            photons: Photons::new(context),
            log: TraceLog::new(),
            virtual_lights: VirtualLightStore::default(),
            refused: None,
        };
        context.check()?;
        let standby = FrameStandby::default();
        Ok(Self { context: Arc::clone(context), device, prepared: None, standby })
    }

    /// Opens an adapter and makes its renderer.
    ///
    /// # Errors
    /// [`GpuError`] when there is no such adapter, or it cannot be used.
    pub fn open(adapter: AdapterChoice) -> Result<Self, GpuError> {
        Self::new(&GpuContext::new(adapter)?)
    }

    /// The renderer, but finding by `primary` what the rays from the camera hit.
    #[must_use]
    pub fn with_primary(mut self, primary: PrimaryVisibility) -> Self {
        self.device.primary = primary;
        self
    }

    /// What the device runs on.
    pub fn context(&self) -> &GpuContext {
        &self.context
    }
}

impl FrameRenderer for GpuRenderer {
    fn commit(&mut self, scene: &Scene, frame: &SceneFrame) -> Result<CommitStats, RenderError> {
        let _span = debug_span!("commit_frame").entered();
        self.prepared = None;
        self.device.virtual_lights.commit(frame);
        let prepared = PreparedFrame::new(scene, frame)?;
        let on_cpu = self.standby.commit(scene, frame)?;
        let device = &mut self.device;
        device.clock.begin_frame();
        device.refused = match self.context.check() {
            Ok(()) => refusal(frame, scene),
            Err(fault) => Some(lost(&fault)),
        };
        let stats = match (&device.refused, on_cpu) {
            (Some(_), Some(stats)) => stats,
            (Some(reason), None) => self.standby.take_over(reason.clone())?,
            (None, _) => device.commit(&self.context, scene, frame, &prepared)?,
        };
        self.prepared = Some(prepared);
        Ok(stats)
    }

    fn render(&mut self, view: &View, settings: &RenderSettings, film: &mut Film) -> FrameStats {
        let _span = debug_span!("render").entered();
        let settings = settings.clamped();
        let refused = self.device.refused.clone();
        let reason = refused.or_else(|| unsupported(&settings, film.width()));
        let rendered = match (&self.prepared, reason) {
            (Some(prepared), None) => {
                let picture = Picture::new(prepared, view, settings.clone());
                self.device.render(&self.context, &picture, film).map_err(Some)
            }
            // Without a frame there is nothing to tell.
            (prepared, reason) => Err(reason.filter(|_| prepared.is_some())),
        };
        rendered.unwrap_or_else(|reason| self.standby.render(reason, view, &settings, film))
    }

    fn memory_usage(&self) -> usize {
        self.budget().bytes() as usize + self.standby.memory_usage()
    }

    fn budget(&self) -> Budget {
        self.device.budget()
    }

    fn notice(&self) -> Option<&str> {
        self.standby.notice()
    }
}

impl DeviceFrame {
    fn commit(
        &mut self,
        context: &GpuContext,
        scene: &Scene,
        frame: &SceneFrame,
        prepared: &PreparedFrame,
    ) -> Result<CommitStats, RenderError> {
        let (geometry, changes) = (&frame.geometry, &frame.changes);
        let (deformer, mut made) = (&mut self.deformer, Vec::new());
        deformer.plan(context, frame);
        let elsewhere = |object_idx| {
            let is_made = deformer.can_make(object_idx);
            made.extend(is_made.then_some(object_idx));
            is_made
        };
        let stats = self.primitives.commit_but(context, geometry, changes, NAME, elsewhere)?;
        self.attributes.commit(context, frame, &self.primitives, &made);
        let (clock, attributes) = (&mut self.clock, self.attributes.buffer());
        self.deformer.make(context, clock, (frame, &made), &self.primitives, attributes);
        self.compute.prepare(context, clock, &self.primitives);
        self.scene.commit(context, scene, prepared);
        Ok(stats)
    }

    /// Renders a picture; `Err` tells why it cannot.
    fn render(
        &mut self,
        context: &GpuContext,
        picture: &Picture<'_>,
        film: &mut Film,
    ) -> Result<FrameStats, String> {
        let start = Instant::now();
        let (width, height) = (film.width(), film.height());
        let mut stats = FrameStats::default();
        match self.shoot_photons(context, picture) {
            Ok(Some(shot)) => shot.add_to(&mut stats),
            Ok(None) => return Err(cannot("so many photons")),
            Err(fault) => return Err(lost(&fault)),
        }
        self.virtual_lights.prepare(context, picture, &mut stats)?;
        let gathered_before = self.gather_seconds();
        let mut rows_at_once = picture.rows_at_once(width);
        let mut first_row = 0;
        while first_row < height {
            let rows = first_row..height.min(first_row + rows_at_once);
            let pixels = &mut film.pixels_mut()[rows.start * width..rows.end * width];
            let band = Band { rows: rows.clone(), width, height };
            match self.render_band(context, picture, &band, pixels) {
                Ok(Rendered::Done(of_band)) => {
                    of_band.add_to(&mut stats);
                    first_row = rows.end;
                }
                Ok(Rendered::TooMuch) if rows_at_once > 1 => {
                    rows_at_once = rows_at_once.div_ceil(2);
                }
                Ok(Rendered::TooMuch) => return Err(cannot("a row with so many rays")),
                Err(fault) => return Err(lost(&fault)),
            }
        }
        stats.indirect.gather_seconds = self.gather_seconds() - gathered_before;
        stats.trace_seconds = start.elapsed().as_secs_f64();
        Ok(stats)
    }

    fn budget(&self) -> Budget {
        let mut budget = self.clock.budget();
        self.primitives.hold(&mut budget);
        self.attributes.hold(&mut budget);
        self.deformer.hold(&mut budget);
        self.scene.hold(&mut budget);
        self.compute.hold(&mut budget);
        self.wave_order.hold(&mut budget);
        self.buffers.hold(&mut budget);
        self.scan.hold(&mut budget);
        self.photons.hold(&mut budget);
        self.log.hold(&mut budget);
        self.virtual_lights.hold(&mut budget);
        if self.refused.is_some() {
            budget.sent_bytes = 0;
        }
        budget
    }
}
