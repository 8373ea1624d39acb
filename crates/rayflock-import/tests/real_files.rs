//! Real files load with the counts that the data's manifest states.
//!
//! The data is not part of the repository. `RAYFLOCK_DATA` says where it is; without it,
//! `../shared/data` beside the repository is tried. Tests say so when they skip.

use std::path::PathBuf;
use std::sync::Arc;

use glam::Vec3;
use rayflock_import::{Reporter, load};
use rayflock_scene::builtin::museum::{KEY_TIMES, sculpture_keys};
use rayflock_scene::{Evaluator, Scene, SceneObject, Shape, SurfaceMesh};

/// Where the data lies, or `None` when it is not there.
fn data_path(relative: &str) -> Option<PathBuf> {
    let beside = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data");
    let folder = std::env::var_os("RAYFLOCK_DATA").map_or(PathBuf::from(beside), PathBuf::from);
    let path = folder.join(relative);
    if path.exists() {
        return Some(path);
    }
    eprintln!("skipped: {} is not there (set RAYFLOCK_DATA)", path.display());
    None
}

/// The scene and its warnings, or `None` when the data is not there.
fn load_data(relative: &str) -> Option<(Scene, Vec<String>)> {
    let path = data_path(relative)?;
    let mut reporter = Reporter::new();
    let scene = load(&path, &mut reporter).unwrap_or_else(|error| panic!("{error}"));
    Some((scene, reporter.warnings().iter().map(ToString::to_string).collect()))
}

/// The numbers of vertices and triangles of each frame.
fn frame_counts(scene: Scene) -> Vec<(usize, usize)> {
    let (frame_count, rate) = (scene.frame_count.unwrap_or(0), scene.default_frame_rate());
    let mut evaluator =
        Evaluator::new(Arc::new(scene), None).unwrap_or_else(|error| panic!("{error}"));
    let mut counts = |frame: usize| {
        let frame = evaluator.evaluate(frame as f64 / rate).unwrap_or_else(|e| panic!("{e}"));
        let mesh = &frame.surfaces[0].mesh;
        (mesh.vertices().len(), mesh.triangles().len())
    };
    (0..frame_count).map(&mut counts).collect()
}

fn surface(object: &SceneObject) -> &SurfaceMesh {
    match &object.shape {
        Shape::Fixed(mesh) | Shape::Deformed { rest: mesh, .. } => mesh,
        Shape::Animated(_) => panic!("not one of these files has animated meshes"),
    }
}

fn triangle_count(scene: &Scene) -> usize {
    scene.objects.iter().map(|object| surface(object).mesh.triangles().len()).sum()
}

fn vertex_count(scene: &Scene) -> usize {
    scene.objects.iter().map(|object| surface(object).mesh.vertices().len()).sum()
}

/// Numbers of joints of the skins of all objects, each number once.
fn joint_counts(scene: &Scene) -> Vec<usize> {
    let mut counts: Vec<usize> = scene
        .objects
        .iter()
        .filter_map(|object| match &object.shape {
            Shape::Deformed { skin, .. } => skin.as_ref().map(|skin| skin.joints.len()),
            _ => None,
        })
        .collect();
    counts.dedup();
    counts
}

fn target_counts(scene: &Scene) -> Vec<usize> {
    let count = |object: &SceneObject| match &object.shape {
        Shape::Deformed { targets, .. } => targets.len(),
        _ => 0,
    };
    scene.objects.iter().map(count).collect()
}

fn longest_clip(scene: &Scene) -> f64 {
    scene.clips.iter().map(rayflock_scene::Clip::duration).fold(0.0, f64::max)
}

fn check(relative: &str, triangles: usize, vertices: usize, clips: usize, seconds: f64) {
    let Some((scene, warnings)) = load_data(relative) else { return };
    println!("{relative}: {warnings:#?}");
    assert_eq!(triangle_count(&scene), triangles);
    assert_eq!(vertex_count(&scene), vertices);
    assert_eq!(scene.clips.len(), clips);
    assert!((longest_clip(&scene) - seconds).abs() < 2e-3, "{}", longest_clip(&scene));
    assert!(!scene.materials.is_empty() && !scene.objects.is_empty());
}

#[test]
fn the_fox_has_three_named_clips_a_skin_and_a_texture() {
    check("fox/Fox.glb", 576, 1728, 3, 3.417);
    let Some((scene, warnings)) = load_data("fox/Fox.glb") else { return };
    let names: Vec<_> = scene.clips.iter().map(|clip| clip.name.as_str()).collect();
    assert_eq!(names, ["Survey", "Walk", "Run"]);
    assert_eq!(scene.clips.iter().map(|clip| clip.channels.len()).sum::<usize>(), 63);
    assert_eq!(joint_counts(&scene), [24]);
    assert_eq!((scene.textures.len(), warnings.len()), (1, 0), "{warnings:?}");
    assert_eq!(surface(&scene.objects[0]).attributes.uvs.len(), 1728);
}

