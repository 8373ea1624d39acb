//! Light that mirrors and glass throw onto rough surfaces: photons from lights, gathered wherever
//! rays from the camera find something rough.
//!
//! 1. **light_views**: what a light sees of the things that mirror or let light through is a
//!    window of texels, as a camera's picture is. A ray through the middle of each texel carries
//!    the flux that passes through the texel.
//! 2. **shoot** follows these rays as those of the camera are followed, by mirrors and through
//!    glass, as deep and down to the same weight. Where one arrives at a rough surface after at
//!    least one turn, it leaves a photon.
//! 3. **photon_map** sorts the photons into cells of space.
//! 4. **gather** estimates, at each point that lights may light, the irradiance by the photons
//!    within a radius.
//!
//! **Source.** H. W. Jensen, "Global Illumination using Photon Maps", EGWR 1996, for the caustic
//! map and the estimate; L. Szecsi, "The Hierarchical Ray Engine", WSCG 2006, for the light's view
//! as the place that rays are traced from; B. W. Silverman, *Density Estimation for Statistics and
//! Data Analysis*, 1986, section 4.2, for the kernel, which is Epanechnikov's.
//!
//! **Departures.** Photons are not left to chance, so they stay where nothing moves, and films do
//! not flicker there. The radius is fixed and not that of the nearest so many, so that a photon
//! counts the same for all points. No photon is left where light of the lamp itself arrives, nor
//! scattered on.
//!
//! **Invariants.** The map does not depend on the engine, the number of threads or the limit of
//! batches. What turns lose at surfaces and in glass is lost; the flux of all photons is the rest,
//! but for paths that are not worth following.
//!
//! **Cost.** A ray a texel and turn, 104 bytes a photon and up to 8 for its cell; a test for each photon in up to eight
//! cells, of twice the radius, for each point.

mod gather;
mod light_views;
mod photon_map;
mod shoot;
#[cfg(test)]
mod tests;

use rayflock_engine::RayEngine;
use rayflock_geom::Aabb;
use rayflock_scene::LightKind;

use self::gather::gather;
pub use self::light_views::{LightView, light_views};
use self::photon_map::PhotonMap;
use self::shoot::{ShootBuffers, shoot};
use crate::frame_shading::FrameShading;
use crate::stats::{FrameStats, Stopwatch};
use crate::wave::ShadedRun;

/// How light that mirrors and glass throw is found. Values out of range are taken as the nearest
/// one in range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CausticSettings {
    /// About how many rays leave each light, `64..=2^22`: a square number, or six where the light
    /// is among the things that mirror.
    pub photons: u32,
    /// How far from a point photons count, as a share of the diagonal of the scene, from a
    /// hundred-thousandth to a half. Wider is smoother and blurs more.
    pub radius: f32,
}

impl Default for CausticSettings {
    /// `2^16` rays a light, and a hundredth of the diagonal.
    fn default() -> Self {
        Self { photons: 1 << 16, radius: 0.01 }
    }
}

impl CausticSettings {
    /// The same settings with every value in its range.
    pub(crate) fn clamped(&self) -> Self {
        let radius = if self.radius.is_nan() { Self::default().radius } else { self.radius };
        Self { photons: self.photons.clamp(64, 1 << 22), radius: radius.clamp(1e-5, 0.5) }
    }
}

/// What rays are traced from lights with.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shooting<'a> {
    pub(crate) frame: &'a FrameShading,
    pub(crate) lights: &'a [LightKind],
    /// Of all geometry.
    pub(crate) bounds: &'a Aabb,
    pub(crate) settings: CausticSettings,
    /// Whether surfaces that would send back more light than arrives are scaled down.
    pub(crate) conserves: bool,
    /// Turns that a path may take.
    pub(crate) depth: u32,
    /// Rays that are traced together at most.
    pub(crate) batch_rays: usize,
}

/// A caustic map and the memory to make it, kept from picture to picture.
#[derive(Debug, Default)]
pub(crate) struct Caustics {
    map: PhotonMap,
    shoot: ShootBuffers,
}

impl Caustics {
    /// Forgets all photons.
    pub(crate) fn clear(&mut self) {
        self.map.clear();
    }

    /// Leaves photons anew.
    pub(crate) fn shoot(
        &mut self,
        engine: &mut dyn RayEngine,
        shooting: &Shooting<'_>,
        stats: &mut FrameStats,
    ) {
        let stopwatch = Stopwatch::start();
        let radius = shooting.settings.radius * shooting.bounds.size().length();
        self.map.clear();
        // Without extent there is nothing to throw light, or nothing to throw it onto.
        if radius > 0.0 && radius.is_finite() {
            shoot(engine, shooting, &mut self.shoot, self.map.photons_mut(), stats);
            self.map.sort(radius);
        }
        stats.caustics.photons = self.map.photons().len() as u64;
        stats.caustics.shoot_seconds += stopwatch.seconds();
    }

    /// Adds what photons bring to the points of the current wave.
    pub(crate) fn gather(&self, runs: &mut [ShadedRun], stats: &mut FrameStats) {
        if self.map.photons().is_empty() {
            return;
        }
        let stopwatch = Stopwatch::start();
        gather(&self.map, runs);
        stats.caustics.gather_seconds += stopwatch.seconds();
    }

    /// Bytes held.
    pub(crate) fn memory_usage(&self) -> usize {
        self.map.memory_usage() + self.shoot.memory_usage()
    }
}
