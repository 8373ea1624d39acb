//! Beams through the scene, and the echo of each surface that they meet.
//!
//! A beam that meets a surface which lets light through goes on in the next pass: the same ray,
//! with an interval that begins just behind. So rays keep sharing their origin, or their
//! direction, however many panes they have passed. Of two surfaces at exactly the same place, the
//! second is not met.

use glam::Vec3;
use rayflock_engine::{RayEngine, TraceStats};
use rayflock_geom::{HitBuffer, RayBatch, RayOrder};
use rayflock_scene::{Fresnel, Material};
use rayon::prelude::*;
use tracing::debug_span;

use super::SensorSettings;
use crate::frame_shading::FrameShading;
use crate::shading::fresnel;
use crate::shading::luminance::luminance;
use crate::shading::surface_point::surface_point;

/// Rays whose echoes one task works out; fewer are not worth sharing.
const RAYS_PER_TASK: usize = 1024;

/// The beams of a step on their way.
#[derive(Debug, Default)]
pub(crate) struct BeamWave {
    /// The origin or the direction of all rays.
    pub(crate) common: Common,
    /// The direction or the origin of each ray.
    pub(crate) varying: Vec<Vec3>,
    /// The beam that each ray is.
    pub(crate) beam_idxs: Vec<u32>,
    /// Where the interval of each ray begins.
    t_min: Vec<f32>,
    /// The share of light that comes back through what each ray has passed.
    shares: Vec<f32>,
    pub(crate) order: RayOrder,
    hits: HitBuffer,
    met: Vec<Option<Met>>,
}

/// What all beams of a step share.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Common {
    Origin(Vec3),
    Direction(Vec3),
}

impl Default for Common {
    fn default() -> Self {
        Self::Origin(Vec3::ZERO)
    }
}

/// What a beam met.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Echo {
    pub(crate) beam_idx: u32,
    /// Distance along the beam.
    pub(crate) range: f32,
    /// How much light comes back.
    pub(crate) intensity: f32,
    /// Cosine of incidence.
    pub(crate) cos: f32,
    /// Facet normal on the sensor's side.
    pub(crate) normal: Vec3,
    pub(crate) object_id: u32,
    pub(crate) prim_id: u32,
}

/// An echo, and what share of light goes on.
#[derive(Clone, Copy, Debug)]
struct Met {
    echo: Echo,
    passing: f32,
}

impl BeamWave {
    /// Traces all beams and adds their echoes, in the order of beams and then of ranges. No ray is
    /// left.
    pub(crate) fn trace(
        &mut self,
        engine: &mut dyn RayEngine,
        shading: &FrameShading,
        settings: &SensorSettings,
        echoes: &mut Vec<Echo>,
    ) -> TraceStats {
        let _span = debug_span!("trace_beams").entered();
        echoes.clear();
        self.t_min.clear();
        self.t_min.resize(self.varying.len(), 0.0);
        self.shares.clear();
        self.shares.resize(self.varying.len(), 1.0);
        let mut stats = TraceStats::default();
        for pass in 0..=settings.panes {
            if self.varying.is_empty() {
                break;
            }
            stats += self.ask(engine, settings.max_range);
            self.meet(shading, settings);
            echoes.extend(self.met.iter().flatten().map(|met| met.echo));
            self.keep_those_behind_glass();
            if pass > 0 {
                // Stable: a beam's echoes stay in the order of their ranges.
                echoes.sort_by_key(|echo| echo.beam_idx);
            }
        }
        stats
    }

    /// The nearest hit of each ray.
    fn ask(&mut self, engine: &mut dyn RayEngine, t_max: f32) -> TraceStats {
        let mut hits = std::mem::take(&mut self.hits);
        hits.reset(self.varying.len());
        let stats = engine.closest_hit(&self.batch(t_max), &mut hits.as_hits());
        self.hits = hits;
        stats
    }

