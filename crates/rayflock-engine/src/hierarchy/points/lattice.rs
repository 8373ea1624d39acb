//! Images whose rays make a lattice on a face, as those of a pinhole or orthographic camera do:
//! tiles of 4 x 4 pixels are cells, and nothing has to be sorted.
//!
//! The lattice is fitted to the corners and asked of some rays; whether it holds is seen when each
//! ray is loaded. Where one is astray the batch is sorted after all.
//!
//! **Invariants.** A ray for which [`FaceStrips::holds`] lies within [`SLACK`] of its tile, so the
//! tiles between those of a widened box's corners have all rays in the box.

use rayflock_geom::simd::face::{Face, FaceKind};
use rayflock_geom::simd::{
    LANES, Simd, SimdBase, SimdCvtFloat, SimdCvtTruncate, SimdLevel, SimdMask, dispatch, f32x16,
    mask32x16, u32x16,
};
use rayflock_geom::{RayBatch, RayOrder};

use super::super::arrange::{Image, NO_RAY, TILE_SIDE};
use super::ray_columns::RayColumns;
use super::ray_strips::{FaceStrips, RayStrips, extent};

/// How far points may lie from the lattice, in pixels.
const SLACK: f32 = 1.0 / 64.0;

/// Rays along each side of an image that are asked before it is taken for a lattice.
const SAMPLE_SIDE: usize = 7;

/// How much farther than the corners' an origin may be from the center of its face.
const WIDER: f32 = 1.01;

/// More than there are along a side.
const MOST_PIXELS: f32 = (1 << 20) as f32;

/// A regular image on a face.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lattice {
    /// Pixels of a column and of a strip: points of a pixel are around its number and a half.
    pixels: f32,
}

/// Where the first pixel is, and the way to the next column and row.
#[derive(Clone, Copy, Debug)]
struct Fit {
    first: [f32; 2],
    step: [f32; 2],
    reach: f32,
}

/// Brings images into strips.
#[derive(Debug, Default)]
pub(super) struct LatticeTiler {
    /// The order of the rays for the image that was the last one.
    ray_idx: Vec<u32>,
    made_for: Option<(RayOrder, bool)>,
}

impl Lattice {
    /// Which boxes a pixel's point may be in.
    #[inline(always)]
    pub(super) fn may_hold<S: Simd>(
        &self,
        simd: S,
        face: &FaceStrips,
        [x0, x1, y0, y1]: &[f32x16<S>; 4],
    ) -> mask32x16<S> {
        self.has_pixel(simd, face, 0, [*x0, *x1]) & self.has_pixel(simd, face, 1, [*y0, *y1])
    }

    /// Whether a column or row of pixels may lie between two coordinates.
    #[inline(always)]
    fn has_pixel<S: Simd>(
        &self,
        simd: S,
        face: &FaceStrips,
        axis: usize,
        [from, to]: [f32x16<S>; 2],
    ) -> mask32x16<S> {
        let slack = f32x16::splat(simd, 0.5 - 2.0 * SLACK);
        let scale = self.pixels * face.scale[axis];
        let first = (from - face.low[axis]) * scale + slack;
        let last = (to - face.low[axis]) * scale - slack + f32x16::splat(simd, 1.0);
        // Numbers of pixels from one on: the last one that is not beyond, if it is not before.
        let last = last.max(f32x16::splat(simd, 0.0)).min(f32x16::splat(simd, MOST_PIXELS));
        let whole: u32x16<S> = u32x16::truncate_from(last);
        f32x16::float_from(whole).simd_ge(first)
    }
}

impl LatticeTiler {
    /// Brings the rays into strips, if the batch is an image that looks like a lattice.
    pub(super) fn tile(
        &mut self,
        level: SimdLevel,
        batch: &RayBatch<'_>,
        faces: &[Face],
        band_len: usize,
        strips: &mut RayStrips,
    ) -> bool {
        let ([face], Some(image)) = (faces, Image::of(batch)) else { return false };
        let Some(fit) = fit(level, batch, face, image) else { return false };
        strips.clear(faces);
        let columns = image.width.div_ceil(TILE_SIDE);
        let strip_count = image.height.div_ceil(TILE_SIDE);
        set_face(&mut strips.faces[0], &fit, [columns, strip_count]);
        let is_upward = fit.step[1] < 0.0;
        if self.made_for != Some((batch.order(), is_upward)) {
            self.made_for = Some((batch.order(), is_upward));
            self.order_rays(image, is_upward);
        }
        std::mem::swap(&mut self.ray_idx, &mut strips.ray_idx);
        strips.cells.clear();
        strips.cells.extend((0..=columns * strip_count).map(|cell| (cell * LANES) as u32));
        strips.cut_bands(band_len);
        true
    }

