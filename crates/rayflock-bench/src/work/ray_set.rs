//! Rays that own their columns.

use std::sync::Arc;

use rayflock::geom::{Column, ColumnElement, RayBatch, RayOrder};
use rayflock::prelude::Vec3;

use super::{Question, RayKind};

/// All rays of one kind of one frame.
#[derive(Clone, Debug)]
pub struct RaySet {
    kind: RayKind,
    parts: Vec<Rays>,
}

/// One batch.
#[derive(Clone, Debug)]
pub(super) struct Rays {
    pub(super) origin: Values<Vec3>,
    pub(super) direction: Values<Vec3>,
    pub(super) t_max: Values<f32>,
    pub(super) order: RayOrder,
}

/// An owned column; batches that agree in one share it.
#[derive(Clone, Debug)]
pub(super) enum Values<T> {
    /// One value for all rays.
    Uniform(T),
    /// One value a ray.
    PerRay(Arc<[T]>),
}

impl<T> FromIterator<T> for Values<T> {
    fn from_iter<I: IntoIterator<Item = T>>(values: I) -> Self {
        Self::PerRay(values.into_iter().collect())
    }
}

impl<T> Values<T> {
    fn column<'a>(&'a self) -> Column<'a, T>
    where
        T: ColumnElement,
        &'a [T]: Into<Column<'a, T>>,
    {
        match self {
            Self::Uniform(value) => Column::Uniform(*value),
            Self::PerRay(values) => (&values[..]).into(),
        }
    }
}

impl Rays {
    pub(super) fn batch(&self) -> RayBatch<'_> {
        let batch = RayBatch::new(self.origin.column(), self.direction.column());
        let Ok(batch) = batch.and_then(|batch| batch.with_interval(0.0, self.t_max.column()))
        else {
            unreachable!("all columns of a batch are made from the same pixels")
        };
        batch.with_order(self.order)
    }
}

impl RaySet {
    pub(super) fn new(kind: RayKind, parts: Vec<Rays>) -> Self {
        Self { kind, parts }
    }

    /// The kind of the rays.
    pub const fn kind(&self) -> RayKind {
        self.kind
    }

    /// What is asked about the rays.
    pub const fn question(&self) -> Question {
        self.kind.question()
    }

    /// The batches, to be traced one after the other: one for each direction of
    /// [`RayKind::Suns`], one for all rays of any other kind.
    pub fn batches(&self) -> impl Iterator<Item = RayBatch<'_>> {
        self.parts.iter().map(Rays::batch)
    }

    /// Number of rays in all batches.
    pub fn len(&self) -> usize {
        self.batches().map(|batch| batch.len()).sum()
    }

    /// Whether there is no ray.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}
