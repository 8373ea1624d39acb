//! Light that mirrors and glass throw, on the device: photons from the lights' views, and what they
//! bring to the points of each wave.
//!
//! Before the first band, for each view of each light:
//!
//! 1. **camera_rays** with the view as the camera; scan conversion finds what these rays hit, as it
//!    does for those of the camera, or tracing does.
//! 2. **leave_photons** turns hits into photons and the rays of the next wave, which the stages of
//!    the engine `gpu:compute` trace; and so on, as deep as rays from the camera go.
//!
//! Then **sort_photons** counts photons by buckets of cells, **place_photons** makes room for each
//! bucket, and **sort_photons** brings them there. With each wave of each band, **gather_photons**
//! adds what they bring to the film.
//!
//! **Source.** H. W. Jensen, "Global Illumination using Photon Maps", EGWR 1996; L. Szecsi, "The
//! Hierarchical Ray Engine", WSCG 2006, whose rays start where the scene is drawn as the eye or a
//! light sees it.
//!
//! **Departures** from the renderer of the CPU: sums in `f32`, in any order; texels that carry
//! nothing have a ray, which is not followed.
//!
//! **Invariants.** Photons, rays and pairs for which there is no room are counted, and read once for
//! some rows of a light's view; then all photons are left anew with more room, or in fewer rows at
//! once.
//!
//! **Cost.** A wait for each view and as many texels as a wave may hold, and one for the count;
//! 140 bytes a photon.

mod shoot_photons;
#[cfg(test)]
mod tests;

use rayflock_engine::Budget;
use rayflock_render::prepared::ThrownLight;
use wgpu::{BindingResource, BufferUsages};

use super::DeviceFrame;
use super::render_band::{tiles, whole};
use crate::buffer::{GrowingBuffer, part_of};
use crate::layout::{BUCKET_BYTES, FrameParams, PHOTON_BYTES, PHOTONS_OFFSET, PhotonParams};
use crate::pass::{Groups, StageEncoder};
use crate::pipeline::{ComputeStage, compute_stage};
use crate::{GpuContext, shaders};

/// Photons that there is room for at first.
const FIRST_CAPACITY: usize = 1 << 16;

/// Photons of a picture.
#[derive(Debug)]
pub(super) struct Photons {
    leave_photons: ComputeStage,
    /// That counts, and that fills.
    sort_photons: [ComputeStage; 2],
    place_photons: ComputeStage,
    gather_photons: ComputeStage,
    /// As they are left.
    store: GrowingBuffer,
    /// By bucket.
    sorted: GrowingBuffer,
    buckets: GrowingBuffer,
    params: GrowingBuffer,
    capacity: usize,
    /// Those of the picture at hand.
    count: usize,
}

impl Photons {
    pub(super) fn new(context: &GpuContext) -> Self {
        let stage = |shader| compute_stage(context, shader, &[]);
        let sort = |fill| compute_stage(context, shaders::SORT_PHOTONS, &[("FILL", fill)]);
        Self {
            leave_photons: stage(shaders::LEAVE_PHOTONS),
            sort_photons: [sort(0.0), sort(1.0)],
            place_photons: stage(shaders::PLACE_PHOTONS),
            gather_photons: stage(shaders::GATHER_PHOTONS),
            store: GrowingBuffer::storage("photons"),
            sorted: GrowingBuffer::storage("sorted photons"),
            buckets: GrowingBuffer::storage("photon buckets"),
            params: GrowingBuffer::new("photon params", BufferUsages::UNIFORM),
            capacity: FIRST_CAPACITY,
            count: 0,
        }
    }

    /// Sorts the photons that have been left.
    fn sort(&mut self, encoder: &mut StageEncoder<'_>, thrown: &ThrownLight) {
        let context = encoder.context;
        let bucket_count = self.count.next_power_of_two();
        let params = PhotonParams {
            low: thrown.low.to_array(),
            radius: thrown.radius,
            photon_count: self.count as u32,
            bucket_count: bucket_count as u32,
            ..PhotonParams::default()
        };
        self.params.write(context, &[params]);
        self.sorted.reserve(context, self.count * PHOTON_BYTES);
        self.buckets.reserve(context, bucket_count * BUCKET_BYTES);
        encoder.encoder.clear_buffer(self.buckets.buffer(), 0, None);
        let store = || part_of(self.store.buffer(), store_bytes(self.count));
        let (buckets, sorted) = (whole(self.buckets.buffer()), whole(self.sorted.buffer()));
        let groups = |count: usize| Groups::Count(count.div_ceil(64));
        let [count, fill] = &self.sort_photons;
        let resources = [store(), buckets.clone(), sorted, self.params()];
        encoder.stage(count, &resources[..], groups(self.count));
        let placed = [store(), buckets, self.params()];
        encoder.stage(&self.place_photons, &placed, groups(bucket_count));
        encoder.stage(fill, &resources, groups(self.count));
    }

    fn params(&self) -> BindingResource<'_> {
        part_of(self.params.buffer(), size_of::<PhotonParams>())
    }

    /// Tells what is held.
    pub(super) fn hold(&self, budget: &mut Budget) {
        let buffers = [&self.store, &self.sorted, &self.buckets, &self.params];
        buffers.iter().for_each(|buffer| buffer.hold(budget));
    }
}

impl DeviceFrame {
    /// Adds what photons bring to the points of a wave.
    pub(super) fn gather_photons(&mut self, context: &GpuContext, params: &FrameParams) {
        let (b, photons) = (&self.buffers, &self.photons);
        if photons.count == 0 {
            return;
        }
        let resources = [
            whole(b.points.buffer()),
            whole(photons.buckets.buffer()),
            whole(photons.sorted.buffer()),
            whole(b.film.buffer()),
            photons.params(),
        ];
        let mut encoder = StageEncoder::new(context, &mut self.clock);
        encoder.stage(&photons.gather_photons, &resources, tiles(params));
        encoder.submit();
    }
}

/// Bytes of so many photons and of what lies before them.
const fn store_bytes(photon_count: usize) -> usize {
    PHOTONS_OFFSET + photon_count * PHOTON_BYTES
}
