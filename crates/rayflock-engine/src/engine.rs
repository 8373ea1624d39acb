//! The question that every engine answers.

use std::fmt::{self, Debug};
use std::ops::{Add, AddAssign};
use std::str::FromStr;

use rayflock_geom::{FrameChanges, Geometry, Hits, RayBatch};
use thiserror::Error;

use crate::Budget;
use crate::auto::Choice;

/// Traces batches of rays against one frame of geometry at a time.
///
/// All engines give the same answer to the bit: the nearest hit by the accepting tests of
/// [`rayflock_geom::simd`], the lowest (object, primitive) where two are equally near. It does
/// not depend on earlier frames, hints, SIMD level, thread count, or how a batch is split.
///
/// Work runs on the current rayon thread pool; install a pool around a call to choose its size.
pub trait RayEngine: Debug + Send {
    /// The name of the engine, as on the command line.
    fn name(&self) -> &str;

    /// Makes `geometry` the current frame. `changes` tells how it differs from the frame
    /// committed before; [`FrameChanges::all`] is always correct.
    ///
    /// # Errors
    /// [`EngineError`] when the engine cannot hold the geometry; the frame committed before is
    /// then gone.
    fn commit(
        &mut self,
        geometry: &Geometry,
        changes: &FrameChanges,
    ) -> Result<CommitStats, EngineError>;

    /// Replaces entry `i` of `hits` by a nearer hit of ray `i`, if there is one. Start from
    /// [`Hit::MISS`](rayflock_geom::Hit::MISS).
    ///
    /// # Panics
    /// When a column of `hits` is not as long as the batch.
    fn closest_hit(&mut self, rays: &RayBatch<'_>, hits: &mut Hits<'_>) -> TraceStats;

    /// Writes whether anything lies within the interval of each ray: what
    /// [`Self::closest_hit`] not missing would say.
    ///
    /// # Panics
    /// When `occluded.len() != rays.len()`.
    fn occluded(&mut self, rays: &RayBatch<'_>, occluded: &mut [bool]) -> TraceStats;

    /// Bytes held by the engine itself, without the shared meshes.
    fn memory_usage(&self) -> usize;

    /// Which engine was asked about each batch since the last commit, and why: for engines that
    /// choose among others, empty otherwise.
    fn choices(&self) -> &[Choice] {
        &[]
    }

    /// Numbers about what the engine holds that only this engine has.
    fn facts(&self) -> Vec<Fact> {
        Vec::new()
    }

    /// What stages took since the last commit, and what is held: for engines on a device, empty
    /// otherwise.
    fn budget(&self) -> Budget {
        Budget::default()
    }

    /// What the user should hear of, though every question is answered: that a device was lost
    /// and another engine goes on.
    fn notice(&self) -> Option<&str> {
        None
    }
}

/// A number about what an engine holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fact {
    /// What is counted, in words.
    pub name: &'static str,
    /// How many.
    pub value: f64,
}

/// The engines, by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum EngineKind {
    /// Whichever of the others is expected to answer soonest.
    Auto,
    /// All rays against all primitives.
    Brute,
    /// A hierarchy over the rays, none over the geometry.
    Hierarchy,
    /// A tree over the geometry, built anew each frame, and streams of rays.
    Bvh,
    /// Grids of primitives, one for each direction.
    Subfields,
}

impl EngineKind {
    /// Every engine of this crate.
    pub const ALL: [Self; 5] =
        [Self::Auto, Self::Brute, Self::Hierarchy, Self::Bvh, Self::Subfields];

    /// The name on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::Brute => "brute",
            Self::Hierarchy => "hierarchy",
            Self::Bvh => "bvh",
            Self::Subfields => "subfields",
        }
    }
}

impl fmt::Display for EngineKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for EngineKind {
    type Err = EngineError;

