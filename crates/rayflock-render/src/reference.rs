//! The reference renderer: recursive Whitted, one ray at a time, for checking the fast one.
//!
//! It shares with the wavefront renderer what is defined once (Fresnel, textures, the meaning of
//! a hit, what a light sends, sample positions) and nothing of how work is arranged: no waves, no
//! stages, no threads, no batches longer than one ray. Camera rays, the shares of a material,
//! shadow rays and recursion are written a second time, straight from their definitions.
//!
//! **Agreement**: pictures agree but for rounding. Shadow rays of point lights run from the
//! surface here, so pixels on the edge of a shadow may differ by the light of one sample.
//!
//! **Source**: T. Whitted, *An Improved Illumination Model for Shaded Display*, CACM 23(6), 1980.
//!
//! **Cost**: thousands of times that of [`WhittedRenderer`](crate::WhittedRenderer).

use glam::{Affine3A, Vec2, Vec3};
use rayflock_engine::RayEngine;
use rayflock_geom::{FrameChanges, HitBuffer, Ray, RayBatch};
use rayflock_scene::{Background, Fresnel, LightKind, Material, Projection, Scene, SceneFrame};

use crate::frame_shading::FrameShading;
use crate::lights::incident::incident;
use crate::lights::key_light::{SKY_SHARE, key_light};
use crate::shading::background::{self, DEFAULT_SKY};
use crate::shading::fresnel;
use crate::shading::sampling::{PathSeed, Turn, subpixel};
use crate::shading::surface_point::{SurfacePoint, surface_point};
use crate::{Film, RenderError, RenderSettings, View};

/// Renders `frame` of `scene` slowly and plainly; every pixel of `film` is written.
///
/// # Errors
/// [`RenderError`] as for [`FrameRenderer::commit`](crate::FrameRenderer::commit).
pub fn render(
    engine: &mut dyn RayEngine,
    scene: &Scene,
    frame: &SceneFrame,
    view: &View,
    settings: &RenderSettings,
    film: &mut Film,
) -> Result<(), RenderError> {
    let settings = settings.clamped();
    let shading = FrameShading::new(scene, frame)?;
    engine.commit(&frame.geometry, &FrameChanges::all())?;
    let sky_lights = shading.lights.are_missing();
    let mut tracer = Tracer {
        engine,
        frame: &shading,
        lights: match sky_lights {
            true => vec![key_light(&view.world_from_camera)],
            false => frame.lights.clone(),
        },
        sky_lights,
        background: settings.background.or(scene.background).unwrap_or(DEFAULT_SKY),
        settings: &settings,
        sample_idx: 0,
    };
    let size = Vec2::new(film.width() as f32, film.height() as f32);
    let width = film.width();
    for (pixel_idx, pixel) in film.pixels_mut().iter_mut().enumerate() {
        let (x, y) = (pixel_idx % width, pixel_idx / width);
        *pixel = tracer.pixel(view, x, y, size).to_array();
    }
    Ok(())
}

/// All that a ray needs to know.
struct Tracer<'a> {
    engine: &'a mut dyn RayEngine,
    frame: &'a FrameShading,
    lights: Vec<LightKind>,
    sky_lights: bool,
    background: Background,
    settings: &'a RenderSettings,
    sample_idx: u32,
}

/// Where a ray is in the recursion.
#[derive(Clone, Copy)]
struct Course {
    /// Turns taken.
    bounce: u32,
    /// What the light found will be multiplied with on its way to the pixel.
    weight: Vec3,
    /// Absorption along the ray.
    absorption: Vec3,
    seed: PathSeed,
}

