//! Rays that share an origin or a direction, as points of a face: the triangles are streamed past
//! them once, and look up which rays they may hit.
//!
//! ```text
//!   choose faces      one plane across all rays, or the six sides of a cube around their origin
//!   lattice           an image that is regular on the face: its tiles are cells, nothing is sorted
//!   sort_strips       other rays, by strips across the face and by columns
//!   stream_triangles  all triangles are projected, and listed for the bands of strips that they
//!                     touch; where they are many, or faces are, first: is a ray in their box?
//!   look_up_groups    which groups of sixteen rays sixteen triangles of a band's list may hit
//!   trace_band        each of these pairs is asked: edge functions and depth; what is left meets the
//!                     accepting test, unless it is only asked whether there is a hit, and that is
//!                     certain
//! ```
//!
//! **Source.** L. Szecsi, "The Hierarchical Ray Engine", WSCG 2006 (all triangles past tiles of
//! rays; primary visibility by scan conversion); J. Pineda, "A Parallel Algorithm for Polygon
//! Rasterization", SIGGRAPH 1988 (edge functions); N. Greene, M. Kass, G. Miller, "Hierarchical
//! Z-Buffer Visibility", SIGGRAPH 1993 (`occupancy`); S. Molnar, M. Cox, D. Ellsworth, H. Fuchs,
//! "A Sorting Classification of Parallel Rendering", CG&A 1994 (sort-middle).
//!
//! **Departures.** Points lie anywhere, not on a raster, so it is the rays that are sorted into
//! cells, and a triangle is converted to ranges of them. Nothing that is rasterised decides: edge
//! functions are widened until they keep all that the accepting test may accept. A tree of boxes
//! over the rays, which was here before, asked four boxes for each triangle and tile and read
//! triangles in no order; ranges are found by arithmetic (64K triangles past 64K rays in one
//! direction: from 12.9 to 4.7 ms). Triangle by triangle, loops over strips and groups cost a
//! mistaken branch each; sixteen triangles look their groups up together, so pairs are a list that
//! is shortened without branches (the same, with prefetched rows: from 4.2 to 3.3 ms).
//!
//! **Invariants.** See [`face`](rayflock_geom::simd::face),
//! [`face_triangle`](rayflock_geom::simd::face_triangle) and `ray_strips`. A batch with a ray that
//! looks behind its origin, or that has no place on any face, is not taken.
//!
//! **Cost.** One pass over the rays, two more where they are sorted, and one over the triangles for
//! each face; for triangles in reach 64 bytes a band, and some 25 cycles for each group of sixteen
//! rays in reach. 16 bytes a ray, 16 more where they are sorted; 1.5 kilobytes for sixteen rays of
//! a band at work.
//!
//! **Did not pay.** Sorting those of sixteen neighbours of the batch that lie close together as one,
//! as most shadow rays of a picture do: sorting a million took 4.4 instead of 7.7 ms, but they reach
//! into other cells, so triangles find two to three times as many groups (26K triangles past a
//! million rays: from 18 to 22 ms, 11K: from 14.9 to 13.2).

mod faces;
mod lattice;
mod look_up_groups;
mod occupancy;
mod place_rays;
mod ray_columns;
mod ray_group;
mod ray_strips;
mod sort_strips;
mod staged;
mod stream_triangles;
mod trace_band;

use rayflock_geom::RayBatch;
use rayflock_geom::simd::face::Face;
use rayflock_geom::simd::{LANES, SimdLevel, dispatch};
use rayon::prelude::*;
use tracing::debug_span;

use self::faces::Faces;
use self::lattice::LatticeTiler;
use self::ray_strips::RayStrips;
use self::sort_strips::StripSorter;
use self::stream_triangles::{Chunk, Share};
use self::trace_band::{BandTracer, BandWork, Loaded};
use crate::TraceStats;
use crate::answers::Answers;
use crate::packet::{Nearest, Question};
use crate::primitives::PrimitiveTable;
use crate::scratch::Scratch;

/// Bands wanted for each thread, so that all finish at about the same time.
const BANDS_PER_THREAD: usize = 8;

/// Rays in a band at most, where a cell has not more.
const LARGEST_BAND: usize = 8192;

/// Shares of the triangles wanted for each thread.
const SHARES_PER_THREAD: usize = 4;

/// Triangles a ray from which on it pays to ask whether any ray is near. With one instead of three,
/// 64K shadow rays past as many triangles took 1.3 to 1.6 times as long.
const TRIANGLES_PER_RAY: usize = 3;

/// Blocks of triangles in the smallest share.
const SMALLEST_SHARE: usize = 64;

/// Traces batches of rays that share an origin or a direction.
#[derive(Debug, Default)]
pub(super) struct PointTracer {
    faces: Faces,
    sorter: StripSorter,
    tiler: LatticeTiler,
    strips: RayStrips,
    chunks: Vec<Chunk>,
    answers: Answers,
    /// Tracers of tasks that are not running.
    tracers: Scratch<BandTracer>,
}

/// One question about one batch.
pub(super) struct PointWork<'a> {
    pub(super) simd: SimdLevel,
    pub(super) table: &'a PrimitiveTable,
    pub(super) rays: &'a RayBatch<'a>,
    pub(super) question: Question,
    /// Beyond which `t` hits are of no interest, for each ray, if that is known.
    pub(super) t_bounds: Option<&'a [f32]>,
}

