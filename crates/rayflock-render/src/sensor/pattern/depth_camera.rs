//! The pixels of a pinhole camera.

use std::str::FromStr;

use glam::{DVec3, Vec3};

use super::check_field;
use crate::sensor::SensorError;
use crate::sensor::beams::cell_middle;
use crate::sensor::layout::{Layout, Lines};

/// A pinhole camera that measures ranges: a beam through the middle of each pixel. The depth along
/// its axis is [`Sweep::depth`](crate::sensor::Sweep::depth).
#[derive(Clone, Debug, PartialEq)]
pub struct DepthCamera {
    /// Pixels a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Angle between the top and the bottom of the picture, in radians.
    pub vertical_field: f64,
    /// Pictures a second.
    pub rate: f64,
    /// When pixels are measured.
    pub shutter: Shutter,
}

/// When the pixels of a picture are measured.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Shutter {
    /// All at once, at the start of the sweep.
    #[default]
    Global,
    /// Row by row, in the whole time of a sweep.
    Rolling,
}

impl Shutter {
    /// From the first row to where one after the last would be.
    pub(super) fn seconds(self, rate: f64) -> f64 {
        match self {
            Self::Global => 0.0,
            Self::Rolling => rate.recip(),
        }
    }
}

impl FromStr for Shutter {
    type Err = SensorError;

    fn from_str(name: &str) -> Result<Self, SensorError> {
        match name {
            "global" => Ok(Self::Global),
            "rolling" => Ok(Self::Rolling),
            _ => Err(SensorError::UnknownShutter { found: name.to_owned() }),
        }
    }
}

impl DepthCamera {
    pub(super) fn check(&self) -> Result<(), SensorError> {
        check_field([self.vertical_field; 2], [175.0; 2])
    }

    pub(super) fn layout(&self) -> Layout {
        Layout {
            beam_count: self.width as usize * self.height as usize,
            line_len: self.width as usize,
            lines: Lines::Rows,
            seconds: self.shutter.seconds(self.rate),
        }
    }

    pub(super) fn directions(&self) -> Vec<Vec3> {
        let tall = 2.0 * (0.5 * self.vertical_field).tan();
        let wide = tall * f64::from(self.width) / f64::from(self.height);
        let row = |row: u32| {
            let y = -cell_middle(row, self.height) * tall;
            (0..self.width).map(move |column| {
                let x = cell_middle(column, self.width) * wide;
                DVec3::new(x, y, -1.0).normalize().as_vec3()
            })
        };
        (0..self.height).flat_map(row).collect()
    }
}
