//! Embree as an engine: commit, trace, answer.

use std::ffi::CString;
use std::sync::Arc;
use std::time::Instant;

use rayflock::engine::{CommitStats, EngineError, RayEngine, TraceStats};
use rayflock::geom::{FrameChanges, Geometry, Hits, RayBatch};

use super::ffi::Device;
use super::layout::{
    self, Arguments, PROPERTY_POINT_GEOMETRY, PROPERTY_RAY_MASK, RAY_QUERY_COHERENT,
};
use super::rays::{Batch, Found, FoundBlock, RayBlock};
use super::trace::{closest_packets, closest_singles, occluded_packets, occluded_singles};
use super::world::World;
use super::{EmbreeLibrary, Setting, Traversal, Width};
use crate::peer::PeerError;

/// Traces with Embree, used as the setting says.
#[derive(Debug)]
pub struct EmbreeEngine {
    name: String,
    setting: Setting,
    library: EmbreeLibrary,
    world: World,
    device: Arc<Device>,
    /// Threads that the device builds with.
    thread_count: usize,
    rays: Vec<layout::Ray>,
    found: Vec<Found>,
    ray_blocks: Vec<RayBlock>,
    found_blocks: Vec<FoundBlock>,
}

impl EmbreeEngine {
    /// An engine with an empty frame.
    ///
    /// # Errors
    /// [`PeerError::Device`] when Embree refuses to work.
    pub fn new(library: &EmbreeLibrary, setting: Setting) -> Result<Self, PeerError> {
        let thread_count = rayon::current_num_threads();
        let device = start(library, thread_count)
            .map_err(|reason| PeerError::Device { path: library.path().to_owned(), reason })?;
        Ok(Self {
            name: name(setting),
            setting,
            library: library.clone(),
            world: World::new(&device, setting.build, setting.robust),
            device,
            thread_count,
            rays: Vec::new(),
            found: Vec::new(),
            ray_blocks: Vec::new(),
            found_blocks: Vec::new(),
        })
    }

    /// How Embree is used.
    pub const fn setting(&self) -> Setting {
        self.setting
    }

    /// Hands rays over in another way from now on; the frame stays.
    pub fn set_traversal(&mut self, traversal: Traversal) {
        self.setting.traversal = traversal;
        self.name = name(self.setting);
    }

    /// Builds with as many threads as we trace with.
    fn follow_thread_count(&mut self) -> Result<(), EngineError> {
        let thread_count = rayon::current_num_threads();
        if thread_count != self.thread_count {
            self.device =
                start(&self.library, thread_count).map_err(|reason| self.failure(reason))?;
            self.thread_count = thread_count;
            self.forget_frame();
        }
        Ok(())
    }

    fn forget_frame(&mut self) {
        self.world = World::new(&self.device, self.setting.build, self.setting.robust);
    }

    fn check_supported(&self, geometry: &Geometry) -> Result<(), EngineError> {
        let any =
            |has: fn(&rayflock::geom::GeometryObject) -> bool| geometry.objects().iter().any(has);
        let lacks = |property| self.device.property(property) == 0;
        let what = if any(|object| object.shape.user().is_some()) {
            "user primitives"
        } else if any(|object| object.mask != u32::MAX) && lacks(PROPERTY_RAY_MASK) {
            "masks with this build of the library"
        } else if any(|object| !object.shape.spheres().is_empty()) && lacks(PROPERTY_POINT_GEOMETRY)
        {
            "spheres with this build of the library"
        } else {
            return Ok(());
        };
        Err(EngineError::Unsupported { engine: self.name.clone(), what: what.to_owned() })
    }

    fn failure(&self, reason: String) -> EngineError {
        EngineError::Failed { engine: self.name.clone(), reason }
    }

    fn arguments(&self) -> Arguments {
        let flags = if self.setting.traversal.coherent { RAY_QUERY_COHERENT } else { 0 };
        Arguments::new(flags, self.world.features())
    }
}

impl RayEngine for EmbreeEngine {
    fn name(&self) -> &str {
        &self.name
    }

    fn commit(
        &mut self,
        geometry: &Geometry,
        _: &FrameChanges,
    ) -> Result<CommitStats, EngineError> {
        self.follow_thread_count()?;
        let committed = self.check_supported(geometry).and_then(|()| {
            let stats = self.world.commit(geometry);
            self.device.take_error().map_or(Ok(stats), |error| Err(self.failure(error)))
        });
        if committed.is_err() {
            self.forget_frame();
        }
        committed
    }

