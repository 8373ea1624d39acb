//! First stage: walks from the lights leave virtual lights where they hit.
//!
//! All walks take their steps together, a batch through the engine each. A walk carries flux. At a
//! rough surface it leaves a light that sends on what the surface scatters; then it turns, as the
//! path tracer's paths do, or ends by chance (Russian roulette), so that what goes on carries as
//! much as before. Mirrors and glass only turn it.
//!
//! **Source**: A. Keller, *Instant Radiosity*, SIGGRAPH 1997; E. Veach, *Robust Monte Carlo Methods
//! for Light Transport Simulation*, 1997, sections 5.3 and 8.3, for walks from lights over shading
//! normals.
//!
//! **Invariants**: walk `i` always takes the same numbers, in whatever frame and among however many
//! threads; so lights stay where nothing moves. Energy is conserved: what lights leave and what is
//! absorbed add up to what sources send.
//!
//! **Cost**: a ray a walk and step; in a room whose walls send back half, two steps a walk.

use std::f32::consts::FRAC_1_PI;

use glam::Vec3;
use rayflock_engine::RayEngine;
use rayflock_geom::{Hit, HitBuffer, Ray, RayOrder};
use rayflock_scene::{Fresnel, Material};
use rayon::prelude::*;
use tracing::debug_span;

use super::sources::{Sources, Start};
use super::{Lobe, VirtualLight, VirtualLights};
use crate::frame_shading::FrameShading;
use crate::shading::sampling::PathSeed;
use crate::shading::scatter::{Scatter, scatter};
use crate::shading::surface_point::{SurfacePoint, surface_point};
use crate::shading::turns::{Chances, TurnKind, rough_direction};
use crate::stats::{StageStats, Stopwatch};
use crate::wave::{Path, Wave};

/// A walk that has not ended by chance after so many steps is cut off: in the brightest room that
/// is not a furnace, nothing is left by then.
const MAX_STEPS: u32 = 60;
/// Walks that one task moves on.
const RUN: usize = 512;
/// What comes in along a surface would leave a highlight without bound.
const GRAZING: f32 = 0.02;

/// What shooting took.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct ShootStats {
    /// Rays traced.
    pub(crate) rays: u64,
    /// What tracing took.
    pub(crate) traced: StageStats,
}

/// Working memory, kept from frame to frame.
#[derive(Debug, Default)]
pub(crate) struct ShootBuffers {
    wave: Wave,
    hits: HitBuffer,
    /// By walk: whether its flux grows on the way to the first hit.
    grows: Vec<bool>,
    runs: Vec<Run>,
    plain: Vec<VirtualLight>,
    lobed: Vec<(VirtualLight, Lobe)>,
    sky: Vec<VirtualLight>,
}

/// What some walks leave in one step.
#[derive(Debug, Default)]
struct Run {
    next: Wave,
    plain: Vec<VirtualLight>,
    lobed: Vec<(VirtualLight, Lobe)>,
}

/// Sends `walk_count` walks out; `lights` holds what they leave, and `sky_count` lights for the
/// background.
pub(crate) fn shoot(
    engine: &mut dyn RayEngine,
    frame: &FrameShading,
    sources: &Sources<'_>,
    (walk_count, sky_count): (u32, usize),
    reach: f32,
    buffers: &mut ShootBuffers,
    lights: &mut VirtualLights,
) -> ShootStats {
    let _span = debug_span!("shoot").entered();
    let mut stats = ShootStats::default();
    buffers.plain.clear();
    buffers.lobed.clear();
    start_walks(sources, walk_count, buffers);
    for step in 0..MAX_STEPS {
        if buffers.wave.len() == 0 {
            break;
        }
        buffers.hits.reset(buffers.wave.len());
        stats.rays += buffers.wave.len() as u64;
        let stopwatch = Stopwatch::start();
        let trace = engine.closest_hit(&buffers.wave.batch(), &mut buffers.hits.as_hits());
        stats.traced += StageStats { trace, seconds: stopwatch.seconds() };
        step_walks(frame, step, buffers);
    }
    sources.sky_lights(sky_count, &mut buffers.sky);
    lights.assign(reach, &buffers.plain, &buffers.lobed, &buffers.sky);
    stats
}

