//! PLY: the mesh with hours and colours, binary.
//!
//! The element that has the samples, `face` or `vertex`, has the properties `sun_hours` (float)
//! and `red`, `green`, `blue` (uchar, sRGB).

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;

use anyhow::Result;
use ply_rs_bw::ply::{
    Addable, ElementDef, Encoding, Header, PropertyAccess, PropertyDef, PropertyType, ScalarType,
};
use ply_rs_bw::writer::Writer;
use rayflock::render::sun::Sampling;

use crate::commands::sun::hours::SunHours;

/// Writes the mesh in its first frame.
pub(super) fn write(path: &Path, hours: &SunHours<'_>) -> Result<()> {
    let mut file = BufWriter::new(File::create(path)?);
    let header = header(hours);
    Writer::<Row>::new().write_header(&mut file, &header)?;

    let scale = hours.color_scale();
    let reading = |sampling: Sampling, idx: usize| {
        let hours = (hours.sampling == sampling).then(|| hours.hours[idx])?;
        Some(Reading { hours: hours as f32, color: scale.srgb8(hours) })
    };
    let vertices = hours.mesh.vertices().iter().enumerate().map(|(idx, position)| Row {
        position: position.to_array(),
        reading: reading(Sampling::Vertices, idx),
        ..Row::default()
    });
    write_rows(&mut file, &header, "vertex", vertices)?;
    let faces = hours.mesh.triangles().iter().enumerate().map(|(idx, corners)| Row {
        corners: *corners,
        reading: reading(Sampling::Faces, idx),
        ..Row::default()
    });
    write_rows(&mut file, &header, "face", faces)?;
    Ok(file.flush()?)
}

/// A row of either element; only what the header announces is written.
#[derive(Clone, Copy, Debug, Default)]
struct Row {
    position: [f32; 3],
    corners: [u32; 3],
    reading: Option<Reading>,
}

/// What a sample tells.
#[derive(Clone, Copy, Debug)]
struct Reading {
    hours: f32,
    color: [u8; 3],
}

impl PropertyAccess for Row {
    fn new() -> Self {
        Self::default()
    }

    fn get_float(&self, name: &str) -> Option<f32> {
        match name {
            "x" => Some(self.position[0]),
            "y" => Some(self.position[1]),
            "z" => Some(self.position[2]),
            "sun_hours" => self.reading.map(|reading| reading.hours),
            _ => None,
        }
    }

    fn get_uchar(&self, name: &str) -> Option<u8> {
        let channel = ["red", "green", "blue"].iter().position(|channel| *channel == name)?;
        self.reading.map(|reading| reading.color[channel])
    }

    fn get_list_uint(&self, name: &str) -> Option<&[u32]> {
        (name == "vertex_indices").then_some(&self.corners[..])
    }
}

fn header(hours: &SunHours<'_>) -> Header {
    let mut header = Header::new();
    header.encoding = Encoding::BinaryLittleEndian;
    header.comments.push(format!("sun_hours in {}", hours.unit()));
    let float = PropertyType::Scalar(ScalarType::Float);
    let list = PropertyType::List(ScalarType::UChar, ScalarType::UInt);

    let (vertex_count, face_count) = (hours.mesh.vertices().len(), hours.mesh.triangles().len());
    let positions = ["x", "y", "z"].map(|name| (name, float.clone()));
    let mut vertex = element("vertex", vertex_count, &positions);
    let mut face = element("face", face_count, &[("vertex_indices", list)]);
    let color = PropertyType::Scalar(ScalarType::UChar);
    let told = match hours.sampling {
        Sampling::Vertices => &mut vertex,
        Sampling::Faces => &mut face,
    };
    told.properties.add(PropertyDef::new("sun_hours".to_owned(), float));
    for name in ["red", "green", "blue"] {
        told.properties.add(PropertyDef::new(name.to_owned(), color.clone()));
    }
    header.elements.add(vertex);
    header.elements.add(face);
    header
}

fn element(name: &str, count: usize, properties: &[(&str, PropertyType)]) -> ElementDef {
    let mut element = ElementDef::new(name.to_owned());
    element.count = count;
    for (name, property_type) in properties {
        element.properties.add(PropertyDef::new((*name).to_owned(), property_type.clone()));
    }
    element
}

fn write_rows(
    file: &mut impl Write,
    header: &Header,
    name: &str,
    mut rows: impl Iterator<Item = Row>,
) -> Result<()> {
    let Some(element) = header.elements.get(name) else { return Ok(()) };
    let writer = Writer::<Row>::new();
    rows.try_for_each(|row| {
        writer.write_little_endian_element(file, &row, element)?;
        Ok(())
    })
}
