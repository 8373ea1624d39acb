//! The rays that one task traces through the trees together.

use glam::Vec3;
use rayflock_geom::simd::ray_boxes::{BoxBounds, BoxRay};
use rayflock_geom::simd::ray_triangle::ShearedRay;
use rayflock_geom::{Ray, RayBatch, RayState};

use crate::TraceStats;
use crate::packet::{Nearest, Question};

/// Faces of a cube. Rays with directions through the same face share the axes kx, ky, kz of the
/// accepting test, and go about the same way.
pub(super) const FACES: usize = 6;

/// The axes kx, ky, kz of a face.
pub(super) const fn face_axes(face: usize) -> [usize; 3] {
    match face / 2 {
        0 => [1, 2, 0],
        1 => [2, 0, 1],
        _ => [0, 1, 2],
    }
}

/// Whether directions through a face go along the axis, not against it.
pub(super) const fn goes_along(face: usize) -> bool {
    face % 2 == 0
}

/// All that boxes and triangles need to know about a ray: one line of the cache, for rays are read
/// far more often than anything else here.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(super) struct StreamRay {
    /// In the order kx, ky, kz.
    pub(super) origin: Vec3,
    /// In the same order.
    pub(super) box_ray: BoxRay,
    /// As in [`ShearedRay`].
    pub(super) shear: [f32; 3],
    pub(super) t_min: f32,
    /// The nearest hit so far; minus infinity when the ray looks nowhere any more.
    pub(super) t_max: f32,
    /// Which objects the ray sees.
    pub(super) mask: u32,
}

impl StreamRay {
    /// A ray that hits nothing.
    const EMPTY: Self = Self {
        origin: Vec3::ZERO,
        box_ray: BoxRay::EMPTY,
        shear: [0.0, 0.0, 1.0],
        t_min: f32::INFINITY,
        t_max: f32::NEG_INFINITY,
        mask: 0,
    };

    /// Prepares an active ray; also tells the face of its direction.
    #[inline(always)]
    fn new(ray: &Ray, bounds: &BoxBounds, slack: f32) -> (Self, usize) {
        let ShearedRay { axes, shear, .. } = ShearedRay::new(ray);
        let prepared = Self {
            origin: axes.map(|axis| ray.origin[axis]).into(),
            box_ray: BoxRay::new(ray, axes, bounds, slack),
            shear,
            t_min: ray.t_min,
            t_max: ray.t_max,
            mask: ray.mask,
        };
        (prepared, 2 * axes[2] + usize::from(shear[2] < 0.0))
    }

    /// Makes the ray look no farther than `t`.
    #[inline(always)]
    fn set_t_max(&mut self, t: f32) {
        self.t_max = t;
        // The largest coordinate of the direction is that along kz.
        self.box_ray.set_t_max(t, self.shear[2].abs());
    }

    /// Whether the ray looks nowhere any more.
    #[inline(always)]
    pub(super) fn is_done(&self) -> bool {
        self.t_max == f32::NEG_INFINITY
    }
}

/// Rays in the order of their batch.
#[derive(Debug, Default)]
pub(super) struct RayBlock {
    /// Position in the batch of the first ray.
    pub(super) first_ray: usize,
    pub(super) rays: Vec<StreamRay>,
    /// The active rays by the face of their direction, as positions in the block.
    pub(super) faces: [Vec<u32>; FACES],
}

impl RayBlock {
    /// Takes in `len` rays of a batch, for boxes within `bounds`; `t_bound` tells beyond which
    /// hits are of no interest.
    #[inline(always)]
    pub(super) fn fill(
        &mut self,
        batch: &RayBatch<'_>,
        first_ray: usize,
        len: usize,
        bounds: &BoxBounds,
        slack: f32,
        t_bound: &impl Fn(usize) -> f32,
    ) -> TraceStats {
        let mut stats = TraceStats { rays: len as u64, ..TraceStats::default() };
        self.first_ray = first_ray;
        self.faces.iter_mut().for_each(Vec::clear);
        self.rays.resize(len, StreamRay::EMPTY);
        for (idx, place) in self.rays.iter_mut().enumerate() {
            let ray = batch.ray(first_ray + idx);
            match ray.state() {
                RayState::Active => {
                    let t_max = ray.t_max.min(t_bound(first_ray + idx));
                    let (ray, face) = StreamRay::new(&Ray { t_max, ..ray }, bounds, slack);
                    *place = ray;
                    self.faces[face].push(idx as u32);
                }
                RayState::Inactive => {}
                RayState::Invalid => stats.invalid_rays += 1,
            }
        }
        stats
    }

    /// Makes a ray look no farther than its nearest hit, or, when any hit will do, nowhere.
    #[inline(always)]
    pub(super) fn shorten(&mut self, idx: usize, nearest: &Nearest, question: Question) {
        self.rays[idx].set_t_max(match question {
            Question::Closest => nearest.t,
            Question::Occluded => f32::NEG_INFINITY,
        });
    }

    /// Bytes held.
    pub(super) fn memory_usage(&self) -> usize {
        self.rays.capacity() * size_of::<StreamRay>()
            + self.faces.iter().map(Vec::capacity).sum::<usize>() * size_of::<u32>()
    }
}
