//! What a light sees: windows of texels around the things that turn light.
//!
//! ```text
//!   lamp beside them    a frustum around the sphere that holds them, or around the lamp's cone
//!                       where that is narrower
//!   lamp among them     the six faces of a cube
//!   directional light   a rectangle around them, before the whole scene
//! ```
//!
//! A window is the film of a [`Lens`], so whatever renders a camera's picture renders a light's.

use glam::{Vec2, Vec3};
use rayflock_geom::Aabb;
use rayflock_scene::LightKind;

use crate::lights::incident::incident;
use crate::{FilmPlane, Lens};

/// Texels along the side of a window are a multiple of this: tiles of rays.
const TILE: u32 = 8;
/// Half angles of a frustum are below 57 degrees: beyond, the corners of a window lie far out.
const WIDEST_SIN: f32 = 0.84;

/// A square number of texels that a light shines through.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightView {
    /// From the light, or before the scene along it; a texel is a pixel.
    pub lens: Lens,
    /// Texels along each side, a multiple of 8.
    pub edge: u32,
}

impl LightView {
    /// Origin and unit direction of the ray through the middle of a texel, and the flux of `light`
    /// through the texel: where the light does not fall with the distance, the flux for a distance
    /// of 1, which grows with its square.
    pub fn texel(&self, light: &LightKind, [x, y]: [u32; 2]) -> (Vec3, Vec3, Vec3) {
        let at = Vec2::new(x as f32 + 0.5, y as f32 + 0.5);
        let through = |film: &FilmPlane| film.top_left + film.right * at.x + film.down * at.y;
        match &self.lens {
            Lens::Pinhole { origin, film } => {
                let point = through(film);
                let direction = point.normalize_or(Vec3::NEG_Z);
                let solid_angle = across(film, point) / point.length_squared().powf(1.5);
                // A surface at distance 1 gets as irradiance what the light sends as intensity;
                // around 0, since places far away are too coarse for that.
                let intensity = incident(&at_origin(light), direction);
                let intensity = intensity.map_or(Vec3::ZERO, |incident| incident.irradiance);
                (*origin, direction, intensity * solid_angle)
            }
            Lens::Parallel { direction, film } => {
                let irradiance = match light {
                    LightKind::Directional { irradiance, .. } => *irradiance,
                    _ => Vec3::ZERO,
                };
                (through(film), *direction, irradiance * across(film, *direction))
            }
        }
    }
}

/// The light as if it were at 0.
fn at_origin(light: &LightKind) -> LightKind {
    let mut light = *light;
    match &mut light {
        LightKind::Point { position, .. } | LightKind::Spot { position, .. } => {
            *position = Vec3::ZERO;
        }
        LightKind::Directional { .. } => {}
    }
    light
}

/// The area of a texel as seen along `direction`, times its length.
fn across(film: &FilmPlane, direction: Vec3) -> f32 {
    film.right.cross(film.down).dot(direction).abs()
}

/// The windows through which `light` shines on what lies within `turning`, with about so many
/// texels in all; none where that is empty. `bounds` are those of the scene.
pub fn light_views(
    light: &LightKind,
    turning: &Aabb,
    bounds: &Aabb,
    texel_count: u32,
) -> Vec<LightView> {
    if turning.is_empty() || !turning.size().is_finite() || !bounds.size().is_finite() {
        return Vec::new();
    }
    let lenses = match *light {
        LightKind::Directional { direction, .. } => {
            let direction = direction.normalize_or_zero();
            let edge = edge_of(texel_count, 1);
            let lens =
                (direction != Vec3::ZERO).then(|| along(direction, turning, bounds, edge as f32));
            return lens.map(|lens| LightView { lens, edge }).into_iter().collect();
        }
        LightKind::Point { position, .. } => frusta(position, toward(position, turning)),
        LightKind::Spot { position, direction, cos_outer, .. } => {
            let cos = cos_outer.clamp(-1.0, 1.0);
            let sin = if cos > 0.0 { (1.0 - cos * cos).sqrt() } else { 1.0 };
            let cone = (direction.normalize_or(Vec3::NEG_Y), sin);
            let around = toward(position, turning);
            frusta(position, if cone.1 < around.1 { cone } else { around })
        }
    };
    let edge = edge_of(texel_count, lenses.len() as u32);
    let view = |frustum: &Frustum| LightView { lens: frustum.lens(edge as f32), edge };
    lenses.iter().map(view).collect()
}

/// Texels along the side of each of some windows that have so many in all.
fn edge_of(texel_count: u32, window_count: u32) -> u32 {
    let side = (texel_count as f32 / window_count as f32).sqrt();
    ((side / TILE as f32).round() as u32 * TILE).max(TILE)
}

/// The direction to the middle of a box, and the sine of the half angle of the cone around it; 1
/// from within.
fn toward(position: Vec3, around: &Aabb) -> (Vec3, f32) {
    let offset = around.center() - position;
    let radius = 0.5 * around.size().length();
    (offset.normalize_or(Vec3::NEG_Y), (radius / offset.length()).min(1.0))
}

/// A square pyramid of directions.
#[derive(Clone, Copy, Debug)]
struct Frustum {
    origin: Vec3,
    axis: Vec3,
    /// Tangent of the angle between the axis and the middle of a side.
    tan: f32,
}

