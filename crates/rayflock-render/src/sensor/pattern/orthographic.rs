//! Parallel beams through a grid.

use glam::{DVec3, Vec3};

use super::Shutter;
use crate::sensor::SensorError;
use crate::sensor::beams::cell_middle;
use crate::sensor::error::ensure_value;
use crate::sensor::layout::{Layout, Lines};

/// Parallel beams along the sensor's -Z, through the middle of each cell of a grid around it.
#[derive(Clone, Debug, PartialEq)]
pub struct OrthographicScanner {
    /// Beams a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Width and height of the grid, in scene units.
    pub extent: [f32; 2],
    /// Sweeps a second.
    pub rate: f64,
    /// When beams are fired.
    pub shutter: Shutter,
}

impl OrthographicScanner {
    pub(super) fn check(&self) -> Result<(), SensorError> {
        let [wide, tall] = self.extent;
        let is_right = self.extent.iter().all(|edge| *edge > 0.0 && edge.is_finite());
        ensure_value(is_right, "extent", format!("{wide} x {tall}"), "finite lengths above 0")
    }

    pub(super) fn layout(&self) -> Layout {
        Layout {
            beam_count: self.width as usize * self.height as usize,
            line_len: self.width as usize,
            lines: Lines::Rows,
            seconds: self.shutter.seconds(self.rate),
        }
    }

    pub(super) fn origins(&self) -> Vec<Vec3> {
        let [wide, tall] = self.extent.map(f64::from);
        let row = |row: u32| {
            let y = -cell_middle(row, self.height) * tall;
            (0..self.width).map(move |column| {
                DVec3::new(cell_middle(column, self.width) * wide, y, 0.0).as_vec3()
            })
        };
        (0..self.height).flat_map(row).collect()
    }
}
