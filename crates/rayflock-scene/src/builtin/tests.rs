//! What every built-in scene promises.

use std::collections::HashSet;
use std::sync::Arc;

use rayflock_geom::{ObjectChange, PrimId, is_degenerate_triangle};

use super::*;
use crate::{Evaluator, SceneFrame};

/// Large scenes are like the small ones of their family.
fn tested() -> impl Iterator<Item = &'static Builtin> {
    all().iter().filter(|builtin| !["museum7", "museum8"].contains(&builtin.name))
}

fn evaluator(name: &str) -> Evaluator {
    Evaluator::new(Arc::new(build(name).unwrap()), None).unwrap()
}

fn time_of(scene: &Scene, frame: usize) -> f64 {
    frame as f64 / scene.frame_rate.unwrap()
}

#[test]
fn names_are_unique_and_no_other_name_is_known() {
    let names: HashSet<_> = all().iter().map(|builtin| builtin.name).collect();
    assert_eq!(names.len(), all().len());
    for unknown in ["", "museum", "museum2", "museum9", "museum05", "museum+5", "Cornell"] {
        assert!(build(unknown).is_none(), "{unknown}");
    }
}

#[test]
fn each_is_complete() {
    for builtin in tested() {
        let scene = build(builtin.name).unwrap();
        assert_eq!(scene.name, builtin.name);
        assert!(builtin.frame_count >= 240 && !builtin.about.is_empty());
        assert!(!scene.lights.is_empty() && !scene.cameras.is_empty());
        assert!(scene.background.is_some() && scene.frame_rate.is_some());
    }
}

#[test]
fn each_evaluates_and_is_sound_over_its_frames() {
    for builtin in tested() {
        let mut evaluator = evaluator(builtin.name);
        let scene = Arc::clone(evaluator.scene());
        for frame in [0, builtin.frame_count / 2, builtin.frame_count - 1] {
            let frame = evaluator.evaluate(time_of(&scene, frame)).unwrap();
            check_sound(builtin.name, &scene, frame);
        }
    }
}

fn check_sound(name: &str, scene: &Scene, frame: &SceneFrame) {
    for surface in &frame.surfaces {
        let mesh = &surface.mesh;
        assert!(surface.normals.is_empty() || surface.normals.len() == mesh.vertices().len());
        for normal in surface.normals.iter() {
            assert!((normal.length() - 1.0).abs() < 1e-3, "{name}: normal {normal}");
        }
        for triangle in 0..mesh.triangles().len() {
            let corners = mesh.corners(triangle);
            assert!(!is_degenerate_triangle(corners), "{name}: {triangle} {corners:?}");
        }
        for prim in 0..mesh.prim_count() {
            let material = surface.attributes.materials.get(PrimId(prim as u32));
            assert!((material.0 as usize) < scene.materials.len(), "{name}: {material:?}");
        }
    }
    for texture in scene.materials.iter().filter_map(|material| material.diffuse_texture) {
        assert!((texture.0 as usize) < scene.textures.len(), "{name}: {texture:?}");
    }
}

#[test]
fn two_builds_are_equal() {
    for builtin in tested() {
        let [mut a, mut b] = [evaluator(builtin.name), evaluator(builtin.name)];
        assert_eq!(a.scene().materials, b.scene().materials);
        assert_eq!(a.scene().textures, b.scene().textures);
        assert_eq!(a.scene().clips, b.scene().clips);
        let time = time_of(a.scene(), builtin.frame_count * 2 / 3);
        let [a, b] = [a.evaluate(time).unwrap(), b.evaluate(time).unwrap()];
        for (a, b) in a.surfaces.iter().zip(&b.surfaces) {
            assert_eq!(a.mesh.vertices(), b.mesh.vertices(), "{}", builtin.name);
            assert_eq!(a.mesh.triangles(), b.mesh.triangles(), "{}", builtin.name);
            assert_eq!(a.normals, b.normals, "{}", builtin.name);
            assert_eq!(a.attributes, b.attributes, "{}", builtin.name);
        }
    }
}

#[test]
fn the_museum_has_bart_s_number_of_triangles() {
    for n in 3..=8 {
        let mut evaluator = evaluator(&format!("museum{n}"));
        let counts = |frame: &SceneFrame| {
            frame.surfaces.iter().map(|surface| surface.mesh.triangles().len()).collect::<Vec<_>>()
        };
        let counts = counts(evaluator.evaluate(0.0).unwrap());
        assert!((9_000..12_000).contains(&counts[0]), "museum{n}: {} static", counts[0]);
        assert_eq!(counts[1..], [4_usize.pow(n)]);
    }
}

#[test]
fn in_the_museum_only_the_sculpture_changes() {
    let mut evaluator = evaluator("museum3");
    let mut changes_at = |time| evaluator.evaluate(time).unwrap().changes.clone();
    changes_at(0.0);
    let changes = changes_at(3.3);
    let changed: Vec<_> = changes
        .iter()
        .filter(|(_, change)| *change != ObjectChange::Unchanged)
        .map(|(id, change)| (id.0, change))
        .collect();
    assert_eq!(changed, [(1, ObjectChange::Deformed)]);
}
