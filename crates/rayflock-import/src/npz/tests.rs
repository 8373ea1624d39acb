//! Tests on tiny files.

use std::io::{Cursor, Write};
use std::sync::Arc;

use glam::Vec3;
use ndarray::{Array, Array1, Array2, Array3, arr0, arr1, arr2};
use ndarray_npy::{NpzWriter, WritableElement};
use rayflock_geom::Sphere;
use rayflock_scene::{Evaluator, MotionKind, Scene};

use crate::tests::{fixed_mesh, load_bytes};

type Writer = NpzWriter<Cursor<Vec<u8>>>;

/// A file of arrays.
fn npz(add: impl FnOnce(&mut Writer)) -> Vec<u8> {
    let mut writer = NpzWriter::new(Cursor::new(Vec::new()));
    add(&mut writer);
    writer.finish().unwrap().into_inner()
}

fn load(add: impl FnOnce(&mut Writer)) -> (Scene, Vec<String>) {
    load_bytes("a.npz", &npz(add)).unwrap()
}

fn message(add: impl FnOnce(&mut Writer)) -> String {
    load_bytes("a.npz", &npz(add)).unwrap_err().to_string()
}

fn add<T: WritableElement, D: ndarray::Dimension>(
    writer: &mut Writer,
    name: &str,
    array: &Array<T, D>,
) {
    writer.add_array(name, array).unwrap();
}

/// Two frames of three vertices; the first coordinate of the second vertex is 1, then 2.
fn two_frames() -> Array3<f32> {
    let frame = |x| [0.0, 0.0, 0.0, x, 0.0, 0.0, 0.0, 1.0, 0.0];
    Array3::from_shape_vec((2, 3, 3), [frame(1.0), frame(2.0)].concat()).unwrap()
}

fn triangle() -> Array2<i32> {
    arr2(&[[0, 1, 2]])
}

#[test]
fn one_frame_is_at_rest_in_any_type_of_numbers() {
    let vertices = two_frames().index_axis_move(ndarray::Axis(0), 1);
    let check = |(scene, warnings): (Scene, Vec<String>)| {
        let mesh = &fixed_mesh(&scene, 0).mesh;
        assert_eq!(mesh.corners(0), [Vec3::ZERO, 2.0 * Vec3::X, Vec3::Y]);
        assert!(scene.frame_count.is_none() && warnings.is_empty(), "{warnings:?}");
    };
    check(load(|file| {
        add(file, "vertices", &vertices);
        add(file, "triangles", &triangle());
    }));
    check(load(|file| {
        add(file, "vertices", &vertices.mapv(f64::from));
        add(file, "triangles", &triangle().mapv(i64::from));
        add(file, "temperature", &arr1(&[1_i16, 2]));
        add(file, "radii", &arr1(&["no centers".len() as i16]));
    }));
    check(load(|file| {
        // Columns first, as Fortran has them.
        let by_columns = vertices.t().as_standard_layout().into_owned().reversed_axes();
        add(file, "vertices", &by_columns);
        add(file, "triangles", &triangle().mapv(|idx| idx as u32));
    }));
    check(load(|file| {
        add(file, "vertices", &vertices);
        add(file, "triangles", &triangle().mapv(|idx| idx as u64));
    }));
}

#[test]
fn frames_of_one_topology_deform() {
    let (scene, _) = load(|file| {
        add(file, "vertices", &two_frames());
        add(file, "triangles", &triangle());
        add(file, "frame_rate", &arr0(10.0));
    });
    assert_eq!((scene.frame_count, scene.frame_rate), (Some(2), Some(10.0)));
    let mut evaluator = Evaluator::new(Arc::new(scene), None).unwrap();
    assert_eq!(evaluator.motion_kinds(), [MotionKind::Deforming]);
    let first = Arc::clone(&evaluator.evaluate(0.0).unwrap().surfaces[0].mesh);
    let second = Arc::clone(&evaluator.evaluate(0.1).unwrap().surfaces[0].mesh);
    assert_eq!((first.vertices()[1].x, second.vertices()[1].x), (1.0, 2.0));
    assert!(second.has_topology_of(&first));
}

