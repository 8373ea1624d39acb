//! Where a sensor's beams go, and when.
//!
//! | Pattern | Beams | Lines, and so time |
//! |---|---|---|
//! | [`Spinning`] | a column of elevations that turns once a sweep | columns |
//! | [`Raster`] | a grid of equal angles, as of a mirror that tilts | rows |
//! | [`Rosette`] | where two turning prisms bend one beam | bursts of [`Rosette::BURST`] |
//! | [`DepthCamera`] | through the pixels of a pinhole camera | rows, or all at once |
//! | [`OrthographicScanner`] | parallel, through a grid | rows, or all at once |
//!
//! [`PatternOptions`] are what users say about presets.
//!
//! Azimuths are to the right of straight ahead, elevations up. Rows are counted from the top,
//! columns from the left.

mod depth_camera;
mod options;
mod orthographic;
mod preset;
mod raster;
mod rosette;
mod spinning;

pub use depth_camera::{DepthCamera, Shutter};
pub use options::{Elevations, FieldOfView, PatternOptions, Surroundings};
pub use orthographic::OrthographicScanner;
pub use raster::Raster;
pub use rosette::Rosette;
pub use spinning::{Spinning, evenly};

use super::SensorError;
use super::beams::Beams;
use super::error::ensure_value;
use super::layout::Layout;

/// Beams of a sweep at most.
const MAX_BEAM_COUNT: u64 = 1 << 24;
/// Sweeps a second.
const RATES: (f64, f64) = (1e-3, 1e5);

/// Where a sensor's beams go, and when. Presets have names: `"spinning:64".parse()`.
#[derive(Clone, Debug, PartialEq)]
pub enum Pattern {
    /// A column of beams that turns around.
    Spinning(Spinning),
    /// A grid of equal angles.
    Raster(Raster),
    /// A beam bent by two turning prisms.
    Rosette(Rosette),
    /// The pixels of a pinhole camera.
    Depth(DepthCamera),
    /// Parallel beams.
    Orthographic(OrthographicScanner),
}

impl Pattern {
    /// Sweeps a second.
    pub fn rate(&self) -> f64 {
        match self {
            Self::Spinning(pattern) => pattern.revolutions_per_second,
            Self::Raster(pattern) => pattern.rate,
            Self::Rosette(pattern) => pattern.rate,
            Self::Depth(pattern) => pattern.rate,
            Self::Orthographic(pattern) => pattern.rate,
        }
    }

    /// Rows and columns of the picture that beams make; one row where they make none.
    pub fn shape(&self) -> (usize, usize) {
        let (rows, columns) = match self {
            Self::Spinning(pattern) => (pattern.elevations.len() as u64, pattern.columns.into()),
            Self::Raster(pattern) => (pattern.rows.into(), pattern.columns.into()),
            Self::Rosette(pattern) => (1, u64::from(pattern.beams)),
            Self::Depth(pattern) => (pattern.height.into(), pattern.width.into()),
            Self::Orthographic(pattern) => (pattern.height.into(), pattern.width.into()),
        };
        (rows as usize, columns as usize)
    }

    /// Whether neighbours in a row or column are neighbours in space.
    pub const fn is_picture(&self) -> bool {
        !matches!(self, Self::Rosette(_))
    }

    /// Fails where the pattern cannot be.
    pub(super) fn check(&self) -> Result<(), SensorError> {
        let (rate, (least, most)) = (self.rate(), RATES);
        let is_right = (least..=most).contains(&rate);
        ensure_value(is_right, "rate", rate, format!("{least} to {most} sweeps a second"))?;
        let (rows, columns) = self.shape();
        let count = (rows as u64).saturating_mul(columns as u64);
        let expected = format!("1 to {MAX_BEAM_COUNT}");
        ensure_value((1..=MAX_BEAM_COUNT).contains(&count), "number of beams", count, expected)?;
        match self {
            Self::Spinning(pattern) => pattern.check(),
            Self::Raster(pattern) => pattern.check(),
            Self::Rosette(pattern) => pattern.check(),
            Self::Depth(pattern) => pattern.check(),
            Self::Orthographic(pattern) => pattern.check(),
        }
    }

    pub(super) fn layout(&self) -> Layout {
        match self {
            Self::Spinning(pattern) => pattern.layout(),
            Self::Raster(pattern) => pattern.layout(),
            Self::Rosette(pattern) => pattern.layout(),
            Self::Depth(pattern) => pattern.layout(),
            Self::Orthographic(pattern) => pattern.layout(),
        }
    }

    /// The beams of the sweep that starts at `start` seconds.
    pub(super) fn beams(&self, start: f64) -> Beams {
        match self {
            Self::Spinning(pattern) => Beams::FromPoint(pattern.directions()),
            Self::Raster(pattern) => Beams::FromPoint(pattern.directions()),
            Self::Rosette(pattern) => Beams::FromPoint(pattern.directions(start)),
            Self::Depth(pattern) => Beams::FromPoint(pattern.directions()),
            Self::Orthographic(pattern) => Beams::Parallel(pattern.origins()),
        }
    }

    /// Whether each sweep has the beams of the one before.
    pub(super) const fn repeats(&self) -> bool {
        !matches!(self, Self::Rosette(_))
    }
}

/// Fails unless both angles of a field of view, across and up, are above 0 and within `limits`, in
/// degrees.
fn check_field(field: [f64; 2], limits: [f64; 2]) -> Result<(), SensorError> {
    let [across, up] = field.map(f64::to_degrees);
    let [most_across, most_up] = limits;
    let is_right = across > 0.0 && across <= most_across && up > 0.0 && up <= most_up;
    let expected = format!("above 0 and up to {most_across} x {most_up} degrees");
    ensure_value(is_right, "field of view", format!("{across} x {up} degrees"), expected)
}
