//! Virtual lights of a picture and what hides them, on the device.
//!
//! The host shoots the lights and fits the spheres; both take little beside gathering, and the code
//! is that of the renderer on the CPU.

use rayflock_engine::Budget;
use rayflock_render::prepared::{PreparedVirtualLights, ShotLights};
use rayflock_render::vpl::{Visibility, VplSettings};
use rayflock_render::{FrameStats, Indirect};
use rayflock_scene::SceneFrame;
use wgpu::{Buffer, BufferUsages};

use super::gather_lights::BLOCK_SPHERES;
use super::picture::Picture;
use super::refusal::cannot;
use crate::GpuContext;
use crate::buffer::GrowingBuffer;
use crate::layout::virtual_lights::{
    DeviceSoftSphere, DeviceVirtualLight, DeviceWall, GatherParams,
};
use crate::slots::TILE_RAYS;

/// Lights that one dispatch gathers at most: long ones are taken for a fault.
const LIGHTS_AT_ONCE: usize = 256;

/// Turns of all loops of an invocation in one dispatch at most; the rest is for sums. The driver
/// llvmpipe ends every loop after 65535 turns together, without a word.
const TURNS_AT_ONCE: usize = 65_000;

/// Lights that a binding may hold; and as many spheres and walls as a single light can be gathered
/// past in that many turns.
const MOST: [usize; 3] = [(128 << 20) / size_of::<DeviceVirtualLight>(), 1 << 15, 1 << 14];
const KINDS: [&str; 3] = ["virtual lights", "spheres in place of geometry", "walls around it"];

/// Virtual lights and spheres.
#[derive(Debug)]
pub(super) struct VirtualLightStore {
    prepared: PreparedVirtualLights,
    lights: GrowingBuffer,
    spheres: GrowingBuffer,
    walls: GrowingBuffer,
    params: GrowingBuffer,
    light_count: usize,
    /// What all dispatches have in common.
    common: GatherParams,
}

impl Default for VirtualLightStore {
    fn default() -> Self {
        Self {
            prepared: PreparedVirtualLights::default(),
            lights: GrowingBuffer::storage("virtual lights"),
            spheres: GrowingBuffer::storage("soft spheres"),
            walls: GrowingBuffer::storage("walls"),
            params: GrowingBuffer::new("gather params", BufferUsages::UNIFORM),
            light_count: 0,
            common: GatherParams::default(),
        }
    }
}

impl VirtualLightStore {
    /// Takes the next frame; nothing is computed before lights are asked for.
    pub(super) fn commit(&mut self, frame: &SceneFrame) {
        self.prepared.commit(frame);
    }

    /// Shoots and sends what a picture is lit by; `Err` tells why that cannot be.
    pub(super) fn prepare(
        &mut self,
        context: &GpuContext,
        picture: &Picture<'_>,
        stats: &mut FrameStats,
    ) -> Result<(), String> {
        self.light_count = 0;
        if picture.settings.indirect == Indirect::Off {
            return Ok(());
        }
        let (frame, view, settings) = (picture.prepared, picture.view, &picture.settings);
        let shot = self.prepared.shoot(frame, view, settings, stats);
        let shot = shot.map_err(|error| cannot(&format!("virtual lights ({error})")))?;
        let ShotLights { lights, bound, distance, spheres, walls } = shot;
        check_room([lights.len(), spheres.len(), walls.len()])?;
        let of_light = |light_idx| DeviceVirtualLight::new(lights, light_idx);
        write(&mut self.lights, context, (0..lights.len()).map(of_light));
        write(&mut self.spheres, context, spheres.iter().map(DeviceSoftSphere::from));
        write(&mut self.walls, context, walls.iter().map(DeviceWall::from));
        self.light_count = lights.len();
        self.common = GatherParams {
            bound: bound.min(f32::MAX),
            distance,
            sphere_count: spheres.len() as u32,
            wall_count: walls.len() as u32,
            ..GatherParams::default()
        };
        Ok(())
    }

    /// What is gathered, one dispatch after another, of a film whose sums begin at `first_sum`.
    pub(super) fn dispatches(
        &self,
        first_sum: usize,
    ) -> impl Iterator<Item = GatherParams> + use<> {
        let (common, light_count) = (self.common, self.light_count);
        let (spheres, walls) = (common.sphere_count as usize, common.wall_count as usize);
        // At worst a point goes through all walls and spheres, after looking for these.
        let lists = spheres.div_ceil(BLOCK_SPHERES);
        let turns = 1 + walls + spheres + spheres.div_ceil(TILE_RAYS) + lists;
        let at_once = (TURNS_AT_ONCE / turns).clamp(1, LIGHTS_AT_ONCE);
        (0..light_count).step_by(at_once).map(move |first_light| GatherParams {
            first_light: first_light as u32,
            end_light: light_count.min(first_light + at_once) as u32,
            first_sum: first_sum as u32,
            ..common
        })
    }

