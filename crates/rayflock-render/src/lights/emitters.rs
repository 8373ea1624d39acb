//! Surfaces that emit, as lights: which primitives there are, and points sampled on them.
//!
//! A primitive is chosen in proportion to its area times the luminance of its emission. On a
//! triangle the point is uniform in area; on a sphere it is uniform in the solid angle of what is
//! visible. Triangles send light to both sides. User primitives that emit are seen, but light
//! nothing: their areas are not known.
//!
//! **Source**: M. Pharr, W. Jakob, G. Humphreys, *Physically Based Rendering*, 4th ed. (2023),
//! sections 6.2.4 and 6.5.4 for the two samplings.
//!
//! Cost: a frame takes time linear in the primitives of objects that can emit; a sample takes
//! time logarithmic in the number of primitives that do.

use std::f32::consts::{PI, TAU};

use glam::Vec3;
use rayflock_geom::{
    Geometry, PrimId, PrimKind, Sphere, is_degenerate_triangle, transform_point, transform_sphere,
};
use rayflock_scene::PrimMaterials;

use super::incident::Incident;
use crate::frame_shading::{FrameShading, ShadedObject, shaded_objects};
use crate::shading::luminance::luminance;
use crate::shading::surface_point::{area_normal, slack};

/// All primitives that emit, in world space.
#[derive(Clone, Debug, Default)]
pub(crate) struct Emitters {
    emitters: Vec<Emitter>,
    /// Sums of the weights up to and including each emitter.
    cumulative: Vec<f32>,
}

/// A primitive that emits.
#[derive(Clone, Copy, Debug)]
pub struct Emitter {
    /// Where it is, in world space.
    pub shape: EmitterShape,
    /// What it sends out.
    pub radiance: Vec3,
    /// How likely it is chosen, relative to the others: area times luminance.
    pub weight: f32,
}

/// The shape of a primitive that emits.
#[derive(Clone, Copy, Debug)]
pub enum EmitterShape {
    /// Three corners; light leaves both sides.
    Triangle([Vec3; 3]),
    /// A sphere, from the outside.
    Sphere(Sphere),
}

/// A point on an emitter that lights a point of a surface.
#[derive(Clone, Copy, Debug)]
pub(crate) struct EmitterSample {
    /// On the emitter, in world space.
    pub(crate) source: Vec3,
    /// What arrives, divided by the probability of the sample.
    pub(crate) incident: Incident,
    /// The density with which the sample was chosen, by solid angle.
    pub(crate) density: f32,
}

/// A point from which light leaves an emitter.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Leaving {
    /// Just off the emitter, in world space.
    pub(crate) origin: Vec3,
    /// On the side to which light leaves, of unit length; by the cosine to it.
    pub(crate) normal: Vec3,
    /// All flux, divided by the probability of the emitter.
    pub(crate) flux: Vec3,
}

impl Emitters {
    /// Finds what emits in a frame.
    pub(crate) fn new(shading: &FrameShading, geometry: &Geometry) -> Self {
        let mut emitters = Self::default();
        if shading.has_emission() {
            for object in shaded_objects(shading, geometry) {
                emitters.add_object(shading, object);
            }
        }
        emitters
    }

    /// What all emitters together send out, into both sides of triangles.
    pub(crate) fn flux(&self) -> Vec3 {
        let flux = |emitter: &Emitter| emitter.radiance * (PI * emitter.shape.lit_area());
        self.emitters.iter().map(flux).sum()
    }

    /// A point on some emitter, chosen by `choice` and `place` (numbers in `0..1`), from which
    /// light leaves.
    pub(crate) fn leaving(&self, choice: f32, place: [f32; 3]) -> Option<Leaving> {
        let total = *self.cumulative.last()?;
        let chosen = self.cumulative.partition_point(|&sum| sum <= choice * total);
        let emitter = &self.emitters[chosen.min(self.emitters.len() - 1)];
        let (source, normal) = match &emitter.shape {
            EmitterShape::Triangle(corners) => {
                let side = if place[0] < 0.5 { 1.0 } else { -1.0 };
                let normal = area_normal(*corners).normalize_or_zero().as_vec3();
                (triangle_point(corners, [place[1], place[2]]), side * normal)
            }
            EmitterShape::Sphere(sphere) => {
                let height = 1.0 - 2.0 * place[1];
                let (sin, cos) = (TAU * place[2]).sin_cos();
                let radius = (1.0 - height * height).max(0.0).sqrt();
                let outward = Vec3::new(radius * cos, height, radius * sin);
                (sphere.center + sphere.radius * outward, outward)
            }
        };
        let origin = source + normal * slack(source.abs().max_element());
        let flux = emitter.radiance * (PI * emitter.shape.lit_area() * total / emitter.weight);
        (flux.is_finite() && normal != Vec3::ZERO).then_some(Leaving { origin, normal, flux })
    }

    /// All of them.
    pub(crate) fn all(&self) -> &[Emitter] {
        &self.emitters
    }

    /// Whether nothing emits.
    pub(crate) fn is_empty(&self) -> bool {
        self.emitters.is_empty()
    }

