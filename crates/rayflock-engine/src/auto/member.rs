//! An engine among those chosen from, and the frame that it holds.

use rayflock_geom::simd::SimdLevel;
use rayflock_geom::{FrameChanges, Geometry};
use web_time::Instant;

use crate::brute::{self, BruteEngine};
use crate::bvh::{self, BvhEngine};
use crate::hierarchy::{self, HierarchyEngine};
use crate::subfields::{self, SubfieldsEngine};
use crate::{CommitStats, EngineError, EngineKind, RayEngine};

/// The engines that are chosen from; the first where nothing tells them apart.
pub(super) const MEMBERS: [EngineKind; 4] =
    [EngineKind::Hierarchy, EngineKind::Bvh, EngineKind::Brute, EngineKind::Subfields];

/// An engine that keeps the last frame it was given, which may be older than the current one.
#[derive(Debug)]
pub(super) struct Member {
    engine: Box<dyn RayEngine>,
    /// What the engine was given last.
    pub(super) held: Geometry,
    /// Whether that is the current frame.
    pub(super) is_current: bool,
    /// Whether a batch of the current frame was traced.
    pub(super) has_traced: bool,
    /// What the last commit took.
    pub(super) commit_ns: f32,
}

impl Member {
    /// An engine with an empty frame.
    pub(super) fn new(kind: EngineKind, simd: SimdLevel) -> Self {
        let engine: Box<dyn RayEngine> = match kind {
            EngineKind::Brute => Box::new(BruteEngine::new(brute::Config { simd })),
            EngineKind::Hierarchy => Box::new(HierarchyEngine::new(hierarchy::Config { simd })),
            EngineKind::Bvh => Box::new(BvhEngine::new(bvh::Config { simd })),
            EngineKind::Subfields => Box::new(SubfieldsEngine::new(subfields::Config {
                simd,
                ..subfields::Config::default()
            })),
            EngineKind::Auto => unreachable!("the choosing engine does not choose itself"),
        };
        let held = Geometry::default();
        Self { engine, held, is_current: true, has_traced: false, commit_ns: 0.0 }
    }

    /// Gives the engine the current frame; `changes` since the frame it holds.
    pub(super) fn commit(
        &mut self,
        geometry: &Geometry,
        changes: &FrameChanges,
    ) -> Result<CommitStats, EngineError> {
        let start = Instant::now();
        let stats = self.engine.commit(geometry, changes)?;
        self.commit_ns = start.elapsed().as_nanos() as f32;
        self.held = geometry.clone();
        self.is_current = true;
        Ok(stats)
    }

    /// The engine itself.
    pub(super) fn engine(&mut self) -> &mut dyn RayEngine {
        &mut *self.engine
    }

    /// Bytes held.
    pub(super) fn memory_usage(&self) -> usize {
        self.engine.memory_usage()
    }
}
