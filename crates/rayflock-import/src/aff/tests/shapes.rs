//! Shapes and the blocks that they stand in.

use std::sync::Arc;

use glam::{Vec2, Vec3};
use rayflock_scene::{Evaluator, MaterialIdx, PrimMaterials, Scene};

use super::{load, load_with_warnings, message};
use crate::tests::fixed_mesh;

/// The corners of triangle `triangle_idx` of an object.
fn corners(scene: &Scene, object_idx: usize, triangle_idx: usize) -> [Vec3; 3] {
    fixed_mesh(scene, object_idx).mesh.corners(triangle_idx)
}

#[test]
fn polygons_become_triangles_with_the_material_in_force() {
    let scene = load(
        "f 1 0 0 1 0 1 0 0\np 4 0 0 0  1 0 0  1 1 0  0 1 0\nf 0 1 0 1 0 1 0 0 p 3\n0 0 5\n1 0 5\n\
         0 1 5 # end\nf 1 0 0 1 0 1 0 0 p 3 0 0 6 1 0 6 0 1 6",
    );
    let mesh = fixed_mesh(&scene, 0);
    assert_eq!(mesh.mesh.triangles(), [[0, 1, 2], [0, 2, 3], [4, 5, 6], [7, 8, 9]]);
    assert_eq!(
        corners(&scene, 0, 2),
        [5.0 * Vec3::Z, Vec3::new(1.0, 0.0, 5.0), Vec3::new(0.0, 1.0, 5.0)]
    );
    assert!(mesh.normals.is_empty() && mesh.attributes.uvs.is_empty());
    let expected = [0, 0, 1, 0].map(MaterialIdx).to_vec();
    assert_eq!(mesh.attributes.materials, PrimMaterials::PerPrim(expected));
    assert_eq!((scene.materials.len(), scene.objects.len()), (2, 1));
    assert_eq!(scene.objects[0].name, "a");
    assert_eq!(scene.materials[1].name, "a line 3");
}

#[test]
fn concave_polygons_are_cut_along_their_inside() {
    let scene = load("p 5  0 0 0  4 0 0  4 4 0  3 1 0  0 1 0");
    let mesh = &fixed_mesh(&scene, 0).mesh;
    let area = |idx| {
        let [a, b, c] = mesh.corners(idx);
        0.5 * (b - a).cross(c - a).z
    };
    let areas: Vec<f32> = (0..mesh.triangles().len()).map(area).collect();
    assert!(areas.iter().all(|&area| area > 0.0), "{areas:?}");
    assert!((areas.iter().sum::<f32>() - 5.5).abs() < 1e-6, "{areas:?}");
}

#[test]
fn patches_have_normals_and_are_objects_of_their_own() {
    let scene = load("pp 3  0 0 0 0 0 2  1 0 0 0 0 1  0 1 0 0 1 1\np 3 0 0 0 1 0 0 0 1 0");
    assert_eq!(scene.objects.len(), 2);
    let normals = &fixed_mesh(&scene, 1).normals;
    let expected = [Vec3::Z, Vec3::Z, Vec3::new(0.0, 1.0, 1.0).normalize()];
    for (normal, expected) in normals.iter().zip(expected) {
        assert!(normal.abs_diff_eq(expected, 1e-6), "{normal}");
    }
    assert!(fixed_mesh(&scene, 0).normals.is_empty());
}

#[test]
fn meshes_join_equal_corners_and_leave_out_the_rest() {
    let (scene, warnings) = load_with_warnings(
        "m\nvertices 5\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n9 9 9\nnormals 2\n0 0 1 0 0.6 0.8\n\
         texturecoords 2 gone.ppm\n0 0\n1 0.5\ntriangles 2\n0 1 2  0 0 0  0 1 1\n\
         0 2 3  0 0 1  0 1 0\n",
    );
    assert!(warnings.len() == 1 && warnings[0].contains("gone.ppm"), "{warnings:?}");
    let mesh = fixed_mesh(&scene, 0);
    assert_eq!(mesh.mesh.triangles(), [[0, 1, 2], [0, 2, 3]]);
    assert_eq!(mesh.mesh.vertices(), [Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1.0, 0.0), Vec3::Y]);
    assert!(mesh.normals[3].abs_diff_eq(Vec3::new(0.0, 0.6, 0.8), 1e-6));
    let corner = Vec2::new(1.0, 0.5);
    assert_eq!(mesh.attributes.uvs, [Vec2::ZERO, corner, corner, Vec2::ZERO]);

    let flat = load("m vertices 3 0 0 0 1 0 0 0 1 0 triangles 1 0 1 2");
    assert!(fixed_mesh(&flat, 0).normals.is_empty());
}

#[test]
fn textured_triangles_have_texture_coordinates() {
    let (scene, warnings) = load_with_warnings(
        "tt gone.ppm 0 0 0 0 1  1 0 0 1 1  0 1 0 0 0\n\
         ttp gone.ppm 0 0 0 0 0 1 0 1  1 0 0 0 0 1 1 1  0 1 0 0 0 1 0 0",
    );
    assert_eq!(warnings.len(), 1, "{warnings:?}");
    assert!(warnings[0].contains("gone.ppm"));
    for object_idx in [0, 1] {
        let mesh = fixed_mesh(&scene, object_idx);
        assert_eq!(mesh.attributes.uvs, [Vec2::Y, Vec2::ONE, Vec2::ZERO]);
        assert_eq!(mesh.normals.len(), 3 * object_idx);
    }
}

