//! One ray on its way over the tiles of a grid, from near to far.
//!
//! ```text
//!   clip     the interval of the ray to the depths of the grid, then to its window
//!   strips   blocks, and in each the tiles, in strips across the way: a strip bounds the ray's
//!            interval, and that the rows of the strip that the ray may be in
//!   meet     the leaves of a tile, as far as their depths overlap with that interval
//! ```
//!
//! Each strip is reckoned from the ray's equation, not from the strip before, so errors do not add
//! up; `pad` covers those of a single one.
//!
//! **Invariants.** The point at which the ray's line pierces a primitive that the accepting test
//! would hit lies in a visited tile, unless a nearer hit was found before. What the reported `t` may
//! differ from that point is `t_slack`.

use glam::Vec3;
use rayflock_geom::simd::Simd;
use rayflock_geom::simd::face_rows::CELL_BITS;

use super::meet_tile::{DepthRange, Meeting, TileRay};
use super::tile_grid::{TileBlock, TileGrid};

/// A ray's place on a face: all linear in `t`.
#[derive(Clone, Copy, Debug)]
pub(super) struct RayLine {
    /// x, y and depth at `t = 0`.
    pub(super) start: Vec3,
    /// The same for each unit of `t`; x and y are zero for rays along the face's direction.
    pub(super) pace: Vec3,
    /// A length of which places may be off by a part, beside the distances from the origin.
    extent: f32,
}

/// Directions shorter than this, in their largest coordinate, or longer than its inverse are not
/// reckoned with.
const SHORTEST: f32 = 1e-15;

impl RayLine {
    /// The line of a ray whose direction has this largest coordinate; if that is out of range, the
    /// ray is nowhere in particular, and so everywhere.
    #[inline(always)]
    pub(super) fn new(start: Vec3, pace: Vec3, size: f32) -> Self {
        if (SHORTEST..1.0 / SHORTEST).contains(&size) {
            Self { start, pace, extent: 0.0 }
        } else {
            Self { start: Vec3::NAN, pace: Vec3::NAN, extent: 0.0 }
        }
    }

    /// The same, with a length of which places may be off by a part.
    #[inline(always)]
    pub(super) fn with_extent(self, extent: f32) -> Self {
        Self { extent, ..self }
    }

    /// The line of a ray along the direction of the face.
    #[inline(always)]
    pub(super) fn along(start: Vec3, pace: f32) -> Self {
        Self::new(start, Vec3::new(0.0, 0.0, pace), pace)
    }
}

/// A part of the ray between two places.
#[derive(Clone, Copy, Debug)]
struct Interval {
    begin: f32,
    end: f32,
}

/// The ray in cells of a grid.
struct Walk<'a> {
    grid: &'a TileGrid,
    line: RayLine,
    /// Column and row at `t = 0`, and for each unit of `t`.
    start: [f32; 2],
    pace: [f32; 2],
    /// By how much columns and rows may be off.
    pad: [f32; 2],
    /// By how much a depth may be off.
    depth_slack: f32,
    /// By how much a reported `t` may be off.
    t_slack: f32,
    /// 0 if the way leads along columns, 1 if along rows.
    major: usize,
}

/// Sends a ray over a grid. `slack` is relative to distances.
#[inline(never)]
pub(super) fn walk_grid<S: Simd>(
    simd: S,
    grid: &TileGrid,
    line: &RayLine,
    slack: f32,
    ray: &mut TileRay,
    meeting: &mut Meeting<'_>,
) {
    // Not a part of the caller, so it has to be told the instruction set again.
    simd.vectorize(
        #[inline(always)]
        || Walk::new(grid, line, slack).walk(simd, ray, meeting),
    );
}

impl<'a> Walk<'a> {
    fn new(grid: &'a TileGrid, line: &RayLine, slack: f32) -> Self {
        let window = &grid.window;
        let extent = line.start.abs().element_sum() + line.extent + grid.reach;
        let error = 4.0 * slack * extent;
        let depth_slack = grid.depth_error + error;
        let cells = |axis: usize| (line.start[axis] - window.low[axis]) * window.scale[axis];
        let pace = |axis: usize| line.pace[axis] * window.scale[axis];
        // A cell is a small part of a tile, and covers the rounding within the window.
        let pad = |axis: usize| error * window.scale[axis] + 0.25;
        Self {
            grid,
            line: *line,
            start: [cells(0), cells(1)],
            pace: [pace(0), pace(1)],
            pad: [pad(0), pad(1)],
            depth_slack,
            t_slack: depth_slack / line.pace.z.abs().max(f32::MIN_POSITIVE),
            major: 0,
        }
    }

    #[inline(always)]
    fn walk<S: Simd>(mut self, simd: S, ray: &mut TileRay, meeting: &mut Meeting<'_>) {
        let Some(way) = self.clip(ray) else { return };
        let length = |axis: usize| (self.pace[axis] * (way.end - way.begin)).abs();
        self.major = usize::from(length(1) > length(0));
        let (grid, all) = (self.grid, (1 << CELL_BITS) - 1);
        let block_bits = CELL_BITS - grid.block_bits;
        self.for_squares(
            way,
            [[0, all]; 2],
            block_bits,
            #[inline(always)]
            |column, row, part| {
                let block_idx = ((row << grid.block_bits) | column) as usize;
                if let Some(block) = grid.valid_block(block_idx) {
                    let first = [column << block_bits, row << block_bits];
                    self.walk_block(simd, block, first, part, ray, meeting);
                }
                !self.is_over(ray, part)
            },
        );
    }

