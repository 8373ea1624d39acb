//! What is known of a batch and its frame before anything is traced.

use std::fmt;

use rayflock_geom::{Geometry, GeometryObject, RayBatch, RayOrder};

use crate::packet::Question;

/// What the rays of a batch share, as far as the batch tells.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum RayClass {
    /// All start at one point, go through the pixels of an image and ask for what is nearest: those
    /// of a camera.
    SharedOriginImage,
    /// All start at one point.
    SharedOrigin,
    /// All go one way, through the pixels of an image, and ask for what is nearest: those of an
    /// orthographic camera.
    SharedDirectionImage,
    /// All go one way.
    SharedDirection,
    /// Neighbours are close: an image, or said to be coherent.
    Ordered,
    /// Nothing is known.
    Unordered,
}

impl RayClass {
    fn of(rays: &RayBatch<'_>, question: Question) -> Self {
        // Shadow rays to a lamp or a sun may come in the order of an image, but do not make one.
        let is_image =
            matches!(rays.order(), RayOrder::Image { .. }) && question == Question::Closest;
        if rays.origin().uniform().is_some() {
            if is_image { Self::SharedOriginImage } else { Self::SharedOrigin }
        } else if rays.direction().uniform().is_some() {
            if is_image { Self::SharedDirectionImage } else { Self::SharedDirection }
        } else {
            match rays.order() {
                RayOrder::Image { .. } | RayOrder::Coherent => Self::Ordered,
                RayOrder::Groups(_) | RayOrder::Unordered => Self::Unordered,
            }
        }
    }
}

impl fmt::Display for RayClass {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::SharedOriginImage => "of an image from one point",
            Self::SharedOrigin => "from one point",
            Self::SharedDirectionImage => "of an image in one direction",
            Self::SharedDirection => "in one direction",
            Self::Ordered => "with close neighbours",
            Self::Unordered => "in no order",
        })
    }
}

/// How much there is in a frame, and how much of it is news.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Frame {
    pub(super) prim_count: usize,
    /// Primitives of objects that differ from the frame before.
    pub(super) changed_count: usize,
}

impl Frame {
    /// The sizes of a frame that comes after another one.
    pub(super) fn of(geometry: &Geometry, before: &Geometry) -> Self {
        let is_news = |object: &&GeometryObject| {
            !before.object(object.id).is_some_and(|before| object.is_same(before))
        };
        let changed = geometry.objects().iter().filter(is_news);
        Self {
            prim_count: geometry.prim_count(),
            changed_count: changed.map(|object| object.shape.prim_count()).sum(),
        }
    }
}

/// A batch in its frame, by what its cost depends on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Situation {
    pub(super) class: RayClass,
    pub(super) question: Question,
    pub(super) ray_count: usize,
    pub(super) frame: Frame,
}

/// Situations alike enough to learn from each other: sizes within a factor of two.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct SituationKey {
    class: RayClass,
    is_occlusion: bool,
    ray_log: u32,
    prim_log: u32,
}

impl Situation {
    /// The situation of a batch.
    pub(super) fn of(rays: &RayBatch<'_>, question: Question, frame: &Frame) -> Self {
        Self { class: RayClass::of(rays, question), question, ray_count: rays.len(), frame: *frame }
    }

    /// What it is alike to.
    pub(super) fn key(&self) -> SituationKey {
        SituationKey {
            class: self.class,
            is_occlusion: self.question == Question::Occluded,
            ray_log: log2(self.ray_count),
            prim_log: log2(self.frame.prim_count),
        }
    }
}

impl SituationKey {
    /// How far apart sizes are, in factors of two; `None` for rays of different classes.
    pub(super) fn distance(&self, other: &Self) -> Option<u32> {
        let apart = self.ray_log.abs_diff(other.ray_log) + self.prim_log.abs_diff(other.prim_log);
        (self.class == other.class)
            .then_some(apart + u32::from(self.is_occlusion != other.is_occlusion))
    }
}

/// The logarithm, rounded down; 0 for nothing.
pub(super) fn log2(count: usize) -> u32 {
    count.checked_ilog2().unwrap_or_default()
}
