//! Each ray has the place of its key.

use glam::Vec3;
use rayflock_geom::{FrameChanges, Geometry, GeometryObject, ObjectId};
use rayflock_testkit::Rng;
use rayflock_testkit::scenes::{SoupKind, triangle_soup};

use super::{KEY_BITS, KEYS, RayOrder};
use crate::buffer::GrowingBuffer;
use crate::compute::bucket_order::BucketOrder;
use crate::layout::DeviceRay;
use crate::pass::StageEncoder;
use crate::primitives::PrimitiveStore;
use crate::stage_clock::StageClock;
use crate::testing::{contexts, read};
use crate::twins;

const COUNT: usize = 3000;

/// Rays to all sides, some from outside the scene; every seventh is not traced.
fn rays() -> Vec<DeviceRay> {
    let mut rng = Rng::new(71);
    let mut ray = |slot: usize| {
        let (origin, direction) = (1.2 * rng.in_cube(), 1e3 * rng.on_sphere());
        let (t_min, t_max) = (0.0, if slot.is_multiple_of(7) { -1.0 } else { 1.0 });
        let (origin, direction) = (origin.to_array(), direction.to_array());
        DeviceRay { origin, direction, t_min, t_max, slot: slot as u32, ..DeviceRay::IDLE }
    };
    (0..COUNT).map(&mut ray).collect()
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

#[test]
fn rays_lie_where_their_keys_say() {
    let soup = triangle_soup(&mut Rng::new(72), SoupKind::Plain, 500, Vec3::ZERO, 1.0);
    let geometry = Geometry::new(vec![GeometryObject::new(ObjectId(0), soup)]).unwrap();
    let rays = rays();
    for context in contexts() {
        let mut primitives = PrimitiveStore::default();
        primitives.commit(context, &geometry, &FrameChanges::all(), "gpu:compute").unwrap();
        let (mut scene, mut order) = (BucketOrder::new(context), RayOrder::new(context));
        let mut given = GrowingBuffer::storage("rays");
        let bytes = size_of_val(&*rays);
        let given = crate::buffer::part_of(given.write(context, &rays), bytes);
        let mut clock = StageClock::new(context);
        let mut encoder = StageEncoder::new(context, &mut clock);
        scene.order(&mut encoder, &primitives);
        order.reserve(context, COUNT);
        order.order(&mut encoder, (given, COUNT), scene.bounds());
        encoder.submit();
        let bounds = twins::bound_scene(primitives.host());
        let places: Vec<[u32; 2]> = read(context, order.places.buffer(), COUNT);
        let mut counts = vec![0; KEYS];
        for (ray, [found, _]) in rays.iter().zip(&places) {
            counts[*found as usize] += 1;
            let (expected, margin) = key(twins::count_rays(ray, bounds, KEY_BITS));
            let is_right = if ray.is_active() { *found == expected } else { *found == 1 << 15 };
            assert!(is_right || margin < 1e-4, "{ray:?}: {found}, not {expected}");
        }
        assert!(counts.iter().filter(|&&count| count > 0).count() > 1000);
        let firsts: Vec<u32> = read(context, order.keys.buffer(), KEYS);
        assert_eq!(firsts, twins::place_cells(&counts));
        let ordered: Vec<DeviceRay> = read(context, order.ordered(), COUNT);
        for (ray, [key, place]) in rays.iter().zip(places) {
            assert_eq!(ordered[(firsts[key as usize] + place) as usize], *ray);
        }
    }
}
