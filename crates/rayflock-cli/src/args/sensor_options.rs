//! What a sensor is, on the command line or in a TOML file by the same names.

use clap::Args;
use rayflock::render::sensor::{Returns, Shutter};
use serde::Deserialize;

use super::numbers::{Elevations, Field, Measures, Numbers, perhaps_word, word};
use crate::size::Size;

/// What a sensor is. What is not given is as in the preset.
#[derive(Clone, Debug, Default, Args, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case", default)]
pub(crate) struct SensorOptions {
    /// The preset of a TOML file.
    #[arg(skip)]
    pub(crate) sensor: Option<String>,

    /// Poses along which the sensor moves, in a TOML file.
    #[arg(skip)]
    pub(crate) pose: Vec<PoseOptions>,

    /// Where the sensor is [default: on the camera].
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, conflicts_with = "camera",
          help_heading = PLACE)]
    #[serde(deserialize_with = "perhaps_word")]
    pub(crate) at: Option<Numbers<3>>,

    /// A point that a sensor with --at looks to; +Y is up [default: along -Z].
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, conflicts_with = "camera",
          help_heading = PLACE)]
    #[serde(deserialize_with = "perhaps_word")]
    pub(crate) look_at: Option<Numbers<3>>,

    /// Rows of a spinning sensor, spread evenly over its elevations.
    #[arg(long, value_name = "N", help_heading = BEAMS)]
    pub(crate) rows: Option<u32>,

    /// Elevations of a spinning sensor in degrees: from the top row to the bottom row, or of each.
    #[arg(long, value_name = "A..B|A,B,...", allow_hyphen_values = true, help_heading = BEAMS)]
    #[serde(deserialize_with = "perhaps_word")]
    pub(crate) elevations: Option<Elevations>,

    /// Columns of a revolution of a spinning sensor.
    #[arg(long, value_name = "N", help_heading = BEAMS)]
    pub(crate) columns: Option<u32>,

    /// Beams across and down: of solid-state, depth and ortho.
    #[arg(long, value_name = "WxH", help_heading = BEAMS)]
    #[serde(deserialize_with = "perhaps_word")]
    pub(crate) size: Option<Size>,

    /// Angles of view in degrees, across and up: of solid-state; up alone: of depth [default there:
    /// that of the camera it is on], and across a rosette.
    #[arg(long, value_name = "HxV|V", help_heading = BEAMS)]
    #[serde(deserialize_with = "perhaps_word")]
    pub(crate) fov: Option<Field>,

    /// Width and height of what ortho scans, in scene units [default: what the whole motion needs].
    #[arg(long, value_name = "WxH", help_heading = BEAMS)]
    #[serde(deserialize_with = "perhaps_word")]
    pub(crate) extent: Option<Measures>,

    /// Beams of a sweep of a rosette.
    #[arg(long, value_name = "N", help_heading = BEAMS)]
    pub(crate) beams: Option<u32>,

    /// Turns a second of the two prisms of a rosette.
    #[arg(long, value_name = "A,B", allow_hyphen_values = true, help_heading = BEAMS)]
    #[serde(deserialize_with = "perhaps_word")]
    pub(crate) turns: Option<Numbers<2>>,

    /// Sweeps a second: revolutions, pictures.
    #[arg(long, value_name = "HZ", allow_negative_numbers = true, help_heading = TIME)]
    pub(crate) rate: Option<f64>,

    /// When the beams of depth and ortho are fired: global, all at once, or rolling, row by row
    /// [default: global].
    #[arg(long, value_name = "WHICH", help_heading = TIME)]
    #[serde(deserialize_with = "perhaps_word")]
    pub(crate) shutter: Option<Shutter>,

    /// Times of a sweep at which the scene is looked at [default: one for each column of a spinning
    /// sensor, each row of others, every 64 beams of a rosette].
    #[arg(long, value_name = "N", help_heading = TIME)]
    pub(crate) time_steps: Option<u32>,

    /// The least range that is told, in scene units [default: 0].
    #[arg(long, value_name = "LENGTH", allow_negative_numbers = true, help_heading = ECHOES)]
    pub(crate) min_range: Option<f32>,

    /// The most range that is told [default: none].
    #[arg(long, value_name = "LENGTH", allow_negative_numbers = true, help_heading = ECHOES)]
    pub(crate) max_range: Option<f32>,

    /// Standard deviation of ranges, in scene units [default: 0].
    #[arg(long, value_name = "LENGTH", allow_negative_numbers = true, help_heading = ECHOES)]
    pub(crate) noise: Option<f32>,

    /// What is added to it in proportion to the range: 0.001 is 1 mm for each metre [default: 0].
    #[arg(long, value_name = "SHARE", allow_negative_numbers = true, help_heading = ECHOES)]
    pub(crate) noise_per_range: Option<f32>,

    /// The chance from 0 to 1 that an echo is lost, whichever it is [default: 0].
    #[arg(long, value_name = "CHANCE", allow_negative_numbers = true, help_heading = ECHOES)]
    pub(crate) drop_out: Option<f32>,

    /// The chance that it is lost at grazing incidence; less towards the normal [default: 0].
    #[arg(long, value_name = "CHANCE", allow_negative_numbers = true, help_heading = ECHOES)]
    pub(crate) drop_out_grazing: Option<f32>,

    /// The chance that it is lost at --max-range; less, by the square, nearby [default: 0].
    #[arg(long, value_name = "CHANCE", allow_negative_numbers = true, help_heading = ECHOES)]
    pub(crate) drop_out_far: Option<f32>,

    /// The least intensity that is told; 1 is white, facing, at one scene unit [default: 0].
    #[arg(long, value_name = "INTENSITY", allow_negative_numbers = true, help_heading = ECHOES)]
    pub(crate) min_intensity: Option<f32>,

    /// Which echoes of a beam are told: first, strongest, last, first+last, first+strongest,
    /// strongest+last or all [default: first].
    #[arg(long, value_name = "WHICH", help_heading = ECHOES)]
    #[serde(deserialize_with = "perhaps_word")]
    pub(crate) returns: Option<Returns>,

    /// The share of light that glass scatters at least, by its dust [default: 0.02].
    #[arg(long, value_name = "SHARE", allow_negative_numbers = true, help_heading = ECHOES)]
    pub(crate) dust: Option<f32>,

    /// How many surfaces of glass a beam passes at most [default: 8].
    #[arg(long, value_name = "N", help_heading = ECHOES)]
    pub(crate) panes: Option<u32>,

    /// Chooses noise and drop-outs [default: 0].
    #[arg(long, value_name = "N", help_heading = ECHOES)]
    pub(crate) seed: Option<u64>,
}

