//! The ray engine: all rays against all primitives.
//!
//! The definition of the answer that every other engine must give, to the bit. Rays are taken in
//! chunks, one task a chunk; a chunk meets the triangles in groups of blocks that stay in the
//! first-level cache. One ray is tested against sixteen triangles at a time; spheres and user
//! primitives meet sixteen rays at a time.
//!
//! **Source.** N. Carr, J. Hall, J. Hart, "The Ray Engine", Graphics Hardware 2002.
//!
//! **Departures.** The paper draws one triangle over all rays as pixels and keeps the nearest by
//! the depth test; here loops over registers do both.
//!
//! **Invariants.** Nothing is rejected but by the accepting tests.
//!
//! **Cost.** Rays times primitives; nothing to update but the table of primitives.

mod config;
mod cross;

use rayflock_geom::simd::dispatch;
use rayflock_geom::{FrameChanges, Geometry, Hits, RayBatch};
use rayon::prelude::*;
use tracing::debug_span;

pub use config::Config;

use self::cross::{CHUNK, cross_chunk};
use crate::answer::{offer_hits, tell_occluded};
use crate::packet::{Nearest, Question};
use crate::primitives::PrimitiveTable;
use crate::{CommitStats, EngineError, EngineKind, RayEngine, TraceStats};

/// Tests all rays against all primitives.
#[derive(Debug, Default)]
pub struct BruteEngine {
    config: Config,
    table: PrimitiveTable,
    nearest: Vec<Nearest>,
}

impl BruteEngine {
    /// An engine with an empty frame.
    pub fn new(config: Config) -> Self {
        Self { config, table: PrimitiveTable::new(config.simd), ..Self::default() }
    }

    /// Fills `nearest` for the whole batch; `t_bound` tells beyond which hits are of no interest.
    fn trace(
        &mut self,
        rays: &RayBatch<'_>,
        question: Question,
        t_bound: impl Fn(usize) -> f32 + Sync,
    ) -> TraceStats {
        let _span = debug_span!("cross").entered();
        // Tasks write what they begin with.
        self.nearest.resize(rays.len(), Nearest::NONE);
        let (level, table) = (self.config.simd.level(), &self.table);
        let chunks = self.nearest.par_chunks_mut(CHUNK).enumerate();
        let counted = chunks.map(|(chunk_idx, nearest)| {
            let first_ray = chunk_idx * CHUNK;
            dispatch!(level, simd => {
                cross_chunk(simd, table, rays, first_ray, question, &t_bound, nearest)
            })
        });
        counted.reduce(TraceStats::default, |a, b| a + b)
    }
}

impl RayEngine for BruteEngine {
    fn name(&self) -> &str {
        EngineKind::Brute.name()
    }

    fn commit(
        &mut self,
        geometry: &Geometry,
        changes: &FrameChanges,
    ) -> Result<CommitStats, EngineError> {
        let stats = self.table.commit(geometry, changes);
        self.table.write_triangles();
        Ok(stats)
    }

    fn closest_hit(&mut self, rays: &RayBatch<'_>, hits: &mut Hits<'_>) -> TraceStats {
        assert!(hits.has_len(rays.len()), "every column must have one entry for each ray");
        let bounds: &[f32] = hits.t;
        let stats = self.trace(rays, Question::Closest, |ray_idx| bounds[ray_idx]);
        offer_hits(&self.table, |ray_idx| self.nearest[ray_idx], hits);
        stats
    }

    fn occluded(&mut self, rays: &RayBatch<'_>, occluded: &mut [bool]) -> TraceStats {
        assert_eq!(occluded.len(), rays.len(), "there must be one answer for each ray");
        let stats = self.trace(rays, Question::Occluded, |_| f32::INFINITY);
        tell_occluded(|ray_idx| !self.nearest[ray_idx].is_none(), occluded);
        stats
    }

    fn memory_usage(&self) -> usize {
        self.table.memory_usage() + self.nearest.capacity() * size_of::<Nearest>()
    }
}
