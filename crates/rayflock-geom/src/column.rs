//! Borrowed columns: one value for a whole batch, or one value a ray, read in place.

use bytemuck::Pod;
use glam::Vec3;

use crate::prefetch;
use crate::simd::axes::{Axes, load_axes, splat_axes};
use crate::simd::{LANES, Simd, SimdBase, f32x16, point_columns, u32x16};

/// A value that a [`Column`] can hold, stored as consecutive scalars.
pub trait ColumnElement: Copy {
    /// The scalar the column is made of.
    type Scalar: Pod;
    /// How many scalars one value takes.
    const WIDTH: usize;
    /// One value a lane, as columns of scalars.
    type Lanes: Copy;
    /// Reads a value from its `WIDTH` scalars.
    fn load(scalars: &[Self::Scalar]) -> Self;
    /// The value in every lane.
    fn splat(self) -> Self::Lanes;
    /// Writes one lane.
    fn set_lane(self, lanes: &mut Self::Lanes, lane: usize);
}

impl ColumnElement for f32 {
    type Scalar = f32;
    const WIDTH: usize = 1;
    #[inline(always)]
    fn load(scalars: &[f32]) -> Self {
        scalars[0]
    }
    type Lanes = [f32; LANES];
    #[inline(always)]
    fn splat(self) -> [f32; LANES] {
        [self; LANES]
    }
    #[inline(always)]
    fn set_lane(self, lanes: &mut [f32; LANES], lane: usize) {
        lanes[lane] = self;
    }
}

impl ColumnElement for u32 {
    type Scalar = u32;
    const WIDTH: usize = 1;
    #[inline(always)]
    fn load(scalars: &[u32]) -> Self {
        scalars[0]
    }
    type Lanes = [u32; LANES];
    #[inline(always)]
    fn splat(self) -> [u32; LANES] {
        [self; LANES]
    }
    #[inline(always)]
    fn set_lane(self, lanes: &mut [u32; LANES], lane: usize) {
        lanes[lane] = self;
    }
}

impl ColumnElement for Vec3 {
    type Scalar = f32;
    const WIDTH: usize = 3;
    #[inline(always)]
    fn load(scalars: &[f32]) -> Self {
        Self::new(scalars[0], scalars[1], scalars[2])
    }
    type Lanes = [[f32; LANES]; 3];
    #[inline(always)]
    fn splat(self) -> [[f32; LANES]; 3] {
        [[self.x; LANES], [self.y; LANES], [self.z; LANES]]
    }
    #[inline(always)]
    fn set_lane(self, [x, y, z]: &mut [[f32; LANES]; 3], lane: usize) {
        (x[lane], y[lane], z[lane]) = (self.x, self.y, self.z);
    }
}

/// One property of every ray of a batch.
///
/// A uniform column is more than a saving of memory: it tells an engine that all rays share an
/// origin (a pinhole camera, a point light) or a direction (the sun).
#[derive(Clone, Copy, Debug)]
pub enum Column<'a, T: ColumnElement> {
    /// All rays share this value.
    Uniform(T),
    /// Ray `i` has the value at `values[i * stride..i * stride + T::WIDTH]`.
    PerRay {
        /// The scalars, of any number of interleaved columns.
        values: &'a [T::Scalar],
        /// Scalars from one ray's value to the next ray's, at least `T::WIDTH`;
        /// [`Column::strided`] checks it.
        stride: usize,
    },
}

impl<'a, T: ColumnElement> Column<'a, T> {
    /// A column of densely packed values.
    pub const fn packed(values: &'a [T::Scalar]) -> Self {
        Self::PerRay { values, stride: T::WIDTH }
    }

    /// A column read in place from a wider table: `values` starts at the first ray's value, and
    /// `stride` scalars lie between one value and the next. An `(n, 6)` array of origins and
    /// directions is `strided(&array, 6)` and `strided(&array[3..], 6)`.
    ///
    /// # Panics
    /// When `stride` is smaller than one value.
    pub const fn strided(values: &'a [T::Scalar], stride: usize) -> Self {
        assert!(stride >= T::WIDTH, "the stride of a column must hold at least one value");
        Self::PerRay { values, stride }
    }

    /// The number of values, or `None` for a uniform column, which has any.
    pub const fn len(&self) -> Option<usize> {
        match self {
            Self::Uniform(_) => None,
            Self::PerRay { values, stride } => {
                Some((values.len() + (*stride - T::WIDTH)) / *stride)
            }
        }
    }

    /// Whether this is a column per ray with no ray.
    pub const fn is_empty(&self) -> bool {
        matches!(self.len(), Some(0))
    }

    /// The one value of a uniform column.
    pub const fn uniform(&self) -> Option<T> {
        match self {
            Self::Uniform(value) => Some(*value),
            Self::PerRay { .. } => None,
        }
    }

