//! Builds the ray tree bottom-up: cones around the rays of a tile, then around cones.

use glam::Vec3;
use rayflock_geom::simd::LANES;
use rayflock_geom::simd::cone_sphere::Reach;
use rayflock_geom::{Ray, RayBatch, RayState, Sphere, SphereCone};
use rayon::prelude::*;
use tracing::debug_span;

use super::arrange::{Arrangement, NO_RAY};
use super::ray_tree::{RayNode, RayTree};
use crate::TraceStats;
use crate::packet::{direction_length, far_distance, unit_direction};

/// Tiles that one task bounds at least.
const TILES_PER_TASK: usize = 256;

/// The bits of a code that tell siblings apart: fanout 4.
const CODE_BITS: u32 = 2;

/// What no ray can hit.
const NO_REACH: Reach = Reach { near: f32::INFINITY, far: f32::NEG_INFINITY };

impl RayTree {
    /// Builds the tree over all tiles of the arrangement. Counts rays, and those not valid.
    pub(super) fn build(
        &mut self,
        batch: &RayBatch<'_>,
        arrangement: &Arrangement,
        t_bound: &(impl Fn(usize) -> f32 + Sync),
    ) -> TraceStats {
        let _span = debug_span!("build_tree").entered();
        self.clear();
        let (_, tiles) = self.push_level();
        let tile_count = arrangement.codes.len();
        tiles.resize(tile_count, RayNode::EMPTY);
        let tasks = tiles.par_iter_mut().zip(arrangement.ray_idx.par_chunks(LANES));
        let invalid_rays = tasks
            .enumerate()
            .with_min_len(TILES_PER_TASK)
            .map(|(tile_idx, (tile, ray_idx))| {
                let (node, invalid_rays) = bound_tile(batch, ray_idx, t_bound);
                *tile = RayNode { first_tile: tile_idx as u32, ..node };
                invalid_rays
            })
            .sum();

        // Group nodes whose codes agree but for the last bits, until one is left.
        let mut shift = 0;
        while self.nodes(self.level_count() - 1).len() > 1 {
            shift += CODE_BITS;
            let (below, level) = self.push_level();
            group_nodes(below, &arrangement.codes, shift, level);
            level
                .par_iter_mut()
                .with_min_len(TILES_PER_TASK)
                .for_each(|node| bound_node(node, below));
        }
        TraceStats { rays: batch.len() as u64, invalid_rays, ..TraceStats::default() }
    }
}

impl RayNode {
    /// A node without rays or children.
    const EMPTY: Self = Self {
        cone: SphereCone {
            origin: Sphere::new(Vec3::ZERO, 0.0),
            axis: Vec3::Z,
            cos: 1.0,
            sin: 0.0,
        },
        reach: NO_REACH,
        first_tile: 0,
        first_child: 0,
        child_count: 0,
    };
}

/// Bounds the rays of a tile; also counts those that are not valid.
fn bound_tile(
    batch: &RayBatch<'_>,
    ray_idx: &[u32],
    t_bound: &impl Fn(usize) -> f32,
) -> (RayNode, u64) {
    let mut active = [(Vec3::ZERO, Vec3::ZERO); LANES];
    let (mut count, mut invalid_rays) = (0, 0);
    let (mut reach, mut backward) = (NO_REACH, false);
    for &ray_idx in ray_idx.iter().filter(|&&ray_idx| ray_idx != NO_RAY) {
        let ray = batch.ray(ray_idx as usize);
        match ray.state() {
            RayState::Active => {
                active[count] = (ray.origin, unit_direction(&ray));
                count += 1;
                backward |= ray.t_min < 0.0;
                let t_max = ray.t_max.min(t_bound(ray_idx as usize));
                reach = union(reach, reach_of_ray(&Ray { t_max, ..ray }));
            }
            RayState::Inactive => {}
            RayState::Invalid => invalid_rays += 1,
        }
    }
    let cone = SphereCone::around_rays(active[..count].iter().copied());
    let cone = forward_only(cone, backward);
    (RayNode { cone, reach, ..RayNode::EMPTY }, invalid_rays)
}

/// Bounds a single active ray.
pub(super) fn bound_ray(ray: &Ray) -> (SphereCone, Reach) {
    let cone = SphereCone::around_ray(ray.origin, unit_direction(ray));
    (forward_only(cone, ray.t_min < 0.0), reach_of_ray(ray))
}

/// A cone that says nothing about what lies behind the origins, if a ray looks `backward` too.
fn forward_only(cone: SphereCone, backward: bool) -> SphereCone {
    if backward { SphereCone { cos: 0.0, sin: 0.0, ..cone } } else { cone }
}

/// The distances of a ray's interval, enlarged for rounding.
fn reach_of_ray(ray: &Ray) -> Reach {
    let length = direction_length(ray);
    let near = if ray.t_min > 0.0 { ray.t_min * length * (1.0 - 1e-6) } else { 0.0 };
    Reach { near, far: far_distance(ray.t_min, ray.t_max, length) }
}

fn union(a: Reach, b: Reach) -> Reach {
    Reach { near: a.near.min(b.near), far: a.far.max(b.far) }
}

/// Makes a node of each run of nodes below whose codes agree above `shift`.
fn group_nodes(below: &[RayNode], codes: &[u32], shift: u32, level: &mut Vec<RayNode>) {
    let prefix = |node: &RayNode| codes[node.first_tile as usize].checked_shr(shift).unwrap_or(0);
    let mut first_child = 0;
    for siblings in below.chunk_by(|a, b| prefix(a) == prefix(b)) {
        level.push(RayNode {
            first_tile: siblings[0].first_tile,
            first_child,
            child_count: siblings.len() as u32,
            ..RayNode::EMPTY
        });
        first_child += siblings.len() as u32;
    }
}

/// Bounds the children of a node.
fn bound_node(node: &mut RayNode, below: &[RayNode]) {
    let mut cones = [node.cone; 1 << CODE_BITS];
    let mut count = 0;
    for child in below[node.children()].iter().filter(|child| child.is_active()) {
        cones[count] = child.cone;
        count += 1;
        node.reach = union(node.reach, child.reach);
    }
    node.cone = SphereCone::around_cones(&cones[..count]);
}
