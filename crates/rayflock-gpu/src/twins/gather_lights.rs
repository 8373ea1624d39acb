//! What virtual lights send to a point past spheres and walls, light by light and sphere by sphere.

use std::f32::consts::FRAC_1_PI;

use bytemuck::{Pod, Zeroable};
use glam::Vec3;
use rayflock_geom::simd::segment_spheres::{AT_END, DARK, RISE};

use crate::layout::virtual_lights::{
    DISTANT, DeviceSoftSphere, DeviceVirtualLight, DeviceWall, LOBED,
};

/// `LitPoint` of `frame/frame.wgsl`, which the host never writes but in tests.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct LitPoint {
    pub(crate) shadow_position: [f32; 3],
    pub(crate) pixel: u32,
    pub(crate) normal: [f32; 3],
    pub(crate) shininess: f32,
    pub(crate) to_viewer: [f32; 3],
    pub(crate) seed: u32,
    pub(crate) diffuse: [f32; 3],
    pub(crate) unused_a: u32,
    pub(crate) specular: [f32; 3],
    pub(crate) unused_b: u32,
    pub(crate) emitted: [f32; 3],
    pub(crate) emitted_pixel: u32,
}

/// An end of a way: where it is, and the unit normal of the surface there, or zero without one.
pub(crate) type End = [Vec3; 2];

/// What is in the way.
#[derive(Clone, Copy, Debug)]
pub(crate) struct InTheWay<'a> {
    pub(crate) spheres: &'a [DeviceSoftSphere],
    pub(crate) walls: &'a [DeviceWall],
}

/// The radiance that lights add to a point, geometry terms counting up to `bound`, and the sum of
/// the colours that the bound keeps away. Distant lights go `distance` away from `center`.
pub(crate) fn gather_lights(
    point: &LitPoint,
    lights: &[DeviceVirtualLight],
    in_the_way: InTheWay<'_>,
    bound: f32,
    (center, distance): (Vec3, f32),
) -> (Vec3, f32) {
    let here = [Vec3::from(point.shadow_position), Vec3::from(point.normal)];
    let mut sums = (Vec3::ZERO, 0.0);
    for light in lights {
        let mut light = *light;
        let mut bound = bound;
        if light.kind == DISTANT {
            light.position = (center + distance * Vec3::from(light.position)).to_array();
            light.intensity = light.intensity.map(|channel| channel * distance * distance);
            bound = f32::INFINITY;
        }
        let there = [Vec3::from(light.position), Vec3::from(light.normal)];
        let share = past_spheres(here, there, in_the_way.spheres)
            * past_walls(here[0], there[0], in_the_way.walls);
        let (radiance, terms) = arriving(point, &light);
        let kept = if terms > bound { bound / terms } else { 1.0 };
        sums.0 += share * kept * radiance;
        sums.1 += share * (1.0 - kept) * radiance.element_sum();
    }
    sums
}

/// The radiance that a light at a place adds if nothing is in the way, without bound, and the
/// geometry term.
fn arriving(point: &LitPoint, light: &DeviceVirtualLight) -> (Vec3, f32) {
    let [normal, light_normal] = [point.normal, light.normal].map(Vec3::from);
    let offset = Vec3::from(light.position) - Vec3::from(point.shadow_position);
    let to_light = offset.normalize();
    let cos_point = normal.dot(to_light).max(0.0);
    let cos_light = (light.evenness - light_normal.dot(to_light)).max(0.0);
    let mut sent_back = Vec3::from(point.diffuse) * cos_point;
    if cos_point > 0.0 {
        let halfway = (Vec3::from(point.to_viewer) + to_light).normalize_or_zero();
        let highlight = normal.dot(halfway).max(0.0).powf(point.shininess);
        sent_back += Vec3::from(point.specular) * highlight;
    }
    let mut intensity = Vec3::from(light.intensity);
    if light.kind == LOBED {
        intensity *= 1.0 - light.varnish * (1.0 - cos_light).powi(5);
        let halfway = (Vec3::from(light.to_source) - to_light).normalize_or_zero();
        let highlight = light_normal.dot(halfway).max(0.0).powf(light.shininess);
        intensity += Vec3::from(light.highlight) * highlight;
    }
    let inverse_square = offset.length_squared().recip();
    let radiance = sent_back * intensity * (cos_light * inverse_square * FRAC_1_PI);
    (radiance, cos_point * cos_light * inverse_square)
}