fn start_walks(sources: &Sources<'_>, walk_count: u32, buffers: &mut ShootBuffers) {
    let wave = &mut buffers.wave;
    wave.clear(0);
    wave.order = RayOrder::Unordered;
    buffers.grows.clear();
    for walk_idx in 0..walk_count {
        let seed = PathSeed::of_walks(walk_idx >> 16);
        let [choice, place0, place1, place2] = seed.unit_4_cube(walk_idx, 0);
        let [u, v, ..] = seed.unit_4_cube(walk_idx, 1);
        let start = sources.start(choice, [place0, place1, place2], [u, v]);
        buffers.grows.push(start.is_some_and(|start| start.grows));
        if let Some(Start { origin, direction, flux, .. }) = start {
            let weight = flux / walk_count as f32;
            wave.push(origin, direction, Path { weight, seed, pixel_idx: walk_idx, ..Path::NEW });
        }
    }
}

/// Moves all walks on to where they go from their hits.
fn step_walks(frame: &FrameShading, step: u32, buffers: &mut ShootBuffers) {
    let ShootBuffers { wave, hits, grows, runs, plain, lobed, .. } = buffers;
    let (batch, grows) = (wave.batch(), &grows[..]);
    runs.resize_with(wave.len().div_ceil(RUN).max(runs.len()), Run::default);
    runs.par_iter_mut().enumerate().for_each(|(run_idx, run)| {
        run.next.clear(step + 1);
        run.plain.clear();
        run.lobed.clear();
        let start = (run_idx * RUN).min(wave.len());
        for ray_idx in start..(start + RUN).min(wave.len()) {
            let mut path = wave.paths[ray_idx];
            let (ray, hit) = (batch.ray(ray_idx), hits.get(ray_idx));
            if step == 0 && grows[path.pixel_idx as usize] {
                path.weight *= hit.t * hit.t;
            }
            run.step(frame, step, &ray, &hit, path);
        }
    });
    wave.clear(step + 1);
    wave.order = RayOrder::Unordered;
    for run in runs {
        wave.origins.extend_from_slice(&run.next.origins);
        wave.directions.extend_from_slice(&run.next.directions);
        wave.paths.extend_from_slice(&run.next.paths);
        plain.extend_from_slice(&run.plain);
        lobed.extend_from_slice(&run.lobed);
    }
}

/// A walk at a surface.
struct Arrival<'a> {
    path: Path,
    point: SurfacePoint,
    material: &'a Material,
    scatter: Scatter,
    highlight: Vec3,
    /// Where the light comes from.
    to_source: Vec3,
    /// The flux that a rough surface gets to scatter, over that which arrives: shading normals
    /// take more or less than the facet that is hit.
    taken: f32,
    /// Cosine of the angle to the facet's normal.
    cos: f32,
}

impl Run {
    fn step(&mut self, frame: &FrameShading, step: u32, ray: &Ray, hit: &Hit, mut path: Path) {
        let Some(point) = surface_point(frame, ray, hit) else { return };
        path.weight *= (-path.absorption * hit.t).exp();
        if !path.weight.is_finite() || path.weight.max_element() <= 0.0 {
            return;
        }
        let arrival = Arrival::new(frame, point, ray.direction, path);
        self.leave_light(&arrival);
        if step + 1 < MAX_STEPS
            && let Some((origin, direction, next)) = arrival.turn(step)
        {
            self.next.push(origin, direction, next);
        }
    }

    fn leave_light(&mut self, arrival: &Arrival<'_>) {
        let Arrival { path, point, scatter, highlight, .. } = arrival;
        let diffuse = path.weight * scatter.diffuse;
        if diffuse == Vec3::ZERO && *highlight == Vec3::ZERO {
            return;
        }
        let intensity = diffuse * (arrival.taken * FRAC_1_PI);
        let light = VirtualLight::matte(point.shadow_position, point.facet_normal, intensity);
        let varnish = arrival.varnish();
        if *highlight == Vec3::ZERO && varnish == 0.0 {
            self.plain.push(light);
            return;
        }
        let lobe = Lobe {
            to_source: arrival.to_source,
            highlight: path.weight * *highlight * (FRAC_1_PI / arrival.cos.max(GRAZING)),
            shininess: arrival.material.shininess.max(0.0),
            varnish,
        };
        self.lobed.push((light, lobe));
    }
}

