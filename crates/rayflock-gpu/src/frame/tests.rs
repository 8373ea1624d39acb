//! What only this renderer has: buffers that overflow between bounces.

use std::sync::Arc;

use rayflock_render::{Film, FrameRenderer, RenderSettings, View};
use rayflock_scene::{Evaluator, Scene, builtin};

use super::GpuRenderer;
use crate::compute::{Compute, Form};
use crate::testing::contexts;

/// Pairs that buffers have room for at first.
const FEW: usize = 64;

fn render(renderer: &mut GpuRenderer, scene: &Arc<Scene>, time: f64) -> Film {
    let mut evaluator = Evaluator::new(Arc::clone(scene), None).unwrap();
    let frame = evaluator.evaluate(time).unwrap();
    renderer.commit(scene, frame).unwrap();
    let view = View::new(frame.cameras[0], scene.cameras[0].projection);
    let mut film = Film::new(40, 32);
    renderer.render(&view, &RenderSettings::default(), &mut film);
    assert_eq!(renderer.notice(), None);
    film
}

#[test]
fn bands_with_too_many_pairs_are_cut_and_nothing_is_dropped() {
    let scene = Arc::new(builtin::build("museum3").unwrap());
    for context in contexts() {
        let growing = Compute::with_capacity(context, Form::of(context), [FEW, 1 << 20]);
        let mut roomy = GpuRenderer::with_compute(context, growing).unwrap();
        let expected = render(&mut roomy, &scene, 2.0);
        let needed = roomy.device.compute.pair_capacity();
        assert!(needed >= 8 * FEW, "{needed} pairs are too few for the test");
        let limited = Compute::with_capacity(context, Form::of(context), [FEW, needed / 4]);
        let mut tight = GpuRenderer::with_compute(context, limited).unwrap();
        let found = render(&mut tight, &scene, 2.0);
        let apart = |(a, b): (&[f32; 3], &[f32; 3])| {
            a.iter().zip(b).any(|(a, b)| (a - b).abs() > 1e-3 * (1.0 + b.abs()))
        };
        let differing = found.pixels().iter().zip(expected.pixels()).filter(|&p| apart(p)).count();
        // Sums may be in another order, and a ray on an edge may turn out otherwise.
        assert!(differing <= 5, "{differing} pixels differ");
        // All at once do not fit what it had.
        assert!(tight.device.compute.pair_capacity() <= needed / 4);
    }
}
