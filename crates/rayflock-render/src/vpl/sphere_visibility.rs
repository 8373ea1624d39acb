//! Visibility past spheres, pair by pair: a guess for those who want every share written down.
//!
//! Whoever only wants sums is served sooner by [`gather_past_spheres`](super::gather_past_spheres).

use glam::Vec3;
use rayflock_geom::simd::LANES;
use rayon::prelude::*;

use super::{PairTile, PairVisibility, VirtualLights, VisibilityStats};
use crate::occluders::{PointTile, SeenLight, SphereTree, TileSight};

/// Points of a tile of spheres.
const TILE_POINTS: usize = 256;

/// Lights that one task asks about.
const TASK_LIGHTS: usize = 16;

/// Distant lights are taken to be so many times farther away than the scene is large.
pub(super) const DISTANCE: f32 = 64.0;

/// Past the spheres of a frame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SphereVisibility<'a> {
    tree: &'a SphereTree,
}

impl<'a> SphereVisibility<'a> {
    /// Past the spheres of `tree`.
    pub(crate) const fn new(tree: &'a SphereTree) -> Self {
        Self { tree }
    }

    /// Asks about the lights from `first_light` on, for as many as there are rows of `shares`;
    /// returns how many lanes were tested.
    fn multiply_rows(&self, asked: &PairTile<'_>, first_light: usize, shares: &mut [f32]) -> u64 {
        let (mut tile, mut sight) = (PointTile::default(), TileSight::default());
        let (point_count, mut lights) = (asked.points.len(), Vec::with_capacity(TASK_LIGHTS));
        let points = asked.points.chunks(TILE_POINTS).zip(asked.normals.chunks(TILE_POINTS));
        for (tile_idx, (points, normals)) in points.enumerate() {
            tile.assign(points, normals);
            let row_count = shares.len() / point_count;
            lights.clear();
            lights.extend(
                (first_light..first_light + row_count)
                    .map(|light_idx| seen_light(asked.lights, light_idx, tile.center())),
            );
            sight.see(self.tree, &tile, &lights, |row, block_idx, through| {
                let first_point = LANES * block_idx;
                let row = &mut shares[row * point_count + tile_idx * TILE_POINTS..];
                let row = &mut row[first_point..points.len()];
                row.iter_mut().zip(through).for_each(|(share, through)| *share *= through);
            });
        }
        sight.tests()
    }
}

/// A light as spheres see it from about `center`.
fn seen_light(lights: &VirtualLights, light_idx: usize, center: Vec3) -> SeenLight {
    let position = lights.positions()[light_idx];
    match lights.is_distant(light_idx) {
        true => SeenLight {
            position: center + DISTANCE * lights.reach() * position,
            normal: Vec3::ZERO,
        },
        false => SeenLight { position, normal: lights.normals()[light_idx] },
    }
}

impl PairVisibility for SphereVisibility<'_> {
    fn multiply(&mut self, tile: &PairTile<'_>, shares: &mut [f32]) -> VisibilityStats {
        assert_eq!(shares.len(), tile.len(), "there must be a share for each pair");
        let pairs = shares.iter().filter(|share| **share != 0.0).count() as u64;
        let rows = shares.par_chunks_mut(TASK_LIGHTS * tile.points.len().max(1)).enumerate();
        let tests = rows.map(|(task_idx, shares)| {
            self.multiply_rows(tile, tile.range.start + task_idx * TASK_LIGHTS, shares)
        });
        VisibilityStats { pairs, rays: 0, tests: tests.sum() }
    }
}
