//! Planes and spheres, whose ranges are known in closed form.

use glam::{DVec3, Vec3};
use rayflock_render::sensor::{
    OrthographicScanner, Pattern, Pose, PosePath, Raster, Rosette, Sensor, Shutter, StepPose, Sweep,
};

use crate::common::{ball, depth, matte, scene, sensor, spinning, sweep, wall};

fn relative_error(found: f32, expected: f64) -> f64 {
    (f64::from(found) - expected).abs() / expected
}

/// Where a beam goes in the sensor's frame, by what came back along it.
fn direction(sweep: &Sweep, idx: usize) -> DVec3 {
    sweep.position_in_sensor[idx].as_dvec3().normalize()
}

#[test]
fn a_wall_has_one_depth() {
    let scene = scene(vec![(wall(-5.0, 100.0), matte(0.5))]);
    let sweep = sweep(&scene, &sensor(depth(24, 16, Shutter::Global)));
    assert_eq!(sweep.len(), 24 * 16);
    for idx in 0..sweep.len() {
        assert!(relative_error(sweep.depth(idx), 5.0) < 1e-5);
        let (row, column) = (f64::from(sweep.row[idx]), f64::from(sweep.column[idx]));
        // The picture is 2 high at distance 1, and 3 wide.
        let aside =
            (5.0 * 3.0 * ((column + 0.5) / 24.0 - 0.5), 5.0 * 2.0 * (0.5 - (row + 0.5) / 16.0));
        let expected = DVec3::new(aside.0, aside.1, -5.0);
        assert!(sweep.position[idx].as_dvec3().distance(expected) < 5e-5, "{row} {column}");
        assert!(relative_error(sweep.range[idx], expected.length()) < 1e-5);
        // Lambert over the range squared.
        let intensity = 0.5 * (5.0 / expected.length()) / expected.length_squared();
        assert!(relative_error(sweep.intensity[idx], intensity) < 1e-4);
        assert_eq!((sweep.normal[idx], sweep.time[idx]), (Vec3::Z, 0.0));
        assert_eq!((sweep.return_number[idx], sweep.return_count[idx]), (1, 1));
    }
    assert!((0..2).all(|triangle| sweep.prim_id.contains(&triangle)));
    let picture = sweep.picture((16, 24), f32::NAN, |idx| sweep.depth(idx));
    assert!(picture.iter().all(|depth| (depth - 5.0).abs() < 5e-5));
}

#[test]
fn a_spinning_sensor_sees_the_sphere_around_it_and_the_one_ahead() {
    let center = DVec3::new(0.0, 0.0, -4.0);
    let scene =
        scene(vec![(ball(Vec3::ZERO, 9.0), matte(0.8)), (ball(center.as_vec3(), 1.0), matte(0.2))]);
    let sweep = sweep(&scene, &sensor(spinning(9, 360)));
    assert_eq!(sweep.len(), 9 * 360);
    let mut ahead = 0;
    for idx in 0..sweep.len() {
        let to = direction(&sweep, idx);
        let middle = to.dot(center);
        let squared = middle * middle - center.length_squared() + 1.0;
        let expected = if middle > 0.0 && squared > 0.0 { middle - squared.sqrt() } else { 9.0 };
        // A sphere seen edge-on amplifies every error.
        let tolerance = if squared.abs() < 0.1 { 1e-3 } else { 1e-5 };
        assert!(relative_error(sweep.range[idx], expected) < tolerance, "{expected}");
        ahead += u32::from(sweep.object_id[idx] == 1);
        let column = f64::from(sweep.column[idx]);
        assert!((sweep.time[idx] - column / 3600.0).abs() < 1e-12);
        let azimuth = (column - 180.0).to_radians();
        let elevation = (20.0 - 5.0 * f64::from(sweep.row[idx])).to_radians();
        assert!((to.x.atan2(-to.z) - azimuth).abs() < 1e-5 || column == 0.0);
        assert!((to.y.asin() - elevation).abs() < 1e-5);
    }
    // The sphere ahead is seen under an angle of 2 asin(1 / 4), 29 columns and 5 rows of 5 degrees.
    assert!((100..140).contains(&ahead), "{ahead}");
}