    /// The column as a uniform one where all rays have the same value, to the bit.
    ///
    /// An array of rays does not say that they share an origin or a direction; whoever hands one
    /// on can look. Ends at the first value that differs.
    pub fn unified(self) -> Self {
        let Self::PerRay { values, stride } = self else { return self };
        let Some(first) = values.get(..T::WIDTH) else { return self };
        let bytes =
            |value: &'a [T::Scalar]| -> &'a [u8] { bytemuck::cast_slice(&value[..T::WIDTH]) };
        let is_first = |value| bytes(value) == bytes(first);
        let len = self.len().unwrap_or_default();
        let last = &values[(len - 1) * stride..];
        let mut whole = values[..(len - 1) * stride].chunks_exact(stride);
        if whole.all(is_first) && is_first(last) { Self::Uniform(T::load(first)) } else { self }
    }

    /// The value of ray `ray_idx`.
    ///
    /// # Panics
    /// When a per-ray column has no such ray.
    #[inline(always)]
    pub fn get(&self, ray_idx: usize) -> T {
        match self {
            Self::Uniform(value) => *value,
            Self::PerRay { values, stride } => {
                let start = ray_idx * stride;
                T::load(&values[start..start + T::WIDTH])
            }
        }
    }

    /// Asks for the value of ray `ray_idx`, so that it is in the cache when it is read. Nothing
    /// happens where all share one, or where there is none.
    #[inline(always)]
    pub fn ask_for(&self, ray_idx: usize) {
        if let Self::PerRay { values, stride } = self {
            let first = ray_idx.checked_mul(*stride).and_then(|start| values.get(start));
            first.into_iter().for_each(prefetch);
        }
    }

    /// The values of sixteen rays from `first_ray` on, a lane a ray; the value of the last ray
    /// again where there are no more.
    ///
    /// # Panics
    /// When a per-ray column has no ray `first_ray`.
    #[inline(always)]
    pub fn lanes(&self, first_ray: usize) -> T::Lanes {
        match self {
            Self::Uniform(value) => value.splat(),
            // A stride that is known spares the compiler most bounds checks.
            Self::PerRay { values, stride } if *stride == T::WIDTH => {
                load_lanes::<T>(&values[first_ray * T::WIDTH..], T::WIDTH)
            }
            Self::PerRay { values, stride } => {
                load_lanes::<T>(&values[first_ray * stride..], *stride)
            }
        }
    }

    /// The rays from `start`, as a column that counts from 0.
    pub(crate) fn skip(&self, start: usize) -> Self {
        match self {
            Self::Uniform(value) => Self::Uniform(*value),
            Self::PerRay { values, stride } => Self::PerRay {
                values: &values[(start * stride).min(values.len())..],
                stride: *stride,
            },
        }
    }
}

/// The first sixteen values.
#[inline(always)]
fn load_lanes<T: ColumnElement>(values: &[T::Scalar], stride: usize) -> T::Lanes {
    let mut lanes = T::load(&values[..T::WIDTH]).splat();
    if let Some(whole) = values.get(..(LANES - 1) * stride + T::WIDTH) {
        for lane in 0..LANES {
            T::load(&whole[lane * stride..lane * stride + T::WIDTH]).set_lane(&mut lanes, lane);
        }
        return lanes;
    }
    let last = (values.len() - T::WIDTH) / stride;
    for lane in 0..LANES {
        let start = lane.min(last) * stride;
        T::load(&values[start..start + T::WIDTH]).set_lane(&mut lanes, lane);
    }
    lanes
}

impl Column<'_, Vec3> {
    /// The points of sixteen rays from `first_ray` on, by axis, as [`Self::lanes`] gives them.
    #[inline(always)]
    pub fn axes<S: Simd>(&self, simd: S, first_ray: usize) -> Axes<S> {
        match self {
            Self::Uniform(value) => splat_axes(simd, *value),
            Self::PerRay { values, stride } => {
                let columns = point_columns(simd, &values[first_ray * stride..], *stride);
                columns.unwrap_or_else(|| load_axes(simd, &self.lanes(first_ray)))
            }
        }
    }
}

impl Column<'_, f32> {
    /// The values of sixteen rays from `first_ray` on, as [`Self::lanes`] gives them. What was
    /// written lane by lane can't be read as a whole for some time.
    #[inline(always)]
    pub fn vector<S: Simd>(&self, simd: S, first_ray: usize) -> f32x16<S> {
        match self {
            Self::Uniform(value) => f32x16::splat(simd, *value),
            Self::PerRay { values, stride: 1 } if first_ray + LANES <= values.len() => {
                f32x16::from_slice(simd, &values[first_ray..first_ray + LANES])
            }
            Self::PerRay { .. } => f32x16::from_slice(simd, &self.lanes(first_ray)),
        }
    }
}