    /// Takes the order of the rays back, to use it again.
    pub(super) fn take_back(&mut self, strips: &mut RayStrips) {
        std::mem::swap(&mut self.ray_idx, &mut strips.ray_idx);
    }

    /// Tiles of 4 x 4 pixels along the strips, in the order in which y grows.
    fn order_rays(&mut self, image: Image, is_upward: bool) {
        let rows = image.height.div_ceil(TILE_SIDE);
        self.ray_idx.clear();
        for strip in 0..rows {
            let top = TILE_SIDE * if is_upward { rows - 1 - strip } else { strip };
            for left in (0..image.width).step_by(TILE_SIDE) {
                self.ray_idx.extend((0..LANES).map(|lane| {
                    let (x, y) = (left + lane % TILE_SIDE, top + lane / TILE_SIDE);
                    image.ray_idx(x, y).unwrap_or(NO_RAY)
                }));
            }
        }
    }

    /// Bytes held.
    pub(super) fn memory_usage(&self) -> usize {
        4 * self.ray_idx.capacity()
    }
}

/// Makes the strips of a face those of tiles of pixels.
fn set_face(face: &mut FaceStrips, fit: &Fit, [columns, strip_count]: [usize; 2]) {
    let side = TILE_SIDE as f32;
    let step = [fit.step[0], fit.step[1].abs()];
    let first_row = if fit.step[1] < 0.0 { strip_count as f32 * side - 0.5 } else { -0.5 };
    (face.columns, face.strip_count) = (columns, strip_count);
    face.low = [fit.first[0] - 0.5 * step[0], fit.first[1] + first_row * fit.step[1]];
    face.scale = step.map(|step| 1.0 / (side * step));
    face.tolerance = step.map(|step| SLACK * step);
    let [x0, x1, y0, y1] = face.window();
    let [x, y] = face.tolerance;
    face.bounds = [x0 - x, x1 + x, y0 - y, y1 + y];
    face.lattice = Some(Lattice { pixels: side });
    if let FaceKind::Parallel { reach } = &mut face.face.kind {
        *reach = fit.reach;
    }
}

/// Fits a lattice to the corners of an image, and asks some rays whether they lie on it.
fn fit(level: SimdLevel, batch: &RayBatch<'_>, face: &Face, image: Image) -> Option<Fit> {
    let (right, bottom) = (image.width - 1, image.height - 1);
    let point = |x, y| {
        let ray_idx = image.ray_idx(x, y)?;
        dispatch!(level.level(), simd => point(simd, batch, face, ray_idx))
    };
    let corners = [point(0, 0)?, point(right, 0)?, point(0, bottom)?, point(right, bottom)?];
    let [first, x_end, y_end, _] = corners;
    let step = [(x_end[0] - first[0]) / right as f32, (y_end[1] - first[1]) / bottom as f32];
    let is_upright = step[0] > 0.0 && step[1].abs() > 0.0;
    if !is_upright {
        return None;
    }
    for sample in 0..SAMPLE_SIDE * SAMPLE_SIDE {
        let (column, row) = (sample % SAMPLE_SIDE, sample / SAMPLE_SIDE);
        let pixel = [column * right, row * bottom].map(|place| place / (SAMPLE_SIDE - 1));
        let point = point(pixel[0], pixel[1])?;
        let is_on_lattice = (0..2).all(|axis| {
            let off = (point[axis] - first[axis]) / step[axis] - pixel[axis] as f32;
            off.abs() <= 0.5 * SLACK
        });
        if !is_on_lattice {
            return None;
        }
    }
    let reach = corners.iter().fold(f32::MIN_POSITIVE, |reach, corner| reach.max(corner[2]));
    Some(Fit { first: [first[0], first[1]], step, reach: WIDER * reach })
}