impl<'a> Arrival<'a> {
    fn new(frame: &'a FrameShading, point: SurfacePoint, direction: Vec3, path: Path) -> Self {
        let material = frame.material(point.material);
        let base = frame.base_color(&point);
        let mut scatter = scatter(material, &point, base, direction);
        let mut highlight = material.specular;
        // Fresnel keeps light back on its way to the eye, not on its way in.
        let kept = scatter.conserve(&mut highlight, material.shininess);
        scatter.diffuse = material.diffuse * base * kept;
        let to_source = -direction;
        let cos = to_source.dot(point.facet_normal).max(0.0);
        let taken = to_source.dot(point.normal).max(0.0) / cos.max(GRAZING);
        Self { path, point, material, scatter, highlight, to_source, taken, cos }
    }

    /// How much of the diffuse light varnish keeps back from grazing looks.
    fn varnish(&self) -> f32 {
        match self.material.fresnel {
            Fresnel::Constant => 0.0,
            Fresnel::Schlick => crate::shading::fresnel::schlick(self.material.mirror, 0.0),
            Fresnel::Dielectric => 1.0,
        }
    }

    /// Origin, direction and path after this step, if the walk goes on.
    fn turn(&self, step: u32) -> Option<(Vec3, Vec3, Path)> {
        let Self { path, point, material, scatter, .. } = self;
        let shininess = material.shininess;
        let chances = Chances::new(path.weight, scatter, self.highlight, shininess);
        let random = path.seed.unit_4_cube(path.pixel_idx, step + 2);
        let is_inside = !point.from_outside && material.transmission != Vec3::ZERO;
        let (origin, direction, share, absorption) = match chances.choose(random[0])? {
            TurnKind::Rough { is_highlight } => {
                let (direction, share) =
                    self.rough_turn(&chances, is_highlight, [random[1], random[2]])?;
                (point.above(), direction, share, path.absorption)
            }
            TurnKind::Mirror => {
                let absorption = if is_inside { material.absorption } else { path.absorption };
                let share = scatter.mirror / chances.mirror;
                (point.above(), scatter.mirror_direction, share, absorption)
            }
            TurnKind::Refraction => {
                let absorption = if point.from_outside { material.absorption } else { Vec3::ZERO };
                let share = scatter.transmission / chances.refraction;
                (point.below(), scatter.refraction_direction, share, absorption)
            }
        };
        // As bright as before, or not at all.
        let weight = path.weight * share;
        let staying = (weight.max_element() / path.weight.max_element()).min(1.0);
        let goes_on = staying > 0.0 && random[3] < staying;
        goes_on.then(|| (origin, direction, Path { weight: weight / staying, absorption, ..*path }))
    }

    /// A direction into which a rough surface scatters, and what goes there over the density.
    fn rough_turn(
        &self,
        chances: &Chances,
        is_highlight: bool,
        random: [f32; 2],
    ) -> Option<(Vec3, Vec3)> {
        let (normal, shininess) = (self.point.normal, self.material.shininess);
        let direction = rough_direction(is_highlight, normal, self.to_source, shininess, random)?;
        let cos = direction.dot(self.point.facet_normal);
        if cos <= 0.0 {
            return None;
        }
        let halfway = (self.to_source + direction).normalize_or_zero();
        let spread = normal.dot(halfway).max(0.0).powf(shininess.max(0.0));
        let sideways = (1.0 - cos).max(0.0);
        let let_out = 1.0 - self.varnish() * sideways.powi(5);
        let sent = self.scatter.diffuse * (self.taken * let_out)
            + self.highlight * (spread / self.cos.max(GRAZING));
        let density = chances.density(normal, self.to_source, shininess, direction);
        Some((direction, sent * (cos * FRAC_1_PI / density)))
    }
}

impl ShootBuffers {
    /// Bytes held.
    pub(crate) fn memory_usage(&self) -> usize {
        let lights = self.plain.capacity() * size_of::<VirtualLight>()
            + self.lobed.capacity() * size_of::<(VirtualLight, Lobe)>();
        self.wave.memory_usage() + 2 * lights + self.grows.capacity()
    }
}

#[cfg(test)]
mod tests {
    use std::f32::consts::PI;
    use std::sync::Arc;

    use rayflock_engine::{EngineKind, create};
    use rayflock_geom::{FrameChanges, Mesh, Sphere};
    use rayflock_scene::{
        Background, Evaluator, Falloff, LightKind, MaterialIdx, Scene, SceneObject, Shape,
        SurfaceMesh,
    };

