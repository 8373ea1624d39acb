//! Places rays on their faces: how these are divided into strips and columns, and in which cell
//! each ray lies.

use std::sync::atomic::AtomicU64;

use rayflock_geom::RayBatch;
use rayflock_geom::simd::face::{Face, FaceKind, pierce_cube};
use rayflock_geom::simd::point_box::PointBox;
use rayflock_geom::simd::{LANES, Select, Simd, SimdBase, SimdMask, f32x16, mask32x16, u32x16};

use super::super::arrange::NO_RAY;
use super::faces::spread_positions;
use super::ray_columns::{RayColumns, RayStates};
use super::ray_strips::{FaceStrips, RayStrips, extent};

/// Groups of rays that are looked at for the window.
const WINDOW_SAMPLE: usize = 64;

/// Strips of a face at most, as a power of two.
const MOST_STRIP_BITS: u32 = 10;

/// Columns for each strip of a face, as a power of two: a group is as wide as a strip is high
/// where there are sixteen rays in so many cells.
const COLUMNS_PER_STRIP: u32 = 3;

/// How far points on the sides of a cube are from those on faces at most, for rounding.
const ON_CUBE: f32 = 1.0 / (1 << 18) as f32;

/// Where points on a side of a cube are, rounded as they may be.
const ON_SIDE: [f32; 4] = [-1.0 - ON_CUBE, 1.0 + ON_CUBE, -1.0 - ON_CUBE, 1.0 + ON_CUBE];

/// What is known of some rays.
#[derive(Clone, Copy, Debug)]
pub(super) struct SeenRays {
    pub(super) invalid_count: u64,
    /// Whether an active ray has no place or looks behind its origin.
    pub(super) is_lost: bool,
    /// Around their points, where there is a single face.
    bound: PointBox,
    /// The largest distance of an origin from the center of the face.
    reach: f32,
}

impl SeenRays {
    pub(super) const NONE: Self =
        Self { invalid_count: 0, is_lost: false, bound: PointBox::EMPTY, reach: 0.0 };

    pub(super) fn join(self, other: Self) -> Self {
        Self {
            invalid_count: self.invalid_count + other.invalid_count,
            is_lost: self.is_lost | other.is_lost,
            bound: self.bound.union(&other.bound),
            reach: self.reach.max(other.reach),
        }
    }
}

/// Divides the faces into strips and columns: four by four rays a group, as far as the window
/// around a sample tells; the squares of a cube's sides are known.
#[inline(always)]
pub(super) fn lay_out<S: Simd>(simd: S, batch: &RayBatch<'_>, strips: &mut RayStrips) {
    let is_cube = strips.faces.len() > 1;
    let [x0, x1, y0, y1] = match &strips.faces[..] {
        [face] => sample_bounds(simd, batch, &face.face),
        _ => [-1.0, 1.0, -1.0, 1.0],
    };
    let ray_bits = usize::BITS - batch.len().saturating_sub(1).leading_zeros();
    let strip_bits = (ray_bits.div_ceil(2) - u32::from(is_cube)).saturating_sub(2);
    let strip_bits = strip_bits.min(MOST_STRIP_BITS);
    let (strip_count, columns) = (1 << strip_bits, 1 << (strip_bits + COLUMNS_PER_STRIP));
    let scale = [(columns, x0, x1), (strip_count, y0, y1)].map(|(count, low, high)| {
        let scale = count as f32 / (high - low);
        if scale.is_finite() && scale > 0.0 { scale } else { 1.0 }
    });
    let low = [x0, y0].map(|low| if low.is_finite() { low } else { 0.0 });
    for (face_idx, face) in strips.faces.iter_mut().enumerate() {
        face.first_strip = face_idx * strip_count;
        (face.strip_count, face.columns) = (strip_count, columns);
        (face.low, face.scale) = (low, scale);
        face.tolerance = [if is_cube { ON_CUBE } else { 0.0 }; 2];
    }
}

/// Around the points of some rays.
#[inline(always)]
fn sample_bounds<S: Simd>(simd: S, batch: &RayBatch<'_>, face: &Face) -> [f32; 4] {
    let mut columns = RayColumns::EMPTY;
    let mut bound = PointBox::EMPTY;
    for first_ray in spread_positions(batch.len(), WINDOW_SAMPLE) {
        columns.gather(simd, batch, &positions(first_ray, batch.len()));
        let points = face.project_rays(simd, columns.origin(simd), columns.direction(simd));
        let active = columns.states(simd).active & points.on_face;
        let around = [points.x, points.y, points.x, points.y];
        bound = bound.union(&PointBox::around(simd, around, active));
    }
    bound.bounds
}

