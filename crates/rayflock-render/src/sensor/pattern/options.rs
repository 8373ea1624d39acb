//! A preset, changed as users ask: one reading of options for the program, files and Python.

use super::{
    DepthCamera, MAX_BEAM_COUNT, OrthographicScanner, Pattern, Raster, Rosette, Shutter, Spinning,
    evenly,
};
use crate::sensor::SensorError;
use crate::sensor::error::ensure_value;

/// What changes a preset. What is `None` is as in the preset. Angles are in radians, lengths in
/// scene units, and options are called as users call them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PatternOptions {
    /// Rows of a spinning sensor, spread evenly over its elevations.
    pub rows: Option<u32>,
    /// Elevations of a spinning sensor.
    pub elevations: Option<Elevations>,
    /// Columns of a revolution.
    pub columns: Option<u32>,
    /// Beams across and down.
    pub size: Option<[u32; 2]>,
    /// Angles of view.
    pub fov: Option<FieldOfView>,
    /// Width and height of what an orthographic scanner scans.
    pub extent: Option<[f32; 2]>,
    /// Beams of a sweep of a rosette.
    pub beams: Option<u32>,
    /// Turns of its two prisms a second.
    pub turns: Option<[f64; 2]>,
    /// Sweeps a second.
    pub rate: Option<f64>,
    /// When the pixels of a picture are measured.
    pub shutter: Option<Shutter>,
}

/// Elevations of the rows of a spinning sensor, in radians.
#[derive(Clone, Debug, PartialEq)]
pub enum Elevations {
    /// One a row.
    Each(Vec<f64>),
    /// Those of the top and of the bottom row; others lie evenly between.
    Between([f64; 2]),
}

/// Angles of view, in radians.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FieldOfView {
    /// Of a sensor that has but one.
    One(f64),
    /// Across and up.
    Two([f64; 2]),
}

/// What the scene says where neither preset nor options do.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Surroundings {
    /// The angle of view of the camera that the sensor is on, up, in radians.
    pub vertical_fov: Option<f32>,
    /// The diagonal of everything over the whole motion; 0 where there is nothing, or
    /// [`PatternOptions::wants_diagonal`] says that it does not matter.
    pub diagonal: f32,
}

impl PatternOptions {
    /// Whether the preset called `name` depends on how large everything is.
    pub fn wants_diagonal(&self, name: &str) -> bool {
        self.extent.is_none() && matches!(name.parse(), Ok(Pattern::Orthographic(_)))
    }

    /// The preset called `name`, changed by these options.
    ///
    /// # Errors
    /// [`SensorError`] where there is no such preset, or it has no use for an option or for as many
    /// values.
    pub fn pattern(&self, name: &str, around: &Surroundings) -> Result<Pattern, SensorError> {
        let mut pattern: Pattern = name.parse()?;
        self.refuse_unsuitable(name, &pattern)?;
        match &mut pattern {
            Pattern::Spinning(spinning) => self.change_spinning(spinning)?,
            Pattern::Raster(raster) => self.change_raster(raster)?,
            Pattern::Rosette(rosette) => self.change_rosette(rosette)?,
            Pattern::Depth(depth) => self.change_depth(depth, around.vertical_fov)?,
            Pattern::Orthographic(ortho) => self.change_ortho(ortho, around.diagonal),
        }
        Ok(pattern)
    }

    /// Fails where an option is given that the sensor has no use for.
    fn refuse_unsuitable(&self, name: &str, pattern: &Pattern) -> Result<(), SensorError> {
        let suitable: &[&'static str] = match pattern {
            Pattern::Spinning(_) => &["rows", "elevations", "columns"],
            Pattern::Raster(_) => &["size", "fov"],
            Pattern::Rosette(_) => &["beams", "fov", "turns"],
            Pattern::Depth(_) => &["size", "fov", "shutter"],
            Pattern::Orthographic(_) => &["size", "extent", "shutter"],
        };
        let options = [
            ("rows", self.rows.is_some()),
            ("elevations", self.elevations.is_some()),
            ("columns", self.columns.is_some()),
            ("size", self.size.is_some()),
            ("fov", self.fov.is_some()),
            ("extent", self.extent.is_some()),
            ("beams", self.beams.is_some()),
            ("turns", self.turns.is_some()),
            ("shutter", self.shutter.is_some()),
        ];
        let mut given = options.iter().filter(|(_, is_given)| *is_given);
        match given.find(|(option, _)| !suitable.contains(option)) {
            Some((option, _)) => Err(SensorError::UnsuitableOption {
                option,
                sensor: name.to_owned(),
                suitable: suitable.join(", "),
            }),
            None => Ok(()),
        }
    }

