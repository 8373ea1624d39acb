//! Points that are close to each other, as columns, and what bounds them.

use glam::Vec3;
use rayflock_geom::simd::LANES;
use rayflock_geom::simd::segment_spheres::PointBlock;
use rayflock_geom::{Aabb, Sphere};

use super::see_tile::SeenLight;
use super::share_lookouts::Apart;

/// Points that are close, in blocks of sixteen, and what bounds them.
#[derive(Clone, Debug)]
pub struct PointTile {
    blocks: Vec<PointBlock>,
    /// Around the points of each block.
    block_bounds: Vec<Sphere>,
    len: usize,
    bound: Sphere,
    /// The mean normal, how much normals deviate from it, and how far points lie from the plane
    /// across it.
    axis: Vec3,
    spread: f32,
    thickness: f32,
}

impl Default for PointTile {
    fn default() -> Self {
        let bound = Sphere::new(Vec3::ZERO, 0.0);
        Self {
            blocks: Vec::new(),
            block_bounds: Vec::new(),
            len: 0,
            bound,
            axis: Vec3::Y,
            spread: 2.0,
            thickness: 0.0,
        }
    }
}

impl PointTile {
    /// Makes this the tile of `positions` with unit `normals`, as many of each, keeping its memory.
    pub fn assign(&mut self, positions: &[Vec3], normals: &[Vec3]) {
        self.blocks.clear();
        self.block_bounds.clear();
        self.len = positions.len();
        for (positions, normals) in positions.chunks(LANES).zip(normals.chunks(LANES)) {
            let mut block = PointBlock::splat(positions[0], normals[0]);
            for (lane, (&position, &normal)) in positions.iter().zip(normals).enumerate() {
                block.set(lane, position, normal);
            }
            self.blocks.push(block);
            self.block_bounds.push(ball_around(positions));
        }
        self.bound = ball_around(positions);
        let center = self.bound.center;
        self.axis = normals.iter().sum::<Vec3>().normalize_or(Vec3::Y);
        let deviation = |normal: &Vec3| normal.distance(self.axis);
        self.spread = normals.iter().map(deviation).fold(0.0, f32::max);
        let depth = |position: &Vec3| (*position - center).dot(self.axis).abs();
        self.thickness = positions.iter().map(depth).fold(0.0, f32::max);
    }

    /// Number of points.
    pub const fn len(&self) -> usize {
        self.len
    }

    /// Whether there are none.
    pub const fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// The middle of the points.
    pub const fn center(&self) -> Vec3 {
        self.bound.center
    }

    /// A ball around the points.
    pub(super) const fn bound(&self) -> &Sphere {
        &self.bound
    }

    /// The points, sixteen a block, and a ball around each block; the last block may hold some
    /// twice.
    pub(super) fn blocks(&self) -> impl Iterator<Item = (&PointBlock, &Sphere)> {
        self.blocks.iter().zip(&self.block_bounds)
    }

    /// Whether a light sends nothing to any point, or to those that are `apart` from them, since it
    /// lies behind their planes or they behind its own. `evenness` is added to the cosine at the
    /// light.
    pub(super) fn faces_away(&self, light: &SeenLight, evenness: f32, apart: Apart) -> bool {
        let offset = light.position - self.bound.center;
        let radius = (1.0 + 1e-5) * (self.bound.radius + apart.position);
        let is_behind = evenness == 0.0 && light.normal.dot(offset) > radius;
        is_behind || self.lies_above(light.position, apart)
    }

    /// Whether all points have another one behind their planes.
    pub(super) fn lies_above(&self, other: Vec3, apart: Apart) -> bool {
        let offset = other - self.bound.center;
        let (distance, radius) = (offset.length(), self.bound.radius + apart.position);
        let lift = (self.spread + apart.normal) * (distance + radius);
        let thickness = self.thickness + apart.position;
        offset.dot(self.axis) + thickness + lift + 1e-5 * distance < 0.0
    }
}

/// A ball around points.
fn ball_around(points: &[Vec3]) -> Sphere {
    let center = Aabb::around(points.iter().copied()).center();
    let center = if center.is_finite() { center } else { Vec3::ZERO };
    let squared = points.iter().map(|point| point.distance_squared(center));
    Sphere::new(center, squared.fold(0.0, f32::max).sqrt() * (1.0 + 1e-5))
}
