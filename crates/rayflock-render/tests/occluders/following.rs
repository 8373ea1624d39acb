//! Spheres follow what moves, bends and breaks.
#![expect(clippy::unwrap_used, reason = "tests fail by panicking")]

use std::sync::Arc;

use glam::{Affine3A, Quat, Vec3};
use rayflock_geom::simd::segment_spheres::SoftSphere;
use rayflock_geom::{Geometry, GeometryObject, Mesh, ObjectId, Sphere};
use rayflock_render::occluders::{FitStats, SceneSpheres, SphereSettings};

use super::common::Random;

/// A ball of triangles, `bend` of which is pulled sideways.
fn ball(bend: f32) -> Mesh {
    let (rows, columns) = (16_u32, 24_u32);
    let vertex = |row: u32, column: u32| {
        let (polar, turn) = (
            std::f32::consts::PI * row as f32 / rows as f32,
            std::f32::consts::TAU * column as f32 / columns as f32,
        );
        let place = Vec3::new(polar.sin() * turn.cos(), polar.cos(), polar.sin() * turn.sin());
        place + bend * place.y * place.y * Vec3::X
    };
    let vertices = (0..=rows).flat_map(|row| (0..columns).map(move |column| vertex(row, column)));
    let quads = (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column)));
    let triangles = quads.flat_map(|(row, column)| {
        let at = |row: u32, column: u32| row * columns + column % columns;
        let (a, b) = (at(row, column), at(row, column + 1));
        let (c, d) = (at(row + 1, column), at(row + 1, column + 1));
        [[a, b, d], [a, d, c]]
    });
    Mesh::from_triangles(vertices.collect(), triangles.collect::<Vec<_>>()).unwrap()
}

