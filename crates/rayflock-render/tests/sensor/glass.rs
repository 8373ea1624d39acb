//! Beams that pass panes.

use glam::Vec3;
use rayflock_render::sensor::{Returns, Sensor, Shutter, Sweep};
use rayflock_scene::{Fresnel, Material, Scene};

use crate::common::{depth, matte, scene, sensor, sweep, wall};

fn pane() -> Material {
    Material {
        diffuse: Vec3::ZERO,
        transmission: Vec3::splat(0.9),
        fresnel: Fresnel::Constant,
        ..Material::default()
    }
}

/// Two panes at 2 and 3, and a wall at 4.
fn shop_window() -> Scene {
    scene(vec![(wall(-2.0, 9.0), pane()), (wall(-3.0, 9.0), pane()), (wall(-4.0, 9.0), matte(0.5))])
}

fn looking(returns: Returns) -> Sensor {
    let mut sensor = sensor(depth(7, 7, Shutter::Global));
    sensor.settings.returns = returns;
    sensor
}

/// The returns of the beam straight ahead: object, number, count.
fn ahead(sweep: &Sweep) -> Vec<(u32, u8, u8)> {
    let returns = (0..sweep.len()).filter(|&idx| (sweep.row[idx], sweep.column[idx]) == (3, 3));
    let told = |idx| (sweep.object_id[idx], sweep.return_number[idx], sweep.return_count[idx]);
    returns.map(told).collect()
}

#[test]
fn returns_are_those_that_were_asked_for() {
    let scene = shop_window();
    for (returns, expected) in [
        (Returns::First, &[(0, 1, 1)][..]),
        (Returns::Strongest, &[(2, 1, 1)]),
        (Returns::Last, &[(2, 1, 1)]),
        (Returns::FirstAndLast, &[(0, 1, 2), (2, 2, 2)]),
        (Returns::FirstAndStrongest, &[(0, 1, 2), (2, 2, 2)]),
        (Returns::StrongestAndLast, &[(2, 1, 1)]),
        (Returns::All, &[(0, 1, 3), (1, 2, 3), (2, 3, 3)]),
    ] {
        assert_eq!(ahead(&sweep(&scene, &looking(returns))), expected, "{returns}");
    }
}

#[test]
fn panes_take_their_share_twice() {
    let sweep = sweep(&shop_window(), &looking(Returns::All));
    let middle: Vec<usize> =
        (0..sweep.len()).filter(|&idx| (sweep.row[idx], sweep.column[idx]) == (3, 3)).collect();
    let expected = [0.02 / 4.0, 0.02 * 0.81 / 9.0, 0.5 * 0.81 * 0.81 / 16.0];
    for (idx, expected) in middle.into_iter().zip(expected) {
        assert!((sweep.intensity[idx] - expected).abs() < 1e-6, "{expected}");
    }
    assert!(sweep.beam_idx.is_sorted());
}

#[test]
fn clean_glass_sends_nothing_back_and_too_many_panes_end_the_beam() {
    let scene = shop_window();
    let mut sensor = looking(Returns::First);
    (sensor.settings.dust, sensor.settings.min_intensity) = (0.0, 1e-6);
    assert_eq!(ahead(&sweep(&scene, &sensor)), [(2, 1, 1)]);
    sensor.settings.panes = 1;
    assert!(sweep(&scene, &sensor).is_empty());
    sensor.settings.panes = 2;
    assert_eq!(sweep(&scene, &sensor).len(), 49);
}