#[test]
fn skinned_figures_have_their_joints() {
    check("cesium-man/CesiumMan.glb", 4672, 3273, 1, 2.0);
    check("mannequiny/mannequiny.glb", 13_832, 12_597, 10, 1.492);
    for (file, count) in [("cesium-man/CesiumMan.glb", 19), ("mannequiny/mannequiny.glb", 45)] {
        let Some((scene, _)) = load_data(file) else { return };
        assert_eq!(joint_counts(&scene), [count], "{file}");
    }
}

#[test]
fn adventurers_have_many_clips_and_one_texture() {
    check("kaykit-adventurers/Knight.glb", 6952, 7024, 76, 4.0);
    check("kaykit-adventurers/Mage.glb", 5683, 5279, 76, 4.0);
    let Some((scene, _)) = load_data("kaykit-adventurers/Knight.glb") else { return };
    assert_eq!(joint_counts(&scene), [41]);
    assert_eq!(scene.textures.len(), 1);
    assert_eq!(scene.clips.iter().map(|clip| clip.channels.len()).sum::<usize>(), 8712);
}

#[test]
fn skeletons_share_one_mesh() {
    let Some((scene, _)) = load_data("recursive-skeletons/RecursiveSkeletons.glb") else { return };
    assert_eq!((scene.objects.len(), triangle_count(&scene)), (84, 6384));
    assert_eq!((scene.nodes.len(), scene.clips[0].channels.len()), (924, 840));
    assert_eq!(joint_counts(&scene), [10]);
    let first = &surface(&scene.objects[0]).mesh;
    let shared = scene.objects.iter().all(|o| Arc::ptr_eq(&surface(o).mesh, first));
    assert!(shared);
}

#[test]
fn morphs_have_their_targets() {
    check("morph-stress-test/MorphStressTest.glb", 2412, 1528, 3, 9.367);
    check("animated-morph-cube/AnimatedMorphCube.glb", 12, 24, 1, 4.2);
    let Some((scene, _)) = load_data("morph-stress-test/MorphStressTest.glb") else { return };
    assert_eq!(target_counts(&scene), [8, 8]);
    let Some((scene, _)) = load_data("animated-morph-cube/AnimatedMorphCube.glb") else { return };
    assert_eq!(target_counts(&scene), [2]);
}

#[test]
fn rigid_clips_have_their_interpolations() {
    check("interpolation-test/InterpolationTest.glb", 110, 220, 9, 1.708);
    check("box-animated/BoxAnimated.glb", 254, 320, 1, 3.708);
    check("houdini-rigid-fracture/derived_rigid_fracture.glb", 2204, 1600, 1, 127.0 / 24.0);
    let Some((scene, _)) = load_data("interpolation-test/InterpolationTest.glb") else { return };
    let kinds: std::collections::HashSet<_> = scene
        .clips
        .iter()
        .flat_map(|clip| &clip.channels)
        .map(|channel| format!("{:?}", channel.interpolation))
        .collect();
    assert_eq!(kinds.len(), 3, "{kinds:?}");
}

#[test]
fn missing_textures_are_warnings() {
    check("flight-helmet/FlightHelmet.gltf", 94_722, 55_392, 0, 0.0);
    check("pigman/scene.gltf", 37_136, 27_754, 4, 1.35);
    check("terrarium-robots/scene.gltf", 55_682, 44_381, 0, 0.0);
    for file in ["flight-helmet/FlightHelmet.gltf", "pigman/scene.gltf"] {
        let Some((scene, warnings)) = load_data(file) else { return };
        assert!(scene.textures.is_empty());
        assert!(warnings.iter().any(|warning| warning.contains("do without it")), "{warnings:?}");
    }
}

#[test]
fn spot_has_a_vertex_for_each_seam() {
    check("spot/spot_triangulated.obj", 5856, 3225, 0, 0.0);
    let Some((scene, warnings)) = load_data("spot/spot_triangulated.obj") else { return };
    assert_eq!(surface(&scene.objects[0]).attributes.uvs.len(), 3225);
    assert!(warnings.is_empty(), "{warnings:?}");
}

