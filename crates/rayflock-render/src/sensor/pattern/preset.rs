//! Patterns by name: what kind of sensor, and how many channels.

use std::str::FromStr;

use super::{
    DepthCamera, OrthographicScanner, Pattern, Raster, Rosette, Shutter, Spinning, evenly,
};
use crate::sensor::SensorError;

/// Columns of a revolution.
const COLUMNS: u32 = 1024;
/// Rows of each spinning preset, and the elevations of its top and bottom rows in degrees.
const SPINNING: [(u32, f64, f64); 4] =
    [(16, 15.0, -15.0), (32, 15.0, -25.0), (64, 15.0, -25.0), (128, 15.0, -25.0)];
const OTHERS: [&str; 4] = ["solid-state", "rosette", "depth", "ortho"];

impl Pattern {
    /// The names of all presets.
    pub fn preset_names() -> Vec<String> {
        let spinning = SPINNING.iter().map(|(rows, ..)| format!("spinning:{rows}"));
        spinning.chain(OTHERS.map(str::to_owned)).collect()
    }
}

impl FromStr for Pattern {
    type Err = SensorError;

    fn from_str(name: &str) -> Result<Self, SensorError> {
        let rows = name.strip_prefix("spinning:");
        let spinning = |rows: &str| SPINNING.iter().find(|preset| preset.0.to_string() == rows);
        match name {
            "solid-state" => Ok(Self::Raster(Raster {
                columns: 600,
                rows: 100,
                field: [120.0, 25.0].map(f64::to_radians),
                rate: 10.0,
            })),
            // The golden ratio is as far from any closed curve as a ratio can be.
            "rosette" => Ok(Self::Rosette(Rosette {
                beams: 24_000,
                rate: 10.0,
                bends: [17.5_f64.to_radians(); 2],
                turns: [97.0, -97.0 * std::f64::consts::GOLDEN_RATIO.recip()],
            })),
            "depth" => Ok(Self::Depth(DepthCamera {
                width: 640,
                height: 480,
                vertical_field: 45.0_f64.to_radians(),
                rate: 30.0,
                shutter: Shutter::Global,
            })),
            "ortho" => Ok(Self::Orthographic(OrthographicScanner {
                width: 512,
                height: 512,
                extent: [10.0; 2],
                rate: 10.0,
                shutter: Shutter::Global,
            })),
            _ => match rows.and_then(spinning) {
                Some((rows, top, bottom)) => Ok(Self::Spinning(Spinning {
                    elevations: evenly(top.to_radians(), bottom.to_radians(), *rows),
                    columns: COLUMNS,
                    revolutions_per_second: 10.0,
                })),
                None => Err(SensorError::UnknownPreset {
                    found: name.to_owned(),
                    expected: Self::preset_names().join(", "),
                }),
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_preset_can_be_and_others_are_told_what_there_is() {
        for name in Pattern::preset_names() {
            let pattern: Pattern = name.parse().unwrap();
            pattern.check().unwrap();
            let (rows, columns) = pattern.shape();
            assert_eq!(pattern.layout().beam_count, rows * columns, "{name}");
        }
        for name in ["spinning", "spinning:17", "spinning:064", "lidar", ""] {
            let message = name.parse::<Pattern>().unwrap_err().to_string();
            assert!(message.contains(&format!("\"{name}\"; there are: spinning:16")), "{message}");
        }
    }
}
