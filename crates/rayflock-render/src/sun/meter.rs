//! How long the sun shines on each sample, added up step by step.

use glam::Vec3;
use rayflock_engine::{CommitStats, RayEngine, TraceStats};
use rayflock_geom::{FrameChanges, Geometry, RayBatch, RayOrder};
use rayon::prelude::*;
use tracing::debug_span;

use super::samples::sample_surface;
use super::{Sampling, SunError, SunSample, WorldMesh};

/// Which sides of a surface count.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Sides {
    /// Both, as everywhere in this crate: a sample is lit on whichever side the sun is. The back
    /// of a closed surface is dark anyway, and a sheet need not be wound one way.
    #[default]
    Both,
    /// The side from which the corners of a triangle run counter-clockwise.
    Front,
}

/// Adds up how long the sun shines on each face or vertex of a geometry that may move.
#[derive(Debug)]
pub struct SunMeter {
    pub(super) engine: Box<dyn RayEngine>,
    pub(super) sampling: Sampling,
    sides: Sides,
    /// What the engine holds.
    pub(super) geometry: Geometry,
    /// Samples of the committed frame.
    samples: Vec<SunSample>,
    /// How long each sample was lit; empty before the first frame.
    pub(super) seconds: Vec<f64>,
    buffers: Buffers,
}

/// The rays of one step, kept from step to step.
#[derive(Debug, Default)]
struct Buffers {
    /// Where they start, and from which samples.
    rays: (Vec<Vec3>, Vec<u32>),
    occluded: Vec<bool>,
}

impl SunMeter {
    /// A meter that traces with `engine` and has seen no sun yet.
    pub fn new(engine: Box<dyn RayEngine>, sampling: Sampling, sides: Sides) -> Self {
        Self {
            engine,
            sampling,
            sides,
            geometry: Geometry::default(),
            samples: Vec::new(),
            seconds: Vec::new(),
            buffers: Buffers::default(),
        }
    }

    /// Makes `geometry` the one that the sun shines on from now on. Its samples take over the
    /// seconds of those before: face `i` stays face `i`, however it moves. Returns its triangles.
    ///
    /// # Errors
    /// [`SunError::NoTriangles`], [`SunError::TooManyVertices`], [`SunError::Topology`] where the
    /// number of faces or vertices differs from the frame before, which then stays; and
    /// [`SunError::Engine`], after which no frame is left.
    pub fn commit(
        &mut self,
        geometry: &Geometry,
        changes: &FrameChanges,
    ) -> Result<(WorldMesh, CommitStats), SunError> {
        let _span = debug_span!("commit_frame").entered();
        let mesh = WorldMesh::new(geometry)?;
        let (what, found) = match self.sampling {
            Sampling::Faces => ("faces", mesh.triangles().len()),
            Sampling::Vertices => ("vertices", mesh.vertices().len()),
        };
        if self.seconds.is_empty() {
            self.seconds.resize(found, 0.0);
        }
        let expected = self.seconds.len();
        if found != expected {
            return Err(SunError::Topology { what, found, expected });
        }
        self.samples.clear();
        let stats = self.engine.commit(geometry, changes)?;
        self.geometry = geometry.clone();
        sample_surface(&mesh, self.sampling, &mut self.samples);
        Ok((mesh, stats))
    }

    /// Adds `seconds` to each sample that sees the sun in the direction `to_sun`, of unit length,
    /// in world space. One batch of rays.
    pub fn add(&mut self, to_sun: Vec3, seconds: f64) -> TraceStats {
        let _span = debug_span!("add_sun").entered();
        self.collect_rays(to_sun);
        let Buffers { rays: (origins, sample_idxs), occluded } = &mut self.buffers;
        occluded.clear();
        occluded.resize(origins.len(), false);
        if origins.is_empty() {
            return TraceStats::default();
        }
        let Ok(batch) = RayBatch::new(&*origins, to_sun) else {
            unreachable!("a uniform column has the length of any other")
        };
        let stats = self.engine.occluded(&batch.with_order(RayOrder::Coherent), occluded);
        for (sample_idx, _) in sample_idxs.iter().zip(occluded).filter(|(_, occluded)| !**occluded)
        {
            self.seconds[*sample_idx as usize] += seconds;
        }
        stats
    }

    /// The samples of the committed frame.
    pub fn samples(&self) -> &[SunSample] {
        &self.samples
    }

    /// What the user should hear of the engine, though every question is answered.
    pub fn notice(&self) -> Option<&str> {
        self.engine.notice()
    }

    /// How long each sample was lit, in seconds; `seconds().len() == samples().len()`.
    pub fn seconds(&self) -> &[f64] {
        &self.seconds
    }

    /// One ray for each sample that faces the sun, off the side that does.
    fn collect_rays(&mut self, to_sun: Vec3) {
        let rays = &mut self.buffers.rays;
        rays.0.clear();
        rays.1.clear();
        let sides = self.sides;
        let ray = |(sample_idx, sample): (u32, &SunSample)| {
            Some((start(sample, to_sun, sides)?, sample_idx))
        };
        let samples = (0..self.samples.len() as u32).into_par_iter().zip(&self.samples);
        rays.par_extend(samples.filter_map(ray));
    }
}

/// Where a ray from `sample` to the sun starts; `None` where the surface faces away.
fn start(sample: &SunSample, to_sun: Vec3, sides: Sides) -> Option<Vec3> {
    let facing = sample.normal.dot(to_sun);
    let outward = match sides {
        Sides::Both if facing < 0.0 => -sample.normal,
        _ => sample.normal,
    };
    (outward.dot(to_sun) > 0.0).then(|| sample.position + sample.slack * outward)
}