    fn from_str(name: &str) -> Result<Self, EngineError> {
        Self::ALL
            .into_iter()
            .find(|kind| kind.name() == name)
            .ok_or_else(|| EngineError::UnknownEngine(name.to_owned()))
    }
}

/// Why an engine cannot do what it was asked.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum EngineError {
    /// No engine has this name.
    #[error("unknown engine \"{0}\"; there are: {names}", names = engine_names())]
    UnknownEngine(String),
    /// An engine has no setting of this name.
    #[error("the engine {engine} has no setting \"{found}\"; there are: {expected}")]
    UnknownSetting {
        /// The engine.
        engine: &'static str,
        /// What was asked for.
        found: String,
        /// What there is.
        expected: String,
    },
    /// The geometry holds something that this engine does not know.
    #[error("the engine {engine} does not support {what}")]
    Unsupported {
        /// The engine.
        engine: String,
        /// What it does not know.
        what: String,
    },
    /// A library that the engine is made of failed.
    #[error("the engine {engine} failed: {reason}")]
    Failed {
        /// The engine.
        engine: String,
        /// What the library says.
        reason: String,
    },
}

fn engine_names() -> String {
    EngineKind::ALL.map(EngineKind::name).join(", ")
}

/// What a commit found and did. What is ignored is counted by
/// [`count_ignored`](crate::count_ignored), not by engines.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CommitStats {
    /// Primitives in the frame.
    pub prim_count: usize,
    /// Primitives of the objects that changed, whose data have to be written anew.
    pub rewritten_count: usize,
    /// Nanoseconds spent on bringing geometry into the layout of a foreign library, which its own
    /// users would not spend. Benchmarks subtract it; engines of this crate leave it 0.
    pub conversion_ns: u64,
}

/// What tracing a batch took.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TraceStats {
    /// Rays in the batch.
    pub rays: u64,
    /// Rays that were NaN, infinite or had a zero direction: misses.
    pub invalid_rays: u64,
    /// Sphere-cone tests, in SIMD lanes.
    pub cone_tests: u64,
    /// Box tests, in SIMD lanes.
    pub box_tests: u64,
    /// Ray-triangle tests, in SIMD lanes: sixteen a call, lanes without a ray or triangle included.
    pub triangle_tests: u64,
    /// Ray-sphere tests, in SIMD lanes.
    pub sphere_tests: u64,
    /// Rays handed to user primitives.
    pub user_tests: u64,
    /// Tiles of subfields that rays visited.
    pub tiles: u64,
    /// Candidate pairs of a group of rays and a primitive or group of primitives that an engine
    /// wrote down for its next stage.
    pub pairs: u64,
    /// Bytes of primitives, bounds and candidate lists that tests read and stages wrote. Rays,
    /// bounds of rays and hits are not counted, nor what user primitives read.
    pub bytes: u64,
    /// Nanoseconds spent on the geometry of the frame, because this batch was the first to need
    /// it so: trees built, subfields brought up to date. Work of several batches at once counts
    /// as long as it takes.
    pub update_ns: u64,
    /// Nanoseconds spent on bringing rays and hits into and out of the layout of a foreign
    /// library, which its own users would not spend. Benchmarks subtract it; engines of this
    /// crate leave it 0.
    pub conversion_ns: u64,
}

impl Add for TraceStats {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            rays: self.rays + other.rays,
            invalid_rays: self.invalid_rays + other.invalid_rays,
            cone_tests: self.cone_tests + other.cone_tests,
            box_tests: self.box_tests + other.box_tests,
            triangle_tests: self.triangle_tests + other.triangle_tests,
            sphere_tests: self.sphere_tests + other.sphere_tests,
            user_tests: self.user_tests + other.user_tests,
            tiles: self.tiles + other.tiles,
            pairs: self.pairs + other.pairs,
            bytes: self.bytes + other.bytes,
            update_ns: self.update_ns + other.update_ns,
            conversion_ns: self.conversion_ns + other.conversion_ns,
        }
    }
}

impl AddAssign for TraceStats {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}
