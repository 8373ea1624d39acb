//! What a tile of points sees of lights, past the spheres of a frame.
//!
//! ```text
//!   once a tile and group of lights:  in_shaft, above the tile's planes  -> near spheres
//!   once a tile and light:            those in the shaft to it           -> blockers
//!   sixteen points and a light:       those in their own shaft, then let_through
//! ```
//!
//! **Invariants.** What is let through does not depend, but for rounding of what lies a thousand
//! times farther away than it is large, on how points and lights are cut into tiles and groups: a
//! sphere that is left out would have changed nothing, and others keep their order.
//!
//! **Cost.** About three SIMD lanes a pair where a few spheres are near, besides two or three
//! lanes a sphere for each tile and group.

use glam::Vec3;
use rayflock_geom::Sphere;
use rayflock_geom::simd::cone_sphere::SphereBlock;
use rayflock_geom::simd::segment_spheres::{Blocker, PointBlock, let_through};
use rayflock_geom::simd::segment_walls::{Wall, past_wall};
use rayflock_geom::simd::{LANES, Lanes, Simd, SimdBase, SimdLevel, SimdMask, dispatch, f32x16};

use super::point_tile::PointTile;
use super::share_lookouts::Apart;
use super::sphere_tree::{Shaft, SphereTree};

/// A light as a point of a surface, or one without surface where the normal is zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeenLight {
    /// Where it is.
    pub position: Vec3,
    /// Of its surface.
    pub normal: Vec3,
}

/// Spheres and their bounds, sixteen a block.
#[derive(Debug, Default)]
struct Bounded {
    blockers: Vec<Blocker>,
    blocks: Vec<SphereBlock>,
}

impl Bounded {
    fn clear(&mut self) {
        self.blockers.clear();
        self.blocks.clear();
    }

    #[inline(always)]
    fn push(&mut self, blocker: &Blocker, center: Vec3, radius: f32) {
        let lane = self.blockers.len() % LANES;
        if lane == 0 {
            self.blocks.push(SphereBlock::EMPTY);
        }
        self.blockers.push(*blocker);
        if let Some(block) = self.blocks.last_mut() {
            for (column, coordinate) in block.center.iter_mut().zip(center.to_array()) {
                column[lane] = coordinate;
            }
            block.radius[lane] = radius;
        }
    }

    /// Calls `found` with those that a segment of the shaft may touch, in order, their centres and
    /// outer radii. Returns how many lanes were tested.
    #[inline(always)]
    fn in_shaft<S: Simd>(
        &self,
        simd: S,
        shaft: &Shaft,
        mut found: impl FnMut(&Blocker, Vec3, f32),
    ) -> u64 {
        for (block, blockers) in self.blocks.iter().zip(self.blockers.chunks(LANES)) {
            let mut lanes = shaft.touched(simd, block);
            while lanes != 0 {
                let lane = lanes.trailing_zeros() as usize;
                lanes &= lanes - 1;
                let [x, y, z] = &block.center;
                let center = Vec3::new(x[lane], y[lane], z[lane]);
                found(&blockers[lane], center, block.radius[lane]);
            }
        }
        (self.blocks.len() * LANES) as u64
    }
}

/// Answers for tiles; working memory, one a thread.
#[derive(Debug, Default)]
pub struct TileSight {
    /// Spheres near the way from the tile to a group.
    near: Bounded,
    /// Those near the way from the tile to a light.
    seen: Bounded,
    /// Walls on that way.
    walls: Vec<Wall>,
    /// Those near the way from a block to a light.
    round: Vec<Blocker>,
    flat: Vec<Blocker>,
    tests: u64,
}

impl TileSight {
    /// Calls `seen(light_idx, block_idx, through)` for each light of a group and each block of
    /// sixteen points; of the last block, lanes may stand for no point. Lights of a group should be
    /// close to each other.
    pub fn see(
        &mut self,
        tree: &SphereTree,
        tile: &PointTile,
        lights: &[SeenLight],
        mut seen: impl FnMut(usize, usize, &Lanes),
    ) {
        if tile.is_empty() {
            return;
        }
        dispatch!(SimdLevel::best().level(), simd => {
            self.see_group(simd, tree, tile, lights, &mut seen);
        });
    }

