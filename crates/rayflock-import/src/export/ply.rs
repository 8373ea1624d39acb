//! PLY files, binary.

use std::io::{self, Write};

use ply_rs_bw::ply::{
    Addable, ElementDef, Encoding, Header, PropertyAccess, PropertyDef, PropertyType, ScalarType,
};
use ply_rs_bw::writer::Writer;
use rayflock_geom::Sphere;

use super::FrameMesh;

/// Writes the triangles of a frame as a binary PLY file; or its spheres as points with a radius,
/// where there are no triangles: PLY readers take all points for vertices.
///
/// # Errors
/// When `out` cannot be written to.
pub fn write_ply(frame: &FrameMesh, out: &mut impl Write) -> io::Result<()> {
    let has_spheres = frame.triangles.is_empty() && !frame.spheres.is_empty();
    let vertices: Vec<VertexRow> = match has_spheres {
        true => frame.spheres.iter().map(|&sphere| VertexRow(sphere)).collect(),
        false => frame.vertices.iter().map(|&v| VertexRow(Sphere::new(v, 0.0))).collect(),
    };
    let faces: Vec<FaceRow> = frame.triangles.iter().map(|&corners| FaceRow::of(corners)).collect();

    let mut header = Header::new();
    header.encoding = Encoding::BinaryLittleEndian;
    let mut vertex = ElementDef::new("vertex".to_owned());
    vertex.count = vertices.len();
    let names: &[&str] = if has_spheres { &["x", "y", "z", "radius"] } else { &["x", "y", "z"] };
    for name in names {
        let float = PropertyType::Scalar(ScalarType::Float);
        vertex.properties.add(PropertyDef::new((*name).to_owned(), float));
    }
    header.elements.add(vertex.clone());
    let mut face = ElementDef::new("face".to_owned());
    face.count = faces.len();
    let list = PropertyType::List(ScalarType::UChar, ScalarType::Int);
    face.properties.add(PropertyDef::new("vertex_indices".to_owned(), list));
    if !has_spheres {
        header.elements.add(face.clone());
    }

    Writer::<VertexRow>::new().write_header(out, &header)?;
    Writer::new().write_payload_of_element(out, &vertices, &vertex, &header)?;
    Writer::new().write_payload_of_element(out, &faces, &face, &header)?;
    out.flush()
}

/// A vertex, or a sphere.
struct VertexRow(Sphere);

impl PropertyAccess for VertexRow {
    fn new() -> Self {
        Self(Sphere::default())
    }

    fn get_float(&self, name: &str) -> Option<f32> {
        match name {
            "x" => Some(self.0.center.x),
            "y" => Some(self.0.center.y),
            "z" => Some(self.0.center.z),
            "radius" => Some(self.0.radius),
            _ => None,
        }
    }
}

/// A triangle.
#[derive(Default)]
struct FaceRow {
    /// Most readers want signed numbers.
    corners: [i32; 3],
}

impl FaceRow {
    fn of(corners: [u32; 3]) -> Self {
        Self { corners: corners.map(u32::cast_signed) }
    }
}

impl PropertyAccess for FaceRow {
    fn new() -> Self {
        Self::default()
    }

    fn get_list_int(&self, _: &str) -> Option<&[i32]> {
        Some(&self.corners)
    }
}
