//! The stage on hand-made points, against its twin.

use glam::Vec3;
use rayflock_geom::simd::segment_spheres::SoftSphere;
use rayflock_geom::simd::segment_walls::Wall;
use rayflock_render::vpl::{Lobe, VirtualLight, VirtualLights};
use rayflock_testkit::Rng;

use super::*;
use crate::buffer::GrowingBuffer;
use crate::layout::virtual_lights::{DeviceSoftSphere, DeviceVirtualLight, DeviceWall};
use crate::pass::Groups;
use crate::pipeline::compute_stage;
use crate::stage_clock::StageClock;
use crate::testing::{contexts, read};
use crate::twins::{self, InTheWay, LitPoint};

const POINTS: usize = 192;
const BOUND: f32 = 0.5;
const DISTANCE: f32 = 64.0;

/// What a dispatch reads.
struct Asked {
    points: Vec<LitPoint>,
    lights: Vec<DeviceVirtualLight>,
    spheres: Vec<DeviceSoftSphere>,
    walls: Vec<DeviceWall>,
}

impl Asked {
    /// More spheres than a list has room for; a tile with some points, a full one and an empty one.
    fn new(rng: &mut Rng) -> Self {
        let walls = Wall::new(Vec3::new(-2.0, -2.0, -0.9), [4.0 * Vec3::X, 4.0 * Vec3::Y], 0.5);
        Self {
            points: (0..POINTS).map(|idx| point(rng, idx)).collect(),
            lights: lights(rng),
            spheres: (0..700).map(|_| DeviceSoftSphere::from(&sphere(rng))).collect(),
            walls: walls.iter().map(DeviceWall::from).collect(),
        }
    }

    /// The film that comes of it, and the sums behind it.
    fn gather(&self, context: &GpuContext) -> (Vec<[f32; 3]>, GatherSums) {
        let params = GatherParams {
            bound: BOUND,
            distance: DISTANCE,
            first_light: 1,
            end_light: self.lights.len() as u32,
            sphere_count: self.spheres.len() as u32,
            wall_count: self.walls.len() as u32,
            first_sum: 3 * POINTS as u32,
            unused: 0,
        };
        let [mut points, mut lights, mut spheres, mut walls, mut film] =
            ["points", "lights", "spheres", "walls", "film"].map(GrowingBuffer::storage);
        let mut uniform = GrowingBuffer::new("params", wgpu::BufferUsages::UNIFORM);
        let words = 3 * POINTS + SUM_BYTES / size_of::<f32>();
        let resources = [
            whole(points.write(context, &self.points)),
            whole(lights.write(context, &self.lights)),
            whole(spheres.write(context, &self.spheres)),
            whole(walls.write(context, &self.walls)),
            whole(film.write(context, &vec![0.0_f32; words])),
            part_of(uniform.write(context, &[params]), size_of::<GatherParams>()),
        ];
        let stage = compute_stage(context, GATHER_LIGHTS, &[]);
        let mut clock = StageClock::new(context);
        let mut encoder = StageEncoder::new(context, &mut clock);
        encoder.stage(&stage, &resources, Groups::Count(POINTS / 64));
        encoder.submit();
        let words: Vec<f32> = read(context, film.buffer(), words);
        let (film, sums) = words.split_at(3 * POINTS);
        (bytemuck::cast_slice(film).to_vec(), GatherSums::read(bytemuck::cast_slice(sums)))
    }

    /// The middle of the lit points of a tile.
    fn center_of_tile(&self, point_idx: usize) -> Vec3 {
        let tile = &self.points[point_idx / 64 * 64..][..64];
        let lit = tile.iter().filter(|point| point.pixel != u32::MAX);
        let places = lit.map(|point| Vec3::from(point.shadow_position));
        let low = places.clone().fold(Vec3::INFINITY, Vec3::min);
        0.5 * low + 0.5 * places.fold(Vec3::NEG_INFINITY, Vec3::max)
    }
}

fn point(rng: &mut Rng, idx: usize) -> LitPoint {
    let is_lit = idx < 128 && (idx >= 64 || idx.is_multiple_of(3));
    let normal = (Vec3::Z + 0.5 * rng.in_cube()).normalize();
    let is_shiny = rng.one_in(2);
    LitPoint {
        shadow_position: Vec3::new(rng.signed(), rng.signed(), -0.8).to_array(),
        pixel: if is_lit { idx as u32 } else { u32::MAX },
        normal: normal.to_array(),
        shininess: if rng.one_in(5) { 0.0 } else { rng.between(1.0, 60.0) },
        to_viewer: (Vec3::Z + 0.9 * rng.in_cube()).normalize().to_array(),
        diffuse: [0.5, 0.6, 0.7],
        specular: if is_shiny { [0.3, 0.2, 0.1] } else { [0.0; 3] },
        ..LitPoint::default()
    }
}