/// The share of light that comes past spheres from an end of a way to the other.
pub(crate) fn past_spheres(
    [point, normal]: End,
    [light, light_normal]: End,
    spheres: &[DeviceSoftSphere],
) -> f32 {
    let taken = spheres.iter().map(|sphere| {
        let dimming =
            |squared: f32| (sphere.peak - squared * sphere.slope).clamp(0.0, sphere.opacity);
        let rise = |[end, normal]: End| {
            let height = normal.dot(Vec3::from(sphere.center) - end) / (RISE * sphere.outer);
            if normal == Vec3::ZERO { 1.0 } else { height.clamp(0.0, 1.0) }
        };
        // In a space where the sphere is round.
        let flatness = Vec3::from(sphere.flatness);
        let stretch = (1.0 + flatness.length_squared()).sqrt() - 1.0;
        let axis = flatness.normalize_or_zero();
        let round = |v: Vec3| v + stretch * axis.dot(v) * axis;
        let [from, to] = [point, light].map(|end| round(end - Vec3::from(sphere.center)));
        let along = (-from).dot(to - from) / (to - from).length_squared();
        let nearest = from.lerp(to, along.clamp(0.0, 1.0));
        let at_ends = dimming(from.length_squared()) + dimming(to.length_squared());
        let counted = (dimming(nearest.length_squared()) - AT_END * at_ends).max(0.0);
        counted * rise([point, normal]) * rise([light, light_normal])
    });
    let through = 1.0 - taken.sum::<f32>();
    if through > DARK { through } else { 0.0 }
}

/// The share of light that comes past walls.
pub(crate) fn past_walls(point: Vec3, light: Vec3, walls: &[DeviceWall]) -> f32 {
    let past = |wall: &DeviceWall| {
        let [corner, normal, axis_a, axis_b] =
            [wall.corner, wall.normal, wall.axis_a, wall.axis_b].map(Vec3::from);
        let [from, to] = [point, light].map(|end| normal.dot(end - corner));
        let met = point.lerp(light, from / (from - to)) - corner;
        let is_within = [axis_a, axis_b].iter().all(|axis| (0.0..=1.0).contains(&axis.dot(met)));
        if from * to < 0.0 && is_within { 1.0 - wall.opacity } else { 1.0 }
    };
    walls.iter().map(past).product()
}

#[cfg(test)]
mod tests {
    use rayflock_geom::simd::segment_spheres::{Blocker, PointBlock, SoftSphere, let_through};
    use rayflock_geom::simd::segment_walls::{Wall, past_wall};
    use rayflock_geom::simd::{Lanes, SimdLevel, dispatch};
    use rayflock_testkit::Rng;

    use super::*;

    /// The definition is that of the CPU's kernels.
    #[test]
    fn what_comes_past_spheres_and_walls_is_what_the_kernels_let_through() {
        let mut rng = Rng::new(71);
        let mut dimmed = 0;
        for _ in 0..2000 {
            let (point, normal, light) = (rng.in_cube(), rng.on_sphere(), rng.in_cube());
            let light_normal = if rng.one_in(3) { Vec3::ZERO } else { rng.on_sphere() };
            let spheres: Vec<_> = (0..rng.below(40)).map(|_| sphere(&mut rng, 1.0)).collect();
            let edges = [rng.in_cube(), rng.in_cube()];
            let walls: Vec<_> = Wall::new(rng.in_cube(), edges, rng.unit()).into_iter().collect();

            let seen = spheres.iter().map(Blocker::new);
            let (flat, round): (Vec<_>, Vec<_>) = seen
                .filter_map(|blocker| blocker.toward(light, light_normal))
                .partition(Blocker::is_flat);
            let points = PointBlock::splat(point, normal);
            let expected: [Lanes; 2] = dispatch!(SimdLevel::best().level(), simd => {
                let past_wall = |wall: &Wall| *past_wall(simd, &points, light, wall);
                let past_walls = walls.first().map_or([1.0; 16], past_wall);
                [*let_through(simd, &points, light, &round, &flat), past_walls]
            });
            let device: Vec<_> = spheres.iter().map(DeviceSoftSphere::from).collect();
            let found = past_spheres([point, normal], [light, light_normal], &device);
            assert!((found - expected[0][0]).abs() < 3.0 * DARK, "{found}, not {expected:?}");
            let device: Vec<_> = walls.iter().map(DeviceWall::from).collect();
            let beyond = past_walls(point, light, &device);
            assert!((beyond - expected[1][0]).abs() < 1e-5, "{beyond}, not {expected:?}");
            dimmed += usize::from(found < 1.0) + usize::from(beyond < 1.0);
        }
        assert!(dimmed > 500, "{dimmed}");
    }

    fn sphere(rng: &mut Rng, size: f32) -> SoftSphere {
        let inner = 0.3 * size * rng.unit();
        SoftSphere {
            center: rng.in_cube(),
            inner,
            outer: inner + size * rng.between(0.05, 0.3),
            opacity: rng.between(0.1, 1.0),
            flatness: if rng.one_in(2) { Vec3::ZERO } else { 6.0 * rng.in_cube() },
        }
    }
}