/// Takes over what was seen of all rays.
#[inline(always)]
pub(super) fn note_bounds<S: Simd>(simd: S, seen: &SeenRays, strips: &mut RayStrips) {
    if let [face] = &mut strips.faces[..] {
        face.bounds = seen.bound.bounds;
        if let FaceKind::Parallel { reach } = &mut face.face.kind {
            *reach = seen.reach;
        }
        return;
    }
    for face in &mut strips.faces {
        let (first_strip, columns) = (face.first_strip, face.columns);
        let has_rays = |strip: &usize| {
            let cell = (first_strip + strip) * columns;
            strips.cells[cell] < strips.cells[cell + columns]
        };
        // The first strip and the last reach to the bounds.
        face.bounds = ON_SIDE;
        let first = (0..face.strip_count).find(has_rays);
        let last = (0..face.strip_count).rfind(has_rays);
        if let (Some(first), Some(last)) = (first, last) {
            let heights = |strip: usize| face.heights(simd, u32x16::splat(simd, strip as u32));
            let ([low, _], [_, high]) = (heights(first), heights(last));
            let [x0, x1, y0, y1] = ON_SIDE;
            face.bounds = [x0, x1, low[0].max(y0), high[0].min(y1)];
        } else {
            face.bounds = PointBox::EMPTY.bounds;
        }
    }
}

/// Up to sixteen consecutive positions.
fn positions(first: usize, len: usize) -> [u32; LANES] {
    std::array::from_fn(|lane| if first + lane < len { (first + lane) as u32 } else { NO_RAY })
}

/// Writes the cells of the rays from `first_ray` on.
#[inline(always)]
pub(super) fn write_keys<S: Simd>(
    simd: S,
    batch: &RayBatch<'_>,
    strips: &RayStrips,
    first_ray: usize,
    keyed: &mut [AtomicU64],
) -> SeenRays {
    let mut columns = RayColumns::EMPTY;
    let mut seen = SeenRays::NONE;
    // All faces are divided alike.
    let face = &strips.faces[0];
    let face_cells = (face.strip_count * face.columns) as u32;
    let nowhere = u32x16::splat(simd, strips.faces.len() as u32 * face_cells);
    for (idx, keyed) in keyed.chunks_mut(LANES).enumerate() {
        let first = first_ray + idx * LANES;
        columns.gather(simd, batch, &positions(first, first + keyed.len()));
        let states = columns.states(simd);
        let placed = place(simd, strips, &columns, &states, &mut seen);
        let cell = face.places(simd, placed.y, 1) * u32x16::splat(simd, face.columns as u32)
            + face.places(simd, placed.x, 0)
            + placed.face_idx * u32x16::splat(simd, face_cells);
        let cell = placed.is_there.select(cell, nowhere);
        for (lane, keyed) in keyed.iter_mut().enumerate() {
            *keyed.get_mut() = (u64::from(cell[lane]) << 32) | (first + lane) as u64;
        }
    }
    seen
}

/// Sixteen rays on their faces.
struct Placed<S: Simd> {
    is_there: mask32x16<S>,
    face_idx: u32x16<S>,
    x: f32x16<S>,
    y: f32x16<S>,
}

/// Finds the points of sixteen rays, and notes what was seen of them.
#[inline(always)]
fn place<S: Simd>(
    simd: S,
    strips: &RayStrips,
    columns: &RayColumns,
    states: &RayStates<S>,
    seen: &mut SeenRays,
) -> Placed<S> {
    seen.invalid_count += states.invalid_count;
    let [FaceStrips { face, occupancy, asks_occupancy, .. }] = &strips.faces[..] else {
        let (face_idx, [x, y]) = pierce_cube(simd, columns.direction(simd));
        seen.is_lost |= states.looks_back;
        return Placed { is_there: states.active, face_idx, x, y };
    };
    let points = face.project_rays(simd, columns.origin(simd), columns.direction(simd));
    let is_there = states.active & points.on_face;
    let around = [points.x, points.y, points.x, points.y, extent(&points)];
    let (bound, reach) = PointBox::around_with_most(simd, around, is_there);
    seen.bound = seen.bound.union(&bound);
    seen.reach = seen.reach.max(reach);
    seen.is_lost |= states.looks_back | (states.active & !points.on_face).any_true();
    if *asks_occupancy {
        occupancy.note(simd, points.x, points.y, is_there);
    }
    Placed { is_there, face_idx: u32x16::splat(simd, 0), x: points.x, y: points.y }
}
