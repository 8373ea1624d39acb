//! A grid of equal angles, as of a mirror that tilts about two axes.

use glam::Vec3;

use super::check_field;
use crate::sensor::SensorError;
use crate::sensor::beams::{cell_middle, direction};
use crate::sensor::layout::{Layout, Lines};

/// A grid of equal angles around straight ahead, row by row.
#[derive(Clone, Debug, PartialEq)]
pub struct Raster {
    /// Beams a row.
    pub columns: u32,
    /// Rows.
    pub rows: u32,
    /// Angles from the left to the right edge and from the bottom to the top edge, in radians;
    /// beams are in the middle of cells.
    pub field: [f64; 2],
    /// Sweeps a second.
    pub rate: f64,
}

impl Raster {
    pub(super) fn check(&self) -> Result<(), SensorError> {
        // Beyond the zenith, rows would come down on the other side.
        check_field(self.field, [360.0, 180.0])
    }

    pub(super) fn layout(&self) -> Layout {
        Layout {
            beam_count: self.columns as usize * self.rows as usize,
            line_len: self.columns as usize,
            lines: Lines::Rows,
            seconds: self.rate.recip(),
        }
    }

    pub(super) fn directions(&self) -> Vec<Vec3> {
        let [across, up] = self.field;
        let row = |row: u32| {
            let elevation = -cell_middle(row, self.rows) * up;
            (0..self.columns)
                .map(move |column| direction(cell_middle(column, self.columns) * across, elevation))
        };
        (0..self.rows).flat_map(row).collect()
    }
}