impl Tracer<'_> {
    fn pixel(&mut self, view: &View, x: usize, y: usize, size: Vec2) -> Vec3 {
        let sample_count = self.settings.samples_per_pixel;
        let mut sum = Vec3::ZERO;
        for sample_idx in 0..sample_count {
            self.sample_idx = sample_idx;
            let on_film = (Vec2::new(x as f32, y as f32) + subpixel(sample_idx)) / size;
            let ray = camera_ray(view, on_film, size.x / size.y);
            let seed = PathSeed::of_pixel(x, y);
            let course = Course { bounce: 0, weight: Vec3::ONE, absorption: Vec3::ZERO, seed };
            sum += self.radiance(&ray, course);
        }
        sum / sample_count as f32
    }

    /// The radiance that arrives along `ray`.
    fn radiance(&mut self, ray: &Ray, mut course: Course) -> Vec3 {
        let Some((point, t)) = self.cast(ray) else {
            return background::radiance(&self.background, ray.direction);
        };
        let let_through = (-course.absorption * t * ray.direction.length()).exp();
        course.weight *= let_through;

        let material = self.frame.material(point.material);
        let base = self.frame.base_color(&point);
        let to_viewer = -ray.direction.normalize();
        let shares = Shares::new(material, &point, to_viewer);
        let mut sum = material.emission;
        sum += material.ambient * base * shares.kept * self.ambient(point.normal);
        sum += self.direct(&point, material, base * shares.kept, to_viewer, course.seed);
        sum += self.mirrored(&point, material, &shares, to_viewer, course);
        sum += self.refracted(&point, material, &shares, to_viewer, course);
        let_through * sum
    }

    fn ambient(&self, normal: Vec3) -> Vec3 {
        let sky = background::irradiance_over_pi(&self.background, normal);
        self.frame.lights.ambient + if self.sky_lights { SKY_SHARE * sky } else { Vec3::ZERO }
    }

    /// Light that comes straight from lights and emitters.
    fn direct(
        &mut self,
        point: &SurfacePoint,
        material: &Material,
        base: Vec3,
        to_viewer: Vec3,
        seed: PathSeed,
    ) -> Vec3 {
        let frame = self.frame;
        let position = point.shadow_position;
        let sent_back = |to_light: Vec3| {
            let cos = point.normal.dot(to_light);
            let halfway = (to_viewer + to_light).normalize_or_zero();
            let highlight = point.normal.dot(halfway).max(0.0).powf(material.shininess.max(0.0));
            let both = material.diffuse * base * cos + material.specular * highlight;
            if cos > 0.0 { both / std::f32::consts::PI } else { Vec3::ZERO }
        };
        let mut sum = Vec3::ZERO;
        for light in self.lights.clone() {
            let Some(arriving) = incident(&light, position) else { continue };
            let added = arriving.irradiance * sent_back(arriving.to_light);
            if added != Vec3::ZERO && !self.is_shadowed(position, &light) {
                sum += added;
            }
        }
        let count = self.settings.light_samples;
        for light_sample in 0..count {
            let random = seed.unit_cube(self.sample_idx * count + light_sample);
            let Some(sample) = frame.lights.emitters.sample(position, random) else { continue };
            let added = sample.incident.irradiance * sent_back(sample.incident.to_light);
            let to_source = sample.source - position;
            if added != Vec3::ZERO && !self.is_blocked(position, to_source, 1.0 - 1e-4) {
                sum += added / count as f32;
            }
        }
        sum
    }

    fn mirrored(
        &mut self,
        point: &SurfacePoint,
        material: &Material,
        shares: &Shares,
        to_viewer: Vec3,
        course: Course,
    ) -> Vec3 {
        let Some(course) = self.next(course, shares.mirror, Turn::Mirror) else {
            return Vec3::ZERO;
        };
        let inside = !point.from_outside && material.transmission != Vec3::ZERO;
        let absorption = if inside { material.absorption } else { course.absorption };
        // Turn the direction to the viewer around the normal by half a circle.
        let mut direction = 2.0 * to_viewer.dot(shares.normal) * shares.normal - to_viewer;
        let height = direction.dot(point.facet_normal);
        if height <= 1e-3 {
            direction = (direction + (1e-3 - height) * point.facet_normal).normalize();
        }
        let ray = Ray::new(point.position + point.slack * point.facet_normal, direction);
        shares.mirror * self.radiance(&ray, Course { absorption, ..course })
    }

    fn refracted(
        &mut self,
        point: &SurfacePoint,
        material: &Material,
        shares: &Shares,
        to_viewer: Vec3,
        course: Course,
    ) -> Vec3 {
        let Some(course) = self.next(course, shares.transmission, Turn::Refraction) else {
            return Vec3::ZERO;
        };
        let absorption = if point.from_outside { material.absorption } else { Vec3::ZERO };
        // Snell in terms of the part across the normal: it shrinks by the ratio of indices.
        let across = (shares.normal * to_viewer.dot(shares.normal) - to_viewer) * shares.eta;
        let along = (1.0 - across.length_squared()).max(0.0).sqrt();
        let mut direction = across - along * shares.normal;
        let height = direction.dot(point.facet_normal);
        if height >= -1e-3 {
            direction = (direction - (height + 1e-3) * point.facet_normal).normalize();
        }
        let ray = Ray::new(point.position - point.slack * point.facet_normal, direction);
        shares.transmission * self.radiance(&ray, Course { absorption, ..course })
    }

    /// The course after a turn; `None` where it ends.
    fn next(&self, course: Course, share: Vec3, turn: Turn) -> Option<Course> {
        let weight = course.weight * share;
        let goes_on = course.bounce < self.settings.depth && weight.max_element() >= 1.0 / 2048.0;
        let (bounce, seed) = (course.bounce + 1, course.seed.after(turn));
        goes_on.then_some(Course { bounce, weight, seed, ..course })
    }

    fn is_shadowed(&mut self, position: Vec3, light: &LightKind) -> bool {
        match *light {
            LightKind::Directional { direction, .. } => {
                self.is_blocked(position, -direction, f32::INFINITY)
            }
            LightKind::Point { position: source, .. }
            | LightKind::Spot { position: source, .. } => {
                self.is_blocked(position, source - position, 1.0 - 1e-4)
            }
        }
    }

    fn is_blocked(&mut self, origin: Vec3, direction: Vec3, t_max: f32) -> bool {
        if !self.settings.shadows {
            return false;
        }
        let Ok(batch) =
            RayBatch::new(origin, direction).and_then(|batch| batch.with_interval(0.0, t_max))
        else {
            unreachable!("uniform columns make a batch")
        };
        let mut occluded = [false];
        self.engine.occluded(&batch, &mut occluded);
        occluded[0]
    }

    /// What `ray` hits, and where along it.
    fn cast(&mut self, ray: &Ray) -> Option<(SurfacePoint, f32)> {
        let Ok(batch) = RayBatch::new(ray.origin, ray.direction) else {
            unreachable!("uniform columns make a batch")
        };
        let mut hits = HitBuffer::new(1);
        self.engine.closest_hit(&batch, &mut hits.as_hits());
        let hit = hits.get(0);
        Some((surface_point(self.frame, ray, &hit)?, hit.t))
    }
}

