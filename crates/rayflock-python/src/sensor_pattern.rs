//! Where the beams of a sensor go: a preset, and what Python says besides.

use pyo3::prelude::*;
use rayflock::render::sensor::{
    DepthCamera, OrthographicScanner, Pattern, Raster, Rosette, Shutter, Spinning, evenly,
};

use crate::errors::Failure;

/// A preset and changes to it. What is `None` is as in the preset; what the preset has no use for
/// changes nothing.
#[derive(Clone, Debug, FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct PatternOptions {
    preset: String,
    rows: Option<u32>,
    /// In degrees, one a row.
    elevations: Option<Vec<f64>>,
    /// In degrees, of the top row and of the bottom row, in place of all of them.
    elevation_ends: Option<[f64; 2]>,
    columns: Option<u32>,
    /// Beams across and down.
    size: Option<[u32; 2]>,
    /// Angles in degrees, across and up; the same where a sensor has but one.
    fov: Option<[f64; 2]>,
    extent: Option<[f32; 2]>,
    beams: Option<u32>,
    turns: Option<[f64; 2]>,
    rate: Option<f64>,
    shutter: Option<String>,
}

/// What the scene says where neither preset nor options do.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Surroundings {
    /// The angle of view of the camera that the sensor is on, up, in radians.
    pub(crate) vertical_fov: Option<f32>,
    /// The diagonal of everything over the whole motion; 0 where there is nothing.
    pub(crate) diagonal: f32,
}

impl PatternOptions {
    /// Whether the pattern depends on how large everything is.
    pub(crate) fn wants_diagonal(&self) -> bool {
        self.extent.is_none() && matches!(self.preset.parse(), Ok(Pattern::Orthographic(_)))
    }

    /// The preset, changed as the options say.
    pub(crate) fn pattern(&self, surroundings: &Surroundings) -> Result<Pattern, Failure> {
        let mut pattern: Pattern = self.preset.parse()?;
        match &mut pattern {
            Pattern::Spinning(spinning) => self.change_spinning(spinning),
            Pattern::Raster(raster) => self.change_raster(raster),
            Pattern::Rosette(rosette) => self.change_rosette(rosette),
            Pattern::Depth(depth) => self.change_depth(depth, surroundings.vertical_fov)?,
            Pattern::Orthographic(ortho) => self.change_ortho(ortho, surroundings.diagonal)?,
        }
        Ok(pattern)
    }

    fn change_spinning(&self, spinning: &mut Spinning) {
        spinning.columns = self.columns.unwrap_or(spinning.columns);
        spinning.revolutions_per_second = self.rate.unwrap_or(spinning.revolutions_per_second);
        if let Some(elevations) = &self.elevations {
            spinning.elevations = elevations.iter().map(|degrees| degrees.to_radians()).collect();
            return;
        }
        let preset = &spinning.elevations;
        let [first, last] = match self.elevation_ends {
            Some(ends) => ends.map(f64::to_radians),
            None => [preset.first(), preset.last()].map(|end| end.copied().unwrap_or_default()),
        };
        let rows = self.rows.unwrap_or(preset.len() as u32);
        spinning.elevations = evenly(first, last, rows);
    }

    fn change_raster(&self, raster: &mut Raster) {
        [raster.columns, raster.rows] = self.size.unwrap_or([raster.columns, raster.rows]);
        raster.field = self.fov.map_or(raster.field, |fov| fov.map(f64::to_radians));
        raster.rate = self.rate.unwrap_or(raster.rate);
    }

    fn change_rosette(&self, rosette: &mut Rosette) {
        rosette.beams = self.beams.unwrap_or(rosette.beams);
        rosette.turns = self.turns.unwrap_or(rosette.turns);
        if let Some([_, field]) = self.fov {
            rosette.bends = [0.25 * field.to_radians(); 2];
        }
        rosette.rate = self.rate.unwrap_or(rosette.rate);
    }

    fn change_depth(
        &self,
        depth: &mut DepthCamera,
        vertical_fov: Option<f32>,
    ) -> Result<(), Failure> {
        [depth.width, depth.height] = self.size.unwrap_or([depth.width, depth.height]);
        let of_camera = vertical_fov.map_or(depth.vertical_field, f64::from);
        depth.vertical_field = self.fov.map_or(of_camera, |[_, up]| up.to_radians());
        depth.rate = self.rate.unwrap_or(depth.rate);
        depth.shutter = self.shutter_or(depth.shutter)?;
        Ok(())
    }

    fn change_ortho(&self, ortho: &mut OrthographicScanner, diagonal: f32) -> Result<(), Failure> {
        [ortho.width, ortho.height] = self.size.unwrap_or([ortho.width, ortho.height]);
        let aspect = ortho.width as f32 / ortho.height as f32;
        ortho.extent = match self.extent {
            Some(extent) => extent,
            None if diagonal > 0.0 => [diagonal * aspect.max(1.0), diagonal / aspect.min(1.0)],
            None => ortho.extent,
        };
        ortho.rate = self.rate.unwrap_or(ortho.rate);
        ortho.shutter = self.shutter_or(ortho.shutter)?;
        Ok(())
    }

    fn shutter_or(&self, preset: Shutter) -> Result<Shutter, Failure> {
        match self.shutter.as_deref() {
            None => Ok(preset),
            Some("global") => Ok(Shutter::Global),
            Some("rolling") => Ok(Shutter::Rolling),
            Some(found) => Err(Failure::value(format!(
                "unknown shutter \"{found}\"; there are: global, rolling"
            ))),
        }
    }
}
