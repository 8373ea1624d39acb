//! What a study found, for everything that tells it.

use glam::Vec3;
use rayflock::render::sun::{Sampling, SunStep, WorldMesh};

use crate::false_color::ColorScale;

/// What a study found.
#[derive(Debug)]
pub(super) struct SunHours<'a> {
    /// The scene in its first frame, in world space.
    pub(super) mesh: WorldMesh,
    /// Where hours are told.
    pub(super) sampling: Sampling,
    /// Where the samples are in the first frame, in world space.
    pub(super) positions: Vec<Vec3>,
    /// Hours of each sample; `hours.len() == positions.len()`.
    pub(super) hours: Vec<f64>,
    /// The steps in which the sun was up.
    pub(super) steps: &'a [SunStep],
    /// Hours told for one second of sun.
    pub(super) hours_per_second: f64,
    /// Whether hours are told a day.
    pub(super) is_average: bool,
}

impl SunHours<'_> {
    /// The least and the most hours.
    pub(super) fn range(&self) -> (f64, f64) {
        let least = self.hours.iter().copied().fold(f64::INFINITY, f64::min);
        (least, self.hours.iter().copied().fold(0.0, f64::max))
    }

    /// The mean over all samples, each as good as any other.
    pub(super) fn mean(&self) -> f64 {
        self.hours.iter().sum::<f64>() / self.hours.len().max(1) as f64
    }

    /// The colours of the hours.
    pub(super) fn color_scale(&self) -> ColorScale {
        let (least, most) = self.range();
        ColorScale::new(least, most)
    }

    /// What samples are called.
    pub(super) const fn sample_name(&self) -> &'static str {
        match self.sampling {
            Sampling::Faces => "faces",
            Sampling::Vertices => "vertices",
        }
    }

    /// What the hours are called.
    pub(super) const fn unit(&self) -> &'static str {
        if self.is_average { "hours/day" } else { "hours" }
    }
}
