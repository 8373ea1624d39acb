//! Rolling time: scenes and sensors that move during a sweep.

use glam::{Quat, Vec3};
use rayflock_engine::{EngineKind, create};
use rayflock_render::sensor::{Pose, PoseKey, PosePath, Scanner, SensorError, Shutter, Sweep};
use rayflock_scene::{
    Camera, Channel, ChannelValues, Clip, Interpolation, LocalTransform, Node, NodeIdx, Projection,
    Scene,
};

use crate::common::{ball, depth, evaluator, matte, scene, sensor, spinning, sweep, wall};

/// A wall at Z = -10 that comes nearer by 20 a second, for a second.
fn approaching() -> Scene {
    let mut scene = scene(vec![(wall(-10.0, 500.0), matte(1.0))]);
    scene.nodes.push(Node {
        name: "rail".to_owned(),
        parent: None,
        rest: LocalTransform::IDENTITY,
        rest_weights: vec![],
    });
    scene.objects[0].node = Some(NodeIdx(0));
    scene.clips.push(Clip {
        name: "approach".to_owned(),
        channels: vec![Channel {
            node: NodeIdx(0),
            times: vec![0.0, 1.0],
            interpolation: Interpolation::Linear,
            values: ChannelValues::Translation(vec![Vec3::ZERO, 20.0 * Vec3::Z]),
        }],
    });
    scene
}

#[test]
fn each_row_sees_the_wall_where_it_is_then() {
    let scene = approaching();
    let rolling = sweep(&scene, &sensor(depth(8, 10, Shutter::Rolling)));
    assert_eq!((rolling.len(), rolling.steps.len()), (80, 10));
    for idx in 0..80 {
        // Ten rows in a 25th of a second.
        let time = f64::from(rolling.row[idx]) / 250.0;
        assert!((rolling.time[idx] - time).abs() < 1e-12);
        let expected = 10.0 - 20.0 * time;
        assert!((f64::from(rolling.depth(idx)) - expected).abs() < 1e-5, "{}", rolling.row[idx]);
    }
    let global = sweep(&scene, &sensor(depth(8, 10, Shutter::Global)));
    assert!((0..80).all(|idx| (global.depth(idx) - 10.0).abs() < 1e-5));
}

#[test]
fn fewer_steps_group_lines() {
    let mut sensor = sensor(depth(8, 10, Shutter::Rolling));
    sensor.settings.time_steps = Some(2);
    let sweep = sweep(&approaching(), &sensor);
    for idx in 0..80 {
        let time = if sweep.row[idx] < 5 { 2.0 / 250.0 } else { 7.0 / 250.0 };
        assert!((sweep.time[idx] - time).abs() < 1e-12);
        assert!((f64::from(sweep.depth(idx)) - (10.0 - 20.0 * time)).abs() < 1e-5);
    }
}

#[test]
fn a_sensor_that_moves_along_keys_sees_from_where_it_is() {
    let scene = scene(vec![(ball(Vec3::ZERO, 50.0), matte(1.0))]);
    let key = |time, x: f32, angle: f32| PoseKey {
        time,
        pose: Pose { position: Vec3::X * x, rotation: Quat::from_rotation_y(angle) },
    };
    let mut sensor = sensor(spinning(3, 40));
    sensor.path = PosePath::Keyed(vec![key(0.0, 0.0, 0.0), key(0.1, 2.0, 0.4)]);
    let sweep = sweep(&scene, &sensor);
    assert_eq!(sweep.len(), 120);
    for idx in 0..120 {
        let share = (sweep.time[idx] / 0.1) as f32;
        let (position, turn) = (Vec3::X * 2.0 * share, Quat::from_rotation_y(0.4 * share));
        let expected = position + turn * sweep.position_in_sensor[idx];
        assert!(sweep.position[idx].distance(expected) < 1e-4);
        assert!((sweep.position[idx].length() - 50.0).abs() < 1e-3);
    }
}

#[test]
fn a_sensor_rides_on_a_camera_that_moves() {
    let mut scene = approaching();
    scene.cameras.push(Camera {
        name: "front".to_owned(),
        node: Some(NodeIdx(0)),
        node_from_camera: glam::Affine3A::IDENTITY,
        projection: Projection::Perspective { vertical_fov: 1.0 },
    });
    let mut sensor = sensor(depth(8, 10, Shutter::Rolling));
    sensor.path = PosePath::Camera(0);
    // It moves along with the wall.
    let seen = sweep(&scene, &sensor);
    assert!((0..80).all(|idx| (seen.depth(idx) - 10.0).abs() < 1e-5));
    let last = seen.steps.last().unwrap();
    assert!((f64::from(last.world_from_sensor.translation.z) - 20.0 * last.time).abs() < 1e-5);

    sensor.path = PosePath::Camera(1);
    let mut scanner = Scanner::new(create(EngineKind::Brute), sensor).unwrap();
    let error = scanner.sweep(&mut evaluator(scene), 0.0, &mut Sweep::default()).unwrap_err();
    assert_eq!(error, SensorError::Camera { found: 1, count: 1 });
    assert_eq!(error.to_string(), "the sensor rides on camera 1, but the number of cameras is 1");
}
