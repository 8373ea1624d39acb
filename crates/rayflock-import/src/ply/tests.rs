//! Tests on tiny files.

use glam::{Vec2, Vec3};
use rayflock_geom::Sphere;

use crate::tests::{fixed_mesh, load_bytes};

const ASCII: &str = "ply\nformat ascii 1.0\ncomment by hand\nelement vertex 4\n\
    property float x\nproperty float y\nproperty double z\nelement face 1\n\
    property list uchar int vertex_indices\nend_header\n\
    0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n";

/// A binary file of one triangle with everything a vertex can have.
fn binary(is_big: bool) -> Vec<u8> {
    let order = if is_big { "big" } else { "little" };
    let mut header = format!("ply\nformat binary_{order}_endian 1.0\nelement vertex 3\n");
    for name in ["x", "y", "z", "nx", "ny", "nz"] {
        header += &format!("property float {name}\n");
    }
    for name in ["red", "green", "blue"] {
        header += &format!("property uchar {name}\n");
    }
    header += "property float s\nproperty float t\nelement face 1\n\
        property list ushort uint vertex_index\nelement odd 1\nproperty list uchar float a\nend_header\n";
    let mut bytes = header.into_bytes();
    let float = |value: f32| if is_big { value.to_be_bytes() } else { value.to_le_bytes() };
    for [x, y] in [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]] {
        bytes.extend([x, y, 0.0, 0.0, 0.0, 2.0].into_iter().flat_map(float));
        bytes.extend([255, 0, 255]);
        bytes.extend([x, 0.25].into_iter().flat_map(float));
    }
    bytes.extend(if is_big { 3_u16.to_be_bytes() } else { 3_u16.to_le_bytes() });
    let int = |value: u32| if is_big { value.to_be_bytes() } else { value.to_le_bytes() };
    bytes.extend([0, 1, 2].into_iter().flat_map(int));
    bytes.extend([1]);
    bytes.extend(float(0.5));
    bytes
}

#[test]
fn ascii_polygons_become_fans() {
    let (scene, warnings) = load_bytes("a.ply", ASCII.as_bytes()).unwrap();
    assert_eq!(fixed_mesh(&scene, 0).mesh.triangles(), [[0, 1, 2], [0, 2, 3]]);
    assert!(warnings.is_empty() && scene.materials.len() == 1);
}

#[test]
fn both_byte_orders_carry_all_attributes() {
    for is_big in [false, true] {
        let (scene, warnings) = load_bytes("a.ply", &binary(is_big)).unwrap();
        let mesh = fixed_mesh(&scene, 0);
        assert_eq!(mesh.mesh.corners(0), [Vec3::ZERO, Vec3::X, Vec3::Y]);
        assert_eq!(*mesh.normals, [Vec3::Z; 3]);
        assert_eq!(mesh.attributes.colors, [Vec3::new(1.0, 0.0, 1.0); 3]);
        assert_eq!(mesh.attributes.uvs[1], Vec2::new(1.0, 0.75));
        assert!(warnings.is_empty(), "{warnings:?}");
    }
}

#[test]
fn strips_end_at_minus_one() {
    let text = ASCII
        .replace("element face 1", "element tristrips 1")
        .replace("\n4 0 1 2 3\n", "\n8 0 1 2 3 -1 2 1 0\n");
    let (scene, _) = load_bytes("a.ply", text.as_bytes()).unwrap();
    assert_eq!(fixed_mesh(&scene, 0).mesh.triangles(), [[0, 1, 2], [1, 3, 2], [2, 1, 0]]);
}

#[test]
fn points_are_spheres_with_a_radius_of_their_own_or_a_usual_one() {
    let points = |property: &str, rows: &str| {
        format!(
            "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\n\
             property float z\n{property}end_header\n{rows}"
        )
    };
    let text = points("property float radius\n", "0 0 0 1\n4 0 0 0\n");
    let (scene, warnings) = load_bytes("a.ply", text.as_bytes()).unwrap();
    assert_eq!(fixed_mesh(&scene, 0).mesh.spheres().len(), 2);
    assert!(warnings[0].contains("1 spheres"), "{warnings:?}");
    let text = points("", "0 0 0\n4 0 0\n");
    let (scene, warnings) = load_bytes("a.ply", text.as_bytes()).unwrap();
    assert_eq!(fixed_mesh(&scene, 0).mesh.spheres()[1], Sphere::new(4.0 * Vec3::X, 2.0));
    assert!(warnings[0].contains("without a radius are shown with 2"), "{warnings:?}");
}

#[test]
fn a_header_that_claims_too_much_is_refused() {
    for claim in ["element vertex 1000000000000", "element vertex 18446744073709551615"] {
        let text = ASCII.replace("element vertex 4", claim);
        let message = load_bytes("a.ply", text.as_bytes()).unwrap_err().to_string();
        assert!(message.contains("vertex") && message.contains("after the header"), "{message}");
    }
    let bare = "ply\nformat ascii 1.0\nelement vertex 1000000000000\nend_header\n";
    let message = load_bytes("a.ply", bare.as_bytes()).unwrap_err().to_string();
    assert!(message.contains("at least one property"), "{message}");
}

#[test]
fn damage_is_an_error_with_its_place() {
    let cases = [
        (ASCII.replace("4 0 1 2 3", "4 0 1 2 4"), "face 0: found vertex 4"),
        (ASCII.replace("4 0 1 2 3", "3 0 1 -2"), "face 0: found vertex -2"),
        (ASCII.replace("4 0 1 2 3", "4 0 1 2"), "line 15"),
        (ASCII.replace("1 0 0", "1 zero 0"), "line 12"),
        (ASCII.replace("property float y", "property float q"), "no x, y and z"),
        (ASCII.replace("end_header\n", ""), "header"),
        (ASCII.replace("ply", "pl"), "header"),
        (ASCII.replace("uchar int", "uchar float"), "face"),
        (String::new(), "header"),
    ];
    for (text, expected) in cases {
        let message = load_bytes("a.ply", text.as_bytes()).unwrap_err().to_string();
        assert!(message.contains(expected), "{expected}: {message}");
    }
    let whole = binary(false);
    assert!(load_bytes("a.ply", &whole[..whole.len() - 3]).is_err());
    let mut tail = whole;
    tail.extend(b"tail");
    assert_eq!(load_bytes("a.ply", &tail).unwrap().1.len(), 1);
}
