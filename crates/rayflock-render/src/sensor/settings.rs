//! What a sensor sees, and a sensor as data.

use super::error::ensure_value;
use super::{Pattern, PosePath, Returns, SensorError};

/// A sensor as data: where its beams go, where it is, and what it sees.
#[derive(Clone, Debug, PartialEq)]
pub struct Sensor {
    /// Where its beams go, and when.
    pub pattern: Pattern,
    /// Where it is.
    pub path: PosePath,
    /// What it sees.
    pub settings: SensorSettings,
}

/// What a sensor sees. Lengths are in scene units.
#[derive(Clone, Debug, PartialEq)]
pub struct SensorSettings {
    /// Nearer echoes are not told, but what sends them is in the way.
    pub min_range: f32,
    /// Farther echoes are not told; may be infinite.
    pub max_range: f32,
    /// How ranges scatter.
    pub noise: RangeNoise,
    /// By which chance echoes are lost.
    pub drop_out: DropOut,
    /// Weaker echoes are lost.
    pub min_intensity: f32,
    /// Which echoes of a beam are told.
    pub returns: Returns,
    /// The share of light that surfaces which let light through scatter at least: dust on glass.
    pub dust: f32,
    /// How many surfaces that let light through a beam passes at most.
    pub panes: u32,
    /// Chooses noise and drop-outs.
    pub seed: u64,
    /// Time steps of a sweep; by default one for each line of the pattern.
    pub time_steps: Option<u32>,
}

/// The standard deviation of ranges (Gaussian): `constant + proportional * range`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RangeNoise {
    /// In scene units.
    pub constant: f32,
    /// As a share of the range.
    pub proportional: f32,
}

/// By which chance an echo is lost. The three are independent.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DropOut {
    /// Always.
    pub constant: f32,
    /// At grazing incidence. At an angle `a` from the normal it is this times `(1 - cos(a))^5`,
    /// by which a smooth surface mirrors light away (Schlick).
    pub grazing: f32,
    /// At the maximum range. At a range `r` it is this times `(r / max_range)^2`.
    pub far: f32,
}

impl Sensor {
    /// A sensor with default settings.
    pub fn new(pattern: Pattern, path: PosePath) -> Self {
        Self { pattern, path, settings: SensorSettings::default() }
    }

    /// Fails where no such sensor can be.
    pub(super) fn check(&self) -> Result<(), SensorError> {
        self.pattern.check()?;
        self.path.check()?;
        self.settings.check()?;
        let Some(steps) = self.settings.time_steps else { return Ok(()) };
        let most = self.pattern.layout().most_steps();
        let expected = match most {
            1 => "1, for all beams are fired at once".to_owned(),
            _ => format!("1 to {most}, the lines of the pattern"),
        };
        let is_right = (1..=most).contains(&(steps as usize));
        ensure_value(is_right, "number of time steps", steps, expected)
    }
}

impl Default for SensorSettings {
    /// All ranges, no noise, no drop-outs, the first return, 2 % of dust on up to eight panes, a
    /// time step a line.
    fn default() -> Self {
        Self {
            min_range: 0.0,
            max_range: f32::INFINITY,
            noise: RangeNoise::default(),
            drop_out: DropOut::default(),
            min_intensity: 0.0,
            returns: Returns::First,
            dust: 0.02,
            panes: 8,
            seed: 0,
            time_steps: None,
        }
    }
}

