//! What Python says about where the beams of a sensor go, as the library takes it.

use pyo3::prelude::*;
use rayflock::render::sensor::{self, Elevations, FieldOfView};

use crate::errors::Failure;

/// A preset and changes to it. What is `None` is as in the preset.
#[derive(Clone, Debug, FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct PatternOptions {
    pub(crate) preset: String,
    rows: Option<u32>,
    /// In degrees, one a row.
    elevations: Option<Vec<f64>>,
    /// In degrees, of the top row and of the bottom row, in place of all of them.
    elevation_ends: Option<[f64; 2]>,
    columns: Option<u32>,
    /// Beams across and down.
    size: Option<[u32; 2]>,
    /// One angle or two, in degrees.
    fov: Option<Vec<f64>>,
    extent: Option<[f32; 2]>,
    beams: Option<u32>,
    turns: Option<[f64; 2]>,
    rate: Option<f64>,
    shutter: Option<String>,
}

impl PatternOptions {
    /// The changes.
    pub(crate) fn changes(&self) -> Result<sensor::PatternOptions, Failure> {
        Ok(sensor::PatternOptions {
            rows: self.rows,
            elevations: self.elevations(),
            columns: self.columns,
            size: self.size,
            fov: self.fov.as_deref().map(field_of_view).transpose()?,
            extent: self.extent,
            beams: self.beams,
            turns: self.turns,
            rate: self.rate,
            shutter: self.shutter.as_deref().map(str::parse).transpose()?,
        })
    }

    fn elevations(&self) -> Option<Elevations> {
        let each = self.elevations.as_ref();
        let each = each.map(|each| each.iter().map(|degrees| degrees.to_radians()).collect());
        let ends = self.elevation_ends.map(|ends| ends.map(f64::to_radians));
        each.map(Elevations::Each).or(ends.map(Elevations::Between))
    }
}

fn field_of_view(degrees: &[f64]) -> Result<FieldOfView, Failure> {
    match *degrees {
        [angle] => Ok(FieldOfView::One(angle.to_radians())),
        [across, up] => Ok(FieldOfView::Two([across, up].map(f64::to_radians))),
        _ => Err(Failure::value(format!("fov must be one angle or two, found {degrees:?}"))),
    }
}
