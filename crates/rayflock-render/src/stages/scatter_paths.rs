//! Turns hits into light, lit points, and the one ray with which each path goes on.
//!
//! The stage of the path tracer in place of `shade_surface`: nothing stands for light from
//! elsewhere, since paths find it. What a path meets that emits counts for as much as was left to
//! it by the shadow rays toward emitters (the balance heuristic of E. Veach, *Robust Monte Carlo
//! Methods for Light Transport Simulation*, 1997, section 9.2). Where surfaces would send back
//! more light than arrives they are scaled down.

use glam::Vec3;
use rayflock_geom::{Hit, HitBuffer, Ray, RayBatch};
use rayflock_scene::Material;
use tracing::debug_span;

use super::runs::begin_runs;
use super::shade_surface::Surroundings;
use crate::shading::background;
use crate::shading::sampling::Turn;
use crate::shading::scatter::{Scatter, reflected, scatter};
use crate::shading::surface_point::{SurfacePoint, surface_point};
use crate::shading::turns::{Chances, TurnKind, rough_direction};
use crate::wave::{Contribution, LitPoint, Path, ShadedRun, Wave};

/// Turns after which a path that carries little may end by chance.
const SURE_TURNS: u32 = 3;

/// Shades every ray of `wave`, at position `sample_idx` of the samples of its pixel; `runs` holds
/// the results in the order of the rays, the rays of the next bounce in `mirror`.
pub(crate) fn scatter_paths(
    surroundings: &Surroundings<'_>,
    sample_idx: u32,
    wave: &Wave,
    hits: &HitBuffer,
    runs: &mut Vec<ShadedRun>,
) {
    let _span = debug_span!("scatter_paths").entered();
    let batch = wave.batch();
    begin_runs(wave, runs, |rays, run| {
        let course = Course { surroundings, sample_idx, bounce: wave.bounce };
        for ray_idx in rays {
            course.shade_ray(&batch, &wave.paths[ray_idx], &hits.get(ray_idx), ray_idx, run);
        }
    });
}

/// What the rays of a wave have in common.
struct Course<'a> {
    surroundings: &'a Surroundings<'a>,
    sample_idx: u32,
    bounce: u32,
}

impl Course<'_> {
    fn shade_ray(
        &self,
        batch: &RayBatch<'_>,
        path: &Path,
        hit: &Hit,
        ray_idx: usize,
        run: &mut ShadedRun,
    ) {
        let ray = batch.ray(ray_idx);
        let frame = self.surroundings.frame;
        let mut path = *path;
        let Some(point) = surface_point(frame, &ray, hit) else {
            let sky = background::radiance(&self.surroundings.background, ray.direction);
            push(path.pixel_idx, path.weight * sky, run);
            return;
        };
        let length = ray.direction.length();
        path.weight *= (-path.absorption * (hit.t * length)).exp();

        let material = frame.material(point.material);
        if material.emission != Vec3::ZERO {
            let share = self.emission_share(&path, &ray, &point, hit, material.emission);
            push(path.pixel_idx, path.weight * material.emission * share, run);
        }

        // What lights may add, and where the path goes on.
        let goes_on = self.bounce < self.surroundings.depth;
        let mut scatter =
            scatter(material, &point, frame.base_color(&point), ray.direction / length);
        let mut highlight = material.specular;
        scatter.conserve(&mut highlight, material.shininess);
        let chances = Chances::new(path.weight, &scatter, highlight, material.shininess);
        let lit = LitPoint {
            shadow_position: point.shadow_position,
            normal: point.normal,
            to_viewer: -ray.direction.normalize_or_zero(),
            diffuse: path.weight * scatter.diffuse,
            specular: path.weight * highlight,
            shininess: material.shininess,
            pixel_idx: path.pixel_idx,
            seed: path.seed,
        };
        // A path that ends here leaves all light of emitters to shadow rays.
        let chances = if goes_on { chances } else { Chances::NONE };
        if lit.diffuse != Vec3::ZERO || lit.specular != Vec3::ZERO {
            run.points.push(lit);
            run.chances.push(chances);
        }
        if goes_on {
            self.turn(&path, &point, material, &scatter, (&lit, &chances), &mut run.mirror);
        }
    }

    /// What is left to the path of the light of an emitter that it met.
    fn emission_share(
        &self,
        path: &Path,
        ray: &Ray,
        point: &SurfacePoint,
        hit: &Hit,
        emission: Vec3,
    ) -> f32 {
        let frame = self.surroundings.frame;
        let Some(object) = frame.object(hit.object_id).filter(|_| path.density > 0.0) else {
            return 1.0;
        };
        let emitters = &frame.lights.emitters;
        let by_light = emitters.density(object, hit.prim_id, emission, ray.origin, point.position);
        path.density / (path.density + by_light)
    }

    /// Adds the ray of the next bounce, if the path goes on.
    fn turn(
        &self,
        path: &Path,
        point: &SurfacePoint,
        material: &Material,
        scatter: &Scatter,
        (lit, chances): (&LitPoint, &Chances),
        wave: &mut Wave,
    ) {
        let random = path.seed.unit_4_cube(self.sample_idx, self.bounce);
        let Some(kind) = chances.choose(random[0]) else { return };
        let Some((origin, direction, mut next)) =
            turned(kind, [random[1], random[2]], path, point, material, scatter, (lit, chances))
        else {
            return;
        };
        if self.bounce >= SURE_TURNS {
            let staying = next.weight.max_element().clamp(0.05, 1.0);
            if random[3] >= staying {
                return;
            }
            next.weight /= staying;
        }
        if next.weight.max_element() > 0.0 {
            wave.push(origin, direction, next);
        }
    }
}

/// Origin, direction and path after a turn of this kind.
fn turned(
    kind: TurnKind,
    random: [f32; 2],
    path: &Path,
    point: &SurfacePoint,
    material: &Material,
    scatter: &Scatter,
    (lit, chances): (&LitPoint, &Chances),
) -> Option<(Vec3, Vec3, Path)> {
    let seed = path.seed.after(Turn::Chance);
    match kind {
        TurnKind::Rough { is_highlight } => {
            let (normal, to_viewer) = (lit.normal, lit.to_viewer);
            let direction =
                rough_direction(is_highlight, normal, to_viewer, lit.shininess, random)?;
            if direction.dot(point.facet_normal) <= 0.0 {
                return None;
            }
            let density = chances.density(normal, to_viewer, lit.shininess, direction);
            let sent =
                reflected(lit.diffuse, lit.specular, lit.shininess, normal, to_viewer, direction);
            let weight = sent / density;
            Some((point.above(), direction, Path { weight, seed, density, ..*path }))
        }
        TurnKind::Mirror => {
            let is_inside = !point.from_outside && material.transmission != Vec3::ZERO;
            let absorption = if is_inside { material.absorption } else { path.absorption };
            let weight = path.weight * scatter.mirror / chances.mirror;
            let next = Path { weight, absorption, seed, density: 0.0, ..*path };
            Some((point.above(), scatter.mirror_direction, next))
        }
        TurnKind::Refraction => {
            let absorption = if point.from_outside { material.absorption } else { Vec3::ZERO };
            let weight = path.weight * scatter.transmission / chances.refraction;
            let next = Path { weight, absorption, seed, density: 0.0, ..*path };
            Some((point.below(), scatter.refraction_direction, next))
        }
    }
}

fn push(pixel_idx: u32, radiance: Vec3, run: &mut ShadedRun) {
    if radiance != Vec3::ZERO {
        run.unshadowed.push(Contribution { pixel_idx, radiance });
    }
}
