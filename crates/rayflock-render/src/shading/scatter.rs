//! What a surface does with light: how a material's shares depend on the angle.
//!
//! With `cos` the cosine of incidence and `F` the mirrored share:
//!
//! | Fresnel | mirror | transmission | diffuse, ambient |
//! |---|---|---|---|
//! | `Constant` | `mirror` | `transmission` | as they are |
//! | `Schlick` | `mirror + (1 - mirror) s` | `transmission (1 - s)` | times `1 - s` |
//! | `Dielectric` | `F`, colourless | `transmission (1 - F)` | times `1 - F` |
//!
//! where `s` is [`fresnel::schlick`], about `(1 - cos)^5`: what Schlick adds to the mirror is lost
//! below, for `1 - F = (1 - mirror)(1 - s)`. Where refraction is not possible (total internal reflection), the transmitted share is
//! mirrored.

use glam::Vec3;
use rayflock_scene::{Fresnel, Material};

use super::fresnel;
use super::surface_point::SurfacePoint;

/// What becomes of the light at a point, seen along one ray.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Scatter {
    /// Multiplies ambient light.
    pub(crate) ambient: Vec3,
    /// Multiplies irradiance over pi.
    pub(crate) diffuse: Vec3,
    /// Multiplies radiance along `mirror_direction`.
    pub(crate) mirror: Vec3,
    /// The mirrored ray, of unit length, on the side from which the ray came, meaningless
    /// without a share in `mirror`.
    pub(crate) mirror_direction: Vec3,
    /// Multiplies radiance along `refraction_direction`.
    pub(crate) transmission: Vec3,
    /// The refracted ray, of unit length, on the other side, where there is transmission.
    pub(crate) refraction_direction: Vec3,
}

impl Scatter {
    /// Scales everything down, `highlight` too, where more light would leave than arrives, as
    /// classic materials may have it; returns the factor. Light that goes on and on then fades.
    pub(crate) fn conserve(&mut self, highlight: &mut Vec3, shininess: f32) -> f32 {
        let sent = self.diffuse + self.mirror + self.transmission;
        let most = (sent + *highlight * highlight_albedo(shininess)).max_element();
        let kept = if most > 1.0 { most.recip() } else { 1.0 };
        let shares = [&mut self.diffuse, &mut self.mirror, &mut self.transmission, highlight];
        shares.into_iter().for_each(|share| *share *= kept);
        kept
    }
}

/// At most this times its strength a highlight sends back: `8 / (shininess + 1)`, by the integral
/// of `(normal . halfway) ^ shininess` over all directions, and 2, a whole hemisphere.
pub(crate) fn highlight_albedo(shininess: f32) -> f32 {
    (8.0 / (shininess.max(0.0) + 1.0)).min(2.0)
}

/// Evaluates `material` at `point` for a ray along unit `direction`; `base` multiplies the
/// diffuse and the ambient share.
#[inline(always)]
pub(crate) fn scatter(
    material: &Material,
    point: &SurfacePoint,
    base: Vec3,
    direction: Vec3,
) -> Scatter {
    let cos = -direction.dot(point.normal);
    // A smooth normal may point away from the viewer near a silhouette; the facet never does.
    let (normal, cos) = if cos > 0.0 {
        (point.normal, cos)
    } else {
        (point.facet_normal, 0.0_f32.max(-direction.dot(point.facet_normal)))
    };
    let eta = || relative_index(material, point.from_outside);
    let (mut mirror, kept) = match material.fresnel {
        Fresnel::Constant => (material.mirror, 1.0),
        Fresnel::Schlick => {
            let added = fresnel::schlick(material.mirror, cos);
            (material.mirror + (Vec3::ONE - material.mirror) * added, 1.0 - added)
        }
        Fresnel::Dielectric => {
            let share = fresnel::dielectric(cos, eta());
            (Vec3::splat(share), 1.0 - share)
        }
    };
    let mut transmission = material.transmission * kept;
    let mut refraction_direction = direction;
    if transmission != Vec3::ZERO {
        match fresnel::refracted(direction, normal, eta()) {
            Some(refracted) => refraction_direction = turned_below(refracted, point.facet_normal),
            None => {
                mirror += transmission;
                transmission = Vec3::ZERO;
            }
        }
    }
    let mirror_direction = if mirror == Vec3::ZERO {
        direction
    } else {
        -turned_below(-fresnel::mirrored(direction, normal), point.facet_normal)
    };
    Scatter {
        ambient: material.ambient * base * kept,
        diffuse: material.diffuse * base * kept,
        mirror,
        mirror_direction,
        transmission,
        refraction_direction,
    }
}

/// The index of the side of incidence over that of the other side.
fn relative_index(material: &Material, from_outside: bool) -> f32 {
    let ior = if material.ior > 0.0 && material.ior.is_finite() { material.ior } else { 1.0 };
    if from_outside { 1.0 / ior } else { ior }
}

/// `direction`, bent just below the plane with unit `normal` where a smooth normal sent it above.
fn turned_below(direction: Vec3, normal: Vec3) -> Vec3 {
    const GRAZING: f32 = 1e-3;
    let height = direction.dot(normal);
    if height < -GRAZING {
        return direction;
    }
    (direction - (height + GRAZING) * normal).normalize_or(-normal)
}

/// The share of the irradiance of a light along `to_light` that leaves toward `to_viewer` (unit
/// vectors): Lambert for `diffuse`, Blinn-Phong for `specular`, both over pi.
///
/// **Source**: J. F. Blinn, *Models of Light Reflection for Computer Synthesized Pictures* (1977).
/// **Departures**: the highlight is divided by pi too, so that a material keeps its look when
/// lights are given as irradiance instead of classic intensity.
pub(crate) fn reflected(
    diffuse: Vec3,
    specular: Vec3,
    shininess: f32,
    normal: Vec3,
    to_viewer: Vec3,
    to_light: Vec3,
) -> Vec3 {
    let cos = normal.dot(to_light);
    if cos <= 0.0 {
        return Vec3::ZERO;
    }
    let mut sum = diffuse * cos;
    if specular != Vec3::ZERO {
        let halfway = (to_viewer + to_light).normalize_or_zero();
        sum += specular * normal.dot(halfway).max(0.0).powf(shininess.max(0.0));
    }
    sum * std::f32::consts::FRAC_1_PI
}
