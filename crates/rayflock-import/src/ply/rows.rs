//! Rows of elements, filled by the parser property by property.

use ply_rs_bw::ply::{Property, PropertyAccess, PropertyAccessResult};

/// A row of the element `vertex`.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct VertexRow {
    pub(super) position: [f32; 3],
    pub(super) normal: [f32; 3],
    /// As stored, 0 to 1.
    pub(super) color: [f32; 3],
    pub(super) uv: [f32; 2],
    pub(super) radius: f32,
}

impl PropertyAccess for VertexRow {
    fn new() -> Self {
        Self::default()
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        let slot = match name {
            "x" => &mut self.position[0],
            "y" => &mut self.position[1],
            "z" => &mut self.position[2],
            "nx" => &mut self.normal[0],
            "ny" => &mut self.normal[1],
            "nz" => &mut self.normal[2],
            "red" => &mut self.color[0],
            "green" => &mut self.color[1],
            "blue" => &mut self.color[2],
            "s" | "u" | "texture_u" => &mut self.uv[0],
            "t" | "v" | "texture_v" => &mut self.uv[1],
            "radius" => &mut self.radius,
            _ => return PropertyAccessResult::Ignored,
        };
        let Some(value) = property.to_f32_lossy() else { return PropertyAccessResult::Ignored };
        let is_color = matches!(name, "red" | "green" | "blue");
        *slot = if is_color { value / color_scale(&property) } else { value };
        PropertyAccessResult::Set
    }
}

/// What stands for full colour in this type.
fn color_scale(property: &Property) -> f32 {
    match property {
        Property::Float(_) | Property::Double(_) => 1.0,
        Property::Short(_) | Property::UShort(_) => 65_535.0,
        _ => 255.0,
    }
}

/// A row of the elements `face` and `tristrips`.
#[derive(Clone, Debug, Default)]
pub(super) struct FaceRow {
    pub(super) indices: Vec<i64>,
}

impl PropertyAccess for FaceRow {
    fn new() -> Self {
        Self::default()
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        if !matches!(name, "vertex_indices" | "vertex_index") {
            return PropertyAccessResult::Ignored;
        }
        self.indices = match property {
            Property::ListChar(list) => list.into_iter().map(i64::from).collect(),
            Property::ListUChar(list) => list.into_iter().map(i64::from).collect(),
            Property::ListShort(list) => list.into_iter().map(i64::from).collect(),
            Property::ListUShort(list) => list.into_iter().map(i64::from).collect(),
            Property::ListInt(list) => list.into_iter().map(i64::from).collect(),
            Property::ListUInt(list) => list.into_iter().map(i64::from).collect(),
            _ => return PropertyAccessResult::UnsupportedType,
        };
        PropertyAccessResult::Set
    }
}

/// A row of an element that is not read.
#[derive(Clone, Copy, Debug)]
pub(super) struct SkippedRow;

impl PropertyAccess for SkippedRow {
    fn new() -> Self {
        Self
    }
}
