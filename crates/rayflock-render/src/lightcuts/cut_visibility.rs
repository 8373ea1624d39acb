//! What points see of the lights that speak for clusters: exactly, past spheres, or everything.

use std::fmt::Debug;

use glam::Vec3;
use rayflock_engine::RayEngine;
use rayflock_geom::RayOrder;
use rayflock_geom::simd::LANES;
use rayon::prelude::*;

use crate::occluders::{PointTile, SeenLight, SphereTree, TileSight};
use crate::stats::StageStats;
use crate::vpl::VisibilityStats;
use crate::vpl::shadow_segments::{ShadowSegments, Start};
use crate::wave::Shared;

/// Pairs that one task asks about past spheres.
const PAIRS_PER_TASK: usize = 1024;

/// A point and a light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CutPair {
    /// Off the surface by more than rounding.
    pub point: Vec3,
    /// Of the surface at the point.
    pub normal: Vec3,
    /// The light, or where the way to a distant one leaves the scene.
    pub light: SeenLight,
}

/// Answers what points see of lights, many pairs at once.
pub trait CutVisibility: Debug {
    /// Sets `shares[i]` to what the point of pair i sees of its light, from 0 to 1.
    /// `shares.len() == pairs.len()`. Pairs of a point follow each other.
    fn shares(&mut self, pairs: &[CutPair], shares: &mut [f32]) -> VisibilityStats;
}

/// Everything is seen.
#[derive(Clone, Copy, Debug, Default)]
pub struct Open;

impl CutVisibility for Open {
    fn shares(&mut self, pairs: &[CutPair], shares: &mut [f32]) -> VisibilityStats {
        shares.fill(1.0);
        VisibilityStats { pairs: pairs.len() as u64, ..VisibilityStats::default() }
    }
}

/// By rays through an engine. They start at points, whose rays follow each other.
#[derive(Debug)]
pub struct Exact<'a> {
    engine: &'a mut dyn RayEngine,
    segments: ShadowSegments,
    /// What tracing took so far.
    pub(crate) traced: StageStats,
}

impl<'a> Exact<'a> {
    /// By rays through `engine`, which holds the frame.
    pub fn new(engine: &'a mut dyn RayEngine) -> Self {
        Self { engine, segments: ShadowSegments::default(), traced: StageStats::default() }
    }
}

impl CutVisibility for Exact<'_> {
    fn shares(&mut self, pairs: &[CutPair], shares: &mut [f32]) -> VisibilityStats {
        self.segments.clear();
        for CutPair { point, light, .. } in pairs {
            self.segments.push(*point, light.position - point);
        }
        let asked = (Start::Point, Shared::Nothing);
        self.traced += self.segments.trace(self.engine, asked, RayOrder::Unordered);
        for (share, &occluded) in shares.iter_mut().zip(self.segments.occluded()) {
            *share = if occluded { 0.0 } else { 1.0 };
        }
        let count = pairs.len() as u64;
        VisibilityStats { pairs: count, rays: count, tests: 0 }
    }
}

/// Past spheres. Segments have no direction for them, so the lights of a point are the points of
/// a tile, and the point is its light.
#[derive(Clone, Copy, Debug)]
pub struct PastSpheres<'a> {
    tree: &'a SphereTree,
}

impl<'a> PastSpheres<'a> {
    /// Past the spheres of a frame.
    pub const fn new(tree: &'a SphereTree) -> Self {
        Self { tree }
    }
}

impl CutVisibility for PastSpheres<'_> {
    fn shares(&mut self, pairs: &[CutPair], shares: &mut [f32]) -> VisibilityStats {
        let tree = self.tree;
        let tasks = pairs.par_chunks(PAIRS_PER_TASK).zip(shares.par_chunks_mut(PAIRS_PER_TASK));
        let tests = tasks.map_init(LightTile::default, |tile, (pairs, mut shares)| {
            let before = tile.sight.tests();
            for pairs in pairs.chunk_by(|a, b| a.point == b.point && a.normal == b.normal) {
                let (of_point, others) = shares.split_at_mut(pairs.len());
                tile.see(tree, pairs, of_point);
                shares = others;
            }
            tile.sight.tests() - before
        });
        VisibilityStats { pairs: pairs.len() as u64, rays: 0, tests: tests.sum() }
    }
}

/// The normal at the light. A light without has one that is so long that every sphere on the way
/// rises above its plane in full.
fn normal_at_light(pair: &CutPair) -> Vec3 {
    const LONG: f32 = 1e4;
    let SeenLight { position, normal } = pair.light;
    if normal == Vec3::ZERO { LONG * (pair.point - position).normalize_or_zero() } else { normal }
}

/// Working memory for the lights of one point.
#[derive(Debug, Default)]
struct LightTile {
    positions: Vec<Vec3>,
    normals: Vec<Vec3>,
    tile: PointTile,
    sight: TileSight,
}

impl LightTile {
    fn see(&mut self, tree: &SphereTree, pairs: &[CutPair], shares: &mut [f32]) {
        let Self { positions, normals, tile, sight } = self;
        positions.clear();
        normals.clear();
        positions.extend(pairs.iter().map(|pair| pair.light.position));
        normals.extend(pairs.iter().map(normal_at_light));
        tile.assign(positions, normals);
        let point = SeenLight { position: pairs[0].point, normal: pairs[0].normal };
        sight.see(tree, tile, &[point], |_, block_idx, through| {
            let lanes = shares.iter_mut().skip(LANES * block_idx).zip(through);
            lanes.for_each(|(share, through)| *share = *through);
        });
    }
}
