//! Last stage: points that lights may light get the light of photons too.
//!
//! Of what a surface sends back, the diffuse share; highlights of what mirrors and glass throw are
//! left out.

use std::f32::consts::FRAC_1_PI;

use glam::Vec3;
use rayon::prelude::*;
use tracing::debug_span;

use super::photon_map::PhotonMap;
use crate::wave::{Contribution, ShadedRun};

/// Adds to what needs no shadow ray.
pub(super) fn gather(map: &PhotonMap, runs: &mut [ShadedRun]) {
    let _span = debug_span!("gather_photons").entered();
    runs.par_iter_mut().for_each(|run| {
        for point in &run.points {
            if point.diffuse == Vec3::ZERO {
                continue;
            }
            let irradiance = map.irradiance(point.shadow_position, point.normal);
            if irradiance != Vec3::ZERO {
                let radiance = point.diffuse * irradiance * FRAC_1_PI;
                run.unshadowed.push(Contribution { pixel_idx: point.pixel_idx, radiance });
            }
        }
    });
}
