//! Gathers virtual lights at the points of a wave, and what that came to.
//!
//! Sums are kept on the device, in `f32`, behind those of the film: workgroups add to 64 places in
//! turns, so that few wait for each other, and the host adds these up in `f64`. Counts above 2^24 a
//! place are rounded.

#[cfg(test)]
mod tests;

use std::ops::AddAssign;

use rayflock_render::FrameStats;
use rayflock_render::vpl::VisibilityStats;

use super::DeviceFrame;
use super::render_band::{tiles, whole};
use crate::GpuContext;
use crate::buffer::part_of;
use crate::layout::FrameParams;
use crate::layout::virtual_lights::GatherParams;
use crate::pass::StageEncoder;
use crate::shaders::GATHER_LIGHTS;

/// Places of sums, and spheres of a list, as in `frame/gather_lights.wgsl`.
pub(crate) const SUM_PLACES: usize = 64;
pub(crate) const BLOCK_SPHERES: usize = 512;

/// Bytes of the sums.
pub(super) const SUM_BYTES: usize = SUM_PLACES * size_of::<[f32; 4]>();

/// What gathering in a band came to.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct GatherSums {
    /// Radiance that arrived, and what the bound kept away.
    gathered: f64,
    lost: f64,
    /// Points times lights, and tests of spheres.
    pairs: f64,
    tests: f64,
}

impl DeviceFrame {
    /// Adds what all virtual lights send to the points of the wave; sums lie behind those of
    /// `pixel_count` pixels.
    pub(super) fn gather_lights(
        &mut self,
        context: &GpuContext,
        params: &FrameParams,
        pixel_count: usize,
    ) {
        for dispatch in self.virtual_lights.dispatches(3 * pixel_count) {
            self.virtual_lights.write_params(context, dispatch);
            let [lights, spheres, walls] = self.virtual_lights.columns().map(whole);
            let b = &self.buffers;
            let resources = [
                whole(b.points.buffer()),
                lights,
                spheres,
                walls,
                whole(b.film.buffer()),
                part_of(self.virtual_lights.params(), size_of::<GatherParams>()),
            ];
            let mut encoder = StageEncoder::new(context, &mut self.clock);
            encoder.stage(&self.stages.gather_lights, &resources, tiles(params));
            encoder.submit();
        }
    }

    /// Seconds that gathering has taken since the frame began; 0 where stages are not told apart.
    pub(super) fn gather_seconds(&self) -> f64 {
        let stages = self.clock.budget().stages;
        stages.iter().find(|stage| stage.name == GATHER_LIGHTS.name).map_or(0.0, |s| s.seconds)
    }
}

impl GatherSums {
    /// Reads what the device left.
    pub(super) fn read(bytes: &[u8]) -> Self {
        let mut sums = Self::default();
        for place in bytes.chunks_exact(size_of::<[f32; 4]>()) {
            let [gathered, lost, pairs, tests] =
                bytemuck::pod_read_unaligned::<[f32; 4]>(place).map(f64::from);
            sums += Self { gathered, lost, pairs, tests };
        }
        sums
    }

    pub(super) fn add_to(self, stats: &mut FrameStats) {
        let indirect = &mut stats.indirect;
        indirect.gathered += self.gathered;
        indirect.clamped += self.lost;
        let (pairs, tests) = (self.pairs as u64, self.tests as u64);
        indirect.visibility += VisibilityStats { pairs, rays: 0, tests };
    }
}

impl AddAssign for GatherSums {
    fn add_assign(&mut self, other: Self) {
        self.gathered += other.gathered;
        self.lost += other.lost;
        self.pairs += other.pairs;
        self.tests += other.tests;
    }
}