#[test]
fn an_orthographic_scanner_measures_along_its_axis() {
    let pattern = Pattern::Orthographic(OrthographicScanner {
        width: 20,
        height: 10,
        extent: [4.0, 2.0],
        rate: 10.0,
        shutter: Shutter::Global,
    });
    let scene = scene(vec![(ball(Vec3::new(5.0, 0.0, 0.0), 1.0), matte(1.0))]);
    let mut sensor = sensor(pattern);
    // Along +X, from off the middle.
    let position = Vec3::new(-3.0, 0.25, 0.5);
    sensor.path = PosePath::Fixed(Pose::looking_at(position, position + Vec3::X));
    let sweep = sweep(&scene, &sensor);
    let mut seen = 0;
    for row in 0..10 {
        for column in 0..20 {
            let (right, up) =
                (0.2 * (f64::from(column) + 0.5) - 2.0, 1.0 - 0.2 * (f64::from(row) + 0.5));
            let (y, z) = (0.25 + up, 0.5 + right);
            let squared = 1.0 - y * y - z * z;
            let found = (0..sweep.len())
                .find(|&idx| (sweep.row[idx], sweep.column[idx]) == (row as u32, column as u32));
            assert_eq!(found.is_some(), squared > 0.0, "{row} {column}");
            if let Some(idx) = found {
                seen += 1;
                let expected = DVec3::new(5.0 - squared.sqrt(), y, z);
                assert!(sweep.position[idx].as_dvec3().distance(expected) < 1e-4);
                assert!(relative_error(sweep.depth(idx), expected.x + 3.0) < 1e-4);
            }
        }
    }
    assert!((60..100).contains(&seen), "{seen}");
}

#[test]
fn raster_and_rosette_keep_to_their_fields() {
    let scene = scene(vec![(ball(Vec3::ZERO, 2.0), matte(1.0))]);
    let field = [1.2, 0.4];
    let raster = Pattern::Raster(Raster { columns: 30, rows: 8, field, rate: 10.0 });
    let sweep_of = |pattern| sweep(&scene, &sensor(pattern));
    let raster = sweep_of(raster);
    assert_eq!(raster.len(), 240);
    for idx in 0..raster.len() {
        let to = direction(&raster, idx);
        let (column, row) = (f64::from(raster.column[idx]), f64::from(raster.row[idx]));
        assert!((to.x.atan2(-to.z) - 1.2 * ((column + 0.5) / 30.0 - 0.5)).abs() < 1e-6);
        assert!((to.y.asin() - 0.4 * (0.5 - (row + 0.5) / 8.0)).abs() < 1e-6);
        assert!((raster.time[idx] - row / 80.0).abs() < 1e-12);
    }
    let rosette = sweep_of(Pattern::Rosette(Rosette {
        beams: 1000,
        rate: 10.0,
        bends: [0.2, 0.1],
        turns: [30.0, -7.0],
    }));
    assert_eq!((rosette.len(), rosette.steps.len()), (1000, 16));
    let angle = |idx: usize| direction(&rosette, idx).angle_between(DVec3::NEG_Z);
    assert!((0..1000).all(|idx| (0.1 - 1e-6..0.3 + 1e-6).contains(&angle(idx))));
}

#[test]
fn ranges_end_where_the_sensor_does() {
    let scene = scene(vec![(wall(-2.0, 0.5), matte(1.0)), (wall(-6.0, 50.0), matte(1.0))]);
    let mut sensor = sensor(depth(20, 20, Shutter::Global));
    let count = |sensor: &Sensor| sweep(&scene, sensor).len();
    assert_eq!(count(&sensor), 400);
    // The near wall is too near to be told, and still in the way.
    sensor.settings.min_range = 3.0;
    let without_near = count(&sensor);
    assert!((350..400).contains(&without_near), "{without_near}");
    (sensor.settings.min_range, sensor.settings.max_range) = (0.0, 3.0);
    assert_eq!(count(&sensor), 400 - without_near);
    (sensor.settings.max_range, sensor.settings.min_intensity) = (f32::INFINITY, 0.1);
    assert_eq!(count(&sensor), 400 - without_near, "the far wall is too dim");
}

#[test]
fn poses_are_told_step_by_step() {
    let scene = scene(vec![(ball(Vec3::ZERO, 9.0), matte(1.0))]);
    let mut sensor = sensor(spinning(4, 60));
    sensor.settings.time_steps = Some(6);
    let pose = Pose::looking_at(Vec3::new(1.0, 0.5, 0.0), Vec3::new(4.0, 0.0, 2.0));
    sensor.path = PosePath::Fixed(pose);
    let sweep = sweep(&scene, &sensor);
    let times: Vec<f64> = sweep.steps.iter().map(|step| step.time).collect();
    let expected = [4.5, 14.5, 24.5, 34.5, 44.5, 54.5].map(|column| column / 600.0);
    assert!(times.iter().zip(expected).all(|(found, expected)| (found - expected).abs() < 1e-12));
    for idx in 0..sweep.len() {
        let StepPose { world_from_sensor, .. } =
            *sweep.steps.iter().find(|step| step.time == sweep.time[idx]).unwrap();
        let moved = world_from_sensor.transform_point3(sweep.position_in_sensor[idx]);
        assert!(moved.distance(sweep.position[idx]) < 1e-5);
        assert!((sweep.position[idx].length() - 9.0).abs() < 1e-4);
    }
}