#[test]
fn offsets_cut_frames_of_different_length() {
    let (scene, _) = load(|file| {
        let vertices = two_frames().into_shape_with_order((6, 3)).unwrap();
        add(file, "vertices", &vertices);
        add(file, "vertex_offsets", &arr1(&[0_i64, 0, 4, 6]));
        add(file, "triangles", &arr2(&[[0_u32, 1, 2], [3, 2, 1], [0, 1, 0]]));
        add(file, "triangle_offsets", &arr1(&[0_i32, 0, 2, 3]));
    });
    assert_eq!(scene.frame_count, Some(3));
    let mut evaluator = Evaluator::new(Arc::new(scene), None).unwrap();
    assert_eq!(evaluator.motion_kinds(), [MotionKind::Topology]);
    let mut frame = |idx: u32| {
        let frame = evaluator.evaluate(f64::from(idx) / 24.0).unwrap();
        let mesh = &frame.surfaces[0].mesh;
        (mesh.vertices().len(), mesh.triangles().to_vec())
    };
    assert_eq!(frame(0), (0, vec![]));
    assert_eq!(frame(1), (4, vec![[0, 1, 2], [3, 2, 1]]));
    assert_eq!(frame(2), (2, vec![[0, 1, 0]]));
}

#[test]
fn centers_are_spheres() {
    let spheres = |add_radii: &dyn Fn(&mut Writer)| {
        let (scene, warnings) = load(|file| {
            add(file, "centers", &two_frames());
            add_radii(file);
        });
        let mut evaluator = Evaluator::new(Arc::new(scene), None).unwrap();
        let mut last = |frame: u32| {
            let frame = evaluator.evaluate(f64::from(frame) / 24.0).unwrap();
            frame.surfaces[0].mesh.spheres()[2]
        };
        (last(0), last(1), warnings)
    };
    let (y, radius) = (Vec3::Y, |radius| Sphere::new(Vec3::Y, radius));
    let (a, b, _) = spheres(&|file| add(file, "radii", &arr0(0.25_f32)));
    assert_eq!((a, b), (radius(0.25), radius(0.25)));
    let (a, b, _) = spheres(&|file| add(file, "radii", &arr1(&[1.0, 2.0, 3.0])));
    assert_eq!((a, b), (radius(3.0), radius(3.0)));
    let (a, b, _) = spheres(&|file| add(file, "radii", &arr2(&[[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]])));
    assert_eq!((a, b), (radius(3.0), radius(6.0)));
    let (a, b, warnings) = spheres(&|_| {});
    assert_eq!((a, b), (Sphere::new(y, 0.5), Sphere::new(y, 0.5)));
    assert!(warnings.len() == 1 && warnings[0].contains("shown with 0.5"), "{warnings:?}");
}

#[test]
fn a_rate_that_is_none_is_told() {
    for (rate, expected) in [(0.0, "0 is no rate"), (f64::NAN, "NaN is no rate")] {
        let (scene, warnings) = load(|file| {
            add(file, "centers", &two_frames());
            add(file, "radii", &arr0(1.0_f32));
            add(file, "frame_rate", &arr0(rate));
        });
        assert!(scene.frame_rate.is_none() && warnings[0].contains(expected), "{warnings:?}");
    }
    let (scene, _) = load(|file| {
        add(file, "centers", &two_frames());
        add(file, "radii", &arr0(1.0_f32));
        add(file, "frame_rate", &arr0(30_i64));
    });
    assert_eq!(scene.frame_rate, Some(30.0));
}

/// The error of a file with a triangle and what `edit` adds.
fn message_with(edit: &dyn Fn(&mut Writer)) -> String {
    message(|file| {
        add(file, "triangles", &triangle());
        edit(file);
    })
}

fn check(cases: &[(String, &str)]) {
    for (message, expected) in cases {
        assert!(message.contains("a.npz") && message.contains(expected), "{expected}: {message}");
    }
}