/// The ray through a film position in `0..1` from the top left.
fn camera_ray(view: &View, on_film: Vec2, aspect: f32) -> Ray {
    let across = (2.0 * on_film - 1.0) * Vec2::new(aspect, -1.0);
    let camera: &Affine3A = &view.world_from_camera;
    match view.projection {
        Projection::Perspective { vertical_fov } => {
            let half_height = (vertical_fov / 2.0).tan();
            let in_camera = (across * half_height).extend(-1.0);
            let direction = camera.transform_vector3(in_camera).normalize();
            Ray::new(camera.transform_point3(Vec3::ZERO), direction)
        }
        Projection::Orthographic { height } => Ray::new(
            camera.transform_point3((across * height / 2.0).extend(0.0)),
            camera.transform_vector3(Vec3::NEG_Z).normalize(),
        ),
    }
}

/// How a surface splits light, by the table of the material documentation.
struct Shares {
    mirror: Vec3,
    transmission: Vec3,
    /// What is left of diffuse and ambient light.
    kept: f32,
    /// The normal to mirror and refract by.
    normal: Vec3,
    /// The index of the viewer's side over that of the other side.
    eta: f32,
}

impl Shares {
    fn new(material: &Material, point: &SurfacePoint, to_viewer: Vec3) -> Self {
        let faces = to_viewer.dot(point.normal) > 0.0;
        let normal = if faces { point.normal } else { point.facet_normal };
        let cos = to_viewer.dot(normal).max(0.0);
        let ior = if material.ior > 0.0 && material.ior.is_finite() { material.ior } else { 1.0 };
        let eta = if point.from_outside { ior.recip() } else { ior };
        let (mirror, kept) = match material.fresnel {
            Fresnel::Constant => (material.mirror, 1.0),
            Fresnel::Schlick => {
                let kept = 1.0 - fresnel::schlick(material.mirror, cos);
                (Vec3::ONE - (Vec3::ONE - material.mirror) * kept, kept)
            }
            Fresnel::Dielectric => {
                let share = fresnel::dielectric(cos, eta);
                (Vec3::splat(share), 1.0 - share)
            }
        };
        let transmission = material.transmission * kept;
        let sine = (1.0 - cos * cos).max(0.0).sqrt() * eta;
        if sine >= 1.0 {
            return Self {
                mirror: mirror + transmission,
                transmission: Vec3::ZERO,
                kept,
                normal,
                eta,
            };
        }
        Self { mirror, transmission, kept, normal, eta }
    }
}