    use super::*;

    const ALBEDO: f32 = 0.6;

    /// A hollow ball of radius 2, matte inside, with a ball of `material` in it.
    fn hollow_ball(material: Material) -> Scene {
        let white = Vec3::splat(ALBEDO);
        let wall = Material { diffuse: white, ..Material::default() };
        let object = |center: Vec3, radius: f32, idx: u32| {
            let mesh = Mesh::from_spheres(vec![Sphere::new(center, radius)]);
            let shape = Shape::Fixed(SurfaceMesh::new(mesh, MaterialIdx(idx)));
            SceneObject { name: String::new(), node: None, mask: u32::MAX, shape }
        };
        Scene {
            materials: vec![wall, material],
            objects: vec![object(Vec3::ZERO, 2.0, 0), object(Vec3::X, 0.5, 1)],
            ..Scene::default()
        }
    }

    /// What all virtual lights send out, over what `light` sends.
    fn sent(scene: &Scene, light: LightKind, flux: f32) -> f32 {
        let mut evaluator = Evaluator::new(Arc::new(scene.clone()), None).unwrap();
        let frame = evaluator.evaluate(0.0).unwrap();
        let shading = FrameShading::new(scene, frame).unwrap();
        let mut engine = create(EngineKind::Brute);
        engine.commit(&frame.geometry, &FrameChanges::all()).unwrap();
        let (lights, bounds) = ([light], frame.geometry.bounds());
        let black = Background::default();
        let sources = Sources::new(&lights, &shading.lights.emitters, black, &bounds);
        let mut virtual_lights = VirtualLights::default();
        let mut buffers = ShootBuffers::default();
        let counts = (4096, 16);
        shoot(&mut *engine, &shading, &sources, counts, 1.0, &mut buffers, &mut virtual_lights);
        assert!(virtual_lights.distant().is_empty());
        virtual_lights.intensities().iter().map(|intensity| PI * intensity.x).sum::<f32>() / flux
    }

    fn lamp(falloff: Falloff) -> LightKind {
        LightKind::Point { position: Vec3::NEG_X, intensity: Vec3::splat(3.0), falloff }
    }

    #[test]
    fn walks_leave_as_much_as_is_scattered() {
        let black = Material { diffuse: Vec3::ZERO, ..Material::default() };
        let glass =
            Material { transmission: Vec3::ONE, fresnel: Fresnel::Dielectric, ..black.clone() };
        let mirror = Material { mirror: Vec3::ONE, ..black };
        // Neither mirror nor glass takes anything; the wall scatters its share again and again.
        let expected = ALBEDO / (1.0 - ALBEDO);
        for material in [mirror, glass] {
            let scene = hollow_ball(material);
            let found = sent(&scene, lamp(Falloff::InverseSquare), 12.0 * PI);
            assert!((found / expected - 1.0).abs() < 0.03, "{found} instead of {expected}");
        }
    }

    #[test]
    fn a_spot_sends_what_its_cone_holds_and_a_constant_light_what_arrives() {
        let matte = Material { diffuse: Vec3::splat(ALBEDO), ..Material::default() };
        let scene = hollow_ball(matte);
        let expected = ALBEDO / (1.0 - ALBEDO);
        let cos = 0.9;
        let spot = LightKind::Spot {
            position: Vec3::NEG_X,
            direction: Vec3::Y,
            intensity: Vec3::splat(3.0),
            cos_inner: cos + 1e-4,
            cos_outer: cos,
        };
        let found = sent(&scene, spot, 3.0 * 2.0 * PI * (1.0 - cos));
        assert!((found / expected - 1.0).abs() < 0.03, "{found} instead of {expected}");
        // Irradiance 3 on every surface that faces the light, at whatever distance: from the
        // middle of an empty ball it is that of all its surface.
        let mut hollow = scene;
        hollow.objects.pop();
        let (intensity, falloff) = (Vec3::splat(3.0), Falloff::Constant);
        let middle = LightKind::Point { position: Vec3::ZERO, intensity, falloff };
        let found = sent(&hollow, middle, 3.0 * 4.0 * PI * 4.0);
        assert!((found / expected - 1.0).abs() < 0.03, "{found} instead of {expected}");
    }
}
