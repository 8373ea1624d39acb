//! The tree over the rays: a cone and a reach for each tile, and for each group of tiles.

use std::ops::Range;

use rayflock_geom::SphereCone;
use rayflock_geom::simd::cone_sphere::Reach;

/// Nodes with cones beyond this half angle (37 degrees) get no list of their own.
const WIDEST_COS: f32 = 0.8;

/// Levels from the tiles (level 0) upward; each node's children are consecutive nodes of the
/// level below.
#[derive(Debug, Default)]
pub(super) struct RayTree {
    levels: Vec<Vec<RayNode>>,
    level_count: usize,
}

/// A group of rays.
#[derive(Clone, Copy, Debug)]
pub(super) struct RayNode {
    /// Holds the rays.
    pub(super) cone: SphereCone,
    /// How far they reach; `far` is minus infinity without active rays.
    pub(super) reach: Reach,
    /// The first tile below.
    pub(super) first_tile: u32,
    /// First child in the level below; nothing for a tile.
    pub(super) first_child: u32,
    /// Number of children, up to 4; 0 for a tile.
    pub(super) child_count: u32,
}

impl RayNode {
    /// Whether any ray can hit anything.
    pub(super) fn is_active(&self) -> bool {
        self.reach.far > f32::NEG_INFINITY
    }

    /// Whether the cone is so wide that it would keep most of what lies ahead.
    pub(super) fn is_wide(&self) -> bool {
        self.cone.cos < WIDEST_COS
    }

    /// The children in the level below.
    pub(super) fn children(&self) -> Range<usize> {
        let first = self.first_child as usize;
        first..first + self.child_count as usize
    }
}

impl RayTree {
    /// Number of levels; 0 for a tree that was never built.
    pub(super) fn level_count(&self) -> usize {
        self.level_count
    }

    /// The nodes of a level.
    pub(super) fn nodes(&self, level: usize) -> &[RayNode] {
        &self.levels[level]
    }

    /// The level to be written next, emptied, with the one below it.
    pub(super) fn push_level(&mut self) -> (&[RayNode], &mut Vec<RayNode>) {
        if self.levels.len() == self.level_count {
            self.levels.push(Vec::new());
        }
        self.level_count += 1;
        let (below, level) = self.levels.split_at_mut(self.level_count - 1);
        level[0].clear();
        (below.last().map_or(&[], Vec::as_slice), &mut level[0])
    }

    /// Takes all levels away, keeping their memory.
    pub(super) fn clear(&mut self) {
        self.level_count = 0;
    }

    /// The first tile below node `node_idx` of a level, or the number of tiles after the last.
    pub(super) fn first_tile(&self, level: usize, node_idx: usize) -> usize {
        let node = self.levels[level].get(node_idx);
        node.map_or(self.levels[0].len(), |node| node.first_tile as usize)
    }

    /// Bytes held.
    pub(super) fn memory_usage(&self) -> usize {
        self.levels.iter().map(|level| level.capacity() * size_of::<RayNode>()).sum()
    }
}