    /// Lanes of tests since the beginning, of spheres against shafts and against segments.
    pub const fn tests(&self) -> u64 {
        self.tests
    }

    #[inline(always)]
    fn see_group<S: Simd>(
        &mut self,
        simd: S,
        tree: &SphereTree,
        tile: &PointTile,
        lights: &[SeenLight],
        seen: &mut impl FnMut(usize, usize, &Lanes),
    ) {
        self.find_near(simd, tree, tile, lights.iter().map(|light| light.position));
        for (light_idx, light) in lights.iter().enumerate() {
            self.look_at(simd, tree, tile, light);
            for (block_idx, (points, bound)) in tile.blocks().enumerate() {
                let through = self.through(simd, points, bound, light.position);
                let mut lanes = [0.0; LANES];
                through.store_slice(&mut lanes);
                seen(light_idx, block_idx, &lanes);
            }
        }
    }

    /// Lists the spheres on the way from the tile to the lights.
    #[inline(always)]
    fn find_near<S: Simd>(
        &mut self,
        simd: S,
        tree: &SphereTree,
        tile: &PointTile,
        lights: impl Iterator<Item = Vec3> + Clone,
    ) {
        let points = lights.map(|position| Sphere::new(position, 0.0));
        let Some(group) = Sphere::around_spheres(points) else { return };
        let shaft = Shaft::between(tile.bound(), &group);
        let near = &mut self.near;
        near.clear();
        self.tests += tree.in_shaft(simd, &shaft, |sphere, blocker| {
            // One whose centre lies behind the planes of all points counts at none.
            if !tile.lies_above(sphere.center, Apart::default()) {
                near.push(blocker, sphere.center, sphere.outer);
            }
        });
    }

    /// Lists those on the way to one light, and walls.
    #[inline(always)]
    fn look_at<S: Simd>(
        &mut self,
        simd: S,
        tree: &SphereTree,
        tile: &PointTile,
        light: &SeenLight,
    ) {
        let SeenLight { position, normal } = *light;
        let shaft = Shaft::between(tile.bound(), &Sphere::new(position, 0.0));
        let Self { near, seen, walls, .. } = self;
        seen.clear();
        self.tests += near.in_shaft(simd, &shaft, |blocker, center, radius| {
            if let Some(blocker) = blocker.toward(position, normal) {
                seen.push(&blocker, center, radius);
            }
        });
        walls.clear();
        let Sphere { center, radius } = *tile.bound();
        walls.extend(tree.walls().iter().filter(|wall| {
            let lowest = wall.height(position).min(wall.height(center) - radius);
            lowest < 0.0
        }));
    }

    /// What comes through from the light that was looked at last to a block of the tile.
    #[inline(always)]
    fn through<S: Simd>(
        &mut self,
        simd: S,
        points: &PointBlock,
        bound: &Sphere,
        light: Vec3,
    ) -> f32x16<S> {
        let Self { seen, walls, round, flat, .. } = self;
        let mut past_walls = f32x16::splat(simd, 1.0);
        for wall in &*walls {
            past_walls *= past_wall(simd, points, light, wall);
        }
        let is_hidden = !past_walls.simd_gt(f32x16::splat(simd, 0.0)).any_true();
        if seen.blockers.is_empty() || is_hidden {
            return past_walls;
        }
        round.clear();
        flat.clear();
        let shaft = Shaft::between(bound, &Sphere::new(light, 0.0));
        self.tests += seen.in_shaft(simd, &shaft, |blocker, _, _| {
            let list = if blocker.is_flat() { &mut *flat } else { &mut *round };
            list.push(*blocker);
        });
        self.tests += (LANES * (round.len() + flat.len())) as u64;
        past_walls * let_through(simd, points, light, round, flat)
    }
}
