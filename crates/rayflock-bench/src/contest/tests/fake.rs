//! An engine that keeps a log, and answers wrongly where it is told to.

use std::sync::{Arc, Mutex};

use rayflock::engine::brute::BruteEngine;
use rayflock::engine::{CommitStats, EngineError, RayEngine, TraceStats};
use rayflock::geom::{FrameChanges, Geometry, Hits, NO_ID, RayBatch};

use crate::contest::Piece;
use crate::work::MovingScene;

/// What happened, engine by engine, in the order of time.
#[derive(Clone, Debug, Default)]
pub(super) struct Log(Arc<Mutex<Vec<String>>>);

/// What an engine does wrong.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Tamper {
    Nothing,
    /// Hits lie farther than they should.
    Farther,
    /// Hits differ in the last bit.
    LastBit,
    /// All rays miss.
    Misses,
    /// Free rays are occluded and occluded ones free.
    Inverts,
    /// All the time goes into conversions.
    Converts,
    /// It holds no geometry.
    Refuses,
    /// Another engine does its work.
    HandsOver,
}

#[derive(Debug)]
pub(super) struct FakeEngine {
    name: String,
    tamper: Tamper,
    log: Log,
    inner: BruteEngine,
}

impl Log {
    pub(super) fn lines(&self) -> Vec<String> {
        self.0.lock().unwrap().clone()
    }

    /// The lines, with the geometries of the first phase of `piece` by their names.
    pub(super) fn of(&self, piece: &Piece) -> Vec<String> {
        self.lines().iter().map(|line| name_geometries(line, piece)).collect()
    }

    fn add(&self, line: String) {
        self.0.lock().unwrap().push(line);
    }
}

impl FakeEngine {
    pub(super) fn new(name: &str, tamper: Tamper, log: &Log) -> Self {
        let (name, log, inner) = (name.to_owned(), log.clone(), BruteEngine::default());
        Self { name, tamper, log, inner }
    }

    fn conversion_ns(&self) -> u64 {
        if self.tamper == Tamper::Converts { u64::MAX } else { 0 }
    }
}

impl RayEngine for FakeEngine {
    fn name(&self) -> &str {
        &self.name
    }

    fn commit(
        &mut self,
        geometry: &Geometry,
        changes: &FrameChanges,
    ) -> Result<CommitStats, EngineError> {
        if self.tamper == Tamper::Refuses {
            let (engine, what) = (self.name.clone(), "rooms".to_owned());
            return Err(EngineError::Unsupported { engine, what });
        }
        self.log.add(format!("{} commit {}", self.name, identity(geometry)));
        let stats = self.inner.commit(geometry, changes)?;
        Ok(CommitStats { conversion_ns: self.conversion_ns(), ..stats })
    }

    fn closest_hit(&mut self, rays: &RayBatch<'_>, hits: &mut Hits<'_>) -> TraceStats {
        self.log.add(format!("{} trace {}", self.name, rays.len()));
        let stats = self.inner.closest_hit(rays, hits);
        let object_id = hits.object_id.as_mut().unwrap();
        for (t, object_id) in hits.t.iter_mut().zip(&mut **object_id) {
            match self.tamper {
                Tamper::Farther => *t = *t * 1.001 + 0.01,
                Tamper::LastBit => *t = t.next_up(),
                Tamper::Misses => *object_id = NO_ID,
                _ => (),
            }
        }
        TraceStats { conversion_ns: self.conversion_ns(), ..stats }
    }

    fn occluded(&mut self, rays: &RayBatch<'_>, occluded: &mut [bool]) -> TraceStats {
        self.log.add(format!("{} trace {}", self.name, rays.len()));
        let stats = self.inner.occluded(rays, occluded);
        if self.tamper == Tamper::Inverts {
            occluded.iter_mut().for_each(|occluded| *occluded = !*occluded);
        }
        stats
    }

    fn memory_usage(&self) -> usize {
        self.inner.memory_usage()
    }

    fn notice(&self) -> Option<&str> {
        (self.tamper == Tamper::HandsOver).then_some("the device is lost")
    }
}

/// A line of the log with the geometry named by its place in the first phase of the piece.
fn name_geometries(line: &str, piece: &Piece) -> String {
    let phase = &piece.phases[0];
    let frames = phase.frames.iter().enumerate();
    let named = frames.map(|(idx, frame)| (identity(&frame.geometry), idx.to_string()));
    let before = (identity(&phase.before), "before".to_owned());
    let nothing = (identity(&Geometry::default()), "nothing".to_owned());
    named
        .chain([before, nothing])
        .fold(line.to_owned(), |line, (identity, name)| line.replace(&identity, &name))
}

/// The mesh that moves, by its address.
fn identity(geometry: &Geometry) -> String {
    let moving = geometry.object(MovingScene::MOVING);
    moving.map_or("[none]".to_owned(), |object| format!("[{:p}]", Arc::as_ptr(&object.shape)))
}
