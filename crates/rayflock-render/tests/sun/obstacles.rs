//! Shadows of walls, against geometry done by hand.

use std::f32::consts::FRAC_PI_2;

use glam::{Quat, Vec3};
use jiff::civil::date;
use rayflock_geom::{FrameChanges, Mesh, Sphere};
use rayflock_render::sun::{Sampling, Sides, SunError, SunStep};

use crate::common::{geometry, ground, hours, meter, steps, total};

/// The floor of a courtyard as four triangles around its middle, which is vertex 0.
fn floor(half: f32) -> Mesh {
    let corner = |x: f32, z: f32| Vec3::new(x * half, 0.0, z * half);
    let corners = vec![
        Vec3::ZERO,
        corner(-1.0, 1.0),
        corner(1.0, 1.0),
        corner(1.0, -1.0),
        corner(-1.0, -1.0),
    ];
    let triangles = vec![[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 1]];
    Mesh::from_triangles(corners, triangles).unwrap()
}

/// Four walls around it.
fn walls(half: f32, height: f32) -> Vec<Mesh> {
    let wall = |quarter: u8| {
        let turn = Quat::from_rotation_y(f32::from(quarter) * FRAC_PI_2);
        let corner = |x: f32, y: f32| turn * Vec3::new(x * half, y * height, half);
        let corners =
            vec![corner(-1.0, 0.0), corner(1.0, 0.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
        Mesh::from_triangles(corners, vec![[0, 1, 2], [0, 2, 3]]).unwrap()
    };
    (0..4).map(wall).collect()
}

/// Whether the middle of the floor sees the sun over the edge of the wall it stands behind.
fn clears_the_wall(step: &SunStep, half: f64, height: f64) -> bool {
    let [x, y, z] = step.to_sun.to_array().map(f64::from);
    let (elevation, azimuth) = (y.asin(), x.atan2(-z));
    let to_wall = half / azimuth.sin().abs().max(azimuth.cos().abs());
    elevation > (height / to_wall).atan()
}

#[test]
fn the_middle_of_a_courtyard_sees_the_sun_over_its_walls() {
    let mut seen_lit = [false; 2];
    for (half, height) in [(5.0, 2.0), (5.0, 5.0), (3.0, 9.0)] {
        let mut meshes = vec![floor(half)];
        meshes.extend(walls(half, height));
        let yard = geometry(meshes);
        for latitude in [-20.0, 5.0, 40.0, 55.0] {
            for day in [date(2024, 3, 20), date(2024, 6, 20), date(2024, 11, 5)] {
                let steps = steps(latitude, day);
                let lit = steps
                    .iter()
                    .filter(|step| clears_the_wall(step, f64::from(half), f64::from(height)));
                let expected = lit.map(|step| step.seconds).sum::<f64>() / 3600.0;
                let found = hours(&yard, &steps, Sampling::Vertices, Sides::Both)[0];
                assert_eq!(found, expected, "{half} x {height} at {latitude} on {day}");
                seen_lit[usize::from(found > 0.0)] = true;
            }
        }
    }
    assert_eq!(seen_lit, [true; 2], "some courtyards are dark, some are not");
}

#[test]
fn faces_and_vertices_of_open_ground_get_the_same() {
    let mut corners = Vec::new();
    let mut triangles = Vec::new();
    for (row, column) in (0..6_u16).flat_map(|row| (0..6).map(move |column| (row, column))) {
        corners.push(Vec3::new(f32::from(column), 0.0, f32::from(row)));
        if row > 0 && column > 0 {
            let here = u32::from(row * 6 + column);
            triangles.extend([[here - 7, here - 1, here], [here - 7, here, here - 6]]);
        }
    }
    let grid = geometry(vec![Mesh::from_triangles(corners, triangles).unwrap()]);
    let steps = steps(47.0, date(2024, 9, 1));
    let [faces, vertices] = [Sampling::Faces, Sampling::Vertices]
        .map(|sampling| hours(&grid, &steps, sampling, Sides::Front));
    assert_eq!((faces.len(), vertices.len()), (50, 36));
    assert!(faces.iter().chain(&vertices).all(|hours| *hours == total(&steps)));
}

#[test]
fn a_closed_box_is_dark_inside() {
    let steps = steps(30.0, date(2024, 6, 20));
    let mut meshes = vec![ground(Vec3::Y * 0.5, 0.25)];
    meshes.extend(walls(1.0, 1.0));
    meshes.extend([ground(Vec3::ZERO, 1.0), ground(Vec3::Y, 1.0)]);
    let found = hours(&geometry(meshes), &steps, Sampling::Faces, Sides::Both);
    assert_eq!(found[..2], [0.0; 2]);
    assert_eq!(found[found.len() - 1], total(&steps), "the lid");
}

#[test]
fn what_has_no_normal_is_never_lit_and_spheres_only_throw_shadows() {
    let corners = vec![Vec3::ZERO, Vec3::X, -Vec3::Z, Vec3::splat(f32::NAN), Vec3::Y];
    let triangles = vec![[0, 1, 2], [0, 1, 1], [0, 1, 3]];
    let broken = Mesh::from_triangles(corners, triangles).unwrap();
    let steps = steps(30.0, date(2024, 6, 20));
    let found = hours(&geometry(vec![broken.clone()]), &steps, Sampling::Faces, Sides::Both);
    assert_eq!(found, [total(&steps), 0.0, 0.0]);
    let found = hours(&geometry(vec![broken.clone()]), &steps, Sampling::Vertices, Sides::Both);
    assert_eq!(found[3..], [0.0; 2], "one is not finite, one belongs to no triangle");
    assert!(found[..3].iter().all(|hours| *hours == total(&steps)), "{found:?}");

    let dome = broken.with_spheres(vec![Sphere::new(Vec3::ZERO, 5.0)]);
    let found = hours(&geometry(vec![dome]), &steps, Sampling::Faces, Sides::Both);
    assert_eq!(found, [0.0; 3]);
    let sphere = geometry(vec![Mesh::from_spheres(vec![Sphere::new(Vec3::ZERO, 1.0)])]);
    let mut meter = meter(rayflock_engine::EngineKind::Brute, Sampling::Faces, Sides::Both);
    let error = meter.commit(&sphere, &FrameChanges::all()).unwrap_err();
    assert_eq!(error, SunError::NoTriangles);
}
