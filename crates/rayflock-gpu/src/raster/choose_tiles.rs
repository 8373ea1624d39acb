//! Which tiles are drawn: large ones where rays go alike, small ones where they do not.
//!
//! A cone as wide as a hemisphere touches half of everything, and each primitive that it touches costs
//! a test for every ray of its tile. Four tiles cost four times as many cone tests, of all primitives,
//! and their cones are narrower; so a tile is cut in four as long as its cone is wide.

use super::level::EDGES;
use crate::ray_textures::TILES_PER_ROW;

/// Cones with a larger sine of the half angle are cut. Chosen for few exact tests; see
/// `docs/algorithms/gpu.md` for what that takes.
const WIDE: f32 = 0.1;

/// Tiles to draw of each level, by column and row.
pub(super) type Chosen = [Vec<[u32; 2]>; EDGES.len()];

/// Chooses among the tiles of all levels, given the sines of their cones, row by row: negative ones
/// have no ray. There are `tile_count` of the largest.
pub(super) fn choose_tiles(sines: &[Vec<f32>; EDGES.len()], tile_count: usize) -> Chosen {
    let mut chosen = Chosen::default();
    for tile in 0..tile_count {
        let place = [tile % TILES_PER_ROW, tile / TILES_PER_ROW].map(|number| number as u32);
        choose(sines, 0, place, &mut chosen);
    }
    chosen
}

fn choose(sines: &[Vec<f32>], level: usize, [x, y]: [u32; 2], chosen: &mut Chosen) {
    let tiles_per_row = TILES_PER_ROW << level;
    let sine = sines[level][y as usize * tiles_per_row + x as usize];
    if sine < 0.0 {
        return;
    }
    if sine <= WIDE || level + 1 == EDGES.len() {
        chosen[level].push([x, y]);
        return;
    }
    for corner in [[0, 0], [1, 0], [0, 1], [1, 1]] {
        choose(sines, level + 1, [2 * x + corner[0], 2 * y + corner[1]], chosen);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wide_tiles_are_cut_and_each_ray_is_in_one() {
        let mut sines =
            [0, 1, 2].map(|level| vec![0.1; (TILES_PER_ROW << level) * (TILES_PER_ROW << level)]);
        // Of three tiles the second is wide and has a wide quarter; the third has no ray.
        sines[0][1] = 2.0;
        sines[1][3] = 0.9;
        sines[0][2] = -1.0;
        let [large, middle, small] = choose_tiles(&sines, 3);
        assert_eq!(large, [[0, 0]]);
        assert_eq!(middle, [[2, 0], [2, 1], [3, 1]]);
        assert_eq!(small, [[6, 0], [7, 0], [6, 1], [7, 1]]);
        let texels = [large, middle, small].into_iter().zip(EDGES);
        let texels: usize = texels.map(|(tiles, edge)| tiles.len() * edge * edge).sum();
        assert_eq!(texels, 2 * 64);
    }
}