/// The point of an active ray, and how far its origin is from the face's center at most.
#[inline(always)]
fn point<S: Simd>(simd: S, batch: &RayBatch<'_>, face: &Face, ray_idx: u32) -> Option<[f32; 3]> {
    let mut columns = RayColumns::EMPTY;
    let mut positions = [NO_RAY; LANES];
    positions[0] = ray_idx;
    columns.gather(simd, batch, &positions);
    let points = face.project_rays(simd, columns.origin(simd), columns.direction(simd));
    let is_here = (columns.states(simd).active & points.on_face).to_bitmask() & 1 == 1;
    is_here.then(|| [points.x[0], points.y[0], extent(&points)[0]])
}

#[cfg(test)]
mod tests {
    use glam::Vec3;
    use rayflock_testkit::Rng;

    use super::super::faces::Faces;
    use super::*;

    const SIZE: [usize; 2] = [37, 22];

    /// Directions of a camera that looks at an angle to the axes, whose rows are `bent`.
    fn directions(bent: f32) -> Vec<Vec3> {
        let forward = Vec3::new(1.0, -2.0, 0.5).normalize();
        let (right, up) = forward.any_orthonormal_pair();
        let [width, height] = SIZE;
        (0..width * height)
            .map(|idx| {
                let (x, y) = (idx % width, idx / width);
                let x = (x as f32 + 0.5) / width as f32 - 0.5;
                let y = (y as f32 + 0.5) / height as f32 - 0.5 + bent * x * x;
                (3.0 * (forward + x * right - 0.6 * y * up)).normalize()
            })
            .collect()
    }

    /// The strips of a camera's image, if it is taken for a lattice.
    fn strips(level: SimdLevel, directions: &[Vec3]) -> Option<RayStrips> {
        let [width, height] = SIZE;
        let order = RayOrder::Image { width, height, tile: 0 };
        let batch = RayBatch::new(Vec3::ONE, directions).unwrap().with_order(order);
        let (mut faces, mut strips) = (Faces::default(), RayStrips::default());
        assert!(faces.choose(&batch));
        let mut tiler = LatticeTiler::default();
        tiler.tile(level, &batch, &faces.faces, 100, &mut strips).then_some(strips)
    }

    #[test]
    fn straight_cameras_are_lattices_and_bent_ones_are_not() {
        for level in SimdLevel::available() {
            let bent = strips(level, &directions(0.1));
            let strips = strips(level, &directions(0.0)).expect("a pinhole camera is a lattice");
            assert_eq!([strips.faces[0].columns, strips.faces[0].strip_count], [10, 6]);
            assert_eq!(strips.ray_idx.len(), 10 * 6 * LANES);
            assert!(bent.is_none(), "a bent camera is none");
        }
    }

    #[test]
    fn boxes_with_a_pixel_in_them_are_kept() {
        let mut rng = Rng::new(12);
        let [width, height] = SIZE;
        for level in SimdLevel::available() {
            let strips = strips(level, &directions(0.0)).expect("a pinhole camera is a lattice");
            let face = &strips.faces[0];
            let lattice = face.lattice.expect("a lattice");
            let step = face.scale.map(|scale| 1.0 / (scale * lattice.pixels));
            let (mut empty_count, mut kept_count) = (0, 0);
            for _ in 0..4000 {
                // In pixels, whose points are at numbers and a half.
                let (x, y) = (width as f32 * rng.unit(), height as f32 * rng.unit());
                let size = 4.0 * 0.5_f32.powi(rng.below(6) as i32);
                let bounds = [x, x + size * rng.unit(), y, y + size * rng.unit()];
                let place = |axis: usize| face.low[axis / 2] + bounds[axis] * step[axis / 2];
                let is_kept = dispatch!(level.level(), simd => {
                    let lanes = [0, 1, 2, 3].map(|axis| f32x16::splat(simd, place(axis)));
                    lattice.may_hold(simd, face, &lanes).all_true()
                });
                let has = |low: f32, high: f32| (high - 0.5).floor() >= (low - 0.5).ceil();
                let has_pixel = has(bounds[0], bounds[1]) && has(bounds[2], bounds[3]);
                assert!(is_kept || !has_pixel, "{bounds:?}");
                empty_count += usize::from(!has_pixel);
                kept_count += usize::from(is_kept && !has_pixel);
            }
            assert!(8 * kept_count < empty_count, "{kept_count} of {empty_count}");
        }
    }
}