/// Surfaces, lamps, highlights, varnish, and the sky.
fn lights(rng: &mut Rng) -> Vec<DeviceVirtualLight> {
    let mut matte = |idx: usize| {
        let intensity = Vec3::new(1.0, 0.5, 2.0);
        match idx % 3 {
            0 => VirtualLight::even(rng.in_cube(), intensity),
            _ => VirtualLight::matte(rng.in_cube(), rng.on_sphere(), intensity),
        }
    };
    let plain: Vec<_> = (0..20).map(&mut matte).collect();
    let lobed = (0..20).map(|idx| {
        let light = matte(3 * idx + 1);
        let varnish = if idx % 2 == 0 { 0.0 } else { 0.8 };
        let highlight = Vec3::new(2.0, 3.0, 1.0);
        let lobe = Lobe { to_source: light.normal, highlight, shininess: 20.0, varnish };
        (light, lobe)
    });
    let lobed: Vec<_> = lobed.collect();
    let to_sky = (0..10).map(|idx| Vec3::new(0.2 * idx as f32 - 1.0, 0.3, 1.0).normalize());
    let sky: Vec<_> = to_sky.map(|way| VirtualLight::distant(way, Vec3::ONE)).collect();
    let mut lights = VirtualLights::default();
    lights.assign(4.0, &plain, &lobed, &sky);
    (0..lights.len()).map(|idx| DeviceVirtualLight::new(&lights, idx)).collect()
}

fn sphere(rng: &mut Rng) -> SoftSphere {
    let inner = rng.between(0.0, 0.04);
    SoftSphere {
        center: rng.in_cube(),
        inner,
        outer: inner + rng.between(0.01, 0.06),
        opacity: rng.between(0.1, 1.0),
        flatness: if rng.one_in(2) { Vec3::ZERO } else { 6.0 * rng.in_cube() },
    }
}

#[test]
fn what_is_gathered_is_what_the_twin_gathers() {
    let asked = Asked::new(&mut Rng::new(72));
    let in_the_way = InTheWay { spheres: &asked.spheres, walls: &asked.walls };
    let expected: Vec<_> = (0..POINTS)
        .map(|idx| {
            let place = (asked.center_of_tile(idx), DISTANCE);
            let lights = &asked.lights[1..];
            match asked.points[idx].pixel {
                u32::MAX => (Vec3::ZERO, 0.0),
                _ => twins::gather_lights(&asked.points[idx], lights, in_the_way, BOUND, place),
            }
        })
        .collect();
    let gathered: f32 = expected.iter().map(|(radiance, _)| radiance.element_sum()).sum();
    let lost: f32 = expected.iter().map(|(_, lost)| lost).sum();
    assert!(gathered > 10.0 && lost > 1.0, "{gathered}, {lost}");
    let lit_count = asked.points.iter().filter(|point| point.pixel != u32::MAX).count();
    for context in contexts() {
        let (film, sums) = asked.gather(context);
        for (idx, (found, (expected, _))) in film.iter().zip(&expected).enumerate() {
            // A light that is nearly dark may count as dark.
            let apart = Vec3::from(*found).distance(*expected);
            let allowed = 2e-3 * (1.0 + expected.length());
            assert!(apart < allowed, "{idx}: {found:?} is not {expected}");
        }
        let is_near = |found: f64, expected: f32| (found / f64::from(expected) - 1.0).abs() < 2e-3;
        assert!(is_near(sums.gathered, gathered) && is_near(sums.lost, lost), "{sums:?}");
        assert_eq!(sums.pairs, (lit_count * (asked.lights.len() - 1)) as f64);
        // Every sphere once a light and tile that has points, and fewer than all of them a pair.
        let looked_at = (2 * asked.spheres.len() * (asked.lights.len() - 1)) as f64;
        let without = looked_at + sums.pairs * asked.spheres.len() as f64;
        assert!(sums.tests > looked_at && sums.tests < 0.5 * without, "{sums:?}, {without}");
    }
}
