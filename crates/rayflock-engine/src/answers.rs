//! What was found of each ray, in the order of the batch.
//!
//! Tasks write at the positions of their rays, which are scattered over the batch where rays were
//! sorted: that costs less than to keep the order of the tiles and look each ray up in it.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};

use crate::packet::{Nearest, Question};

/// One answer a ray.
#[derive(Debug, Default)]
pub(crate) struct Answers {
    question: Option<Question>,
    /// `t` and u, v and rank.
    nearest: Vec<[AtomicU64; 2]>,
    occluded: Vec<AtomicBool>,
}

impl Answers {
    /// Makes room for so many answers. All of them are to be written.
    pub(crate) fn begin(&mut self, len: usize, question: Question) {
        self.question = Some(question);
        match question {
            Question::Closest => self.nearest.resize_with(len, Default::default),
            Question::Occluded => self.occluded.resize_with(len, Default::default),
        }
    }

    /// Writes the answer of one ray.
    #[inline(always)]
    pub(crate) fn set(&self, ray_idx: usize, found: &Nearest) {
        if self.question == Some(Question::Occluded) {
            self.occluded[ray_idx].store(!found.is_none(), Relaxed);
            return;
        }
        let [first, second] = bytemuck::cast::<Nearest, [u64; 2]>(*found);
        self.nearest[ray_idx][0].store(first, Relaxed);
        self.nearest[ray_idx][1].store(second, Relaxed);
    }

    /// Notes that a ray hits nothing.
    pub(crate) fn set_none(&self, ray_idx: usize) {
        self.set(ray_idx, &Nearest::NONE);
    }

    /// The nearest hit of a ray.
    #[inline(always)]
    pub(crate) fn nearest(&self, ray_idx: usize) -> Nearest {
        let [first, second] = &self.nearest[ray_idx];
        bytemuck::cast([first.load(Relaxed), second.load(Relaxed)])
    }

    /// Whether a ray hits anything.
    #[inline(always)]
    pub(crate) fn is_occluded(&self, ray_idx: usize) -> bool {
        self.occluded[ray_idx].load(Relaxed)
    }

    /// Bytes held.
    pub(crate) fn memory_usage(&self) -> usize {
        16 * self.nearest.capacity() + self.occluded.capacity()
    }
}
