//! What a header promises, checked against what is there.

use ply_rs_bw::ply::{ElementDef, Encoding, Header, PropertyType, ScalarType};

use crate::ImportError;
use crate::job::Job;

/// Which columns the vertices have.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Columns {
    pub(super) positions: bool,
    pub(super) normals: bool,
    pub(super) colors: bool,
    pub(super) uvs: bool,
    pub(super) radius: bool,
}

/// The columns of the element `vertex`.
pub(super) fn columns(header: &Header) -> Columns {
    let vertex = header.elements.iter().find(|(name, _)| name.as_str() == "vertex");
    let Some((_, vertex)) = vertex else { return Columns::default() };
    let has = |wanted: &str| {
        vertex.properties.iter().any(|(name, property)| {
            name == wanted && matches!(property.data_type, PropertyType::Scalar(_))
        })
    };
    let has_all = |names: &[&str]| names.iter().all(|name| has(name));
    Columns {
        positions: has_all(&["x", "y", "z"]),
        normals: has_all(&["nx", "ny", "nz"]),
        colors: has_all(&["red", "green", "blue"]),
        uvs: has_all(&["s", "t"]) || has_all(&["u", "v"]) || has_all(&["texture_u", "texture_v"]),
        radius: has("radius"),
    }
}

/// Refuses counts that the payload is too short for.
pub(super) fn check_sizes(
    header: &Header,
    payload_size: usize,
    job: &Job<'_>,
) -> Result<(), ImportError> {
    let mut needed = 0_u128;
    for (_, element) in &header.elements {
        let least = least_size(element, header.encoding);
        let size = element.count as u128 * least as u128;
        needed += size;
        // The last line of an ascii file may lack its line break.
        let is_room = needed <= payload_size as u128 + 1;
        if element.count > 0 && (least == 0 || !is_room) {
            let place = format!("header, element \"{}\"", element.name);
            let found = format!("a count of {}, at least {size} bytes", element.count);
            let expected = match least {
                0 => "at least one property".to_owned(),
                _ => format!("what fits in the {payload_size} bytes after the header"),
            };
            return Err(job.invalid(place, found, expected));
        }
    }
    Ok(())
}

/// Bytes that one row takes at least.
fn least_size(element: &ElementDef, encoding: Encoding) -> usize {
    let properties = element.properties.iter().map(|(_, property)| &property.data_type);
    match encoding {
        // A digit, and a space or line break.
        Encoding::Ascii => 2 * properties.count(),
        _ => properties
            .map(|data_type| match data_type {
                PropertyType::Scalar(scalar) | PropertyType::List(scalar, _) => size(scalar),
            })
            .sum(),
    }
}

fn size(scalar: &ScalarType) -> usize {
    match scalar {
        ScalarType::Char | ScalarType::UChar => 1,
        ScalarType::Short | ScalarType::UShort => 2,
        ScalarType::Int | ScalarType::UInt | ScalarType::Float => 4,
        ScalarType::Double => 8,
    }
}