const PLACE: &str = "Where the sensor is";
const BEAMS: &str = "Where its beams go";
const TIME: &str = "When they are fired";
const ECHOES: &str = "Which echoes are told";

/// A pose of a TOML file.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(crate) struct PoseOptions {
    /// In seconds of the scene.
    pub(crate) time: f64,
    /// Where the sensor is then.
    #[serde(deserialize_with = "word")]
    pub(crate) at: Numbers<3>,
    /// Where it looks.
    #[serde(default, deserialize_with = "perhaps_word")]
    pub(crate) look_at: Option<Numbers<3>>,
}

impl SensorOptions {
    /// These options, and those of `other` where these say nothing. Who says where the sensor is
    /// says all about it.
    pub(crate) fn or(self, other: Self) -> Self {
        let is_placed = self.at.is_some() || !self.pose.is_empty();
        let (at, look_at, pose) = match is_placed {
            true => (self.at, self.look_at, self.pose),
            false => (other.at, self.look_at.or(other.look_at), other.pose),
        };
        Self {
            sensor: self.sensor.or(other.sensor),
            pose,
            at,
            look_at,
            rows: self.rows.or(other.rows),
            elevations: self.elevations.or(other.elevations),
            columns: self.columns.or(other.columns),
            size: self.size.or(other.size),
            fov: self.fov.or(other.fov),
            extent: self.extent.or(other.extent),
            beams: self.beams.or(other.beams),
            turns: self.turns.or(other.turns),
            rate: self.rate.or(other.rate),
            shutter: self.shutter.or(other.shutter),
            time_steps: self.time_steps.or(other.time_steps),
            min_range: self.min_range.or(other.min_range),
            max_range: self.max_range.or(other.max_range),
            noise: self.noise.or(other.noise),
            noise_per_range: self.noise_per_range.or(other.noise_per_range),
            drop_out: self.drop_out.or(other.drop_out),
            drop_out_grazing: self.drop_out_grazing.or(other.drop_out_grazing),
            drop_out_far: self.drop_out_far.or(other.drop_out_far),
            min_intensity: self.min_intensity.or(other.min_intensity),
            returns: self.returns.or(other.returns),
            dust: self.dust.or(other.dust),
            panes: self.panes.or(other.panes),
            seed: self.seed.or(other.seed),
        }
    }
}
