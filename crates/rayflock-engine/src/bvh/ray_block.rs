//! The rays that one task traces through a tree together.

use rayflock_geom::simd::ray_boxes::{BoxRay, BoxSpace};
use rayflock_geom::simd::ray_triangle::ShearedRay;
use rayflock_geom::{Ray, RayBatch, RayState};

use crate::TraceStats;
use crate::packet::Nearest;

/// A ray as leaves see it.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(super) struct LeafRay {
    /// For the accepting test; `t_max` is the nearest hit so far.
    pub(super) sheared: ShearedRay,
    /// Which objects it sees.
    pub(super) mask: u32,
}

/// Rays in the order of their batch.
#[derive(Debug, Default)]
pub(super) struct RayBlock {
    /// Position in the batch of the first ray.
    pub(super) first_ray: usize,
    /// As nodes see them.
    pub(super) box_rays: Vec<BoxRay>,
    /// As leaves see them.
    pub(super) leaf_rays: Vec<LeafRay>,
    /// The active rays, by their positions in the block.
    pub(super) active: Vec<u32>,
}

impl RayBlock {
    /// Takes in `len` rays of a batch; `t_bound` tells beyond which hits are of no interest.
    #[inline(always)]
    pub(super) fn fill(
        &mut self,
        batch: &RayBatch<'_>,
        first_ray: usize,
        len: usize,
        space: &BoxSpace,
        slack: f32,
        t_bound: &impl Fn(usize) -> f32,
    ) -> TraceStats {
        let mut stats = TraceStats { rays: len as u64, ..TraceStats::default() };
        self.first_ray = first_ray;
        self.active.clear();
        self.box_rays.resize(len, BoxRay::EMPTY);
        self.leaf_rays.resize(len, LeafRay::EMPTY);
        for idx in 0..len {
            let ray = batch.ray(first_ray + idx);
            match ray.state() {
                RayState::Active => {
                    let t_max = ray.t_max.min(t_bound(first_ray + idx));
                    let ray = Ray { t_max, ..ray };
                    self.box_rays[idx] = BoxRay::new(&ray, space, slack);
                    self.leaf_rays[idx] =
                        LeafRay { sheared: ShearedRay::new(&ray), mask: ray.mask };
                    self.active.push(idx as u32);
                }
                RayState::Inactive => {}
                RayState::Invalid => stats.invalid_rays += 1,
            }
        }
        stats
    }

    /// Makes a ray look no farther than its nearest hit.
    #[inline(always)]
    pub(super) fn shorten(&mut self, idx: usize, nearest: &Nearest) {
        self.leaf_rays[idx].sheared.t_max = nearest.t;
        self.box_rays[idx].set_t_max(nearest.t);
    }

    /// Makes a ray look nowhere any more.
    #[inline(always)]
    pub(super) fn retire(&mut self, idx: usize) {
        self.leaf_rays[idx].sheared.t_max = f32::NEG_INFINITY;
        self.box_rays[idx].set_t_max(f32::NEG_INFINITY);
    }

    /// Bytes held.
    pub(super) fn memory_usage(&self) -> usize {
        self.box_rays.capacity() * size_of::<BoxRay>()
            + self.leaf_rays.capacity() * size_of::<LeafRay>()
            + self.active.capacity() * size_of::<u32>()
    }
}

impl LeafRay {
    /// A ray that hits nothing.
    const EMPTY: Self = Self {
        sheared: ShearedRay {
            origin: glam::Vec3::ZERO,
            axes: [0, 1, 2],
            shear: [0.0, 0.0, 1.0],
            t_min: f32::INFINITY,
            t_max: f32::NEG_INFINITY,
        },
        mask: 0,
    };
}