    pub(crate) fn memory_usage(&self) -> usize {
        size_of_val(&self.emitters[..]) + size_of_val(&self.cumulative[..])
    }

    /// A point on some emitter, chosen by `random` (three numbers in `0..1`), and what it sends
    /// to `position`.
    pub(crate) fn sample(&self, position: Vec3, random: [f32; 3]) -> Option<EmitterSample> {
        let total = *self.cumulative.last()?;
        let chosen = self.cumulative.partition_point(|&sum| sum <= random[0] * total);
        let emitter = &self.emitters[chosen.min(self.emitters.len() - 1)];
        let (source, solid_angle) = match &emitter.shape {
            EmitterShape::Triangle(corners) => triangle_sample(corners, position, random)?,
            EmitterShape::Sphere(sphere) => sphere_sample(sphere, position, random)?,
        };
        let to_light = (source - position).normalize_or_zero();
        let solid_angle = solid_angle * total / emitter.weight;
        let irradiance = emitter.radiance * solid_angle;
        let incident = Incident { to_light, irradiance };
        let density = solid_angle.recip();
        irradiance.is_finite().then_some(EmitterSample { source, incident, density })
    }

    /// The density with which [`Self::sample`] chooses the point `seen` of a primitive that emits
    /// `radiance`, from `position`, by solid angle; 0 where it never does.
    pub(crate) fn density(
        &self,
        object: &ShadedObject,
        prim_id: PrimId,
        radiance: Vec3,
        position: Vec3,
        seen: Vec3,
    ) -> f32 {
        let (Some(total), Some(shape)) = (self.cumulative.last(), shape_in_world(object, prim_id))
        else {
            return 0.0;
        };
        let density = match &shape {
            EmitterShape::Triangle(corners) => solid_angle(corners, position, seen).recip(),
            EmitterShape::Sphere(sphere) => {
                sphere_depth(sphere, position).map_or(0.0, |depth| (TAU * depth).recip())
            }
        };
        let density = density * shape.area() * luminance(radiance) / total;
        if density.is_finite() { density } else { 0.0 }
    }

    fn add_object(&mut self, shading: &FrameShading, object: &ShadedObject) {
        let materials = &object.surface.attributes.materials;
        if let PrimMaterials::Uniform(idx) = materials
            && shading.material(*idx).emission.max_element() <= 0.0
        {
            return;
        }
        for prim_idx in 0..object.surface.mesh.prim_count() as u32 {
            let radiance = shading.material(materials.get(PrimId(prim_idx))).emission;
            if radiance.max_element() > 0.0
                && let Some(shape) = shape_in_world(object, PrimId(prim_idx))
            {
                self.add(shape, radiance);
            }
        }
    }

    fn add(&mut self, shape: EmitterShape, radiance: Vec3) {
        let weight = shape.area() * luminance(radiance);
        let sum = self.cumulative.last().copied().unwrap_or_default() + weight;
        if weight > 0.0 && sum.is_finite() {
            self.emitters.push(Emitter { shape, radiance, weight });
            self.cumulative.push(sum);
        }
    }
}

impl EmitterShape {
    fn area(&self) -> f32 {
        match self {
            Self::Triangle([v0, v1, v2]) => 0.5 * (v1 - v0).cross(v2 - v0).length(),
            Self::Sphere(sphere) => 4.0 * PI * sphere.radius * sphere.radius,
        }
    }

    /// The area that light leaves: both sides of a triangle.
    fn lit_area(&self) -> f32 {
        match self {
            Self::Triangle(_) => 2.0 * self.area(),
            Self::Sphere(_) => self.area(),
        }
    }
}

fn shape_in_world(object: &ShadedObject, prim_id: PrimId) -> Option<EmitterShape> {
    let mesh = &object.surface.mesh;
    match mesh.prim_kind(prim_id) {
        PrimKind::Triangle(triangle_idx) => {
            let in_world = |v| object.transform.map_or(v, |m| transform_point(&m, v));
            let corners = mesh.corners(triangle_idx).map(in_world);
            (!is_degenerate_triangle(corners)).then_some(EmitterShape::Triangle(corners))
        }
        PrimKind::Sphere(sphere_idx) => {
            let sphere = mesh.spheres()[sphere_idx];
            let sphere = object.transform.map_or(sphere, |m| transform_sphere(&m, &sphere));
            sphere.is_valid().then_some(EmitterShape::Sphere(sphere))
        }
        PrimKind::User(_) => None,
    }
}

/// A point of the triangle, and the solid angle that stands for all of it: area times cosine over
/// distance squared.
fn triangle_sample(corners: &[Vec3; 3], position: Vec3, random: [f32; 3]) -> Option<(Vec3, f32)> {
    let source = triangle_point(corners, [random[1], random[2]]);
    let solid_angle = solid_angle(corners, position, source);
    (solid_angle > 0.0 && solid_angle.is_finite()).then_some((source, solid_angle))
}

