//! How many directions there are, and how many tiles a subfield has.
//!
//! Writing a subfield costs something for each primitive, a ray something for each of about
//! `1 + N sqrt(2 / D)` tiles, with `D` directions and `N` tiles a side. The sum is least where `D`
//! grows with `(rays N / primitives)^(2/3)`, and `N` with the root of the number of primitives.

/// Primitives for each tile, where rays are along the direction and where they go about along it:
/// those visit several tiles, which cost less when they are larger.
const PRIMS_A_TILE: [f64; 2] = [1.0, 4.0];

/// The part of `(rays / sqrt(primitives))^(2/3)` that the directions are: as of the engine on the
/// CPU.
const DIRECTION_SHARE: f64 = 0.2;

/// Cells of directions along a side of the unfolded hemisphere at most: [`super::MOST_CELLS`] in all.
const LARGEST_DIRECTION_EDGE: usize = 16;

/// Tiles along a side of a subfield at most.
const LARGEST_TILE_EDGE: usize = 512;

/// How finely directions and places are told apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Grid {
    /// Cells of directions along each side of the unfolded hemisphere.
    pub(super) direction_edge: usize,
    /// Tiles along each side of a subfield.
    pub(super) tile_edge: usize,
}

impl Grid {
    pub(super) const fn direction_count(self) -> usize {
        self.direction_edge * self.direction_edge
    }

    pub(super) const fn tile_count(self) -> usize {
        self.tile_edge * self.tile_edge
    }
}

/// What suits so many rays, which share a direction or do not, and primitives.
pub(super) fn choose_grid(ray_count: usize, prim_count: usize, is_shared: bool) -> Grid {
    let (rays, prims) = (ray_count as f64, prim_count.max(1) as f64);
    let [along, about] = PRIMS_A_TILE;
    let tiles = prims / if is_shared { along } else { about };
    let directions = DIRECTION_SHARE * (rays / prims.sqrt()).powf(2.0 / 3.0);
    let direction_edge = if is_shared { 1 } else { directions.sqrt().round() as usize };
    Grid {
        direction_edge: direction_edge.clamp(1, LARGEST_DIRECTION_EDGE),
        tile_edge: (tiles.sqrt().ceil() as usize).clamp(1, LARGEST_TILE_EDGE),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::subfields::MOST_CELLS;

    #[test]
    fn more_rays_get_more_directions_and_more_primitives_more_tiles() {
        let grid = |rays, prims| choose_grid(rays, prims, false);
        assert_eq!(grid(1 << 18, 26_000), Grid { direction_edge: 5, tile_edge: 81 });
        assert!(grid(1 << 18, 26_000).direction_edge > grid(1 << 12, 26_000).direction_edge);
        assert!(grid(1 << 18, 1_000).direction_edge > grid(1 << 18, 1_000_000).direction_edge);
        assert!(grid(1 << 18, 1_000).tile_edge < grid(1 << 18, 10_000).tile_edge);
        assert_eq!(choose_grid(1 << 18, 10_000, true), Grid { direction_edge: 1, tile_edge: 100 });
    }

    #[test]
    fn extremes_are_within_limits() {
        for (rays, prims) in [(0, 0), (1, 1 << 21), (1 << 18, 1), (1 << 30, 1 << 21)] {
            for is_shared in [false, true] {
                let grid = choose_grid(rays, prims, is_shared);
                assert!((1..=MOST_CELLS).contains(&grid.direction_count()), "{grid:?}");
                assert!((1..=512).contains(&grid.tile_edge), "{grid:?}");
            }
        }
    }
}