    /// The part of the ray within the cuboid of the grid.
    fn clip(&self, ray: &TileRay) -> Option<Interval> {
        let mut way = Interval { begin: ray.t_min - self.t_slack, end: ray.t_max + self.t_slack };
        let [near, far] = self.grid.depths;
        let (low, high) = (near - self.depth_slack, far + self.depth_slack);
        way.clip(self.line.start.z, self.line.pace.z, [low, high]);
        for axis in 0..2 {
            let side = (1_u32 << CELL_BITS) as f32;
            way.clip(self.start[axis], self.pace[axis], [-self.pad[axis], side + self.pad[axis]]);
        }
        // NaN is no reason to leave anything out.
        let is_nowhere = way.begin > way.end;
        (!is_nowhere).then_some(way)
    }

    /// Whether what comes after `part` is of no interest.
    fn is_over(&self, ray: &TileRay, part: Interval) -> bool {
        ray.is_done() || ray.t_max + self.t_slack < part.begin
    }

    /// Visits the tiles of a block.
    #[inline(always)]
    fn walk_block<S: Simd>(
        &self,
        simd: S,
        block: &TileBlock,
        first: [u32; 2],
        way: Interval,
        ray: &mut TileRay,
        meeting: &mut Meeting<'_>,
    ) {
        let block_bits = CELL_BITS - self.grid.block_bits;
        let tile_bits = block_bits - block.level;
        let last = (1 << block_bits) - 1;
        let within = [[first[0], first[0] + last], [first[1], first[1] + last]];
        let inside = (1 << block.level) - 1;
        self.for_squares(
            way,
            within,
            tile_bits,
            #[inline(always)]
            |column, row, part| {
                let tile_idx = ((row & inside) << block.level) | (column & inside);
                meeting.meet_tile(simd, block, tile_idx as usize, self.depths(ray, part), ray);
                !self.is_over(ray, part)
            },
        );
    }

    /// The depths of the ray within a part of it.
    #[inline(always)]
    fn depths(&self, ray: &TileRay, part: Interval) -> DepthRange {
        let (start, pace, slack) = (self.line.start.z, self.line.pace.z, self.depth_slack);
        let depth = |t: f32| start + pace * t;
        let (a, b) = (depth(part.begin), depth(part.end.min(ray.t_max + self.t_slack)));
        let (least, most) = (-a.max(b) - slack, -a.min(b) + slack);
        DepthRange { least, most, start, pace, slack }
    }

    /// Calls `visit` with column, row and part of the ray for each square of `2^bits` cells that
    /// the ray may be in, from near to far, until it returns false.
    #[inline(always)]
    fn for_squares(
        &self,
        way: Interval,
        within: [[u32; 2]; 2],
        bits: u32,
        mut visit: impl FnMut(u32, u32, Interval) -> bool,
    ) {
        let (major, minor) = (self.major, 1 - self.major);
        let [first, last] = self.squares(way, major, within[major], bits);
        let size = (1_u32 << bits) as f32;
        for step in 0..=last - first {
            let strip = if self.pace[major] < 0.0 { last - step } else { first + step };
            let mut part = way;
            if first != last {
                let edge = strip as f32 * size;
                let edges = [edge - self.pad[major], edge + size + self.pad[major]];
                part.clip(self.start[major], self.pace[major], edges);
            }
            let [low, high] = self.squares(part, minor, within[minor], bits);
            for step in 0..=high - low {
                let across = if self.pace[minor] < 0.0 { high - step } else { low + step };
                let place = if major == 0 { [strip, across] } else { [across, strip] };
                if !visit(place[0], place[1], part) {
                    return;
                }
            }
        }
    }

    /// The first and the last square that a part of the ray may be in, along an axis.
    #[inline(always)]
    fn squares(&self, part: Interval, axis: usize, within: [u32; 2], bits: u32) -> [u32; 2] {
        let [first, last] = [within[0] as f32, within[1] as f32];
        let (a, b) = if self.pace[axis] == 0.0 {
            (self.start[axis], self.start[axis])
        } else {
            let place = |t: f32| self.start[axis] + self.pace[axis] * t;
            (place(part.begin), place(part.end))
        };
        // NaN, from intervals without end, is every place.
        let low = (a.min(b) - self.pad[axis]).max(first).min(last);
        let high = (a.max(b) + self.pad[axis]).max(first).min(last);
        let (low, high) = if a.is_nan() || b.is_nan() { (first, last) } else { (low, high) };
        [low as u32 >> bits, high as u32 >> bits]
    }
}

impl Interval {
    /// Cuts off what lies outside of `low..=high`, where the place is `start + pace * t`.
    #[inline(always)]
    fn clip(&mut self, start: f32, pace: f32, [low, high]: [f32; 2]) {
        if pace == 0.0 {
            if start < low || start > high {
                self.end = f32::NEG_INFINITY;
            }
            return;
        }
        let (a, b) = ((low - start) / pace, (high - start) / pace);
        // `max` and `min` leave out what is NaN.
        self.begin = self.begin.max(a.min(b));
        self.end = self.end.min(a.max(b));
    }
}