#[test]
fn faces_of_the_rig_have_one_topology() {
    let Some((neutral, warnings)) = load_data("ict-facekit/generic_neutral_mesh.obj.gz") else {
        return;
    };
    assert_eq!((triangle_count(&neutral), neutral.objects.len()), (52_220, 1));
    assert_eq!(neutral.materials.len(), 12);
    assert!(warnings.len() == 1 && warnings[0].contains("ICTFaceModelMaterial.mtl"));
    let Some((open, _)) = load_data("ict-facekit/jawOpen.obj.gz") else { return };
    let (neutral, open) = (surface(&neutral.objects[0]), surface(&open.objects[0]));
    assert_eq!(neutral.mesh.triangles(), open.mesh.triangles());
    assert_eq!(neutral.attributes, open.attributes);
    assert_ne!(neutral.mesh.vertices(), open.mesh.vertices());
}

#[test]
fn parts_of_the_dog_add_up() {
    let Some((first, _)) = load_data("dm-control-dog/dog_assets/BONEC_1.stl.gz") else { return };
    assert!(triangle_count(&first) > 0);
    let Some(folder) = data_path("dm-control-dog/dog_assets") else { return };
    let entries = std::fs::read_dir(folder).unwrap();
    let parts: Vec<PathBuf> = entries
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.to_string_lossy().ends_with(".stl.gz"))
        .collect();
    let count = |path: &PathBuf| triangle_count(&load(path, &mut Reporter::new()).unwrap());
    assert_eq!((parts.len(), parts.iter().map(count).sum::<usize>()), (173, 346_804));
}

#[test]
fn scans_have_their_counts() {
    for (file, triangles, vertices) in [
        ("ct-cranium/surface_0.ply.gz", 399_757, 205_777),
        ("ct-cranium/derived_isosweep/frame_17_iso1600.ply.gz", 3052, 1837),
    ] {
        check(file, triangles, vertices, 0, 0.0);
    }
}

#[test]
fn the_hypergrid_has_empty_frames_and_a_topology_each() {
    let Some((scene, warnings)) = load_data("hypergrid/frames") else { return };
    assert!(warnings.is_empty(), "{warnings:?}");
    assert_eq!((scene.name.as_str(), scene.frame_count), ("Hypergrid_group", Some(240)));
    let counts = frame_counts(scene);
    let empty_count = counts.iter().filter(|(_, triangles)| *triangles == 0).count();
    assert_eq!((empty_count, counts.iter().max()), (6, Some(&(308, 468))));
}

#[test]
fn the_sweep_over_a_scan_has_its_counts() {
    let Some((scene, warnings)) = load_data("ct-cranium/derived_isosweep") else { return };
    assert!(warnings.len() == 1 && warnings[0].contains("182 triangles have no area"));
    let counts = frame_counts(scene);
    assert_eq!((counts.len(), counts[12]), (13, (1837, 3052)));
    assert_eq!(counts.iter().max(), Some(&(135_396, 269_636)));
}

#[test]
fn particles_are_spheres_with_a_usual_radius() {
    for (file, count) in [
        ("bunny_frame_14_7705_particles.vtk", 7706),
        ("double_dam_break_frame_01_4732_particles.vtk", 4732),
        ("hilbert2_18856_particles.vtk", 18_856),
        ("sailors_knot_19539_particles.vtk", 19_539),
    ] {
        let Some((scene, warnings)) = load_data(&format!("sph-particles/{file}")) else { return };
        println!("{warnings:?}");
        assert_eq!(surface(&scene.objects[0]).mesh.spheres().len(), count);
        assert!(warnings.len() == 1 && warnings[0].contains("without a radius"), "{warnings:?}");
    }
}

#[test]
fn snapshots_of_one_simulation_are_a_sequence() {
    let Some(folder) = data_path("sph-particles") else { return };
    let pattern = folder.join("double_dam_break_frame_*.vtk");
    let scene = load(&pattern, &mut Reporter::new()).unwrap();
    assert_eq!(scene.frame_count, Some(2));
    let mut evaluator = Evaluator::new(Arc::new(scene), None).unwrap();
    let [before, after] = [0.0, 1.0 / 24.0]
        .map(|time| evaluator.evaluate(time).unwrap().surfaces[0].mesh.spheres().to_vec());
    assert_eq!((before.len(), after.len()), (4732, 4732));
    assert!(before[0].radius == after[0].radius && before[0].center != after[0].center);
}

