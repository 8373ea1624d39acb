//! What no engine can undercut: reads what has to be read, writes what has to be written, and
//! answers nothing.
//!
//! A frame costs every engine at least the vertices of what changed, the columns of the rays, and
//! the columns of the answers, once each through all cores; and for the closest hit of a ray the
//! accepting test that all our engines share, sixteen rays at once at best. Another engine's total
//! divided by this one's is a bound on how many times faster than that engine any of ours can be on
//! the machine, where all rays hit something.
//!
//! **Departures.** Every ray is said to hit the same, so answers are not compared, and
//! [`EngineSpec::create`](crate::EngineSpec::create) refuses to make it. Index lists are not read.

use std::hint::black_box;

use glam::Vec3;
use rayflock::engine::{CommitStats, EngineError, RayEngine, TraceStats};
use rayflock::geom::simd::ray_triangle::{RayPacket, intersect_packet};
use rayflock::geom::simd::{LANES, Simd, SimdLevel, SimdMask, dispatch, mask32x16};
use rayflock::geom::{
    Column, ColumnElement, FrameChanges, Geometry, GeometryObject, Hits, RayBatch,
};
use rayon::prelude::*;

/// Values that one task reads or writes.
const CHUNK: usize = 1 << 13;

/// Reads and writes what every engine has to.
#[derive(Debug, Default)]
pub(crate) struct FloorEngine {
    geometry: Geometry,
    level: SimdLevel,
}

impl FloorEngine {
    /// Whether an object is as it was in the frame before.
    fn has_rested(&self, object: &GeometryObject) -> bool {
        self.geometry.object(object.id).is_some_and(|before| before.is_same(object))
    }
}

impl RayEngine for FloorEngine {
    fn name(&self) -> &str {
        "floor"
    }

    fn commit(
        &mut self,
        geometry: &Geometry,
        _changes: &FrameChanges,
    ) -> Result<CommitStats, EngineError> {
        for object in geometry.objects().iter().filter(|object| !self.has_rested(object)) {
            read_vertices(object.shape.vertices());
        }
        self.geometry = geometry.clone();
        Ok(CommitStats { prim_count: geometry.prim_count(), ..CommitStats::default() })
    }

    fn closest_hit(&mut self, rays: &RayBatch<'_>, hits: &mut Hits<'_>) -> TraceStats {
        test_rays(self.level, rays);
        write(hits.t, 1.0);
        hits.uv.as_deref_mut().into_iter().for_each(|uv| write(uv, [0.5; 2]));
        let ids = [&mut hits.object_id, &mut hits.prim_id];
        ids.into_iter().filter_map(|ids| ids.as_deref_mut()).for_each(|ids| write(ids, 0));
        TraceStats::default()
    }

    fn occluded(&mut self, rays: &RayBatch<'_>, occluded: &mut [bool]) -> TraceStats {
        read_rays(rays);
        write(occluded, true);
        TraceStats::default()
    }

    fn memory_usage(&self) -> usize {
        0
    }
}

/// Tests each ray once, whole vectors of them at a time.
fn test_rays(level: SimdLevel, rays: &RayBatch<'_>) {
    let tasks = (0..rays.len() / LANES).into_par_iter().with_min_len(CHUNK / LANES);
    let test = |vector: usize| dispatch!(level.level(), simd => test_vector(simd, rays, vector));
    black_box(tasks.map(test).reduce(|| 0, |a, b| a ^ b));
}

#[inline(always)]
fn test_vector<S: Simd>(simd: S, rays: &RayBatch<'_>, vector: usize) -> u64 {
    let first_ray = vector * LANES;
    let axes = |column: &Column<'_, Vec3>| column.axes(simd, first_ray);
    let times = [rays.t_min(), rays.t_max()];
    let interval = times.map(|column| column.vector(simd, first_ray));
    let mut packet = RayPacket::EMPTY;
    packet.fill(simd, axes(rays.origin()), axes(rays.direction()), interval);
    let all = mask32x16::splat(simd, true);
    intersect_packet(simd, &packet, &[Vec3::ZERO, Vec3::X, Vec3::Y], all).accepted.to_bitmask()
}

fn read_rays(rays: &RayBatch<'_>) {
    read_column(rays.origin());
    read_column(rays.direction());
    read_column(rays.t_min());
    read_column(rays.t_max());
}

fn read_vertices(vertices: &[Vec3]) {
    let bits = |vertex: &Vec3| vertex.to_array().map(f32::to_bits);
    let sum = |some: &[Vec3]| some.iter().map(bits).fold(0, |sum, [x, y, z]| sum ^ x ^ y ^ z);
    black_box(vertices.par_chunks(CHUNK).map(sum).reduce(|| 0, |a, b| a ^ b));
}

/// Reads all values of a column.
fn read_column<T: ColumnElement<Scalar = f32>>(column: &Column<'_, T>) {
    let Column::PerRay { values, .. } = column else { return };
    let sum = |some: &[f32]| some.iter().fold(0, |sum, value| sum ^ value.to_bits());
    black_box(values.par_chunks(CHUNK).map(sum).reduce(|| 0, |a, b| a ^ b));
}

fn write<T: Copy + Send + Sync>(column: &mut [T], value: T) {
    column.par_chunks_mut(CHUNK).for_each(|some| some.fill(value));
}
