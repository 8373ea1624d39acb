//! Photons are sorted, and none is lost where there is no room at first.

use std::sync::Arc;

use rayflock_render::caustics::CausticSettings;
use rayflock_render::{Film, FrameRenderer, FrameStats, RenderSettings, View};
use rayflock_scene::{Evaluator, Scene, builtin};

use super::*;
use crate::frame::GpuRenderer;
use crate::testing::{contexts, read};

/// Position, flux, normal and direction, each with a word that is not used.
type Words = [u32; PHOTON_BYTES / 4];

fn render(renderer: &mut GpuRenderer, scene: &Arc<Scene>) -> (Film, FrameStats) {
    let mut evaluator = Evaluator::new(Arc::clone(scene), None).unwrap();
    let frame = evaluator.evaluate(2.0).unwrap();
    renderer.commit(scene, frame).unwrap();
    let view = View::new(frame.cameras[0], scene.cameras[0].projection);
    let mut film = Film::new(24, 16);
    let caustics = Some(CausticSettings { photons: 4096, radius: 0.02 });
    let settings = RenderSettings { caustics, depth: 2, ..RenderSettings::default() };
    let stats = renderer.render(&view, &settings, &mut film);
    assert_eq!(renderer.notice(), None);
    (film, stats)
}

#[test]
fn each_photon_is_found_once_and_those_without_room_are_left_anew() {
    let scene = Arc::new(builtin::build("museum3").unwrap());
    for context in contexts() {
        let mut renderer = GpuRenderer::new(context).unwrap();
        renderer.device.photons.capacity = 16;
        let (found, stats) = render(&mut renderer, &scene);
        let photons = &renderer.device.photons;
        let count = photons.count;
        assert!(count > 100 && count as u64 == stats.caustics.photons, "{count}");
        assert!((count..FIRST_CAPACITY).contains(&photons.capacity), "{}", photons.capacity);
        check_sorted(context, photons);

        // Now there is room for all; sums may be in another order.
        let (expected, counted) = render(&mut renderer, &scene);
        assert_eq!((counted.rays, counted.caustics.photons), (stats.rays, count as u64));
        let apart = |(a, b): (&[f32; 3], &[f32; 3])| {
            a.iter().zip(b).any(|(a, b)| (a - b).abs() > 1e-3 * (1.0 + b.abs()))
        };
        assert_eq!(found.pixels().iter().zip(expected.pixels()).filter(|&p| apart(p)).count(), 0);
    }
}

/// What is sorted is what was left, and buckets take all places, each one once.
fn check_sorted(context: &GpuContext, photons: &Photons) {
    let count = photons.count;
    let header = PHOTONS_OFFSET / size_of::<u32>();
    let store: Vec<u32> = read(context, photons.store.buffer(), store_bytes(count) / 4);
    assert_eq!(store[..2], [count as u32; 2]);
    let mut left: Vec<Words> = bytemuck::pod_collect_to_vec(&store[header..]);
    let mut sorted: Vec<Words> = read(context, photons.sorted.buffer(), count);
    left.sort_unstable();
    sorted.sort_unstable();
    assert!(left == sorted);

    let mut buckets: Vec<[u32; 3]> =
        read(context, photons.buckets.buffer(), count.next_power_of_two());
    buckets.sort_unstable();
    let end = buckets.iter().fold(0, |end, &[first, count, filled]| {
        assert_eq!((first, filled), (end, count));
        end + count
    });
    assert_eq!(end as usize, count);
}