    /// Sends what a dispatch needs to know.
    pub(super) fn write_params(&mut self, context: &GpuContext, params: GatherParams) {
        self.params.write(context, &[params]);
    }

    /// The lights, the spheres and the walls.
    pub(super) fn columns(&self) -> [&Buffer; 3] {
        [&self.lights, &self.spheres, &self.walls].map(GrowingBuffer::buffer)
    }

    pub(super) fn params(&self) -> &Buffer {
        self.params.buffer()
    }

    /// Tells what is held.
    pub(super) fn hold(&self, budget: &mut Budget) {
        budget.hold("shooting on the host", self.prepared.memory_usage() as u64);
        let buffers = [&self.lights, &self.spheres, &self.walls, &self.params];
        buffers.iter().for_each(|buffer| buffer.hold(budget));
    }
}

/// Whether so many lights, spheres and walls can be gathered; `Err` tells what cannot.
fn check_room(counts: [usize; 3]) -> Result<(), String> {
    for ((count, most), what) in counts.into_iter().zip(MOST).zip(KINDS) {
        if count > most {
            return Err(cannot(&format!("{count} {what}, but {most}")));
        }
    }
    Ok(())
}

/// Makes `entries` the beginning of a buffer, which has room for one at least.
fn write<T: bytemuck::Pod>(
    buffer: &mut GrowingBuffer,
    context: &GpuContext,
    entries: impl Iterator<Item = T>,
) {
    buffer.reserve(context, size_of::<T>());
    buffer.write(context, &entries.collect::<Vec<_>>());
}

/// What of such light the device cannot gather, if anything.
pub(super) fn beyond_device(indirect: &Indirect) -> Option<&'static str> {
    match indirect {
        Indirect::Off => None,
        Indirect::Vpl(VplSettings { chosen: Some(_), .. }) => {
            Some("light from virtual lights with chosen rays")
        }
        Indirect::Vpl(lights) => match lights.visibility {
            Visibility::Spheres(_) | Visibility::None => None,
            Visibility::Lookouts(_) => Some("light from virtual lights seen from lookouts"),
            _ => Some("light from virtual lights with exact visibility"),
        },
        _ => Some("light from clusters of virtual lights"),
    }
}

#[cfg(test)]
mod tests {
    use rayflock_render::occluders::SphereSettings;
    use rayflock_render::vpl::{ChosenBy, ChosenRays, LookoutSettings};

    use super::*;

    #[test]
    fn what_needs_rays_or_clusters_is_beyond_the_device() {
        let of = |visibility| VplSettings { visibility, ..VplSettings::default() };
        let spheres = of(Visibility::Spheres(SphereSettings::default()));
        let lookouts = of(Visibility::Lookouts(LookoutSettings::default()));
        let chosen = Some(ChosenRays { count: 2, by: ChosenBy::Weight });
        let lights = [spheres, of(Visibility::None)].map(Indirect::Vpl);
        for indirect in lights.iter().chain([&Indirect::Off]) {
            assert_eq!(beyond_device(indirect), None, "{indirect:?}");
        }
        for (indirect, reason) in [
            (Indirect::Vpl(of(Visibility::Exact)), "exact visibility"),
            (Indirect::Vpl(lookouts), "lookouts"),
            (Indirect::Vpl(VplSettings { chosen, ..spheres }), "chosen rays"),
            (Indirect::Lightcuts { lights: spheres, error_bound: 0.02 }, "clusters"),
        ] {
            let told = beyond_device(&indirect).unwrap_or_default();
            assert!(told.contains(reason), "{indirect:?}: {told}");
        }
    }

    #[test]
    fn too_many_spheres_are_refused() {
        assert_eq!(check_room(MOST), Ok(()));
        let refused = check_room([1, MOST[1] + 1, 1]).unwrap_err();
        assert!(refused.contains("32769 spheres in place of geometry, but 32768"), "{refused}");
    }

    #[test]
    fn dispatches_take_every_light_once_and_few_where_there_are_many_spheres() {
        for (light_count, sphere_count, expected) in
            [(0, 5, 0), (1, 0, 1), (100, 512, 1), (600, 0, 3), (600, 4096, 40), (3, 1 << 15, 3)]
        {
            let store = VirtualLightStore {
                light_count,
                common: GatherParams { sphere_count, ..GatherParams::default() },
                ..VirtualLightStore::default()
            };
            let dispatches: Vec<_> = store.dispatches(7).collect();
            assert_eq!(dispatches.len(), expected);
            let mut next = 0;
            for dispatch in dispatches {
                let lights = dispatch.end_light - dispatch.first_light;
                assert!(lights * (sphere_count + sphere_count / 32) < 65_535);
                assert_eq!((dispatch.first_light, dispatch.first_sum), (next, 7));
                next = dispatch.end_light;
            }
            assert_eq!(next as usize, light_count);
        }
    }
}
