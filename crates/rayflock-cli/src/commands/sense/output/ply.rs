//! PLY: points in world space, binary, coloured by their ranges.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;

use anyhow::Result;
use ply_rs_bw::ply::{
    Addable, ElementDef, Encoding, Header, PropertyAccess, PropertyDef, PropertyType, ScalarType,
};
use ply_rs_bw::writer::Writer;
use rayflock::render::sensor::Sweep;

use crate::commands::sense::scan::Scan;

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
pub(super) fn write(path: &Path, scan: &Scan<'_>) -> Result<()> {
    let sweep = scan.sweep;
    let mut vertex = ElementDef::new("vertex".to_owned());
    vertex.count = sweep.len();
    for (name, kind) in PROPERTIES {
        let kind = PropertyType::Scalar(kind);
        vertex.properties.add(PropertyDef::new(name.to_owned(), kind));
    }
    let mut header = Header::new();
    header.encoding = Encoding::BinaryLittleEndian;
    header.elements.add(vertex.clone());

    let mut file = BufWriter::new(File::create(path)?);
    let writer = Writer::<Row<'_>>::new();
    writer.write_header(&mut file, &header)?;
    let scale = Scan::color_scale(sweep.range.iter().copied());
    for idx in 0..sweep.len() {
        let color = scale.srgb8(f64::from(sweep.range[idx]));
        let row = Row { point: Some((sweep, idx)), color };
        writer.write_little_endian_element(&mut file, &row, &vertex)?;
    }
    Ok(file.flush()?)
}

/// A point, on its way into the file.
#[derive(Clone, Copy, Debug, Default)]
struct Row<'a> {
    point: Option<(&'a Sweep, usize)>,
    color: [u8; 3],
}

impl PropertyAccess for Row<'_> {
    fn new() -> Self {
        Self::default()
    }

    fn get_float(&self, name: &str) -> Option<f32> {
        let (sweep, idx) = self.point?;
        Some(match name {
            "x" => sweep.position[idx].x,
            "y" => sweep.position[idx].y,
            "z" => sweep.position[idx].z,
            "nx" => sweep.normal[idx].x,
            "ny" => sweep.normal[idx].y,
            "nz" => sweep.normal[idx].z,
            "x_sensor" => sweep.position_in_sensor[idx].x,
            "y_sensor" => sweep.position_in_sensor[idx].y,
            "z_sensor" => sweep.position_in_sensor[idx].z,
            "range" => sweep.range[idx],
            "intensity" => sweep.intensity[idx],
            _ => return None,
        })
    }

    fn get_double(&self, name: &str) -> Option<f64> {
        let (sweep, idx) = self.point?;
        (name == "time").then(|| sweep.time[idx])
    }

    fn get_uint(&self, name: &str) -> Option<u32> {
        let (sweep, idx) = self.point?;
        Some(match name {
            "object" => sweep.object_id[idx],
            "primitive" => sweep.prim_id[idx],
            "row" => sweep.row[idx],
            "column" => sweep.column[idx],
            _ => return None,
        })
    }

    fn get_uchar(&self, name: &str) -> Option<u8> {
        let (sweep, idx) = self.point?;
        Some(match name {
            "red" => self.color[0],
            "green" => self.color[1],
            "blue" => self.color[2],
            "return_number" => sweep.return_number[idx],
            "return_count" => sweep.return_count[idx],
            _ => return None,
        })
    }
}
