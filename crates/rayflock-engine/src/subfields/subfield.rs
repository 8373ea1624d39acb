//! A direction and what can be hit along it.

use glam::{DVec3, Vec3};
use rayflock_geom::Ray;
use rayflock_geom::simd::face::{Face, FaceKind};

use super::store::Contents;
use super::tile_grid::TileGrid;
use super::walk_tiles::RayLine;

/// The grids of one direction.
#[derive(Debug)]
pub(super) struct Subfield {
    /// Of any length.
    pub(super) direction: Vec3,
    pub(super) face: Face,
    /// Primitives that rest, written once.
    pub(super) kept: TileGrid,
    /// Primitives that move, written each frame.
    pub(super) moving: TileGrid,
    /// When this was asked for last.
    pub(super) used: u64,
}

impl Subfield {
    /// Empty grids across a direction, which is finite and not zero. Numbers are the more exact the
    /// nearer things are to the center.
    pub(super) fn new(direction: Vec3, center: Vec3, used: u64) -> Self {
        let normal = direction.as_dvec3().normalize();
        let first = normal.any_orthonormal_vector();
        let rows = [first, normal.cross(first), normal].map(DVec3::as_vec3);
        let face = Face { kind: FaceKind::Parallel { reach: 0.0 }, center, rows };
        let (kept, moving) = (TileGrid::default(), TileGrid::default());
        Self { direction, face, kept, moving, used }
    }

    /// Whether both grids hold what they should.
    pub(super) fn is_current(&self, contents: &Contents) -> bool {
        self.kept.frame == contents.kept_frame && self.moving.frame == contents.frame
    }

    /// In the order in which rays are sent over them.
    pub(super) fn grids(&self) -> [&TileGrid; 2] {
        [&self.kept, &self.moving]
    }

    /// Slots of primitives that have no place in the grids.
    pub(super) fn everywhere(&self) -> impl Iterator<Item = u32> + '_ {
        self.grids().into_iter().flat_map(|grid| grid.everywhere.iter().copied())
    }

    /// A ray's line on the face, and `extent` more of which its places may be off by a part.
    #[inline(always)]
    pub(super) fn line(&self, ray: &Ray, extent: f32) -> RayLine {
        let [a, b, c] = self.face.rows;
        let from_center = ray.origin - self.face.center;
        let rotated = |v: Vec3| Vec3::new(a.dot(v), b.dot(v), c.dot(v));
        let size = ray.direction.abs().max_element();
        RayLine::new(rotated(from_center), rotated(ray.direction), size).with_extent(extent)
    }

    /// Bytes held.
    pub(super) fn memory_usage(&self) -> usize {
        self.kept.memory_usage() + self.moving.memory_usage()
    }
}
