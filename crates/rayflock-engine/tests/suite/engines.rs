//! The engines under test, and ways to ask them.

use std::sync::OnceLock;

use proptest::test_runner::{Config as ProptestConfig, RngSeed};
use rayflock_engine::{
    CommitStats, EngineKind, RayEngine, TraceStats, auto, brute, bvh, create, hierarchy, subfields,
};
use rayflock_geom::simd::SimdLevel;
use rayflock_geom::{FrameChanges, Geometry, Hit, HitBuffer, RayBatch};
use rayon::ThreadPool;

/// An engine at one SIMD level, which works on one pool.
#[derive(Debug)]
pub(crate) struct Subject {
    pub(crate) name: String,
    engine: Box<dyn RayEngine>,
    pool: &'static ThreadPool,
}

impl Subject {
    fn new(kind: EngineKind, simd: SimdLevel, threads: usize) -> Self {
        let engine: Box<dyn RayEngine> = match kind {
            EngineKind::Auto => Box::new(auto::AutoEngine::new(auto::Config { simd })),
            EngineKind::Brute => Box::new(brute::BruteEngine::new(brute::Config { simd })),
            EngineKind::Hierarchy => {
                Box::new(hierarchy::HierarchyEngine::new(hierarchy::Config { simd }))
            }
            EngineKind::Bvh => Box::new(bvh::BvhEngine::new(bvh::Config { simd })),
            EngineKind::Subfields => {
                let config = subfields::Config { simd, ..subfields::Config::default() };
                Box::new(subfields::SubfieldsEngine::new(config))
            }
            kind => panic!("tell the suite how to make the engine {kind} at a SIMD level"),
        };
        assert_eq!(engine.name(), kind.name());
        Self { name: format!("{kind}, {simd}, {threads} threads"), engine, pool: pool(threads) }
    }

    /// Engines with settings that are not the default.
    pub(crate) fn with_settings() -> Vec<Self> {
        let all = [
            ("icosahedron+10", 1, 2),
            ("1+list", 1 << 30, 2),
            ("100", 1 << 20, 2),
            ("eager+40", 1 << 20, 1),
            ("eager+20+list+flat", 1 << 30, 2),
            ("locked", 1 << 30, 1),
            ("locked+40", 1 << 30, 2),
            ("locked+list+30", 1 << 20, 2),
        ];
        let subject = |(setting, budget, threads): (&str, usize, usize)| {
            let config = subfields::Config { budget, ..setting.parse().unwrap() };
            let name = format!("subfields:{setting}, {budget} bytes, {threads} threads");
            let engine = Box::new(subfields::SubfieldsEngine::new(config));
            Self { name, engine, pool: pool(threads) }
        };
        all.map(subject).into()
    }

    /// Every engine at every SIMD level with one and two threads.
    pub(crate) fn all() -> Vec<Self> {
        let kinds = EngineKind::ALL.into_iter();
        let levels = kinds
            .flat_map(|kind| SimdLevel::available().into_iter().map(move |level| (kind, level)));
        levels
            .flat_map(|(kind, level)| [1, 2].map(|threads| Self::new(kind, level, threads)))
            .collect()
    }

    /// Every engine at the best level with two threads.
    pub(crate) fn best() -> Vec<Self> {
        EngineKind::ALL.map(|kind| Self::new(kind, SimdLevel::best(), 2)).into()
    }

    pub(crate) fn commit(&mut self, geometry: &Geometry, changes: &FrameChanges) -> CommitStats {
        self.pool.install(|| self.engine.commit(geometry, changes)).unwrap()
    }

    /// Offers the engine's hits to a buffer that may hold hits already.
    pub(crate) fn trace_into(&mut self, rays: &RayBatch<'_>, hits: &mut HitBuffer) -> TraceStats {
        self.pool.install(|| self.engine.closest_hit(rays, &mut hits.as_hits()))
    }

    /// The hits of a batch from scratch.
    pub(crate) fn trace(&mut self, rays: &RayBatch<'_>) -> (HitBuffer, TraceStats) {
        let mut hits = HitBuffer::new(rays.len());
        let stats = self.trace_into(rays, &mut hits);
        (hits, stats)
    }

    pub(crate) fn occluded(&mut self, rays: &RayBatch<'_>) -> (Vec<bool>, TraceStats) {
        // Start from alternating answers, all of which must be overwritten.
        let mut occluded: Vec<bool> = (0..rays.len()).map(|idx| idx % 2 == 0).collect();
        let stats = self.pool.install(|| self.engine.occluded(rays, &mut occluded));
        (occluded, stats)
    }

    pub(crate) fn engine(&mut self) -> &mut dyn RayEngine {
        &mut *self.engine
    }
}

/// The engine that defines the answer, as everyone gets it, with a frame.
pub(crate) fn definition(geometry: &Geometry) -> Box<dyn RayEngine> {
    let mut engine = create(EngineKind::Brute);
    engine.commit(geometry, &FrameChanges::all()).unwrap();
    engine
}

fn pool(threads: usize) -> &'static ThreadPool {
    static POOLS: [OnceLock<ThreadPool>; 2] = [OnceLock::new(), OnceLock::new()];
    POOLS[threads - 1]
        .get_or_init(|| rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap())
}

/// A hit with every bit counted.
pub(crate) fn bits(hit: &Hit) -> [u32; 5] {
    [hit.t.to_bits(), hit.u.to_bits(), hit.v.to_bits(), hit.object_id.0, hit.prim_id.0]
}

/// The first ray for which two buffers differ in any bit.
pub(crate) fn first_difference(found: &HitBuffer, expected: &HitBuffer) -> Option<usize> {
    assert_eq!(found.len(), expected.len());
    (0..found.len()).find(|&idx| bits(&found.get(idx)) != bits(&expected.get(idx)))
}

/// `cases` random cases from a fixed seed, the same in every run.
pub(crate) fn seeded(cases: u32, seed: u64) -> ProptestConfig {
    ProptestConfig {
        cases,
        rng_seed: RngSeed::Fixed(seed),
        failure_persistence: None,
        max_shrink_iters: 40,
        ..ProptestConfig::default()
    }
}
