//! PLY: points in world space, binary, coloured.

use std::io::Write;

use ply_rs_bw::ply::{
    Addable, ElementDef, Encoding, Header, PropertyAccess, PropertyDef, PropertyType, ScalarType,
};
use ply_rs_bw::writer::Writer;

use super::{PointColumns, PointFileError};

/// The properties of a vertex.
const PROPERTIES: [(&str, ScalarType); 21] = [
    ("x", ScalarType::Float),
    ("y", ScalarType::Float),
    ("z", ScalarType::Float),
    ("nx", ScalarType::Float),
    ("ny", ScalarType::Float),
    ("nz", ScalarType::Float),
    ("red", ScalarType::UChar),
    ("green", ScalarType::UChar),
    ("blue", ScalarType::UChar),
    ("x_sensor", ScalarType::Float),
    ("y_sensor", ScalarType::Float),
    ("z_sensor", ScalarType::Float),
    ("range", ScalarType::Float),
    ("intensity", ScalarType::Float),
    ("time", ScalarType::Double),
    ("object", ScalarType::UInt),
    ("primitive", ScalarType::UInt),
    ("row", ScalarType::UInt),
    ("column", ScalarType::UInt),
    ("return_number", ScalarType::UChar),
    ("return_count", ScalarType::UChar),
];

/// Writes all points.
pub(super) fn write(points: &PointColumns<'_>, out: &mut impl Write) -> Result<(), PointFileError> {
    let mut vertex = ElementDef::new("vertex".to_owned());
    vertex.count = points.len();
    for (name, kind) in PROPERTIES {
        let kind = PropertyType::Scalar(kind);
        vertex.properties.add(PropertyDef::new(name.to_owned(), kind));
    }
    let mut header = Header::new();
    header.encoding = Encoding::BinaryLittleEndian;
    header.elements.add(vertex.clone());

    let writer = Writer::<Row<'_>>::new();
    writer.write_header(out, &header)?;
    for idx in 0..points.len() {
        writer.write_little_endian_element(out, &Row(Some((points, idx))), &vertex)?;
    }
    Ok(())
}

/// A point, on its way into the file.
#[derive(Clone, Copy, Debug, Default)]
struct Row<'a>(Option<(&'a PointColumns<'a>, usize)>);

impl PropertyAccess for Row<'_> {
    fn new() -> Self {
        Self::default()
    }

    fn get_float(&self, name: &str) -> Option<f32> {
        let (points, idx) = self.0?;
        Some(match name {
            "x" => points.position[idx].x,
            "y" => points.position[idx].y,
            "z" => points.position[idx].z,
            "nx" => points.normal[idx].x,
            "ny" => points.normal[idx].y,
            "nz" => points.normal[idx].z,
            "x_sensor" => points.position_in_sensor[idx].x,
            "y_sensor" => points.position_in_sensor[idx].y,
            "z_sensor" => points.position_in_sensor[idx].z,
            "range" => points.range[idx],
            "intensity" => points.intensity[idx],
            _ => return None,
        })
    }

    fn get_double(&self, name: &str) -> Option<f64> {
        let (points, idx) = self.0?;
        (name == "time").then(|| points.time[idx])
    }

    fn get_uint(&self, name: &str) -> Option<u32> {
        let (points, idx) = self.0?;
        Some(match name {
            "object" => points.object_id[idx],
            "primitive" => points.prim_id[idx],
            "row" => points.row[idx],
            "column" => points.column[idx],
            _ => return None,
        })
    }

    fn get_uchar(&self, name: &str) -> Option<u8> {
        let (points, idx) = self.0?;
        Some(match name {
            "red" => points.color[idx][0],
            "green" => points.color[idx][1],
            "blue" => points.color[idx][2],
            "return_number" => points.return_number[idx],
            "return_count" => points.return_count[idx],
            _ => return None,
        })
    }
}
