//! What is asked of a batch, and where what may answer lies.

use rayflock_geom::{Ray, RayBatch};

use super::nest_place::NestPlace;
use crate::answers::Answers;
use crate::packet::{Nearest, Question};
use crate::primitives::PrimitiveTable;

/// What is asked of a batch, of one world of grids: that of the scene, or that of a nested object.
#[derive(Clone, Copy)]
pub(super) struct Asked<'a> {
    /// The primitives in world space: they decide.
    pub(super) table: &'a PrimitiveTable,
    pub(super) batch: &'a RayBatch<'a>,
    pub(super) question: Question,
    /// Beyond which `t` hits are of no interest, for each ray, if that is known.
    pub(super) t_bounds: Option<&'a [f32]>,
    /// Where answers go.
    pub(super) answers: &'a Answers,
    /// The place of the object that the grids hold; `None` where they hold the scene.
    pub(super) place: Option<&'a NestPlace>,
    /// Slots of what all rays are to meet, beside what is in the grids.
    pub(super) everywhere: &'a [u32],
}

impl Asked<'_> {
    /// Beyond which `t` hits of a ray are of no interest.
    #[inline(always)]
    pub(super) fn t_bound(&self, ray_idx: usize) -> f32 {
        self.t_bounds.map_or(f32::INFINITY, |t_bounds| t_bounds[ray_idx])
    }

    /// The nearest hit of a ray before it meets the grids.
    #[inline(always)]
    pub(super) fn found_before(&self, ray_idx: usize) -> Nearest {
        match self.place {
            Some(_) if self.question == Question::Closest => self.answers.nearest(ray_idx),
            _ => Nearest::NONE,
        }
    }

    /// A ray in the space of the grids; `t` stays the same.
    #[inline(always)]
    pub(super) fn ray_in_grids(&self, ray: &Ray) -> Ray {
        self.place.map_or(*ray, |place| place.ray_in_object(ray))
    }

    /// The slot in the table of a slot of the grids.
    pub(super) fn slot(&self, slot_in_grids: u32) -> u32 {
        self.place.map_or(0, |place| place.first_slot) + slot_in_grids
    }
}

/// Which rays of a batch are asked about.
#[derive(Clone, Copy)]
pub(super) enum RayList<'a> {
    /// All, of so many.
    All(usize),
    /// Some, by their positions.
    Some(&'a [u32]),
}

impl RayList<'_> {
    /// Number of rays.
    pub(super) const fn len(&self) -> usize {
        match self {
            Self::All(count) => *count,
            Self::Some(ray_idx) => ray_idx.len(),
        }
    }

    /// The position in the batch of ray `idx` of the list.
    #[inline(always)]
    pub(super) fn get(&self, idx: usize) -> usize {
        match self {
            Self::All(_) => idx,
            Self::Some(ray_idx) => ray_idx[idx] as usize,
        }
    }
}