fn triangle_point([v0, v1, v2]: &[Vec3; 3], random: [f32; 2]) -> Vec3 {
    let root = random[0].sqrt();
    let (share0, share1) = (1.0 - root, root * random[1]);
    v0 * share0 + v1 * share1 + v2 * (1.0 - share0 - share1)
}

/// The solid angle of the whole triangle, were all of it as its point `source` is.
fn solid_angle([v0, v1, v2]: &[Vec3; 3], position: Vec3, source: Vec3) -> f32 {
    let doubled_normal = (v1 - v0).cross(v2 - v0);
    let offset = source - position;
    let distance = offset.length();
    let cos_times_area = 0.5 * doubled_normal.dot(offset).abs() / distance;
    cos_times_area / (distance * distance)
}

/// 1 - cos of the angle between the middle of the sphere and its edge, seen from outside; without
/// cancellation.
fn sphere_depth(sphere: &Sphere, position: Vec3) -> Option<f32> {
    let sine = sphere.radius / (sphere.center - position).length();
    (sine < 1.0).then(|| sine * sine / (1.0 + (1.0 - sine * sine).sqrt()))
}

/// A point of the visible part of the sphere, and the solid angle of that part; `None` from
/// inside.
fn sphere_sample(sphere: &Sphere, position: Vec3, random: [f32; 3]) -> Option<(Vec3, f32)> {
    let offset = sphere.center - position;
    let distance = offset.length();
    let depth = sphere_depth(sphere, position)?;
    let cos = 1.0 - random[1] * depth;
    let sin_squared = (1.0 - cos * cos).max(0.0);
    // From the direction in the cone to the near point of the sphere along it.
    let half_chord = (sphere.radius * sphere.radius - distance * distance * sin_squared).max(0.0);
    let along = distance * cos - half_chord.sqrt();
    let axis = offset / distance;
    let (side, up) = axis.any_orthonormal_pair();
    let (sin_turn, cos_turn) = (TAU * random[2]).sin_cos();
    let direction = axis * cos + (side * cos_turn + up * sin_turn) * sin_squared.sqrt();
    Some((position + along * direction, TAU * depth))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shading::sampling::PathSeed;

    /// The mean irradiance of a surface with `normal` at the origin.
    fn irradiance(emitters: &Emitters, normal: Vec3) -> f32 {
        const COUNT: u32 = 4096;
        let sum: f32 = (0..COUNT)
            .filter_map(|i| emitters.sample(Vec3::ZERO, PathSeed::default().unit_cube(i)))
            .map(|s| s.incident.irradiance.x * s.incident.to_light.dot(normal).max(0.0))
            .sum();
        sum / COUNT as f32
    }

    #[test]
    fn a_sphere_lights_as_its_solid_angle_says() {
        let mut emitters = Emitters::default();
        emitters.add(EmitterShape::Sphere(Sphere::new(2.0 * Vec3::Y, 0.5)), Vec3::splat(3.0));
        // A sphere overhead: pi times the squared sine of its half angle.
        let expected = 3.0 * PI * (0.5_f32 / 2.0).powi(2);
        assert!((irradiance(&emitters, Vec3::Y) / expected - 1.0).abs() < 1e-3);
    }

    #[test]
    fn a_square_overhead_lights_as_its_form_factor_says() {
        let corner = |x: f32, z: f32| Vec3::new(x, 1.0, z);
        let (a, b, c, d) =
            (corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0));
        let mut emitters = Emitters::default();
        emitters.add(EmitterShape::Triangle([a, b, c]), Vec3::ONE);
        emitters.add(EmitterShape::Triangle([a, c, d]), Vec3::ONE);
        // Four quarters, each with X = Y = 1 in Howell's catalogue, C-11 (point to rectangle).
        let s = 0.5_f32.sqrt();
        let expected = PI * 4.0 / TAU * 2.0 * s * s.atan();
        assert!((irradiance(&emitters, Vec3::Y) / expected - 1.0).abs() < 5e-3);
    }

    #[test]
    fn brighter_and_larger_emitters_are_chosen_more_often_without_bias() {
        let mut emitters = Emitters::default();
        for (x, radius, radiance) in [(-2.0, 0.2, 1.0), (2.0, 0.6, 20.0)] {
            let sphere = Sphere::new(Vec3::new(x, 2.0, 0.0), radius);
            emitters.add(EmitterShape::Sphere(sphere), Vec3::splat(radiance));
        }
        let one = |radius: f32, radiance: f32| {
            radiance * PI * (radius * radius / 8.0) * std::f32::consts::FRAC_1_SQRT_2
        };
        let expected = one(0.2, 1.0) + one(0.6, 20.0);
        assert!((irradiance(&emitters, Vec3::Y) / expected - 1.0).abs() < 1e-2);
    }

    #[test]
    fn nothing_emits_where_there_is_no_area() {
        let mut emitters = Emitters::default();
        emitters.add(EmitterShape::Triangle([Vec3::ONE; 3]), Vec3::ONE);
        assert!(emitters.is_empty() && emitters.sample(Vec3::ZERO, [0.5; 3]).is_none());
    }
}
