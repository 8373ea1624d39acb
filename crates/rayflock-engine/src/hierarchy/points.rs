//! Rays that share an origin or a direction, as points of a face: the triangles are streamed past
//! them once.
//!
//! ```text
//!   choose faces      one plane across all rays, or the six sides of a cube around their origin
//!   arrange           rays into tiles that are close on a face: as the caller's hint says, or
//!                     sorted along a Hilbert curve
//!   bound_tiles       boxes around the points of each tile, then boxes of sixteen boxes
//!   stream_triangles  project all triangles; set up those in reach, list them for the tiles they
//!                     touch
//!   trace_tile        ask boxes of nodes and groups, then edge functions and depth; what is left
//!                     meets the accepting test
//! ```
//!
//! **Source.** L. Szecsi, "The Hierarchical Ray Engine", WSCG 2006 (primary visibility by scan
//! conversion over tiles of rays); J. Pineda, "A Parallel Algorithm for Polygon Rasterization",
//! SIGGRAPH 1988 (edge functions); N. Greene, M. Kass, G. Miller, "Hierarchical Z-Buffer
//! Visibility", SIGGRAPH 1993; S. Molnar, M. Cox, D. Ellsworth, H. Fuchs, "A Sorting
//! Classification of Parallel Rendering", CG&A 1994 (sort-middle).
//!
//! **Departures.** Points lie anywhere, not on a raster, so the pyramid is one of boxes with
//! sixteen branches. Nothing that is rasterised decides: edge functions are widened until they
//! keep all that the accepting test may accept.
//!
//! **Invariants.** See [`face`](rayflock_geom::simd::face),
//! [`face_triangle`](rayflock_geom::simd::face_triangle) and
//! [`point_boxes`](rayflock_geom::simd::point_boxes). A batch with a ray that looks behind its
//! origin, or that has no place on any face, is not taken.
//!
//! **Cost.** One pass over the rays and one over the triangles for each face; for triangles in
//! reach 128 bytes, and a box test for each level of the pyramid. 16 bytes a ray, 16 more where
//! they are sorted; one kilobyte for sixteen rays of a tile at work.

mod faces;
mod occupancy;
mod point_tiles;
mod ray_columns;
mod sort_points;
mod stream_triangles;
mod trace_tile;

use rayflock_geom::simd::face::{Face, FaceKind};
use rayflock_geom::simd::point_boxes::PointBox;
use rayflock_geom::simd::{LANES, Simd, SimdBase, SimdLevel, SimdMask, dispatch, f32x16};
use rayflock_geom::{RayBatch, RayOrder};
use rayon::prelude::*;
use tracing::debug_span;

use self::faces::Faces;
use self::point_tiles::FaceTiles;
use self::ray_columns::RayColumns;
use self::sort_points::PointSorter;
use self::stream_triangles::{Chunk, Share};
use self::trace_tile::{LARGEST_TILE, TileTracer, TileWork};
use super::arrange::{Arrangement, NO_RAY};
use crate::TraceStats;
use crate::answers::Answers;
use crate::packet::{Nearest, Question};
use crate::primitives::PrimitiveTable;
use crate::scratch::Scratch;

/// Tiles wanted for each thread, so that all finish at about the same time.
const TILES_PER_THREAD: usize = 8;

/// Shares of the triangles wanted for each thread.
const SHARES_PER_THREAD: usize = 4;

/// Where the boxes around each sixteen rays cover the face more often than this, the caller's
/// hint says little about places on the face.
const LOOSEST: f32 = 2.0;

/// Groups of sixteen rays that are asked for that.
const GROUP_SAMPLE: usize = 256;

/// Triangles a ray from which on it pays to ask whether any ray is near.
const TRIANGLES_PER_RAY: usize = 3;

/// Blocks of triangles in the smallest share.
const SMALLEST_SHARE: usize = 64;

