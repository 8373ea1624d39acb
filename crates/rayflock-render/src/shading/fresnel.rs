//! Mirror and refraction at a smooth interface: directions and shares.

use glam::Vec3;

/// What Schlick's approximation adds to a share `mirror` at normal incidence, relative to what
/// `mirror` leaves, at an angle of incidence with cosine `cos`: `(1 - cos)^5`, less where `mirror`
/// is below that of any smooth surface.
///
/// A share below 4 % stands for a surface too rough to show sharp reflections; it does not become
/// a mirror at grazing angles.
///
/// **Source**: C. Schlick, *An Inexpensive BRDF Model for Physically-based Rendering* (1994).
pub(crate) fn schlick(mirror: Vec3, cos: f32) -> f32 {
    const SMOOTH: f32 = 0.04;
    let sideways = (1.0 - cos).clamp(0.0, 1.0);
    let squared = sideways * sideways;
    squared * squared * sideways * (mirror.max_element() / SMOOTH).clamp(0.0, 1.0)
}

/// The mirrored share of unpolarised light at an interface between dielectrics, for a cosine of
/// incidence `cos` in `0..=1` and `eta`, the index of the side of incidence over that of the other
/// side. 1 where the interface mirrors totally.
pub(crate) fn dielectric(cos: f32, eta: f32) -> f32 {
    let Some(cos_t) = refracted_cosine(cos, eta) else { return 1.0 };
    let parallel = (cos - eta * cos_t) / (cos + eta * cos_t);
    let perpendicular = (eta * cos - cos_t) / (eta * cos + cos_t);
    let share = 0.5 * (parallel * parallel + perpendicular * perpendicular);
    if share.is_finite() { share } else { 1.0 }
}

/// The direction into which unit `direction` is refracted, by Snell's law; `normal` is of unit
/// length and points to the side of incidence; `eta` as for [`dielectric`]. `None` when the
/// interface mirrors totally.
pub(crate) fn refracted(direction: Vec3, normal: Vec3, eta: f32) -> Option<Vec3> {
    let cos = -direction.dot(normal);
    let cos_t = refracted_cosine(cos, eta)?;
    Some((eta * direction + (eta * cos - cos_t) * normal).normalize_or(direction))
}

/// The direction into which `direction` is mirrored by a surface with unit `normal`.
pub(crate) fn mirrored(direction: Vec3, normal: Vec3) -> Vec3 {
    direction - 2.0 * direction.dot(normal) * normal
}

fn refracted_cosine(cos: f32, eta: f32) -> Option<f32> {
    let squared = 1.0 - eta * eta * (1.0 - cos * cos);
    (squared > 0.0).then(|| squared.sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn incident(angle: f32) -> Vec3 {
        Vec3::new(angle.sin(), -angle.cos(), 0.0)
    }

    #[test]
    fn glass_mirrors_four_percent_at_normal_incidence_and_all_at_grazing() {
        assert!((dielectric(1.0, 1.0 / 1.5) - 0.04).abs() < 1e-6);
        assert!((dielectric(1.0, 1.5) - 0.04).abs() < 1e-6);
        assert!(dielectric(0.0, 1.0 / 1.5) > 0.999);
    }

    #[test]
    fn schlick_reaches_one_at_grazing_where_the_surface_is_smooth() {
        assert_eq!(schlick(Vec3::splat(0.04), 0.0), 1.0);
        assert_eq!(schlick(Vec3::splat(0.5), 1.0), 0.0);
        assert_eq!(schlick(Vec3::splat(0.01), 0.0), 0.25);
        assert_eq!(schlick(Vec3::ZERO, 0.0), 0.0);
    }

    #[test]
    fn the_share_is_the_same_from_both_sides() {
        for degrees in [10.0_f32, 30.0, 50.0, 70.0] {
            let angle = degrees.to_radians();
            let inside = (angle.sin() / 1.5).asin();
            let from_air = dielectric(angle.cos(), 1.0 / 1.5);
            assert!((from_air - dielectric(inside.cos(), 1.5)).abs() < 1e-5);
        }
    }

    #[test]
    fn brewsters_angle_mirrors_only_one_polarisation() {
        // At tan(angle) = 1.5 the parallel part vanishes; the other is ((1 - n^2) / (1 + n^2))^2.
        let share = dielectric(1.5_f32.atan().cos(), 1.0 / 1.5);
        assert!((share - 0.5 * (1.25_f32 / 3.25).powi(2)).abs() < 1e-5);
    }

    #[test]
    fn refraction_follows_snell() {
        for degrees in [0.0_f32, 20.0, 45.0, 80.0] {
            let angle = degrees.to_radians();
            let inside = refracted(incident(angle), Vec3::Y, 1.0 / 1.33).unwrap();
            assert!((inside.x - angle.sin() / 1.33).abs() < 1e-6);
            assert!(inside.y < 0.0 && (inside.length() - 1.0).abs() < 1e-6);
        }
    }

    #[test]
    fn beyond_the_critical_angle_all_is_mirrored() {
        let critical = (1.0_f32 / 1.5).asin();
        assert!(refracted(incident(critical - 0.01), Vec3::Y, 1.5).is_some());
        assert!(refracted(incident(critical + 0.01), Vec3::Y, 1.5).is_none());
        assert_eq!(dielectric((critical + 0.01).cos(), 1.5), 1.0);
    }

    #[test]
    fn equal_indices_let_everything_through() {
        assert!(dielectric(0.3, 1.0) < 1e-12);
        let through = refracted(incident(1.0), Vec3::Y, 1.0).unwrap();
        assert!((through - incident(1.0)).length() < 1e-6);
    }

    #[test]
    fn a_mirror_turns_the_normal_part_around() {
        assert_eq!(mirrored(Vec3::new(1.0, -2.0, 3.0), Vec3::Y), Vec3::new(1.0, 2.0, 3.0));
    }
}