    fn closest_hit(&mut self, rays: &RayBatch<'_>, hits: &mut Hits<'_>) -> TraceStats {
        assert!(hits.has_len(rays.len()), "every column must have one entry for each ray");
        let (arguments, bounds) = (self.arguments(), self.world.bounds());
        let start = Instant::now();
        let batch = Batch { rays, t_bound: Some(hits.t), bounds };
        let (invalid_rays, trace_ns) = match self.setting.traversal.width {
            Width::Single => {
                let invalid_rays = batch.to_singles(&mut self.rays);
                self.found.resize(rays.len(), Found::NOTHING);
                let trace_ns = nanoseconds(|| {
                    let (rays, found) = (&self.rays, &mut self.found);
                    closest_singles(self.world.tracer(), &arguments, rays, found);
                });
                (invalid_rays, trace_ns)
            }
            Width::Packets => {
                let invalid_rays = batch.to_blocks(&mut self.ray_blocks);
                self.found_blocks.resize(self.ray_blocks.len(), FoundBlock::NOTHING);
                let trace_ns = nanoseconds(|| {
                    let (blocks, found) = (&self.ray_blocks, &mut self.found_blocks);
                    closest_packets(self.world.tracer(), &arguments, blocks, found);
                });
                (invalid_rays, trace_ns)
            }
        };
        let batch = Batch { rays, t_bound: None, bounds };
        match self.setting.traversal.width {
            Width::Single => batch.offer(&self.world, self.found.iter().copied(), hits),
            Width::Packets => {
                let lanes =
                    |block| (0..layout::WIDTH).map(move |lane| FoundBlock::get(block, lane));
                batch.offer(&self.world, self.found_blocks.iter().flat_map(lanes), hits);
            }
        }
        stats(rays, invalid_rays, start, trace_ns)
    }

    fn occluded(&mut self, rays: &RayBatch<'_>, occluded: &mut [bool]) -> TraceStats {
        assert_eq!(occluded.len(), rays.len(), "there must be one answer for each ray");
        let (arguments, tracer) = (self.arguments(), self.world.tracer());
        let start = Instant::now();
        let batch = Batch { rays, t_bound: None, bounds: self.world.bounds() };
        let (invalid_rays, trace_ns) = match self.setting.traversal.width {
            Width::Single => {
                let invalid_rays = batch.to_singles(&mut self.rays);
                let trace = || occluded_singles(tracer, &arguments, &self.rays, occluded);
                (invalid_rays, nanoseconds(trace))
            }
            Width::Packets => {
                let invalid_rays = batch.to_blocks(&mut self.ray_blocks);
                let trace = || occluded_packets(tracer, &arguments, &self.ray_blocks, occluded);
                (invalid_rays, nanoseconds(trace))
            }
        };
        stats(rays, invalid_rays, start, trace_ns)
    }

    fn memory_usage(&self) -> usize {
        let single = size_of::<layout::Ray>() * self.rays.capacity()
            + size_of::<Found>() * self.found.capacity();
        let packets = size_of::<RayBlock>() * self.ray_blocks.capacity()
            + size_of::<FoundBlock>() * self.found_blocks.capacity();
        self.device.memory_usage() + self.world.memory_usage() + single + packets
    }
}

fn name(setting: Setting) -> String {
    format!("embree:{setting}")
}

/// Starts Embree with as many threads as ours, none of them bound to a core. Threads start when
/// they are first wanted: if all are to be there at once, Embree 4.4.0 waits for them whenever a
/// device goes, and now and then one never comes.
fn start(library: &EmbreeLibrary, thread_count: usize) -> Result<Arc<Device>, String> {
    let config = format!("threads={thread_count},set_affinity=0,hugepages=1");
    let config = CString::new(config).map_err(|error| error.to_string())?;
    Device::new(library.functions(), &config).map(Arc::new)
}

fn nanoseconds(work: impl FnOnce()) -> u64 {
    let start = Instant::now();
    work();
    start.elapsed().as_nanos() as u64
}

/// Everything since `start` but tracing was conversion.
fn stats(rays: &RayBatch<'_>, invalid_rays: u64, start: Instant, trace_ns: u64) -> TraceStats {
    let conversion_ns = (start.elapsed().as_nanos() as u64).saturating_sub(trace_ns);
    TraceStats { rays: rays.len() as u64, invalid_rays, conversion_ns, ..TraceStats::default() }
}