/// Loose triangles, other ones for each seed.
fn debris(seed: u64, count: usize) -> Mesh {
    let mut random = Random::new(seed);
    let mut vector = || Vec3::new(random.next(), random.next(), random.next());
    let corners = (0..count).flat_map(|_| {
        let middle = 4.0 * vector();
        [middle + 0.2 * vector(), middle + 0.2 * vector(), middle + 0.2 * vector()]
    });
    let corners: Vec<_> = corners.collect();
    let triangles: Vec<_> = (0..count as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    Mesh::from_triangles(corners, triangles).unwrap()
}

fn of(objects: Vec<GeometryObject>) -> Geometry {
    Geometry::new(objects).unwrap()
}

fn one(mesh: &Arc<Mesh>) -> Geometry {
    of(vec![GeometryObject::new(ObjectId(3), Arc::clone(mesh))])
}

fn fresh(geometry: &Geometry, count: usize) -> SceneSpheres {
    let mut spheres = SceneSpheres::new(SphereSettings { count });
    spheres.commit(geometry);
    spheres
}

fn sorted(spheres: &SceneSpheres) -> Vec<SoftSphere> {
    let mut spheres = spheres.tree().spheres().to_vec();
    spheres
        .sort_by(|a, b| a.center.x.total_cmp(&b.center.x).then(a.center.y.total_cmp(&b.center.y)));
    spheres
}

fn assert_alike(found: &SoftSphere, expected: &SoftSphere) {
    assert!(found.center.distance(expected.center) < 1e-4, "{found:?} is not {expected:?}");
    assert!((found.outer - expected.outer).abs() < 1e-4, "{found:?} is not {expected:?}");
    assert!((found.inner - expected.inner).abs() < 1e-3, "{found:?} is not {expected:?}");
    assert!((found.opacity - expected.opacity).abs() < 1e-3, "{found:?} is not {expected:?}");
    assert!(found.flatness.distance(expected.flatness) < 2e-2, "{found:?} is not {expected:?}");
}

/// Every vertex lies within some sphere.
fn assert_covered(spheres: &SceneSpheres, vertices: impl Iterator<Item = Vec3>) {
    for vertex in vertices {
        let holds = |sphere: &SoftSphere| sphere.distance_squared(vertex).sqrt() <= sphere.outer;
        assert!(spheres.tree().spheres().iter().any(holds), "{vertex} lies in no sphere");
    }
}

#[test]
fn spheres_cover_every_vertex_however_the_mesh_bends() {
    let rest = Arc::new(ball(0.0));
    let mut spheres = fresh(&one(&rest), 40);
    assert_covered(&spheres, rest.vertices().iter().copied());
    for bend in [0.1, 0.3, 0.5] {
        let bent = Arc::new(rest.with_vertices(ball(bend).vertices().to_vec()).unwrap());
        let stats = spheres.commit(&one(&bent));
        assert_eq!((stats.refitted, stats.fitted), (1, 0));
        assert_covered(&spheres, bent.vertices().iter().copied());
    }
}

#[test]
fn a_refit_of_an_unchanged_mesh_is_the_fit() {
    let mesh = Arc::new(ball(0.2));
    let mut spheres = fresh(&one(&mesh), 40);
    let fitted = sorted(&spheres);
    assert!(fitted.len() > 30 && fitted.len() <= 44, "{}", fitted.len());
    // The same vertices, but another mesh as far as anyone can tell.
    let again = Arc::new(mesh.with_vertices(mesh.vertices().to_vec()).unwrap());
    assert_eq!(spheres.commit(&one(&again)).refitted, 1);
    assert_eq!(sorted(&spheres), fitted);
    // And back after a detour.
    let away = Arc::new(mesh.with_vertices(ball(0.25).vertices().to_vec()).unwrap());
    spheres.commit(&one(&away));
    assert_ne!(sorted(&spheres), fitted);
    spheres.commit(&one(&mesh));
    assert_eq!(sorted(&spheres), fitted);
}

#[test]
fn rigid_moves_move_spheres_and_rest_costs_nothing() {
    let mesh = Arc::new(ball(0.0).with_spheres(vec![Sphere::new(3.0 * Vec3::X, 0.5)]));
    let mut spheres = fresh(&one(&mesh), 40);
    let at_rest = spheres.tree().spheres().to_vec();
    let place = Affine3A::from_scale_rotation_translation(
        Vec3::splat(2.0),
        Quat::from_rotation_z(0.7),
        Vec3::new(1.0, -2.0, 3.0),
    );
    let object = GeometryObject::new(ObjectId(3), Arc::clone(&mesh)).with_transform(place);
    let moved = of(vec![object]);
    let counts = |stats: FitStats| (stats.fitted, stats.refitted, stats.moved, stats.kept);
    assert_eq!(counts(spheres.commit(&moved)), (0, 0, 1, 0));
    assert_eq!(counts(spheres.commit(&moved)), (0, 0, 0, 1));
    assert_eq!(spheres.tree().spheres().len(), at_rest.len());
    for sphere in &at_rest {
        let expected = SoftSphere {
            center: place.transform_point3(sphere.center),
            inner: 2.0 * sphere.inner,
            outer: 2.0 * sphere.outer,
            opacity: sphere.opacity,
            flatness: Quat::from_rotation_z(0.7) * sphere.flatness,
        };
        let distance = |other: &SoftSphere| other.center.distance(expected.center);
        let found = spheres.tree().spheres().iter();
        let nearest = found.min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap();
        assert_alike(nearest, &expected);
    }
}

#[test]
fn what_breaks_gets_other_spheres_and_no_more_memory() {
    let mut spheres = SceneSpheres::new(SphereSettings { count: 100 });
    let mut memory = 0;
    for seed in 0..12 {
        let mesh = Arc::new(debris(seed, 500));
        let stats = spheres.commit(&one(&mesh));
        assert_eq!((stats.fitted, stats.refitted), (1, 0));
        assert!(stats.spheres > 60 && stats.spheres <= 130, "{stats:?}");
        assert_covered(&spheres, mesh.vertices().iter().copied());
        if seed == 3 {
            memory = spheres.memory_usage();
        }
    }
    assert!(spheres.memory_usage() <= memory * 5 / 4, "{} after {memory}", spheres.memory_usage());
}

#[test]
fn clusters_that_part_are_made_anew() {
    let rest = Arc::new(debris(1, 300));
    let mut spheres = fresh(&one(&rest), 50);
    let before: f32 = spheres.tree().spheres().iter().map(|sphere| sphere.outer).sum();
    // Each triangle goes to where another one was.
    let corners = rest.vertices();
    let shuffled: Vec<_> = (0..corners.len()).map(|i| corners[i * 7 % corners.len()]).collect();
    let stats = spheres.commit(&one(&Arc::new(rest.with_vertices(shuffled).unwrap())));
    assert_eq!((stats.fitted, stats.refitted), (1, 0));
    let after: f32 = spheres.tree().spheres().iter().map(|sphere| sphere.outer).sum();
    assert!(after < 8.0 * before, "{after} after {before}");
}

#[test]
fn walls_of_a_room_have_spheres_only_while_something_is_behind_them() {
    let floor = Mesh::from_triangles(
        vec![Vec3::ZERO, 9.0 * Vec3::Z, Vec3::new(9.0, 0.0, 9.0), 9.0 * Vec3::X],
        vec![[0, 1, 2], [0, 2, 3]],
    );
    let floor = Arc::new(floor.unwrap());
    let ball = Arc::new(Mesh::from_spheres(vec![Sphere::new(Vec3::ZERO, 1.0)]));
    let scene = |height: f32| {
        let place = Affine3A::from_translation(Vec3::new(4.0, height, 4.0));
        of(vec![
            GeometryObject::new(ObjectId(0), Arc::clone(&floor)),
            GeometryObject::new(ObjectId(1), Arc::clone(&ball)).with_transform(place),
        ])
    };
    let mut spheres = fresh(&scene(2.0), 20);
    assert_eq!(spheres.tree().spheres().len(), 1);
    spheres.commit(&scene(-2.0));
    assert!(spheres.tree().spheres().len() > 4);
    spheres.commit(&scene(2.0));
    assert_eq!(spheres.tree().spheres().len(), 1);
}

#[test]
fn nothing_and_nonsense_have_no_spheres() {
    let mut spheres = fresh(&Geometry::default(), 10);
    assert!(spheres.tree().spheres().is_empty());
    let nonsense = Mesh::from_triangles(vec![Vec3::NAN, Vec3::X, Vec3::Y], vec![[0, 1, 2]]);
    let nonsense = nonsense.unwrap().with_spheres(vec![Sphere::new(Vec3::ZERO, -1.0)]);
    spheres.commit(&one(&Arc::new(nonsense)));
    assert!(spheres.tree().spheres().is_empty());
    spheres.commit(&one(&Arc::new(ball(0.0))));
    assert!(!spheres.tree().spheres().is_empty());
    spheres.commit(&Geometry::default());
    assert!(spheres.tree().spheres().is_empty());
}