impl SensorSettings {
    fn check(&self) -> Result<(), SensorError> {
        let (min, max) = (self.min_range, self.max_range);
        let is_right = min >= 0.0 && min.is_finite();
        ensure_value(is_right, "least range", min, "0 or more")?;
        ensure_value(max > min, "most range", max, format!("more than the least, {min}"))?;
        let at_least_0 = |what, value: f32| {
            ensure_value(value >= 0.0 && value.is_finite(), what, value, "0 or more")
        };
        at_least_0("noise", self.noise.constant)?;
        at_least_0("noise in proportion to the range", self.noise.proportional)?;
        at_least_0("least intensity", self.min_intensity)?;
        for (what, share) in [
            ("drop-out", self.drop_out.constant),
            ("drop-out at grazing incidence", self.drop_out.grazing),
            ("drop-out at the most range", self.drop_out.far),
            ("share of dust", self.dust),
        ] {
            ensure_value((0.0..=1.0).contains(&share), what, share, "0 to 1")?;
        }
        let is_right = self.drop_out.far == 0.0 || max.is_finite();
        ensure_value(is_right, "most range", max, "a finite one for drop-outs to grow towards")?;
        ensure_value(self.panes <= 64, "number of panes", self.panes, "64 at most")
    }

    /// The chance that an echo is lost.
    pub(super) fn drop_out_chance(&self, range: f32, cos: f32) -> f64 {
        let DropOut { constant, grazing, far } = self.drop_out;
        let sideways = f64::from(1.0 - cos).clamp(0.0, 1.0);
        let reach = f64::from(range / self.max_range);
        let kept = (1.0 - f64::from(constant))
            * (1.0 - f64::from(grazing) * sideways.powi(5))
            * (1.0 - f64::from(far) * reach * reach);
        1.0 - kept
    }

    /// The standard deviation of a range.
    pub(super) fn deviation(&self, range: f32) -> f32 {
        self.noise.constant + self.noise.proportional * range
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sensor::Pose;

    fn sensor(preset: &str) -> Sensor {
        Sensor::new(preset.parse().unwrap(), PosePath::Fixed(Pose::at(glam::Vec3::ZERO)))
    }

    #[test]
    fn settings_that_cannot_be_are_told_what_is_wrong() {
        let wrong = |change: fn(&mut SensorSettings), expected: &str| {
            let mut sensor = sensor("spinning:16");
            change(&mut sensor.settings);
            let message = sensor.check().unwrap_err().to_string();
            assert!(message.contains(expected), "{message}");
        };
        wrong(|s| s.min_range = -1.0, "the least range is -1, expected 0 or more");
        wrong(|s| (s.min_range, s.max_range) = (3.0, 3.0), "is 3, expected more than the least, 3");
        wrong(|s| s.max_range = f32::NAN, "the most range is NaN");
        wrong(|s| s.noise.constant = -0.1, "the noise is -0.1, expected 0 or more");
        wrong(|s| s.drop_out.grazing = 1.5, "grazing incidence is 1.5, expected 0 to 1");
        wrong(|s| s.drop_out.far = 0.5, "the most range is inf, expected a finite one");
        wrong(|s| s.dust = f32::NAN, "the share of dust is NaN, expected 0 to 1");
        wrong(|s| s.panes = 65, "panes is 65, expected 64 at most");
        wrong(|s| s.time_steps = Some(1025), "time steps is 1025, expected 1 to 1024");
        wrong(|s| s.time_steps = Some(0), "time steps is 0");
    }

    #[test]
    fn a_global_shutter_has_one_step() {
        let mut sensor = sensor("depth");
        sensor.settings.time_steps = Some(2);
        let message = sensor.check().unwrap_err().to_string();
        assert!(message.contains("is 2, expected 1, for all beams"), "{message}");
    }

    #[test]
    fn echoes_are_lost_aside_and_far_away() {
        let mut settings = SensorSettings { max_range: 10.0, ..SensorSettings::default() };
        assert_eq!(settings.drop_out_chance(9.0, 0.1), 0.0);
        settings.drop_out = DropOut { constant: 0.0, grazing: 1.0, far: 0.8 };
        assert_eq!(settings.drop_out_chance(0.0, 1.0), 0.0);
        assert_eq!(settings.drop_out_chance(0.0, 0.0), 1.0);
        assert!((settings.drop_out_chance(5.0, 1.0) - 0.2).abs() < 1e-7);
        settings.drop_out.constant = 0.5;
        assert!((settings.drop_out_chance(5.0, 1.0) - 0.6).abs() < 1e-7);
    }
}
