//! The question: many rays at once, as columns, with what the caller knows about their order.

use glam::Vec3;
use thiserror::Error;

use crate::{Column, Ray};

/// What the caller knows about how neighbours in the batch relate in space.
///
/// A hint changes speed, never an answer: a wrong one is slow and right.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum RayOrder {
    /// Rows of an image, `width * height == len`; neighbours in both directions are close.
    Image {
        /// Rays a row.
        width: usize,
        /// Number of rows.
        height: usize,
        /// `0`: row by row. Otherwise the rays come in square tiles of this many pixels a side,
        /// rows of tiles from the top, rows within each tile.
        tile: usize,
    },
    /// Neighbours in the array are neighbours in space.
    Coherent,
    /// Each run of this many rays shares an origin.
    Groups(usize),
    /// Nothing is known.
    #[default]
    Unordered,
}

/// A batch of rays: five borrowed columns and an order hint.
///
/// All per-ray columns have the length of the batch. See [`Ray`] for what the columns mean.
#[derive(Clone, Copy, Debug)]
pub struct RayBatch<'a> {
    len: usize,
    origin: Column<'a, Vec3>,
    direction: Column<'a, Vec3>,
    t_min: Column<'a, f32>,
    t_max: Column<'a, f32>,
    mask: Column<'a, u32>,
    order: RayOrder,
}

/// Why columns do not make a batch.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum RayBatchError {
    /// A per-ray column is shorter or longer than the batch.
    #[error("the {column} column has {found} rays, the batch has {expected}")]
    Length {
        /// Which column.
        column: &'static str,
        /// Rays in that column.
        found: usize,
        /// Rays in the batch.
        expected: usize,
    },
}

impl<'a> RayBatch<'a> {
    /// A batch of rays with the interval `0..=infinity` and all mask bits set, in no known order.
    ///
    /// The length is that of the per-ray columns; two uniform columns make one ray.
    ///
    /// # Errors
    /// [`RayBatchError::Length`] when both columns are per ray and differ in length.
    pub fn new(
        origin: impl Into<Column<'a, Vec3>>,
        direction: impl Into<Column<'a, Vec3>>,
    ) -> Result<Self, RayBatchError> {
        let (origin, direction) = (origin.into(), direction.into());
        let len = origin.len().or(direction.len()).unwrap_or(1);
        check_len("direction", direction.len(), len)?;
        Ok(Self {
            len,
            origin,
            direction,
            t_min: Column::Uniform(0.0),
            t_max: Column::Uniform(f32::INFINITY),
            mask: Column::Uniform(u32::MAX),
            order: RayOrder::Unordered,
        })
    }

    /// Limits the rays to `t_min..=t_max`, in multiples of the direction's length.
    ///
    /// # Errors
    /// [`RayBatchError::Length`] when a per-ray column is not as long as the batch.
    pub fn with_interval(
        mut self,
        t_min: impl Into<Column<'a, f32>>,
        t_max: impl Into<Column<'a, f32>>,
    ) -> Result<Self, RayBatchError> {
        (self.t_min, self.t_max) = (t_min.into(), t_max.into());
        check_len("t_min", self.t_min.len(), self.len)?;
        check_len("t_max", self.t_max.len(), self.len)?;
        Ok(self)
    }

    /// Sets which objects the rays see.
    ///
    /// # Errors
    /// [`RayBatchError::Length`] when a per-ray column is not as long as the batch.
    pub fn with_mask(mut self, mask: impl Into<Column<'a, u32>>) -> Result<Self, RayBatchError> {
        self.mask = mask.into();
        check_len("mask", self.mask.len(), self.len)?;
        Ok(self)
    }

    /// States how neighbours relate. Any hint is allowed; see [`RayOrder`].
    pub const fn with_order(mut self, order: RayOrder) -> Self {
        self.order = order;
        self
    }