/// One frustum around a cone where that is narrow, else six that share all directions.
fn frusta(origin: Vec3, (axis, sin): (Vec3, f32)) -> Vec<Frustum> {
    if sin < WIDEST_SIN {
        // A little wider, for what lies at its edge; never without width.
        let tan = (sin / (1.0 - sin * sin).sqrt() * 1.001).max(1e-6);
        return vec![Frustum { origin, axis, tan }];
    }
    let axes = Vec3::AXES.into_iter().flat_map(|axis| [axis, -axis]);
    axes.map(|axis| Frustum { origin, axis, tan: 1.0 }).collect()
}

impl Frustum {
    /// With so many texels along each side.
    fn lens(&self, edge: f32) -> Lens {
        let Self { origin, axis, tan } = *self;
        let (side, up) = axis.any_orthonormal_pair();
        let (right, down) = (side * (2.0 * tan / edge), up * (-2.0 * tan / edge));
        let top_left = axis + (up - side) * tan;
        Lens::Pinhole { origin, film: FilmPlane { top_left, right, down } }
    }
}

/// Around a box, along a direction, from before the scene.
fn along(direction: Vec3, around: &Aabb, bounds: &Aabb, edge: f32) -> Lens {
    let (side, up) = direction.any_orthonormal_pair();
    let middle = around.center();
    let half = 0.5 * around.size();
    // How far the box reaches to either side of its middle; a little more, and never nothing.
    let least = 1e-5 * bounds.size().length();
    let reach = |axis: Vec3| 1.001 * axis.abs().dot(half) + least;
    let (half_width, half_height) = (reach(side), reach(up));
    let back = direction.abs().dot(0.5 * bounds.size()) * 1.01 + least;
    let start = middle + direction * ((bounds.center() - middle).dot(direction) - back);
    let top_left = start - side * half_width + up * half_height;
    let right = side * (2.0 * half_width / edge);
    let down = up * (-2.0 * half_height / edge);
    Lens::Parallel { direction, film: FilmPlane { top_left, right, down } }
}

#[cfg(test)]
mod tests {
    use std::f32::consts::PI;

    use rayflock_scene::Falloff;

    use super::*;

    fn flux(light: &LightKind, views: &[LightView]) -> f32 {
        let texels = |view: &LightView| {
            let edge = view.edge;
            let of = |idx: u32| f64::from(view.texel(light, [idx % edge, idx / edge]).2.x);
            (0..edge * edge).map(of).sum::<f64>()
        };
        views.iter().map(texels).sum::<f64>() as f32
    }

    const UNIT: Aabb = Aabb { min: Vec3::splat(-1.0), max: Vec3::ONE };

    #[test]
    fn windows_carry_the_flux_of_their_light() {
        let intensity = Vec3::splat(3.0);
        let falloff = Falloff::InverseSquare;
        let within = LightKind::Point { position: Vec3::X * 0.2, intensity, falloff };
        let views = light_views(&within, &UNIT, &UNIT, 1 << 14);
        assert_eq!((views.len(), views[0].edge), (6, 56));
        let found = flux(&within, &views);
        assert!((found / (12.0 * PI) - 1.0).abs() < 1e-3, "{found}");

        let (cos_inner, cos_outer) = (0.9501, 0.95);
        let direction = Vec3::new(0.6, 0.0, -0.8);
        let spot =
            LightKind::Spot { position: Vec3::Y, direction, intensity, cos_inner, cos_outer };
        let views = light_views(&spot, &UNIT, &UNIT, 1 << 16);
        assert_eq!((views.len(), views[0].edge), (1, 256));
        let found = flux(&spot, &views);
        assert!((found / (6.0 * PI * 0.05) - 1.0).abs() < 5e-3, "{found}");

        let sun = LightKind::Directional { direction: Vec3::NEG_Y, irradiance: intensity };
        let wide = Aabb { min: Vec3::splat(-9.0), max: Vec3::splat(9.0) };
        let views = light_views(&sun, &UNIT, &wide, 4096);
        let found = flux(&sun, &views);
        assert!((found / 12.0 - 1.0).abs() < 5e-3, "{found}");
        // From above everything there is.
        assert!(views[0].texel(&sun, [0, 0]).0.y > 9.0);
    }

    #[test]
    fn a_lamp_beside_a_box_has_one_window_that_holds_it() {
        let position = Vec3::new(3.0, 4.0, 1.0);
        let (intensity, falloff) = (Vec3::ONE, Falloff::InverseSquare);
        let light = LightKind::Point { position, intensity, falloff };
        let views = light_views(&light, &UNIT, &UNIT, 4096);
        let [LightView { lens: Lens::Pinhole { origin, film }, edge }] = views[..] else {
            panic!("{views:?}")
        };
        assert_eq!((origin, edge), (position, 64));
        let axis = film.right.cross(film.down).normalize();
        for idx in 0..8 {
            let corner = Vec3::from([0, 1, 2].map(|bit| ((idx >> bit & 1) * 2) as f32 - 1.0));
            let offset = corner - position;
            // On the plane of the film, which lies at distance 1.
            let on_film = offset / offset.dot(axis).abs() - film.top_left;
            let place =
                [film.right, film.down].map(|side| on_film.dot(side) / side.length_squared());
            assert!(place.iter().all(|place| (0.0..=64.0).contains(place)), "{place:?}");
        }
        assert!(light_views(&light, &Aabb::EMPTY, &UNIT, 4096).is_empty());
    }
}