    fn batch(&self, t_max: f32) -> RayBatch<'_> {
        let varying = &self.varying;
        let batch = match self.common {
            Common::Origin(origin) => RayBatch::new(origin, varying),
            Common::Direction(direction) => RayBatch::new(varying, direction),
        };
        let batch = batch.and_then(|batch| batch.with_interval(&self.t_min, t_max));
        let Ok(batch) = batch else { unreachable!("the columns of a wave have one length") };
        batch.with_order(self.order)
    }

    /// Works out what each ray met.
    fn meet(&mut self, shading: &FrameShading, settings: &SensorSettings) {
        let mut met = std::mem::take(&mut self.met);
        let rays = (0..self.varying.len()).into_par_iter().with_min_len(RAYS_PER_TASK);
        let batch = self.batch(settings.max_range);
        let meet = |ray_idx: usize| self.met_by(ray_idx, &batch, shading, settings.dust);
        rays.map(meet).collect_into_vec(&mut met);
        self.met = met;
    }

    fn met_by(
        &self,
        ray_idx: usize,
        batch: &RayBatch<'_>,
        shading: &FrameShading,
        dust: f32,
    ) -> Option<Met> {
        let (ray, hit) = (batch.ray(ray_idx), self.hits.get(ray_idx));
        let point = surface_point(shading, &ray, &hit)?;
        let cos = (-ray.direction.dot(point.facet_normal)).clamp(0.0, 1.0);
        let material = shading.material(point.material);
        let color = shading.base_color(&point);
        let surface = Shares::of(material, color, cos, dust);
        let share = self.shares[ray_idx];
        let echo = Echo {
            beam_idx: self.beam_idxs[ray_idx],
            range: hit.t,
            intensity: share * surface.scattered * cos / (hit.t * hit.t).max(f32::MIN_POSITIVE),
            cos,
            normal: point.facet_normal,
            object_id: hit.object_id.0,
            prim_id: hit.prim_id.0,
        };
        Some(Met { echo, passing: share * surface.passing * surface.passing })
    }

    /// Keeps the rays that go on, from behind what they met.
    fn keep_those_behind_glass(&mut self) {
        let mut kept = 0;
        for (ray_idx, met) in self.met.iter().enumerate() {
            let Some(met) = met.filter(|met| met.passing > 0.0) else { continue };
            self.varying[kept] = self.varying[ray_idx];
            self.beam_idxs[kept] = self.beam_idxs[ray_idx];
            self.t_min[kept] = met.echo.range.next_up();
            self.shares[kept] = met.passing;
            kept += 1;
        }
        self.varying.truncate(kept);
        self.beam_idxs.truncate(kept);
        self.t_min.truncate(kept);
        self.shares.truncate(kept);
        self.order = RayOrder::Coherent;
    }
}

/// What becomes of the light of a beam at a surface.
struct Shares {
    /// Scattered, as from a matte surface.
    scattered: f32,
    /// Let through.
    passing: f32,
}

impl Shares {
    fn of(material: &Material, color: Vec3, cos: f32, dust: f32) -> Self {
        // What a surface mirrors at this angle it neither scatters nor lets through.
        let kept = match material.fresnel {
            Fresnel::Constant => 1.0,
            Fresnel::Schlick => 1.0 - fresnel::schlick(material.mirror, cos),
            // Beams go straight through, as if always from outside.
            Fresnel::Dielectric => 1.0 - fresnel::dielectric(cos, material.ior.max(1.0).recip()),
        };
        let passing = (kept * luminance(material.transmission)).clamp(0.0, 1.0);
        let scattered = (kept * luminance(material.diffuse * color)).max(0.0);
        let scattered = if passing > 0.0 { scattered.max(dust) } else { scattered };
        Self { scattered, passing }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dust_is_on_glass_alone() {
        let glass = Material {
            diffuse: Vec3::ZERO,
            transmission: Vec3::ONE,
            fresnel: Fresnel::Dielectric,
            ..Material::default()
        };
        let shares = Shares::of(&glass, Vec3::ONE, 1.0, 0.02);
        assert_eq!(shares.scattered, 0.02);
        assert!((shares.passing - 0.96).abs() < 1e-5);
        assert!((0.42..0.44).contains(&Shares::of(&glass, Vec3::ONE, 0.1, 0.02).passing));
        let black = Material { diffuse: Vec3::ZERO, ..Material::default() };
        let shares = Shares::of(&black, Vec3::ONE, 1.0, 0.02);
        assert_eq!((shares.scattered, shares.passing), (0.0, 0.0));
        let red = Material { diffuse: Vec3::X, ..Material::default() };
        assert!((Shares::of(&red, Vec3::ONE, 1.0, 0.0).scattered - 0.2126).abs() < 1e-6);
    }
}