    fn change_spinning(&self, spinning: &mut Spinning) -> Result<(), SensorError> {
        spinning.columns = self.columns.unwrap_or(spinning.columns);
        spinning.revolutions_per_second = self.rate.unwrap_or(spinning.revolutions_per_second);
        let preset = &spinning.elevations;
        let [first, last] = match &self.elevations {
            Some(Elevations::Each(each)) => {
                let (rows, count) = (self.rows.unwrap_or(0), each.len());
                let is_right = self.rows.is_none_or(|rows| rows as usize == count);
                ensure_value(is_right, "number of rows", rows, format!("{count}, as elevations"))?;
                spinning.elevations.clone_from(each);
                return Ok(());
            }
            Some(Elevations::Between(ends)) => *ends,
            None => [preset.first(), preset.last()].map(|end| end.copied().unwrap_or_default()),
        };
        let rows = self.rows.unwrap_or(preset.len() as u32);
        let is_right = u64::from(rows) <= MAX_BEAM_COUNT;
        ensure_value(is_right, "number of rows", rows, format!("{MAX_BEAM_COUNT} at most"))?;
        spinning.elevations = evenly(first, last, rows);
        Ok(())
    }

    fn change_raster(&self, raster: &mut Raster) -> Result<(), SensorError> {
        [raster.columns, raster.rows] = self.size.unwrap_or([raster.columns, raster.rows]);
        raster.rate = self.rate.unwrap_or(raster.rate);
        raster.field = match self.fov {
            Some(FieldOfView::Two(field)) => field,
            Some(FieldOfView::One(up)) => {
                return Err(wrong_fov(&degrees(up), "two angles, across and up"));
            }
            None => raster.field,
        };
        Ok(())
    }

    fn change_rosette(&self, rosette: &mut Rosette) -> Result<(), SensorError> {
        rosette.beams = self.beams.unwrap_or(rosette.beams);
        rosette.turns = self.turns.unwrap_or(rosette.turns);
        rosette.rate = self.rate.unwrap_or(rosette.rate);
        if let Some(field) = self.one_angle()? {
            rosette.bends = [0.25 * field; 2];
        }
        Ok(())
    }

    fn change_depth(
        &self,
        depth: &mut DepthCamera,
        vertical_fov: Option<f32>,
    ) -> Result<(), SensorError> {
        [depth.width, depth.height] = self.size.unwrap_or([depth.width, depth.height]);
        depth.rate = self.rate.unwrap_or(depth.rate);
        depth.shutter = self.shutter.unwrap_or(depth.shutter);
        let of_camera = vertical_fov.map_or(depth.vertical_field, f64::from);
        depth.vertical_field = self.one_angle()?.unwrap_or(of_camera);
        Ok(())
    }

    fn change_ortho(&self, ortho: &mut OrthographicScanner, diagonal: f32) {
        [ortho.width, ortho.height] = self.size.unwrap_or([ortho.width, ortho.height]);
        ortho.rate = self.rate.unwrap_or(ortho.rate);
        ortho.shutter = self.shutter.unwrap_or(ortho.shutter);
        let aspect = ortho.width as f32 / ortho.height as f32;
        ortho.extent = match self.extent {
            Some(extent) => extent,
            None if diagonal > 0.0 => [diagonal * aspect.max(1.0), diagonal / aspect.min(1.0)],
            None => ortho.extent,
        };
    }

