//! Brings batches of rays into the layout of Embree's users, and hits back.
//!
//! Embree's own users make their rays in that layout in the first place, so this is conversion. A
//! block of sixteen rays keeps only what differs from ray to ray; what is the same for all stays
//! in the packet on the stack of whoever traces.

use glam::Vec3;
use rayflock::geom::{Hit, Hits, Ray, RayBatch, RayState};
use rayon::prelude::*;

use super::layout::{self, Bounds, INVALID_ID, WIDTH};
use super::world::World;
use crate::peer::behind;

/// Rays a task.
pub(super) const CHUNK: usize = 1024;

/// Sixteen rays; those that are not traced have an empty interval.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(super) struct RayBlock {
    /// Origins, by axis.
    pub(super) org: [[f32; WIDTH]; 3],
    /// Directions, by axis.
    pub(super) dir: [[f32; WIDTH]; 3],
    /// Starts of the intervals.
    pub(super) t_near: [f32; WIDTH],
    /// Ends of the intervals.
    pub(super) t_far: [f32; WIDTH],
    /// Which geometries are seen.
    pub(super) mask: [u32; WIDTH],
}

/// What one ray found.
#[derive(Clone, Copy, Debug)]
pub(super) struct Found {
    /// Distance.
    pub(super) t: f32,
    /// Barycentric coordinate of vertex 1.
    pub(super) u: f32,
    /// Barycentric coordinate of vertex 2.
    pub(super) v: f32,
    /// The geometry, or [`INVALID_ID`].
    pub(super) geom_id: u32,
    /// The primitive.
    pub(super) prim_id: u32,
}

/// What sixteen rays found.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(super) struct FoundBlock {
    /// Distances.
    pub(super) t: [f32; WIDTH],
    /// Barycentric coordinates of vertex 1.
    pub(super) u: [f32; WIDTH],
    /// Barycentric coordinates of vertex 2.
    pub(super) v: [f32; WIDTH],
    /// Geometries, or [`INVALID_ID`].
    pub(super) geom_id: [u32; WIDTH],
    /// Primitives.
    pub(super) prim_id: [u32; WIDTH],
}

impl RayBlock {
    /// Rays that are not traced.
    const IDLE: Self = Self {
        org: [[0.0; WIDTH]; 3],
        dir: [[1.0; WIDTH]; 3],
        t_near: [1.0; WIDTH],
        t_far: [0.0; WIDTH],
        mask: [0; WIDTH],
    };

    fn set(&mut self, lane: usize, ray: &layout::Ray) {
        for axis in 0..3 {
            self.org[axis][lane] = ray.org[axis];
            self.dir[axis][lane] = ray.dir[axis];
        }
        self.t_near[lane] = ray.t_near;
        self.t_far[lane] = ray.t_far;
        self.mask[lane] = ray.mask;
    }
}

/// A ray that is not traced.
const IDLE: layout::Ray = layout::Ray {
    org: [0.0; 3],
    t_near: 1.0,
    dir: [1.0; 3],
    time: 0.0,
    t_far: 0.0,
    mask: 0,
    id: 0,
    flags: 0,
};

impl Found {
    /// Nothing.
    pub(super) const NOTHING: Self =
        Self { t: 0.0, u: 0.0, v: 0.0, geom_id: INVALID_ID, prim_id: INVALID_ID };
}

impl FoundBlock {
    /// Nothing.
    pub(super) const NOTHING: Self = Self {
        t: [0.0; WIDTH],
        u: [0.0; WIDTH],
        v: [0.0; WIDTH],
        geom_id: [INVALID_ID; WIDTH],
        prim_id: [INVALID_ID; WIDTH],
    };

    /// What the ray in `lane` found.
    pub(super) fn get(&self, lane: usize) -> Found {
        Found {
            t: self.t[lane],
            u: self.u[lane],
            v: self.v[lane],
            geom_id: self.geom_id[lane],
            prim_id: self.prim_id[lane],
        }
    }
}