#[test]
fn blocks_place_what_is_inside() {
    let triangle = "p 3 0 0 0 1 0 0 0 1 0";
    let scene = load(&format!(
        "xs 2 2 2  0 0 1 90  5 0 0 {{ xs 1 1 1 0 0 0 0 0 1 0 {{ {triangle} }} }} {triangle}"
    ));
    // Scaled, then turned, then moved: X goes to 2 Y.
    let inside = corners(&scene, 0, 0);
    let expected = [Vec3::new(3.0, 0.0, 0.0), Vec3::new(3.0, 2.0, 0.0), Vec3::new(1.0, 0.0, 0.0)];
    for (corner, expected) in inside.into_iter().zip(expected) {
        assert!(corner.abs_diff_eq(expected, 1e-5), "{inside:?}");
    }
    assert_eq!(corners(&scene, 0, 1), [Vec3::ZERO, Vec3::X, Vec3::Y]);
    assert!(scene.nodes.is_empty() && scene.objects[0].node.is_none());
}

#[test]
fn mirrored_and_stretched_surfaces_keep_their_outside() {
    let scene = load("xs -1 4 1 0 0 1 0 0 0 0 { pp 3  0 0 0 1 1 0  0 0 1 1 1 0  1 -1 0 1 1 0 }");
    let [a, b, c] = corners(&scene, 0, 0);
    let normal = fixed_mesh(&scene, 0).normals[0];
    assert!(normal.abs_diff_eq(Vec3::new(-4.0, 1.0, 0.0).normalize(), 1e-6), "{normal}");
    let facing = (b - a).cross(c - a).normalize();
    assert!(facing.abs_diff_eq(normal, 1e-6), "{facing} {normal}");
}

#[test]
fn spheres_stay_spheres_unless_they_are_stretched() {
    let scene = load("xs 2 2 2 0 1 0 30 0 1 0 { s 1 0 0 0.5 } s 0 0 0 -3");
    let spheres = fixed_mesh(&scene, 0).mesh.spheres().to_vec();
    assert!((spheres[0].radius - 1.0).abs() < 1e-6 && spheres[1].radius == 3.0);
    assert!((spheres[0].center.y - 1.0).abs() < 1e-6);

    let (scene, warnings) = load_with_warnings("xs 1 2 1 0 1 0 0 0 0 0 { s 0 0 0 1 }");
    assert!(warnings.len() == 1 && warnings[0].contains("1 are stretched"), "{warnings:?}");
    let bounds = fixed_mesh(&scene, 0).mesh.bounds();
    assert!(bounds.max.abs_diff_eq(Vec3::new(1.0, 2.0, 1.0), 1e-6), "{bounds:?}");

    let keys = |scale: &str| {
        let key = |time: u32| format!("{time} {scale} 0 0 0 ");
        let keys: String = (0..4).map(key).collect();
        format!("a 0 1 2 x ball {{ s 0 0 0 1 }} k ball {{ scale 4 {keys} }}")
    };
    let scene = load(&keys("3 3 3"));
    let frame = Evaluator::new(Arc::new(scene), None).unwrap().evaluate(0.0).cloned().unwrap();
    assert_eq!(frame.geometry.bounds().max, Vec3::splat(3.0));
    let (scene, warnings) = load_with_warnings(&keys("3 3 1"));
    assert!(warnings.len() == 1 && warnings[0].contains("stretched by keys"), "{warnings:?}");
    assert!(Evaluator::new(Arc::new(scene), None).unwrap().evaluate(0.0).is_ok());
}

#[test]
fn cones_are_smooth_tubes() {
    let (scene, warnings) = load_with_warnings("c 0 0 0 1  0 2 0 0.5\nc 0 0 0 1 0 0 0 1");
    let mesh = fixed_mesh(&scene, 0);
    assert_eq!((mesh.mesh.triangles().len(), mesh.normals.len()), (128, 128));
    assert_eq!(mesh.mesh.bounds().max.y, 2.0);
    assert!(warnings.len() == 1 && warnings[0].contains("1 have no length"), "{warnings:?}");
}

#[test]
fn wrong_shapes_name_their_line() {
    let cases = [
        (
            "p 3\n0 0 0\n1 0 x\n0 1 0\n",
            "line 3: found \"x\", expected a finite number for \"p\" of line 1",
        ),
        ("p 3 0 0 0 1 0 0 0 1   ", "found the end of the file, expected a finite number for \"p\""),
        ("p 3 0 0 0 1 0 0 0 1 nan", "line 1: found \"nan\", expected a finite number"),
        ("s 0 0 0 1e39", "found \"1e39\", expected a finite number"),
        ("p -3", "found \"-3\", expected a number of corners"),
        ("pp 4000000000 0 0 0", "found 4000000000 corners, expected at most 0, for which there"),
        ("m\nvertices 99 0 0 0", "line 2: found 99 vertices, expected at most 1"),
        ("m\nvertices 18446744073709551615 0", "found 18446744073709551615 vertices"),
        ("m vertices 1 0 0 0 edges 3", "found \"edges\", expected \"normals\", "),
        ("m triangles", "found \"triangles\", expected \"vertices\""),
        (
            "m vertices 1 0 0 0\ntriangles 1 0 0 1",
            "line 2: found \"1\", expected the number of one of 1 vertices, counted from 0",
        ),
        (
            "m vertices 1 0 0 0 normals 0 triangles 1 0 0 0 0 0 0",
            "expected the number of one of 0 normals",
        ),
        ("tt {", "found \"{\", expected the name of a texture"),
        ("tpa 0", "found 0 keys, expected at least one key"),
    ];
    for (text, expected) in cases {
        let message = message(text);
        assert!(message.contains(expected), "{text:?}: {message}");
    }
}