    /// The angle of view of a sensor that has but one.
    fn one_angle(&self) -> Result<Option<f64>, SensorError> {
        match self.fov {
            None => Ok(None),
            Some(FieldOfView::One(angle)) => Ok(Some(angle)),
            Some(FieldOfView::Two(field)) => {
                Err(wrong_fov(&field.map(degrees).join(" x "), "one angle"))
            }
        }
    }
}

/// An angle as the user gave it: not quite, for it has been converted to radians.
fn degrees(radians: f64) -> String {
    ((1e6 * radians.to_degrees()).round() * 1e-6).to_string()
}

fn wrong_fov(found: &str, expected: &str) -> SensorError {
    SensorError::Value {
        what: "fov",
        found: format!("{found} degrees"),
        expected: expected.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const NOWHERE: Surroundings = Surroundings { vertical_fov: None, diagonal: 0.0 };

    fn message(name: &str, options: &PatternOptions) -> String {
        options.pattern(name, &NOWHERE).unwrap_err().to_string()
    }

    #[test]
    fn without_options_a_preset_stays_as_it_is() {
        for name in Pattern::preset_names() {
            let changed = PatternOptions::default().pattern(&name, &NOWHERE);
            assert_eq!(changed, name.parse(), "{name}");
        }
    }

    #[test]
    fn rows_lie_between_the_ends_of_the_preset_or_of_the_options() {
        let ends = |options: PatternOptions| {
            let Ok(Pattern::Spinning(spinning)) = options.pattern("spinning:32", &NOWHERE) else {
                panic!("it spins")
            };
            spinning.elevations.iter().map(|up| up.to_degrees().round()).collect::<Vec<_>>()
        };
        let rows = Some(3);
        assert_eq!(ends(PatternOptions { rows, ..Default::default() }), [15.0, -5.0, -25.0]);
        let elevations = Some(Elevations::Between([20.0, 0.0].map(f64::to_radians)));
        let options = PatternOptions { rows, elevations, ..Default::default() };
        assert_eq!(ends(options), [20.0, 10.0, 0.0]);
    }

    #[test]
    fn a_scene_says_what_nobody_else_does() {
        let around = Surroundings { vertical_fov: Some(0.5), diagonal: 8.0 };
        let size = Some([200, 100]);
        let options = PatternOptions { size, ..Default::default() };
        let Ok(Pattern::Depth(depth)) = options.pattern("depth", &around) else {
            panic!("it is a camera")
        };
        assert_eq!((depth.vertical_field, depth.width), (0.5, 200));
        let Ok(Pattern::Orthographic(ortho)) = options.pattern("ortho", &around) else {
            panic!("its beams are parallel")
        };
        assert_eq!(ortho.extent, [16.0, 8.0]);
        assert!(options.wants_diagonal("ortho") && !options.wants_diagonal("depth"));
    }

    #[test]
    fn what_a_sensor_has_no_use_for_is_refused() {
        let all = PatternOptions {
            rows: Some(3),
            elevations: Some(Elevations::Each(vec![0.1, 0.0])),
            ..Default::default()
        };
        assert_eq!(
            message("depth", &all),
            "rows says nothing about the sensor depth, which has size, fov, shutter"
        );
        let expected = "the number of rows is 3, expected 2, as elevations";
        assert_eq!(message("spinning:16", &all), expected);
        let most = PatternOptions { rows: Some(u32::MAX), ..Default::default() };
        assert!(message("spinning:16", &most).ends_with("expected 16777216 at most"));
        let fov = Some(FieldOfView::Two([1.0, 0.5].map(f64::to_radians)));
        let two = PatternOptions { fov, ..Default::default() };
        let expected = "the fov is 1 x 0.5 degrees, expected one angle";
        assert_eq!(message("rosette", &two), expected);
        let fov = Some(FieldOfView::One(1.0_f64.to_radians()));
        let one = PatternOptions { fov, ..Default::default() };
        assert!(message("solid-state", &one).ends_with("expected two angles, across and up"));
        assert!(message("lidar", &one).starts_with("unknown sensor \"lidar\""));
    }
}