/// A batch to be brought into Embree's layout.
#[derive(Clone, Copy, Debug)]
pub(super) struct Batch<'a> {
    /// The rays.
    pub(super) rays: &'a RayBatch<'a>,
    /// Hits further than this are of no interest, by ray.
    pub(super) t_bound: Option<&'a [f32]>,
    /// The box around the frame.
    pub(super) bounds: Bounds,
}

impl Batch<'_> {
    /// Fills `rays` with the batch; returns how many are invalid.
    pub(super) fn to_singles(self, rays: &mut Vec<layout::Ray>) -> u64 {
        rays.resize(self.rays.len(), IDLE);
        let chunks = rays.par_chunks_mut(CHUNK).enumerate();
        let counts = chunks.map(|(chunk_idx, chunk)| {
            let mut invalid_count = 0;
            for (ray_idx, ray) in (CHUNK * chunk_idx..).zip(chunk) {
                let (converted, state) = self.convert(ray_idx);
                *ray = converted;
                invalid_count += u64::from(state == RayState::Invalid);
            }
            invalid_count
        });
        counts.sum()
    }

    /// Fills `blocks` with the batch; returns how many rays are invalid.
    pub(super) fn to_blocks(self, blocks: &mut Vec<RayBlock>) -> u64 {
        blocks.resize(self.rays.len().div_ceil(WIDTH), RayBlock::IDLE);
        let chunks = blocks.par_chunks_mut(CHUNK / WIDTH).enumerate();
        let counts = chunks.map(|(chunk_idx, chunk)| {
            let mut invalid_count = 0;
            for (block_idx, block) in chunk.iter_mut().enumerate() {
                *block = RayBlock::IDLE;
                let first = CHUNK * chunk_idx + WIDTH * block_idx;
                for lane in 0..WIDTH.min(self.rays.len() - first) {
                    let (converted, state) = self.convert(first + lane);
                    block.set(lane, &converted);
                    invalid_count += u64::from(state == RayState::Invalid);
                }
            }
            invalid_count
        });
        counts.sum()
    }

    #[inline(always)]
    fn convert(&self, ray_idx: usize) -> (layout::Ray, RayState) {
        let ray = self.rays.ray(ray_idx);
        let state = ray.state();
        if state != RayState::Active || ray.t_min == f32::INFINITY {
            return (IDLE, state);
        }
        let t_max = self.t_bound.map_or(ray.t_max, |t_bound| ray.t_max.min(t_bound[ray_idx]));
        let ray = behind::moved(&Ray { t_max, ..ray }, self.shift(&ray));
        let converted = layout::Ray {
            org: ray.origin.to_array(),
            t_near: ray.t_min,
            dir: ray.direction.to_array(),
            t_far: ray.t_max,
            mask: ray.mask,
            ..IDLE
        };
        (converted, state)
    }

    fn shift(&self, ray: &Ray) -> f32 {
        let [lower, upper] = [self.bounds.lower, self.bounds.upper];
        let corner = |[x, y, z, _]: [f32; 4]| Vec3::new(x, y, z);
        behind::shift(ray, corner(lower), corner(upper))
    }

    /// Offers what rays found to the caller's columns.
    pub(super) fn offer(
        self,
        world: &World,
        found: impl Iterator<Item = Found>,
        hits: &mut Hits<'_>,
    ) {
        for (ray_idx, found) in (0..self.rays.len()).zip(found) {
            let prim = world.prim(found.geom_id, found.prim_id);
            let Some((object_id, prim_id)) = prim.filter(|_| found.geom_id != INVALID_ID) else {
                continue;
            };
            let is_sphere = world.is_sphere(found.geom_id);
            let [u, v] = if is_sphere { [0.0; 2] } else { [found.u, found.v] };
            let t = found.t + self.shift(&self.rays.ray(ray_idx));
            hits.offer(ray_idx, &Hit { t, u, v, object_id, prim_id });
        }
    }
}
