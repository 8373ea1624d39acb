//! The library obvhs as an engine: a hierarchy over the geometry in pure Rust, built anew each
//! frame.
//!
//! The builder is PLOC at its quickest with a little reinsertion, turned into eight-wide
//! compressed nodes. Of the library's quick presets, with and without compression, that took the
//! least time for build and trace together, at 16K to 1M triangles and 64K rays; plain binary
//! nodes are quicker to build and two to five times slower to trace.
//!
//! **Source.** The crate `obvhs` of G. DeVries; D. Meister, J. Bittner, "Parallel Locally-Ordered
//! Clustering for Bounding Volume Hierarchy Construction", TVCG 2018; H. Ylitie, T. Karras, S.
//! Laine, "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs", HPG 2017.
//!
//! **Departures** from what our engines answer: triangles only, one mask for all objects; `t`, `u`
//! and `v` differ within rounding; edges are not watertight; the interval is open at `t_max`; ties
//! are broken by chance.

use std::time::Instant;

use glam::{Vec3A, Vec4};
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
use obvhs::cwbvh::CwBvh;
use obvhs::cwbvh::bvh2_to_cwbvh::bvh2_to_cwbvh;
use obvhs::ploc::PlocBuilder;
use obvhs::ray::{Ray, RayHit};
use obvhs::rt_triangle::RtTriangle;
use obvhs::triangle::Triangle;
use rayflock::engine::{CommitStats, EngineError, RayEngine, TraceStats};
use rayflock::geom::{
    self, FrameChanges, Geometry, GeometryObject, Hit, Hits, NO_ID, ObjectId, PrimId, RayBatch,
    RayState, is_degenerate_triangle, transform_point,
};
use rayon::prelude::*;

use super::behind;

const NAME: &str = "obvhs";
/// How trees are built.
const PARAMS: BvhBuildParams = BvhBuildParams::very_fast_build();
/// The most triangles that a compressed leaf holds.
const LEAF_MAX: u32 = 3;
/// Rays a task.
const CHUNK: usize = 1024;

/// Traces with obvhs.
#[derive(Default)]
pub struct ObvhsEngine {
    builder: PlocBuilder,
    /// In world space, as they came.
    triangles: Vec<Triangle>,
    /// What each of them is.
    ids: Vec<(ObjectId, PrimId)>,
    bvh: CwBvh,
    /// In the order of the leaves.
    leaves: Vec<RtTriangle>,
    rays: Vec<Ray>,
    /// Distance, `u`, `v`; and the leaf, or [`NO_ID`].
    found: Vec<(Vec4, u32)>,
}

impl ObvhsEngine {
    /// An engine with an empty frame.
    pub fn new() -> Self {
        Self::default()
    }

    /// Gathers the triangles that can be hit.
    fn gather(&mut self, geometry: &Geometry) -> CommitStats {
        self.triangles.clear();
        self.ids.clear();
        let prim_count = geometry.prim_count();
        for object in geometry.objects() {
            for triangle_idx in 0..object.shape.triangles().len() {
                let corners = object.shape.corners(triangle_idx);
                let place = |m| corners.map(|corner| transform_point(m, corner));
                let corners = object.world_from_object.as_ref().map_or(corners, place);
                if !is_degenerate_triangle(corners) {
                    let [v0, v1, v2] = corners.map(Vec3A::from);
                    self.triangles.push(Triangle { v0, v1, v2 });
                    self.ids.push((object.id, PrimId(triangle_idx as u32)));
                }
            }
        }
        CommitStats { prim_count, rewritten_count: prim_count, ..CommitStats::default() }
    }

    fn build(&mut self) {
        let indices = (0..self.triangles.len() as u32).collect();
        let mut bvh2 = self.builder.build(
            PARAMS.ploc_search_distance,
            &self.triangles,
            indices,
            PARAMS.sort_precision,
            PARAMS.search_depth_threshold,
        );
        ReinsertionOptimizer::default().run(&mut bvh2, PARAMS.reinsertion_batch_ratio, None);
        self.bvh = bvh2_to_cwbvh(&bvh2, PARAMS.max_prims_per_leaf.min(LEAF_MAX), true, false);
        let (indices, triangles) = (&self.bvh.primitive_indices, &self.triangles);
        let leaves = indices.par_iter().map(|&idx| RtTriangle::from(&triangles[idx as usize]));
        leaves.collect_into_vec(&mut self.leaves);
    }

    /// Brings the batch into the library's layout; returns how many rays are invalid. Rays that
    /// are not traced get an empty interval.
    fn convert(&mut self, rays: &RayBatch<'_>, t_bound: Option<&[f32]>) -> u64 {
        let (idle, bounds) = (Ray::new(Vec3A::ZERO, Vec3A::X, 1.0, 0.0), &self.bvh.total_aabb);
        let convert = |ray_idx: usize| {
            let ray = rays.ray(ray_idx);
            if ray.state() != RayState::Active || ray.mask == 0 {
                return idle;
            }
            let t_max = t_bound.map_or(ray.t_max, |t_bound| ray.t_max.min(t_bound[ray_idx]));
            let ray = behind::moved(&geom::Ray { t_max, ..ray }, shift(bounds, &ray));
            Ray::new(ray.origin.into(), ray.direction.into(), ray.t_min, ray.t_max)
        };
        (0..rays.len()).into_par_iter().map(convert).collect_into_vec(&mut self.rays);
        let is_invalid = |&ray_idx: &usize| rays.ray(ray_idx).state() == RayState::Invalid;
        (0..rays.len()).into_par_iter().filter(is_invalid).count() as u64
    }

