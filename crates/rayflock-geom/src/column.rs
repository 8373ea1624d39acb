//! Borrowed columns: one value for a whole batch, or one value a ray, read in place.

use bytemuck::Pod;
use glam::Vec3;

/// A value that a [`Column`] can hold, stored as consecutive scalars.
pub trait ColumnElement: Copy {
    /// The scalar the column is made of.
    type Scalar: Pod;
    /// How many scalars one value takes.
    const WIDTH: usize;
    /// Reads a value from its `WIDTH` scalars.
    fn load(scalars: &[Self::Scalar]) -> Self;
}

impl ColumnElement for f32 {
    type Scalar = f32;
    const WIDTH: usize = 1;
    #[inline(always)]
    fn load(scalars: &[f32]) -> Self {
        scalars[0]
    }
}

impl ColumnElement for u32 {
    type Scalar = u32;
    const WIDTH: usize = 1;
    #[inline(always)]
    fn load(scalars: &[u32]) -> Self {
        scalars[0]
    }
}

impl ColumnElement for Vec3 {
    type Scalar = f32;
    const WIDTH: usize = 3;
    #[inline(always)]
    fn load(scalars: &[f32]) -> Self {
        Self::new(scalars[0], scalars[1], scalars[2])
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
    fn a_uniform_column_has_any_length() {
        let column = Column::from(2.5_f32);
        assert_eq!((column.len(), column.get(1000), column.uniform()), (None, 2.5, Some(2.5)));
    }
}