impl PointTracer {
    /// Answers a batch; `None` if it is not of the kind that lies on faces.
    pub(super) fn trace(&mut self, work: &PointWork<'_>) -> Option<TraceStats> {
        let rays = work.rays;
        if rays.t_min().uniform().is_some_and(|t_min| t_min < 0.0) || !self.faces.choose(rays) {
            return None;
        }
        self.answers.begin(rays.len(), work.question);
        if rays.is_empty() {
            return Some(TraceStats::default());
        }
        let wanted = BANDS_PER_THREAD * rayon::current_num_threads();
        let band_len = (rays.len() / wanted).clamp(LANES, LARGEST_BAND);
        let slot_count = work.table.triangle_block_count() * LANES;
        let asks_occupancy = slot_count >= TRIANGLES_PER_RAY * rays.len();
        if let Some(stats) = self.trace_lattice(work, band_len, asks_occupancy) {
            return Some(stats);
        }
        let invalid_rays = self.sort(work, (band_len, asks_occupancy))?;
        let stats = self.trace_strips(work).0;
        self.sorter.left_out().for_each(|ray_idx| self.answers.set_none(ray_idx as usize));
        Some(TraceStats { invalid_rays, ..stats })
    }

    /// The nearest hit of a ray of the last batch, after the question for it.
    #[inline(always)]
    pub(super) fn nearest(&self, ray_idx: usize) -> Nearest {
        self.answers.nearest(ray_idx)
    }

    /// Whether a ray of the last batch is occluded, after the question for that.
    #[inline(always)]
    pub(super) fn is_occluded(&self, ray_idx: usize) -> bool {
        self.answers.is_occluded(ray_idx)
    }

    /// Answers a batch whose rays make a lattice; `None` if they do not.
    fn trace_lattice(
        &mut self,
        work: &PointWork<'_>,
        band_len: usize,
        asks_occupancy: bool,
    ) -> Option<TraceStats> {
        let Self { tiler, strips, faces, .. } = self;
        if !tiler.tile(work.simd, work.rays, &faces.faces, band_len, strips) {
            return None;
        }
        strips.faces[0].asks_occupancy = asks_occupancy;
        let (stats, loaded) = self.trace_strips(work);
        self.tiler.take_back(&mut self.strips);
        let invalid_rays = loaded.invalid_count;
        (!loaded.is_astray).then_some(TraceStats { invalid_rays, ..stats })
    }

    /// Sorts rays into strips. Returns the number of rays that are not valid.
    fn sort(&mut self, work: &PointWork<'_>, wanted: (usize, bool)) -> Option<u64> {
        let Self { sorter, strips, faces, .. } = self;
        let mut seen = sorter.sort(work.simd, work.rays, &faces.faces, wanted, strips);
        if seen.is_lost && !faces.is_parallel() && faces.faces.len() == 1 {
            faces.choose_cube(faces.faces[0].center);
            seen = sorter.sort(work.simd, work.rays, &faces.faces, wanted, strips);
        }
        (!seen.is_lost).then_some(seen.invalid_count)
    }

    /// Streams the primitives past the strips and traces these.
    fn trace_strips(&mut self, work: &PointWork<'_>) -> (TraceStats, Loaded) {
        let streamed = self.stream(work);
        let (traced, loaded) = self.trace_bands(work);
        let stats = TraceStats { rays: work.rays.len() as u64, ..TraceStats::default() };
        (stats + streamed + traced, loaded)
    }

    /// Streams all primitives, in parallel.
    fn stream(&mut self, work: &PointWork<'_>) -> TraceStats {
        let _span = debug_span!("stream_triangles").entered();
        let most = SHARES_PER_THREAD * rayon::current_num_threads();
        let part_count = (work.table.block_count() / SMALLEST_SHARE).clamp(1, most);
        if self.chunks.len() != part_count {
            self.chunks.resize_with(part_count, Chunk::default);
        }
        let strips = &self.strips;
        let chunks = self.chunks.par_iter_mut().enumerate();
        let counted = chunks.map(|(part_idx, chunk)| {
            let share = Share { part_idx, part_count };
            dispatch!(work.simd.level(), simd => chunk.stream(simd, work.table, strips, share))
        });
        counted.reduce(TraceStats::default, |a, b| a + b)
    }

    fn trace_bands(&self, work: &PointWork<'_>) -> (TraceStats, Loaded) {
        let _span = debug_span!("trace_bands").entered();
        let PointWork { table, rays, question, t_bounds, .. } = *work;
        let (chunks, strips) = (&self.chunks[..], &self.strips);
        let band_work = BandWork { table, rays, strips, chunks, question, t_bounds };
        let counted = (0..strips.bands.len()).into_par_iter().map(|band_idx| {
            let mut tracer = self.tracers.take();
            let traced = dispatch!(work.simd.level(), simd => {
                tracer.trace(simd, &band_work, band_idx, &self.answers)
            });
            self.tracers.give_back(tracer);
            traced
        });
        counted.reduce(Default::default, |a, b| {
            let invalid_count = a.1.invalid_count + b.1.invalid_count;
            (a.0 + b.0, Loaded { invalid_count, is_astray: a.1.is_astray | b.1.is_astray })
        })
    }

    /// Bytes held.
    pub(super) fn memory_usage(&self) -> usize {
        self.sorter.memory_usage()
            + self.faces.faces.capacity() * size_of::<Face>()
            + self.strips.memory_usage()
            + self.tiler.memory_usage()
            + self.chunks.iter().map(Chunk::memory_usage).sum::<usize>()
            + self.answers.memory_usage()
            + self.tracers.sum(BandTracer::memory_usage)
    }
}
