//! What is traced at a time, and what that took.

use std::ops::Range;

use wgpu::Buffer;

use super::{BLOCK_CHUNKS, CHUNK_PRIMS, FAN_OUT};
use crate::buffer::range_of;
use crate::layout::{Counters, DeviceRay};
use crate::method::{Question, TestCounts};
use crate::primitives::Part;
use crate::slots::TILE_RAYS;

/// What is traced at a time: some tiles against one part of the primitives.
#[derive(Clone, Debug)]
pub(super) struct Span<'a> {
    pub(super) part: Part<'a>,
    pub(super) part_idx: usize,
    pub(super) rays: Buffer,
    pub(super) hits: Buffer,
    pub(super) tiles: Range<usize>,
    pub(super) question: Question,
}

impl Span<'_> {
    pub(super) fn chunk_count(&self) -> usize {
        self.part.count.div_ceil(CHUNK_PRIMS)
    }

    pub(super) fn block_count(&self) -> usize {
        self.chunk_count().div_ceil(BLOCK_CHUNKS)
    }

    pub(super) fn node_count(&self) -> usize {
        self.tiles.len().div_ceil(FAN_OUT)
    }

    pub(super) fn root_count(&self) -> usize {
        self.node_count().div_ceil(FAN_OUT)
    }

    /// Both halves.
    pub(super) fn halves(&self) -> [Self; 2] {
        let middle = self.tiles.start + self.tiles.len() / 2;
        let with = |tiles| Self { tiles, ..self.clone() };
        [with(self.tiles.start..middle), with(middle..self.tiles.end)]
    }

    /// Cone tests of the first level.
    pub(super) fn asked(&self) -> usize {
        self.root_count() * self.block_count()
    }
}

/// The rays of a span; tiles are a multiple of what offsets must be aligned to.
pub(super) fn rays_of<'a>(span: &'a Span<'_>) -> wgpu::BindingResource<'a> {
    let tile_bytes = TILE_RAYS * size_of::<DeviceRay>();
    range_of(&span.rays, span.tiles.start * tile_bytes, span.tiles.len() * tile_bytes)
}

/// The tests of a trace whose first level took so many cone tests.
pub(crate) fn tests_of(asked: usize, found: &Counters) -> TestCounts {
    let [root_pairs, node_pairs, tile_pairs] =
        [found.root_pairs, found.node_pairs, found.tile_pairs].map(u64::from);
    let children = FAN_OUT as u64 * (root_pairs + node_pairs);
    let in_tiles = CHUNK_PRIMS as u64 * u64::from(found.cone_tests);
    let of_all_rays = |tests: u32| TILE_RAYS as u64 * u64::from(tests);
    TestCounts {
        cones: asked as u64 + children + in_tiles + of_all_rays(found.ray_tests),
        triangles: of_all_rays(found.triangle_tests),
        spheres: of_all_rays(found.sphere_tests),
        pairs: root_pairs + node_pairs + tile_pairs,
    }
}

/// Pairs that a buffer has to hold.
pub(crate) fn pairs_needed(found: &Counters) -> usize {
    found.root_pairs.max(found.node_pairs).max(found.tile_pairs) as usize
}
