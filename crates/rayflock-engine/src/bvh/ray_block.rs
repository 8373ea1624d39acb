//! The rays that one task traces through the trees together.

use glam::Vec3;
use rayflock_geom::simd::ray_boxes::{BoxBounds, BoxRay};
use rayflock_geom::simd::ray_triangle::ShearedRay;
use rayflock_geom::{Ray, RayBatch, RayState};

use crate::TraceStats;
use crate::packet::{Nearest, Question};

/// Directions with the same signs.
pub(super) const OCTANTS: usize = 8;

/// The axes kx, ky, kz by the last of them.
const AXES: [[usize; 3]; 3] = [[1, 2, 0], [2, 0, 1], [0, 1, 2]];

/// All that boxes and triangles need to know about a ray: one line of the cache, for rays are read
/// far more often than anything else here.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(super) struct StreamRay {
    pub(super) origin: Vec3,
    pub(super) box_ray: BoxRay,
    /// As in [`ShearedRay`].
    shear: [f32; 3],
    t_min: f32,
    /// The nearest hit so far.
    pub(super) t_max: f32,
    /// The axis kz.
    major: u32,
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
        major: 2,
        mask: 0,
    };

    #[inline(always)]
    fn new(ray: &Ray, bounds: &BoxBounds, slack: f32) -> Self {
        let sheared = ShearedRay::new(ray);
        Self {
            origin: ray.origin,
            box_ray: BoxRay::new(ray, bounds, slack),
            shear: sheared.shear,
            t_min: ray.t_min,
            t_max: ray.t_max,
            major: sheared.axes[2] as u32,
            mask: ray.mask,
        }
    }

    /// The ray as the accepting test needs it.
    #[inline(always)]
    pub(super) fn sheared(&self) -> ShearedRay {
        ShearedRay {
            origin: self.origin,
            axes: AXES[self.major as usize % 3],
            shear: self.shear,
            t_min: self.t_min,
            t_max: self.t_max,
        }
    }

    /// Makes the ray look no farther than `t`.
    #[inline(always)]
    pub(super) fn set_t_max(&mut self, t: f32) {
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
    /// The active rays by the octant of their direction, as positions in the block.
    pub(super) octants: [Vec<u32>; OCTANTS],
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
        self.octants.iter_mut().for_each(Vec::clear);
        self.rays.resize(len, StreamRay::EMPTY);
        for (idx, place) in self.rays.iter_mut().enumerate() {
            let ray = batch.ray(first_ray + idx);
            match ray.state() {
                RayState::Active => {
                    let t_max = ray.t_max.min(t_bound(first_ray + idx));
                    *place = StreamRay::new(&Ray { t_max, ..ray }, bounds, slack);
                    self.octants[octant(ray.direction)].push(idx as u32);
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
        self.rays.capacity() * size_of::<StreamRay>() + self.octants.iter().map(Vec::capacity).sum::<usize>() * size_of::<u32>()
    }
}

/// The octant of a direction: one bit an axis, set where it is negative.
#[inline(always)]
fn octant(direction: Vec3) -> usize {
    direction.is_negative_bitmask() as usize
}

/// A direction in the middle of an octant.
pub(super) fn octant_direction(octant: usize) -> Vec3 {
    let sign = |axis: usize| if octant & (1 << axis) == 0 { 1.0 } else { -1.0 };
    Vec3::new(sign(0), sign(1), sign(2))
}