    /// Finds the nearest hits.
    fn trace_closest(&mut self) {
        let (bvh, leaves) = (&self.bvh, &self.leaves);
        let chunks = self.rays.par_chunks(CHUNK).zip(self.found.par_chunks_mut(CHUNK));
        chunks.for_each(|(rays, found)| {
            for (ray, found) in rays.iter().zip(found) {
                let mut hit = RayHit::none();
                if ray.tmin <= ray.tmax && !leaves.is_empty() {
                    bvh.ray_traverse(*ray, &mut hit, |ray, leaf| leaves[leaf].intersect(ray));
                }
                let mut uv = glam::Vec2::ZERO;
                if hit.primitive_id != NO_ID {
                    uv = leaves[hit.primitive_id as usize].compute_barycentric(ray);
                }
                *found = (Vec4::new(hit.t, uv.x, uv.y, 0.0), hit.primitive_id);
            }
        });
    }

    /// Finds out whether anything is hit.
    fn trace_occluded(&self, occluded: &mut [bool]) {
        let (bvh, leaves) = (&self.bvh, &self.leaves);
        let chunks = self.rays.par_chunks(CHUNK).zip(occluded.par_chunks_mut(CHUNK));
        chunks.for_each(|(rays, occluded)| {
            for (ray, occluded) in rays.iter().zip(occluded) {
                let is_traced = ray.tmin <= ray.tmax && !leaves.is_empty();
                let misses =
                    |ray| bvh.ray_traverse_miss(ray, |ray, leaf| leaves[leaf].intersect(ray));
                *occluded = is_traced && !misses(*ray);
            }
        });
    }

    /// Offers what was found to the caller's columns.
    fn offer(&self, rays: &RayBatch<'_>, hits: &mut Hits<'_>) {
        for (ray_idx, &(found, leaf)) in self.found.iter().enumerate() {
            if leaf != NO_ID {
                let triangle = self.bvh.primitive_indices[leaf as usize];
                let (object_id, prim_id) = self.ids[triangle as usize];
                let [t, u, v, _] = found.to_array();
                let t = t + shift(&self.bvh.total_aabb, &rays.ray(ray_idx));
                hits.offer(ray_idx, &Hit { t, u, v, object_id, prim_id });
            }
        }
    }
}

/// How far a ray is moved; see [`behind`].
fn shift(bounds: &Aabb, ray: &geom::Ray) -> f32 {
    behind::shift(ray, bounds.min.into(), bounds.max.into())
}

/// What of an object the library cannot trace.
fn unsupported(object: &GeometryObject) -> Option<&'static str> {
    let shape = &object.shape;
    let what = [
        (!shape.spheres().is_empty(), "spheres"),
        (shape.user().is_some(), "user primitives"),
        (object.mask != u32::MAX, "masks"),
    ];
    what.into_iter().find(|(is_there, _)| *is_there).map(|(_, name)| name)
}

impl RayEngine for ObvhsEngine {
    fn name(&self) -> &str {
        NAME
    }

    fn commit(
        &mut self,
        geometry: &Geometry,
        _: &FrameChanges,
    ) -> Result<CommitStats, EngineError> {
        if let Some(what) = geometry.objects().iter().find_map(unsupported) {
            *self = Self::new();
            let (engine, what) = (NAME.to_owned(), what.to_owned());
            return Err(EngineError::Unsupported { engine, what });
        }
        let start = Instant::now();
        let stats = self.gather(geometry);
        let conversion_ns = nanoseconds_since(start);
        self.build();
        Ok(CommitStats { conversion_ns, ..stats })
    }

    fn closest_hit(&mut self, rays: &RayBatch<'_>, hits: &mut Hits<'_>) -> TraceStats {
        assert!(hits.has_len(rays.len()), "every column must have one entry for each ray");
        let start = Instant::now();
        let invalid_rays = self.convert(rays, Some(hits.t));
        self.found.resize(rays.len(), (Vec4::ZERO, NO_ID));
        let mut conversion_ns = nanoseconds_since(start);

        self.trace_closest();

        let start = Instant::now();
        self.offer(rays, hits);
        conversion_ns += nanoseconds_since(start);
        stats(rays, invalid_rays, conversion_ns)
    }

    fn occluded(&mut self, rays: &RayBatch<'_>, occluded: &mut [bool]) -> TraceStats {
        assert_eq!(occluded.len(), rays.len(), "there must be one answer for each ray");
        let start = Instant::now();
        let invalid_rays = self.convert(rays, None);
        let conversion_ns = nanoseconds_since(start);
        self.trace_occluded(occluded);
        stats(rays, invalid_rays, conversion_ns)
    }

    fn memory_usage(&self) -> usize {
        size_of_val(&self.triangles[..])
            + size_of_val(&self.ids[..])
            + size_of_val(&self.bvh.nodes[..])
            + size_of_val(&self.bvh.primitive_indices[..])
            + size_of_val(&self.leaves[..])
            + size_of_val(&self.rays[..])
            + size_of_val(&self.found[..])
    }
}

impl std::fmt::Debug for ObvhsEngine {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let count = self.triangles.len();
        f.debug_struct("ObvhsEngine").field("triangle_count", &count).finish_non_exhaustive()
    }
}

fn stats(rays: &RayBatch<'_>, invalid_rays: u64, conversion_ns: u64) -> TraceStats {
    TraceStats { rays: rays.len() as u64, invalid_rays, conversion_ns, ..TraceStats::default() }
}

fn nanoseconds_since(start: Instant) -> u64 {
    start.elapsed().as_nanos() as u64
}