/// Traces batches of rays that share an origin or a direction.
#[derive(Debug, Default)]
pub(super) struct PointTracer {
    faces: Faces,
    sorter: PointSorter,
    is_sorted: bool,
    tiles: Vec<FaceTiles>,
    /// One for each tile of all faces.
    boxes: Vec<PointBox>,
    chunks: Vec<Chunk>,
    answers: Answers,
    /// Tracers of tasks that are not running.
    tracers: Scratch<TileTracer>,
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

/// What is known of a tile, or of several.
#[derive(Clone, Copy)]
struct TileBound {
    bound: PointBox,
    /// The largest distance of an origin from the face's center.
    reach: f32,
    invalid_count: u64,
    /// The areas of the boxes around each sixteen rays.
    group_area: f32,
    /// Whether a ray has no place on the face or looks behind its origin.
    is_lost: bool,
}

impl PointTracer {
    /// Answers a batch; `None` if it is not of the kind that lies on faces.
    pub(super) fn trace(
        &mut self,
        work: &PointWork<'_>,
        arrangement: &mut Arrangement,
    ) -> Option<TraceStats> {
        let rays = work.rays;
        if rays.t_min().uniform().is_some_and(|t_min| t_min < 0.0) || !self.faces.choose(rays) {
            return None;
        }
        self.answers.begin(rays.len(), work.question);
        if rays.is_empty() {
            return Some(TraceStats::default());
        }
        let tile_len = tile_len(rays.len());
        let invalid_rays = self.arrange(work, arrangement, tile_len)?;
        let stats = TraceStats { rays: rays.len() as u64, invalid_rays, ..TraceStats::default() };
        self.note_rays(work, arrangement, tile_len);
        let streamed = self.stream(work);
        let ray_idx = if self.is_sorted { &self.sorter.ray_idx } else { &arrangement.ray_idx };
        if self.is_sorted {
            self.sorter.left_out().for_each(|ray_idx| self.answers.set_none(ray_idx as usize));
        }
        Some(stats + streamed + self.trace_tiles(work, tile_len, ray_idx))
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

    /// Brings rays into tiles and bounds these. Returns the number of rays that are not valid.
    fn arrange(
        &mut self,
        work: &PointWork<'_>,
        arrangement: &mut Arrangement,
        tile_len: usize,
    ) -> Option<u64> {
        let _span = debug_span!("arrange_points").entered();
        let is_hinted = matches!(work.rays.order(), RayOrder::Image { .. } | RayOrder::Coherent);
        if is_hinted && self.faces.faces.len() == 1 {
            arrangement.assign(work.rays);
            self.is_sorted = false;
            if self.is_tight(work, &arrangement.ray_idx) {
                let one = self.bound_tiles(work, tile_len, &arrangement.ray_idx, &[]);
                if !one.is_lost {
                    return Some(one.invalid_count);
                }
            }
        }
        self.is_sorted = true;
        let mut sorted = self.sorter.sort(work.simd, work.rays, &self.faces.faces, tile_len);
        if sorted.1 && !self.faces.is_parallel() && self.faces.faces.len() == 1 {
            self.faces.choose_cube(self.faces.faces[0].center);
            sorted = self.sorter.sort(work.simd, work.rays, &self.faces.faces, tile_len);
        }
        let (invalid_count, is_lost) = sorted;
        if is_lost {
            return None;
        }
        let sorter = std::mem::take(&mut self.sorter);
        let all = self.bound_tiles(work, tile_len, &sorter.ray_idx, &sorter.tile_faces);
        self.sorter = sorter;
        (!all.is_lost).then_some(invalid_count)
    }

    /// Whether, going by a sample, sixteen neighbours of the order are close on the only face.
    fn is_tight(&self, work: &PointWork<'_>, ray_idx: &[u32]) -> bool {
        let face = &self.faces.faces[0];
        let step = ray_idx.len().div_ceil(LANES * GROUP_SAMPLE).max(1);
        let mut all = TileBound::NONE;
        for group in ray_idx.chunks(LANES).step_by(step) {
            all = all.join(dispatch!(work.simd.level(), simd => {
                bound_tile(simd, work, face, group)
            }));
        }
        !all.is_lost && all.group_area * step as f32 <= LOOSEST * all.bound.area()
    }

    /// Bounds tiles and groups of tiles; without `tile_faces` all tiles are on the only face.
    fn bound_tiles(
        &mut self,
        work: &PointWork<'_>,
        tile_len: usize,
        ray_idx: &[u32],
        tile_faces: &[u32],
    ) -> TileBound {
        let _span = debug_span!("bound_tiles").entered();
        self.boxes.clear();
        self.boxes.resize(ray_idx.len().div_ceil(tile_len), PointBox::EMPTY);
        let faces = &self.faces.faces;
        let tiles = self.boxes.par_iter_mut().zip(ray_idx.par_chunks(tile_len)).enumerate();
        let bounds = tiles.map(|(tile_idx, (place, ray_idx))| {
            let face = &faces[tile_faces.get(tile_idx).copied().unwrap_or(0) as usize];
            let tile = dispatch!(work.simd.level(), simd => bound_tile(simd, work, face, ray_idx));
            *place = tile.bound;
            tile
        });
        let all = bounds.reduce(|| TileBound::NONE, TileBound::join);

        // Hand each face its tiles.
        self.tiles.truncate(faces.len());
        let mut first_tile = 0;
        for (face_idx, face) in faces.iter().enumerate() {
            let mut face = *face;
            if let FaceKind::Parallel { reach } = &mut face.kind {
                *reach = all.reach;
            }
            if self.tiles.len() <= face_idx {
                self.tiles.push(FaceTiles::new(face));
            }
            let is_here = |tile_idx: usize| match tile_faces.get(tile_idx) {
                Some(&other) => other as usize == face_idx,
                None => face_idx == 0 && tile_faces.is_empty(),
            };
            let end = (first_tile..self.boxes.len()).find(|&idx| !is_here(idx));
            let end = end.unwrap_or(self.boxes.len());
            self.tiles[face_idx].assign(face, first_tile, &self.boxes[first_tile..end]);
            first_tile = end;
        }
        all
    }

    /// Notes where rays are on the faces, if there are enough triangles to ask for it.
    fn note_rays(&mut self, work: &PointWork<'_>, arrangement: &Arrangement, tile_len: usize) {
        let slot_count = work.table.triangle_block_count() * LANES;
        let is_worth_it = slot_count >= TRIANGLES_PER_RAY * work.rays.len();
        for face in &mut self.tiles {
            face.has_occupancy = is_worth_it && !face.bound.is_empty();
            if face.has_occupancy {
                face.occupancy.clear(&face.bound, work.rays.len());
            }
        }
        if !is_worth_it {
            return;
        }
        let _span = debug_span!("note_rays").entered();
        let ray_idx = if self.is_sorted { &self.sorter.ray_idx } else { &arrangement.ray_idx };
        let tile_faces = if self.is_sorted { &self.sorter.tile_faces[..] } else { &[] };
        ray_idx.par_chunks(tile_len).enumerate().for_each(|(tile_idx, ray_idx)| {
            let face = &self.tiles[tile_faces.get(tile_idx).copied().unwrap_or(0) as usize];
            dispatch!(work.simd.level(), simd => note_tile(simd, work.rays, face, ray_idx));
        });
        self.tiles.par_iter_mut().filter(|face| face.has_occupancy).for_each(|face| {
            face.occupancy.finish();
        });
    }

    /// Streams all primitives, in parallel.
    fn stream(&mut self, work: &PointWork<'_>) -> TraceStats {
        let _span = debug_span!("stream_triangles").entered();
        let most = SHARES_PER_THREAD * rayon::current_num_threads();
        let part_count = (work.table.block_count() / SMALLEST_SHARE).clamp(1, most);
        if self.chunks.len() != part_count {
            self.chunks.resize_with(part_count, Chunk::default);
        }
        let (faces, tile_count) = (&self.tiles, self.boxes.len());
        let chunks = self.chunks.par_iter_mut().enumerate();
        let counted = chunks.map(|(part_idx, chunk)| {
            let share = Share { part_idx, part_count };
            dispatch!(work.simd.level(), simd => {
                chunk.stream(simd, work.table, faces, tile_count, share)
            })
        });
        counted.reduce(TraceStats::default, |a, b| a + b)
    }

    fn trace_tiles(&self, work: &PointWork<'_>, tile_len: usize, ray_idx: &[u32]) -> TraceStats {
        let _span = debug_span!("trace_tiles").entered();
        let PointWork { table, rays, question, t_bounds, .. } = *work;
        let tile_work = TileWork { table, rays, chunks: &self.chunks, question, t_bounds };
        let tile_faces = if self.is_sorted { &self.sorter.tile_faces[..] } else { &[] };
        let tiles = ray_idx.par_chunks(tile_len).enumerate();
        let counted = tiles.map(|(tile_idx, ray_idx)| {
            let face_idx = tile_faces.get(tile_idx).copied().unwrap_or(0);
            let face = &self.tiles[face_idx as usize].face;
            let mut tracer = self.tracers.take();
            let stats = dispatch!(work.simd.level(), simd => {
                tracer.trace(simd, &tile_work, face, tile_idx, ray_idx, &self.answers)
            });
            self.tracers.give_back(tracer);
            stats
        });
        counted.reduce(TraceStats::default, |a, b| a + b)
    }

    /// Bytes held.
    pub(super) fn memory_usage(&self) -> usize {
        self.sorter.memory_usage()
            + self.faces.faces.capacity() * size_of::<Face>()
            + self.tiles.iter().map(FaceTiles::memory_usage).sum::<usize>()
            + self.boxes.capacity() * size_of::<PointBox>()
            + self.chunks.iter().map(Chunk::memory_usage).sum::<usize>()
            + self.answers.memory_usage()
            + self.tracers.sum(TileTracer::memory_usage)
    }
}

impl TileBound {
    const NONE: Self = Self {
        bound: PointBox::EMPTY,
        reach: 0.0,
        invalid_count: 0,
        group_area: 0.0,
        is_lost: false,
    };