impl Column<'_, u32> {
    /// The values of sixteen rays from `first_ray` on, likewise.
    #[inline(always)]
    pub fn vector<S: Simd>(&self, simd: S, first_ray: usize) -> u32x16<S> {
        match self {
            Self::Uniform(value) => u32x16::splat(simd, *value),
            Self::PerRay { values, stride: 1 } if first_ray + LANES <= values.len() => {
                u32x16::from_slice(simd, &values[first_ray..first_ray + LANES])
            }
            Self::PerRay { .. } => u32x16::from_slice(simd, &self.lanes(first_ray)),
        }
    }
}

impl<T: ColumnElement> From<T> for Column<'_, T> {
    fn from(value: T) -> Self {
        Self::Uniform(value)
    }
}

impl<'a> From<&'a [Vec3]> for Column<'a, Vec3> {
    fn from(values: &'a [Vec3]) -> Self {
        Self::packed(bytemuck::cast_slice(values))
    }
}

impl<'a> From<&'a Vec<Vec3>> for Column<'a, Vec3> {
    fn from(values: &'a Vec<Vec3>) -> Self {
        values.as_slice().into()
    }
}

impl<'a> From<&'a [[f32; 3]]> for Column<'a, Vec3> {
    fn from(values: &'a [[f32; 3]]) -> Self {
        Self::packed(values.as_flattened())
    }
}

impl<'a, T: ColumnElement<Scalar = T>> From<&'a [T]> for Column<'a, T> {
    fn from(values: &'a [T]) -> Self {
        Self::packed(values)
    }
}

impl<'a, T: ColumnElement<Scalar = T>> From<&'a Vec<T>> for Column<'a, T> {
    fn from(values: &'a Vec<T>) -> Self {
        Self::packed(values)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_n_by_6_array_is_read_in_place() {
        let array: Vec<f32> = (0..12_u8).map(f32::from).collect();
        let origins = Column::<Vec3>::strided(&array, 6);
        let directions = Column::<Vec3>::strided(&array[3..], 6);
        assert_eq!((origins.len(), directions.len()), (Some(2), Some(2)));
        assert_eq!(origins.get(1), Vec3::new(6.0, 7.0, 8.0));
        assert_eq!(directions.get(1), Vec3::new(9.0, 10.0, 11.0));
        assert_eq!(directions.skip(1).get(0), Vec3::new(9.0, 10.0, 11.0));
    }

    #[test]
    fn any_ray_may_be_asked_for() {
        let scalars = [1.0; 6];
        for column in [Column::<Vec3>::packed(&scalars), Column::from(Vec3::X)] {
            [0, 1, 2, u32::MAX as usize, usize::MAX]
                .into_iter()
                .for_each(|idx| column.ask_for(idx));
        }
    }

    #[test]
    fn lanes_hold_sixteen_rays_or_the_last_one_again() {
        let scalars: Vec<f32> = (0..240_u8).map(f32::from).collect();
        for stride in [3, 4, 6] {
            for len in [1, 15, 16, 17, 40] {
                let column = Column::<Vec3>::strided(&scalars[..(len - 1) * stride + 3], stride);
                for first_ray in [0, len / 2, len - 1] {
                    let lanes = column.lanes(first_ray);
                    for lane in 0..LANES {
                        let expected = column.get((first_ray + lane).min(len - 1)).to_array();
                        assert_eq!(lanes.map(|axis| axis[lane]), expected, "{stride}, {len}");
                    }
                }
            }
        }
        let masks: Vec<u32> = (0..20).collect();
        let column = Column::from(&masks);
        assert!(column.lanes(2).into_iter().eq(2..18));
        assert_eq!(column.lanes(10)[9..], [19; 7]);
        assert_eq!(Column::from(2.5_f32).lanes(7), [2.5; LANES]);
        assert_eq!(Column::from(Vec3::Y).lanes(7)[1], [1.0; LANES]);
    }

    #[test]
    fn a_column_of_one_value_becomes_uniform_and_no_other() {
        let rays = [[1.0, 2.0, 3.0, 0.0, 0.0, 1.0], [1.0, 2.0, 3.0, 0.0, -0.0, 1.0]];
        let scalars = rays.as_flattened();
        let origins = Column::<Vec3>::strided(scalars, 6).unified();
        assert_eq!(origins.uniform(), Some(Vec3::new(1.0, 2.0, 3.0)));
        // Zeros of both signs compare equal, but are not the same.
        assert_eq!(Column::<Vec3>::strided(&scalars[3..], 6).unified().uniform(), None);
        assert_eq!(Column::from(&[f32::NAN; 3][..]).unified().len(), None);
        assert_eq!(Column::from(&[0.0, 0.0, 1.0][..]).unified().len(), Some(3));
        assert_eq!(Column::from(&[] as &[f32]).unified().len(), Some(0));
    }

    #[test]
    fn a_uniform_column_has_any_length() {
        let column = Column::from(2.5_f32);
        assert_eq!((column.len(), column.get(1000), column.uniform()), (None, 2.5, Some(2.5)));
    }
}
