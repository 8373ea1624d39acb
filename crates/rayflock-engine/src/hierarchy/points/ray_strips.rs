//! Rays of the faces, in an order in which a triangle's box becomes ranges of rays by arithmetic.
//!
//! ```text
//!   strip   a row of cells across a face
//!   cell    some consecutive rays
//!   group   sixteen consecutive rays, over the ends of cells
//!   band    consecutive cells that one task traces
//! ```
//!
//! **Invariants.** Points of rays and corners of boxes become strips and columns by the same
//! monotone operations, so a ray whose point lies in a box, widened by the tolerance, is in one of
//! the cells between those of the corners. Points outside the window count for its border.

use rayflock_geom::simd::LANES;
use rayflock_geom::simd::face::{Face, FaceKind, RayPoints};
use rayflock_geom::simd::{
    Select, Simd, SimdBase, SimdCvtFloat, SimdCvtTruncate, SimdMask, f32x16, mask32x16, u32x16,
};

use super::lattice::Lattice;
use super::occupancy::Occupancy;

/// By how much of their height strips reach into others, for rounding.
const OVERLAP: f32 = 0.05;

/// The rays of all faces.
#[derive(Debug, Default)]
pub(super) struct RayStrips {
    pub(super) faces: Vec<FaceStrips>,
    /// For each cell of all strips, how many rays come before it; then how many there are, and what
    /// is left of a table of a size that suits the sorter.
    pub(super) cells: Vec<u32>,
    /// Positions in the batch, cell after cell; each band fills whole groups, with `NO_RAY` at its
    /// end.
    pub(super) ray_idx: Vec<u32>,
    pub(super) bands: Vec<Band>,
    /// The first and the last band that has a cell of the strip.
    pub(super) bands_of_strip: Vec<[u32; 2]>,
}

/// Consecutive cells of one face.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Band {
    pub(super) face_idx: usize,
    pub(super) first_cell: usize,
    pub(super) end_cell: usize,
    /// The first and the last strip of its face of which it has cells.
    own_strips: [usize; 2],
    /// Its rays, where bands are not filled up to whole groups.
    pub(super) first_ray: usize,
    pub(super) end_ray: usize,
    /// Where its rays are in `ray_idx`.
    pub(super) first_place: usize,
    pub(super) end_place: usize,
}

/// The strips of one face.
#[derive(Debug)]
pub(super) struct FaceStrips {
    pub(super) face: Face,
    /// Around the points of all rays: least and largest x, least and largest y.
    pub(super) bounds: [f32; 4],
    /// Strips of faces before it.
    pub(super) first_strip: usize,
    pub(super) strip_count: usize,
    /// Cells in a strip.
    pub(super) columns: usize,
    /// The least x and y of the window.
    pub(super) low: [f32; 2],
    /// Columns and strips for each unit of x and of y.
    pub(super) scale: [f32; 2],
    /// How far the point of a ray may lie beside its cell.
    pub(super) tolerance: [f32; 2],
    /// What is claimed of each ray and has to be seen, where rays were not sorted.
    pub(super) lattice: Option<Lattice>,
    /// Where rays are, if it is worth asking.
    pub(super) occupancy: Occupancy,
    pub(super) asks_occupancy: bool,
}

impl Band {
    /// The strips of its face from the first to the last, for sixteen, of which it has cells.
    #[inline(always)]
    pub(super) fn strips<S: Simd>(&self, simd: S, [first, last]: [u32x16<S>; 2]) -> [u32x16<S>; 2] {
        let [own_first, own_last] = self.own_strips;
        let splat = |strip: usize| u32x16::splat(simd, strip as u32);
        [first.max(splat(own_first)), last.min(splat(own_last))]
    }
}

impl FaceStrips {
    /// A face without rays.
    pub(super) fn new(face: Face) -> Self {
        Self {
            face,
            bounds: [f32::INFINITY, f32::NEG_INFINITY, f32::INFINITY, f32::NEG_INFINITY],
            first_strip: 0,
            strip_count: 1,
            columns: 1,
            low: [0.0; 2],
            scale: [0.0; 2],
            tolerance: [0.0; 2],
            lattice: None,
            occupancy: Occupancy::default(),
            asks_occupancy: false,
        }
    }