/// Checks where the camera is, and where it looks, in the first and the last frame: at the second
/// key and the last but one, or at the key that has the time. Directions are the rotation keys
/// applied to -Z by hand.
fn check_camera(scene: Scene, places: [(Vec3, Vec3); 2]) {
    let rate = scene.default_frame_rate();
    let last = scene.frame_count.expect("AFF scenes are finite") - 1;
    let mut evaluator = Evaluator::new(Arc::new(scene), None).expect("the scene hangs together");
    for (frame, (eye, forward)) in [0, last].into_iter().zip(places) {
        let made = evaluator.evaluate(frame as f64 / rate).expect("the scene makes frames");
        let camera = made.cameras[0];
        assert!(Vec3::from(camera.translation).abs_diff_eq(eye, 1e-4), "{frame}: {camera}");
        let found = camera.transform_vector3(Vec3::NEG_Z);
        assert!(found.abs_diff_eq(forward.normalize(), 1e-3), "{frame}: {found}");
    }
}

/// Triangles of objects that do not deform.
fn fixed_triangle_count(scene: &Scene) -> usize {
    let fixed = scene.objects.iter().filter(|object| matches!(object.shape, Shape::Fixed(_)));
    fixed.map(|object| surface(object).mesh.triangles().len()).sum()
}

/// The warnings, without those of textures that did not come with the data and of triangles that
/// have no area.
fn surprises(warnings: &[String]) -> Vec<&str> {
    let known = |warning: &&str| warning.contains("do without it") || warning.contains("no area");
    warnings.iter().map(String::as_str).filter(|warning| !known(warning)).collect()
}

#[test]
fn the_kitchen_of_bart_has_its_polygons_and_its_camera() {
    let Some((scene, warnings)) = load_data("bart/kitchen/kitchen.aff") else { return };
    assert_eq!(surprises(&warnings), [""; 0]);
    assert_eq!(fixed_triangle_count(&scene), 110_561);
    assert_eq!((scene.lights.len(), scene.frame_count), (6, Some(800)));
    assert_eq!(scene.frame_rate, Some(799.0 / 20.0));
    let first = (Vec3::new(3.75, 2.3, 3.6), Vec3::new(-0.313_48, -0.419_83, -0.851_74));
    let last = (Vec3::new(3.274_88, 0.334_545, 2.980_28), Vec3::new(-0.717_36, -0.462_54, 0.521));
    check_camera(scene, [first, last]);
}

#[test]
fn the_robots_of_bart_have_their_polygons_and_their_keys() {
    let Some((scene, warnings)) = load_data("bart/robot/Robot.aff") else { return };
    let [back, idle, resting] = surprises(&warnings)[..] else { panic!("{warnings:#?}") };
    assert!(back.contains("Robot1.aff line 263: 12 keys of \"gun_rot1\" go back"), "{back}");
    assert!(idle.contains("the keys for old_camera move nothing"), "{idle}");
    assert!(resting.contains("no keys for grip_lift1, grip_rot1, gun_lift2"), "{resting}");
    assert_eq!(fixed_triangle_count(&scene), 71_708);
    assert_eq!((scene.frame_count, scene.clips.len()), (Some(800), 1));
    let first = (Vec3::new(-3.5, 2.0, -203.0), Vec3::new(0.058_82, 0.098_72, -0.993_37));
    let last = (Vec3::new(0.0, 80.0, 0.0), Vec3::new(-0.141_45, -0.985_05, 0.098_28));
    check_camera(scene, [first, last]);
}

#[test]
fn the_museum_of_bart_has_its_polygons_cones_and_animated_triangles() {
    let Some((scene, warnings)) = load_data("bart/museum/museum5.aff") else { return };
    assert_eq!(surprises(&warnings), [""; 0]);
    let cone_triangles = 8 * 128;
    assert_eq!(fixed_triangle_count(&scene), 10_284 + cone_triangles);
    let animated = scene.objects.iter().find_map(|object| match &object.shape {
        Shape::Animated(mesh) => Some(mesh),
        _ => None,
    });
    let sculpture = animated.expect("the sculpture moves");
    let keys = sculpture_keys(5).expect("museum5 is generated");
    for key in 2..5 {
        let found = sculpture.at(KEY_TIMES[key] + 1.0).unwrap();
        assert_eq!(found.mesh.vertices().len(), 3 * 1024);
        for (found, expected) in found.mesh.vertices().iter().zip(&keys[key]) {
            assert!(found.abs_diff_eq(*expected, 1e-6), "key {key}: {found} {expected}");
        }
    }
    let first = (Vec3::new(0.0, 1.8, -9.0), Vec3::Z);
    let last =
        (Vec3::new(0.095_173_3, 1.749_33, -5.988_24), Vec3::new(0.190_34, -0.101_34, -0.976_47));
    check_camera(scene, [first, last]);
}
