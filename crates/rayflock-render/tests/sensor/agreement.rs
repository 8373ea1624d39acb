//! A sweep is the same to the bit by every engine, on any number of threads, after any other.

use glam::Vec3;
use rayflock_engine::{EngineKind, create};
use rayflock_render::sensor::{
    DropOut, Pose, PosePath, RangeNoise, Returns, Scanner, Sensor, Sweep,
};
use rayflock_scene::{Scene, builtin};

use crate::common::{evaluator, sensor, spinning, sweep_by};

/// People who walk, noise and drop-outs.
fn hard() -> (Scene, Sensor) {
    let mut sensor = sensor(spinning(12, 90));
    sensor.path = PosePath::Fixed(Pose::at(Vec3::new(0.5, 1.5, 1.0)));
    sensor.settings.time_steps = Some(9);
    sensor.settings.returns = Returns::FirstAndLast;
    sensor.settings.noise = RangeNoise { constant: 0.01, proportional: 0.001 };
    sensor.settings.drop_out = DropOut { constant: 0.1, grazing: 0.5, far: 0.0 };
    (builtin::build("crowd").unwrap(), sensor)
}

#[test]
fn engines_and_threads_change_nothing() {
    let (scene, sensor) = hard();
    let expected = sweep_by(EngineKind::Brute, &scene, &sensor, 0.4);
    assert!(expected.len() > 500, "{}", expected.len());
    for kind in EngineKind::ALL {
        for threads in [1, 2] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let found = pool.install(|| sweep_by(kind, &scene, &sensor, 0.4));
            assert!(found == expected, "{kind} on {threads} threads");
        }
    }
}

#[test]
fn a_sweep_does_not_depend_on_those_before() {
    let (scene, sensor) = hard();
    let expected = sweep_by(EngineKind::Auto, &scene, &sensor, 0.4);
    let mut scanner = Scanner::new(create(EngineKind::Auto), sensor).unwrap();
    let (mut evaluator, mut sweep) = (evaluator(scene), Sweep::default());
    for start in [1.3, 0.0, 0.4] {
        scanner.sweep(&mut evaluator, start, &mut sweep).unwrap();
    }
    assert!(sweep == expected);
}
