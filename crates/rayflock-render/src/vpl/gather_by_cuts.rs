//! Gathering by cuts through the tree of lights.
//!
//! **Source**: see [`lightcuts`](crate::lightcuts).
//!
//! **Departures** from [`gather`](super::gather): what the bound keeps away is not known, as most
//! lights are not looked at.

use glam::Vec3;

use super::VirtualLights;
use super::gather::GatherStats;
use crate::lightcuts::{CutPoint, CutSettings, CutStats, CutVisibility, Lightcuts};
use crate::wave::{Contribution, LitPoint, ShadedRun};

/// The tree over the lights, and working memory, kept from wave to wave.
#[derive(Debug, Default)]
pub(crate) struct CutGatherer {
    cuts: Lightcuts,
    is_current: bool,
    points: Vec<CutPoint>,
    radiances: Vec<Vec3>,
}

impl CutGatherer {
    /// The lights have changed.
    pub(crate) fn invalidate(&mut self) {
        self.is_current = false;
    }

    /// Makes the tree of `lights`, if it is not there yet.
    pub(crate) fn commit(&mut self, lights: &VirtualLights, error_bound: f32, bound: f32) {
        let settings = CutSettings { error_bound, geometry_bound: bound, ..CutSettings::default() };
        self.cuts.set(settings);
        if !self.is_current {
            self.cuts.commit(lights);
            self.is_current = true;
        }
    }

    /// Gathers the light of `lights` at all points of `runs`; see
    /// [`gather`](super::gather::gather).
    pub(crate) fn gather(
        &mut self,
        lights: &VirtualLights,
        visibility: &mut dyn CutVisibility,
        runs: &mut [ShadedRun],
    ) -> (GatherStats, CutStats) {
        self.points.clear();
        self.points.extend(runs.iter().flat_map(|run| &run.points).map(cut_point));
        self.radiances.clear();
        self.radiances.resize(self.points.len(), Vec3::ZERO);
        let cuts = self.cuts.gather(lights, &self.points, visibility, &mut self.radiances);

        let mut radiances = self.radiances.iter();
        for ShadedRun { points, lit, .. } in runs {
            lit.clear();
            lit.extend(
                points.iter().zip(&mut radiances).map(|(point, &radiance)| Contribution {
                    pixel_idx: point.pixel_idx,
                    radiance,
                }),
            );
        }
        let sums = self.radiances.iter().map(|radiance| f64::from(radiance.element_sum()));
        let gathered = sums.filter(|sum| sum.is_finite()).sum();
        (GatherStats { visibility: cuts.visibility, gathered, lost: 0.0 }, cuts)
    }

    /// Bytes held.
    pub(crate) fn memory_usage(&self) -> usize {
        self.cuts.memory_usage()
            + self.points.capacity() * size_of::<CutPoint>()
            + self.radiances.capacity() * size_of::<Vec3>()
    }
}

fn cut_point(point: &LitPoint) -> CutPoint {
    let LitPoint { normal, to_viewer, diffuse, specular, shininess, .. } = *point;
    CutPoint { position: point.shadow_position, normal, to_viewer, diffuse, specular, shininess }
}
