//! Noise and drop-outs: their statistics, and that a seed repeats them.

use glam::Vec3;
use rayflock_render::sensor::{DropOut, RangeNoise, Sweep};
use rayflock_scene::Scene;

use crate::common::{ball, matte, scene, sensor, spinning, sweep};

const RADIUS: f32 = 10.0;

/// Every beam has a range of 10.
fn room() -> Scene {
    scene(vec![(ball(Vec3::ZERO, RADIUS), matte(0.5))])
}

fn noisy(seed: u64, noise: RangeNoise, drop_out: DropOut) -> Sweep {
    let mut sensor = sensor(spinning(50, 400));
    sensor.settings.noise = noise;
    sensor.settings.drop_out = drop_out;
    sensor.settings.max_range = 20.0;
    sensor.settings.seed = seed;
    // One step, to be quick.
    sensor.settings.time_steps = Some(1);
    sweep(&room(), &sensor)
}

#[test]
fn ranges_scatter_as_they_should() {
    let noise = RangeNoise { constant: 0.05, proportional: 0.01 };
    let sweep = noisy(1, noise, DropOut::default());
    let errors: Vec<f64> = sweep.range.iter().map(|range| f64::from(range - RADIUS)).collect();
    let count = errors.len() as f64;
    let mean = errors.iter().sum::<f64>() / count;
    let deviation = (errors.iter().map(|error| error * error).sum::<f64>() / count).sqrt();
    // 0.05 + 0.01 * 10, within five standard errors of 20,000 samples.
    assert!(mean.abs() < 5.0 * 0.15 / count.sqrt(), "{mean}");
    assert!((deviation / 0.15 - 1.0).abs() < 5.0 / (2.0 * count).sqrt(), "{deviation}");
    for idx in 0..sweep.len() {
        assert!((sweep.position[idx].length() - sweep.range[idx]).abs() < 1e-4);
    }
}

#[test]
fn neighbours_are_off_independently() {
    let noise = RangeNoise { constant: 1.0, proportional: 0.0 };
    let sweep = noisy(2, noise, DropOut::default());
    let errors: Vec<f64> = sweep.range.iter().map(|range| f64::from(range - RADIUS)).collect();
    for distance in [1, 2, 50] {
        let products = errors.iter().zip(&errors[distance..]).map(|(a, b)| a * b);
        let correlation = products.sum::<f64>() / errors.len() as f64;
        assert!(
            correlation.abs() < 5.0 / (errors.len() as f64).sqrt(),
            "{distance}: {correlation}"
        );
    }
}

#[test]
fn as_many_echoes_are_lost_as_should_be() {
    let count = |drop_out| noisy(3, RangeNoise::default(), drop_out).len() as f64 / 20_000.0;
    // Beams meet the ball at normal incidence, half way to the most range.
    for (drop_out, expected) in [
        (DropOut { constant: 0.3, ..DropOut::default() }, 0.7),
        (DropOut { far: 0.8, ..DropOut::default() }, 0.8),
        (DropOut { grazing: 1.0, ..DropOut::default() }, 1.0),
        (DropOut { constant: 0.5, far: 0.4, grazing: 0.5 }, 0.45),
    ] {
        assert!((count(drop_out) - expected).abs() < 0.018, "{drop_out:?}");
    }
}

#[test]
fn a_seed_repeats_a_sweep_and_another_does_not() {
    let noise = RangeNoise { constant: 0.1, proportional: 0.0 };
    let drop_out = DropOut { constant: 0.2, ..DropOut::default() };
    let [first, again, other] = [5, 5, 6].map(|seed| noisy(seed, noise, drop_out));
    assert_eq!(first, again);
    assert_ne!(first.range, other.range);
    assert_ne!(first.beam_idx, other.beam_idx);
}
