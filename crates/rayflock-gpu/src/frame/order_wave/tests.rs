//! Each ray has the place of its key, and its path with it.

use glam::Vec3;
use rayflock_geom::{FrameChanges, Geometry, GeometryObject, ObjectId};
use rayflock_testkit::Rng;
use rayflock_testkit::scenes::{SoupKind, triangle_soup};

use super::{KEY_BITS, KEYS, WaveOrder};
use crate::GpuContext;
use crate::compute::Compute;
use crate::frame::buffers::{FOLLOWED, FrameBuffers, WaveCounts};
use crate::layout::{DeviceHit, DeviceRay, FrameParams};
use crate::method::Method;
use crate::pass::StageEncoder;
use crate::primitives::PrimitiveStore;
use crate::stage_clock::StageClock;
use crate::testing::{contexts, read};
use crate::twins;

/// Slots, and how many of them have a ray.
const SLOTS: usize = 3008;
const COUNT: usize = 2900;

/// Rays to all sides, some from outside the scene, and paths of which nobody has another.
fn rays() -> (Vec<DeviceRay>, Vec<[u32; 8]>) {
    let mut rng = Rng::new(71);
    let mut ray = |slot: usize| {
        let (origin, direction) = (1.2 * rng.in_cube(), 1e3 * rng.on_sphere());
        let (origin, direction, t_max) = (origin.to_array(), direction.to_array(), 1e30);
        DeviceRay { origin, direction, t_min: 0.0, t_max, slot: slot as u32, ..DeviceRay::IDLE }
    };
    let paths = (0..COUNT as u32).map(|slot| [slot; 8]);
    ((0..COUNT).map(&mut ray).collect(), paths.collect())
}

/// The key whose places are these, and how close another one is, in cells.
fn key(places: [f32; 5]) -> (u32, f32) {
    let mut key = 0;
    for bit in (0..KEY_BITS).rev() {
        let bits = places.map(|place| place as u32 >> bit & 1);
        key = key << 5 | bits[0] << 2 | bits[1] << 3 | bits[2] << 4 | bits[3] | bits[4] << 1;
    }
    let margin = places.map(|place| (place - place.round()).abs());
    (key, margin.into_iter().fold(f32::INFINITY, f32::min))
}

/// A wave that was left behind the first half of the buffers.
fn left(context: &GpuContext, rays: &[DeviceRay], paths: &[[u32; 8]]) -> FrameBuffers {
    let mut buffers = FrameBuffers::new();
    buffers.reserve(context, SLOTS, 1);
    buffers.rays.write_at(context, SLOTS * size_of::<DeviceRay>(), rays);
    buffers.paths.write_at(context, SLOTS * size_of::<[u32; 8]>(), paths);
    let mut counts = WaveCounts::default();
    counts[FOLLOWED] = COUNT as u32;
    buffers.counts.write(context, &counts);
    let params = FrameParams { slot_count: SLOTS as u32, ..FrameParams::default() };
    buffers.params.write(context, &[params]);
    buffers
}

#[test]
fn rays_lie_where_their_keys_say() {
    let soup = triangle_soup(&mut Rng::new(72), SoupKind::Plain, 500, Vec3::ZERO, 1.0);
    let geometry = Geometry::new(vec![GeometryObject::new(ObjectId(0), soup)]).unwrap();
    let (rays, paths) = rays();
    for context in contexts() {
        let mut primitives = PrimitiveStore::default();
        primitives.commit(context, &geometry, &FrameChanges::all(), "gpu").unwrap();
        let (mut compute, mut order) = (Compute::new(context), WaveOrder::new(context));
        let mut clock = StageClock::new(context);
        compute.prepare(context, &mut clock, &primitives);
        let buffers = left(context, &rays, &paths);
        let mut encoder = StageEncoder::new(context, &mut clock);
        order.order(&mut encoder, &buffers, SLOTS, compute.bounds());
        encoder.submit();
        let bounds = twins::bound_scene(primitives.host());
        let places: Vec<[u32; 2]> = read(context, order.places.buffer(), SLOTS);
        let mut counts = vec![0; KEYS];
        places.iter().for_each(|[key, _]| counts[*key as usize] += 1);
        for (ray, [found, _]) in rays.iter().zip(&places) {
            let (expected, margin) = key(twins::count_rays(ray, bounds, KEY_BITS));
            assert!(*found == expected || margin < 1e-4, "{ray:?}: {found}, not {expected}");
        }
        assert_eq!(counts[KEYS - 1], (SLOTS - COUNT) as u32);
        assert!(counts.iter().filter(|&&count| count > 0).count() > 1000);
        let firsts: Vec<u32> = read(context, order.keys.buffer(), KEYS);
        assert_eq!(firsts, twins::place_cells(&counts));
        let ordered: Vec<DeviceRay> = read(context, buffers.rays.buffer(), SLOTS);
        let ordered_paths: Vec<[u32; 8]> = read(context, buffers.paths.buffer(), SLOTS);
        for ((ray, path), [key, place]) in rays.iter().zip(&paths).zip(places) {
            let slot = firsts[key as usize] + place;
            let expected = DeviceRay { slot, ..*ray };
            assert_eq!(ordered[slot as usize], expected);
            assert_eq!(ordered_paths[slot as usize], *path);
        }
        assert!(ordered[COUNT..].iter().all(|ray| !ray.is_active()));
        let hits: Vec<DeviceHit> = read(context, buffers.hits.buffer(), SLOTS);
        let nothing =
            |(hit, ray): (&DeviceHit, &DeviceRay)| *hit == DeviceHit::none_before(ray.t_max);
        assert!(hits.iter().zip(&ordered).all(nothing));
    }
}