    /// The same rays, where those whose origins or directions are all the same say so: engines are
    /// faster with rays that share one, and cannot tell from an array. See [`Column::unified`].
    pub fn unified(mut self) -> Self {
        (self.origin, self.direction) = (self.origin.unified(), self.direction.unified());
        self
    }

    /// Number of rays.
    pub const fn len(&self) -> usize {
        self.len
    }

    /// Whether there is no ray.
    pub const fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// The origins.
    pub const fn origin(&self) -> &Column<'a, Vec3> {
        &self.origin
    }

    /// The directions.
    pub const fn direction(&self) -> &Column<'a, Vec3> {
        &self.direction
    }

    /// Where the intervals begin.
    pub const fn t_min(&self) -> &Column<'a, f32> {
        &self.t_min
    }

    /// Where the intervals end.
    pub const fn t_max(&self) -> &Column<'a, f32> {
        &self.t_max
    }

    /// Which objects the rays see.
    pub const fn mask(&self) -> &Column<'a, u32> {
        &self.mask
    }

    /// The order hint.
    pub const fn order(&self) -> RayOrder {
        self.order
    }

    /// Ray `ray_idx`, gathered from the columns.
    ///
    /// # Panics
    /// When `ray_idx >= len()` and some column is per ray.
    #[inline(always)]
    pub fn ray(&self, ray_idx: usize) -> Ray {
        Ray {
            origin: self.origin.get(ray_idx),
            direction: self.direction.get(ray_idx),
            t_min: self.t_min.get(ray_idx),
            t_max: self.t_max.get(ray_idx),
            mask: self.mask.get(ray_idx),
        }
    }

    /// The `len` rays from `start`, as a batch of their own. An image order becomes `Coherent`.
    ///
    /// # Panics
    /// When `start + len` exceeds the batch.
    pub fn slice(&self, start: usize, len: usize) -> Self {
        assert!(start + len <= self.len, "a slice of a batch must lie inside it");
        let order = match self.order {
            RayOrder::Image { .. } => RayOrder::Coherent,
            order => order,
        };
        Self {
            len,
            origin: self.origin.skip(start),
            direction: self.direction.skip(start),
            t_min: self.t_min.skip(start),
            t_max: self.t_max.skip(start),
            mask: self.mask.skip(start),
            order,
        }
    }
}

fn check_len(
    column: &'static str,
    found: Option<usize>,
    expected: usize,
) -> Result<(), RayBatchError> {
    match found {
        Some(found) if found != expected => Err(RayBatchError::Length { column, found, expected }),
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_of_unequal_length_are_an_error_that_names_the_column() {
        let origins = [Vec3::ZERO; 3];
        let directions = [Vec3::X; 2];
        let error = RayBatch::new(&origins[..], &directions[..]).unwrap_err();
        assert_eq!(error.to_string(), "the direction column has 2 rays, the batch has 3");
        let batch = RayBatch::new(&origins[..], Vec3::X).unwrap();
        let error = batch.with_interval(0.0, &[1.0_f32][..]).unwrap_err();
        assert_eq!(error.to_string(), "the t_max column has 1 rays, the batch has 3");
        assert!(batch.with_mask(&[1_u32; 4][..]).is_err());
    }

    #[test]
    fn a_slice_counts_from_its_start() {
        let origins: Vec<Vec3> = (0..5_u8).map(|i| Vec3::splat(f32::from(i))).collect();
        let t_max = [1.0_f32, 2.0, 3.0, 4.0, 5.0];
        let batch = RayBatch::new(&origins, Vec3::X).unwrap();
        let batch = batch.with_interval(0.0, &t_max[..]).unwrap();
        let slice = batch.slice(3, 2);
        assert_eq!(slice.len(), 2);
        assert_eq!(slice.ray(1), batch.ray(4));
    }

    #[test]
    fn two_uniform_columns_make_one_ray() {
        assert_eq!(RayBatch::new(Vec3::ZERO, Vec3::X).unwrap().len(), 1);
        assert!(RayBatch::new(&[] as &[Vec3], Vec3::X).unwrap().is_empty());
    }
}