    /// Whether there is no ray to be traced.
    pub(super) fn is_empty(&self) -> bool {
        self.bounds[0] > self.bounds[1]
    }

    /// The window of cells: least and largest x, least and largest y.
    pub(super) fn window(&self) -> [f32; 4] {
        let size = [self.columns as f32 / self.scale[0], self.strip_count as f32 / self.scale[1]];
        let [x, y] = self.low;
        [x, x + size[0], y, y + size[1]]
    }

    /// Columns (axis 0) or strips (axis 1) of coordinates.
    #[inline(always)]
    pub(super) fn places<S: Simd>(&self, simd: S, value: f32x16<S>, axis: usize) -> u32x16<S> {
        let count = if axis == 0 { self.columns } else { self.strip_count };
        let most = f32x16::splat(simd, (count - 1) as f32);
        let place = (value - self.low[axis]) * self.scale[axis];
        u32x16::truncate_from(place.max(f32x16::splat(simd, 0.0)).min(most))
    }

    /// The strips from the first to the last that boxes may touch.
    #[inline(always)]
    pub(super) fn box_strips<S: Simd>(&self, simd: S, bounds: &[f32x16<S>; 4]) -> [u32x16<S>; 2] {
        let tolerance = f32x16::splat(simd, self.tolerance[1]);
        [self.places(simd, bounds[2] - tolerance, 1), self.places(simd, bounds[3] + tolerance, 1)]
    }

    /// The strips from the first to the last between two y.
    pub(super) fn strips(&self, [y0, y1]: [f32; 2]) -> [usize; 2] {
        let last = self.strip_count - 1;
        let strip = |y: f32| (((y - self.low[1]) * self.scale[1]).max(0.0) as usize).min(last);
        [strip(y0 - self.tolerance[1]), strip(y1 + self.tolerance[1])]
    }

    /// The columns from the first to the last between two x.
    #[inline(always)]
    pub(super) fn box_columns<S: Simd>(&self, simd: S, [x0, x1]: [f32x16<S>; 2]) -> [u32x16<S>; 2] {
        let tolerance = f32x16::splat(simd, self.tolerance[0]);
        [self.places(simd, x0 - tolerance, 0), self.places(simd, x1 + tolerance, 0)]
    }

    /// Least and largest y of the points in strips.
    #[inline(always)]
    pub(super) fn heights<S: Simd>(&self, simd: S, strip: u32x16<S>) -> [f32x16<S>; 2] {
        let splat = f32x16::splat;
        let step = splat(simd, 1.0 / self.scale[1]);
        let start = splat(simd, self.low[1]);
        let at = f32x16::float_from(strip);
        let low = (at - OVERLAP) * step + start;
        let high = (at + (1.0 + OVERLAP)) * step + start;
        let is_first = strip.simd_eq(u32x16::splat(simd, 0));
        let is_last = strip.simd_eq(u32x16::splat(simd, self.strip_count as u32 - 1));
        let low = is_first.select(splat(simd, self.bounds[2]), low);
        let high = is_last.select(splat(simd, self.bounds[3]), high);
        [low - self.tolerance[1], high + self.tolerance[1]]
    }

    /// Which of the `asked` boxes a ray may be in, if that is worth asking: from the size of boxes,
    /// or, more `closely`, cell by cell.
    #[inline(always)]
    pub(super) fn keep<S: Simd>(
        &self,
        simd: S,
        bounds: &[f32x16<S>; 4],
        asked: mask32x16<S>,
        closely: bool,
    ) -> mask32x16<S> {
        if !self.asks_occupancy || !asked.any_true() {
            asked
        } else if let Some(lattice) = &self.lattice {
            asked & lattice.may_hold(simd, self, bounds)
        } else if closely {
            self.occupancy.keep_closely(simd, bounds, asked)
        } else {
            self.occupancy.keep(simd, bounds, asked)
        }
    }