    fn join(self, other: Self) -> Self {
        Self {
            bound: self.bound.union(&other.bound),
            reach: self.reach.max(other.reach),
            invalid_count: self.invalid_count + other.invalid_count,
            group_area: self.group_area + other.group_area,
            is_lost: self.is_lost | other.is_lost,
        }
    }
}

/// Rays in a tile: a multiple of 256, enough tiles to keep all threads busy.
fn tile_len(ray_count: usize) -> usize {
    let wanted = TILES_PER_THREAD * rayon::current_num_threads();
    (ray_count / wanted).next_multiple_of(LANES * LANES).clamp(LANES * LANES, LARGEST_TILE)
}

#[inline(always)]
fn bound_tile<S: Simd>(simd: S, work: &PointWork<'_>, face: &Face, ray_idx: &[u32]) -> TileBound {
    let mut columns = RayColumns::EMPTY;
    let mut all = TileBound::NONE;
    for ray_idx in ray_idx.chunks(LANES) {
        if ray_idx.iter().all(|&ray_idx| ray_idx == NO_RAY) {
            continue;
        }
        columns.gather(simd, work.rays, ray_idx);
        let states = columns.states(simd);
        let points = face.project_rays(simd, columns.origin(simd), columns.direction(simd));
        let limit = face.limit(simd, &points, f32x16::from_slice(simd, &columns.t_max));
        let begin = face.begin(simd, &points, f32x16::from_slice(simd, &columns.t_min));
        let extent = points.x.abs() + points.y.abs() + points.start.abs();
        let around = [points.x, points.y, limit, begin, extent];
        let (bound, most) = PointBox::around_with_most(simd, around, states.active);
        let is_lost = states.looks_back | (states.active & !points.on_face).any_true();
        let reach = most.max(0.0);
        let invalid_count = states.invalid_count;
        let group_area = bound.area();
        all = all.join(TileBound { bound, reach, invalid_count, group_area, is_lost });
    }
    all
}

#[inline(always)]
fn note_tile<S: Simd>(simd: S, rays: &RayBatch<'_>, face: &FaceTiles, ray_idx: &[u32]) {
    let mut columns = RayColumns::EMPTY;
    for ray_idx in ray_idx.chunks(LANES) {
        columns.gather(simd, rays, ray_idx);
        let active = columns.states(simd).active;
        let points = face.face.project_rays(simd, columns.origin(simd), columns.direction(simd));
        face.occupancy.note(simd, points.x, points.y, active);
    }
}