#[test]
fn arrays_of_other_shapes_and_types_are_errors() {
    let cases = [
        (message(|file| add(file, "elevation", &arr0(1_i16))), "found the arrays elevation"),
        (
            message_with(&|_| {}),
            "found the arrays triangles, expected vertices and triangles, or centers",
        ),
        (
            message_with(&|file| add(file, "vertices", &arr2(&[[0.0, 1.0]]))),
            "array \"vertices\": found the shape (1, 2), expected (frames, rows, 3) or (rows, 3)",
        ),
        (
            message_with(&|file| add(file, "vertices", &Array3::<f32>::zeros((0, 3, 3)))),
            "found the shape (0, 3, 3)",
        ),
        (
            message_with(&|file| add(file, "vertices", &arr2(&[[0_i16, 0, 0]]))),
            "found the type \"<i2\", expected float32 or float64",
        ),
        (
            message_with(&|file| add(file, "vertices", &arr2(&[[0.0, 0.0, 0.0]]))),
            "array \"triangles\": found vertex 2 in frame 0, expected less than 1",
        ),
        (
            message(|file| {
                add(file, "vertices", &two_frames());
                add(file, "triangles", &arr2(&[[0, 1, -1]]));
            }),
            "a negative or too large number in frame 0",
        ),
    ];
    check(&cases);
}

#[test]
fn frames_that_do_not_belong_together_are_errors() {
    let vertices = || two_frames().into_shape_with_order((6, 3)).unwrap();
    let cases = [
        (
            message_with(&|file| {
                add(file, "vertices", &vertices());
                add(file, "vertex_offsets", &arr1(&[0_i64, 4, 3, 6]));
            }),
            "array \"vertex_offsets\": found 3 after 4, expected rising from 0 to 6",
        ),
        (
            message_with(&|file| {
                add(file, "vertices", &vertices());
                add(file, "vertex_offsets", &arr1(&[0_i64, 3, 7]));
            }),
            "found 0 to 7 in the shape (3,), expected rising from 0 to 6",
        ),
        (
            message_with(&|file| {
                add(file, "vertices", &two_frames());
                add(file, "centers", &Array3::<f32>::zeros((3, 1, 3)));
            }),
            "found 2 frames of vertices, 3 of centers, expected as many of each",
        ),
        (
            message(|file| {
                add(file, "centers", &two_frames());
                add(file, "radii", &Array1::<f32>::zeros(4));
            }),
            "array \"radii\": found the shape (4,)",
        ),
    ];
    check(&cases);
}

/// A zip file with this one array as it is.
fn zipped(array: &[u8]) -> Vec<u8> {
    let mut zip = zip::ZipWriter::new(Cursor::new(Vec::new()));
    zip.start_file("vertices.npy", zip::write::SimpleFileOptions::default()).unwrap();
    zip.write_all(array).unwrap();
    zip.finish().unwrap().into_inner()
}

fn npy(text: &str) -> Vec<u8> {
    let length = (text.len() as u16).to_le_bytes();
    [b"\x93NUMPY\x01\0", &length[..], text.as_bytes()].concat()
}

#[test]
fn files_that_claim_too_much_are_refused() {
    let claim =
        |shape: &str| format!("{{'descr': '<f4', 'fortran_order': False, 'shape': {shape}, }}\n");
    let cases = [
        (b"PK".to_vec(), "zip: found"),
        (zipped(b"hello"), "array \"vertices\": found no NumPy array"),
        (zipped(b"\x93NUMPY\x09\0\0\0\0\0"), "an unknown version"),
        (zipped(&npy(&" ".repeat(9000))), "a description of 9000 bytes"),
        (zipped(&npy(&"(".repeat(4000))), "a description with 4000 brackets"),
        (zipped(&npy("{'shape': (3,), {{{")), "a description with brackets 4 deep"),
        (zipped(&npy(&claim("(4000000000000, 3)"))), "array \"vertices\": found"),
        (zipped(&npy(&claim("(18446744073709551615, 3, 9999)"))), "array \"vertices\": found"),
        (zipped(&npy(&claim("(4000000000000, 0, 3)"))), "4000000000000 frames without rows"),
        (zipped(&npy(&claim("(0, 4000000000000, 4000000000000)"))), "the shape (0, 4000"),
        (zipped(&npy(&claim("3"))), "found the description"),
        (zipped(&npy("{}\n")), "array \"vertices\": found"),
    ];
    for (bytes, expected) in cases {
        let message = load_bytes("a.npz", &bytes).unwrap_err().to_string();
        assert!(message.contains("a.npz") && message.contains(expected), "{expected}: {message}");
    }
}