    /// Which points lie in a cell, as far as is tolerated, and within what is said of all.
    #[inline(always)]
    pub(super) fn holds<S: Simd>(
        &self,
        simd: S,
        points: &RayPoints<S>,
        cell: usize,
    ) -> mask32x16<S> {
        let mut holds = points.on_face;
        let places = [cell % self.columns, cell / self.columns];
        for (axis, value) in [points.x, points.y].into_iter().enumerate() {
            let tolerance = f32x16::splat(simd, self.tolerance[axis]);
            let place = u32x16::splat(simd, places[axis] as u32);
            holds &= self.places(simd, value - tolerance, axis).simd_le(place);
            holds &= self.places(simd, value + tolerance, axis).simd_ge(place);
            holds &= value.simd_ge(f32x16::splat(simd, self.bounds[2 * axis]));
            holds &= value.simd_le(f32x16::splat(simd, self.bounds[2 * axis + 1]));
        }
        if let FaceKind::Parallel { reach } = self.face.kind {
            holds &= extent(points).simd_le(f32x16::splat(simd, reach));
        }
        holds
    }
}

/// How far origins are from the center of their face at most, along all axes together.
#[inline(always)]
pub(super) fn extent<S: Simd>(points: &RayPoints<S>) -> f32x16<S> {
    points.x.abs() + points.y.abs() + points.start.abs()
}

impl RayStrips {
    /// Whether the faces are the six sides of a cube: along each axis, then against it.
    pub(super) fn is_cube(&self) -> bool {
        self.faces.len() == 6
    }

    /// Takes these faces, without rays.
    pub(super) fn clear(&mut self, faces: &[Face]) {
        self.faces.truncate(faces.len());
        for (idx, &face) in faces.iter().enumerate() {
            if let Some(place) = self.faces.get_mut(idx) {
                let occupancy = std::mem::take(&mut place.occupancy);
                *place = FaceStrips { occupancy, ..FaceStrips::new(face) };
            } else {
                self.faces.push(FaceStrips::new(face));
            }
        }
    }

    /// Cuts the cells into bands of about `band_len` rays, once `cells` are written.
    pub(super) fn cut_bands(&mut self, band_len: usize) {
        self.bands.clear();
        let mut place = 0;
        for (face_idx, face) in self.faces.iter().enumerate() {
            let end = (face.first_strip + face.strip_count) * face.columns;
            let mut first = face.first_strip * face.columns;
            while first < end {
                let first_ray = self.cells[first] as usize;
                let fitting = &self.cells[first + 1..=end];
                let fits = |&ray: &u32| ray as usize <= first_ray + band_len;
                let last = first + fitting.partition_point(fits).max(1);
                let end_ray = self.cells[last] as usize;
                let end_place = place + (end_ray - first_ray).next_multiple_of(LANES);
                let strip_of = |cell: usize| cell / face.columns - face.first_strip;
                self.bands.push(Band {
                    face_idx,
                    first_cell: first,
                    end_cell: last,
                    own_strips: [strip_of(first), strip_of(last - 1)],
                    first_ray,
                    end_ray,
                    first_place: place,
                    end_place,
                });
                (first, place) = (last, end_place);
            }
        }
        self.note_bands_of_strips();
    }

    fn note_bands_of_strips(&mut self) {
        self.bands_of_strip.clear();
        let mut band_idx = 0;
        for face in &self.faces {
            for strip in face.first_strip..face.first_strip + face.strip_count {
                let end = (strip + 1) * face.columns;
                let first = band_idx;
                while self.bands[band_idx].end_cell < end {
                    band_idx += 1;
                }
                self.bands_of_strip.push([first as u32, band_idx as u32]);
                band_idx += usize::from(self.bands[band_idx].end_cell == end);
            }
        }
    }

    /// Bytes held.
    pub(super) fn memory_usage(&self) -> usize {
        4 * (self.ray_idx.capacity() + self.cells.capacity() + 2 * self.bands_of_strip.capacity())
            + self.bands.capacity() * size_of::<Band>()
            + self.faces.iter().map(|face| face.occupancy.memory_usage()).sum::<usize>()
    }
}
