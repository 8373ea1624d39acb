//! The kernels of `rayflock::geom::simd` on seeded primitives.

use glam::Vec3;
use rayflock::geom::simd::cone_sphere::{Reach, SLACK, SphereBlock, touches};
use rayflock::geom::simd::ray_sphere::{SphereRays, intersect_sphere};
use rayflock::geom::simd::ray_triangle::{
    RayPacket, ShearedRay, TriangleBlock, intersect_block, intersect_packet,
};
use rayflock::geom::simd::{
    LANES, Select, Simd, SimdBase, SimdLevel, SimdMask, dispatch, f32x16, mask32x16,
};
use rayflock::geom::{Mesh, Ray, Sphere, SphereCone};
use rayflock_testkit::Rng;
use rayflock_testkit::scenes::{SoupKind, triangle_soup};

use crate::{Case, measured_part};

/// Primitives that sixteen rays, or a cone, meet.
const PRIM_COUNT: usize = 4096;

pub(crate) const CASES: [Case; 4] = [
    Case { name: "ray_triangle_packet", item: "ray-triangle tests", run: ray_triangle_packet },
    Case { name: "ray_triangle_block", item: "ray-triangle tests", run: ray_triangle_block },
    Case { name: "ray_sphere", item: "ray-sphere tests", run: ray_sphere },
    Case { name: "cone_sphere", item: "cone-sphere tests", run: cone_sphere },
];

/// Sixteen rays that enter the unit ball from one side, like a tile of a picture.
fn rays() -> [Ray; LANES] {
    let target = |idx: usize| Vec3::new((idx % 4) as f32, (idx / 4) as f32, 0.0) * 0.05;
    std::array::from_fn(|idx| {
        let origin = Vec3::new(0.1, 0.2, 4.0);
        Ray::new(origin, target(idx) - origin)
    })
}

fn triangles() -> Mesh {
    triangle_soup(&mut Rng::new(1), SoupKind::Plain, PRIM_COUNT, Vec3::ZERO, 1.0)
}

fn spheres() -> Vec<Sphere> {
    let mesh = triangles();
    let around = |idx| {
        let [a, b, c] = mesh.corners(idx);
        Sphere::around_triangle(a, b, c)
    };
    (0..PRIM_COUNT).map(around).collect()
}

/// Sixteen rays against one triangle after the other, the nearest hit kept.
fn ray_triangle_packet() -> usize {
    let mesh = triangles();
    let corners: Vec<_> = (0..PRIM_COUNT).map(|idx| mesh.corners(idx)).collect();
    let mut packet = RayPacket::EMPTY;
    for (lane, ray) in rays().iter().enumerate() {
        packet.set(lane, &ShearedRay::new(ray));
    }
    let level = SimdLevel::best().level();
    measured_part(|| dispatch!(level, simd => packet_nearest(simd, &mut packet, &corners)));
    LANES * PRIM_COUNT
}

#[inline(always)]
fn packet_nearest<S: Simd>(simd: S, packet: &mut RayPacket, corners: &[[Vec3; 3]]) {
    let active = mask32x16::from_bitmask(simd, 0xffff);
    for corners in corners {
        let hits = intersect_packet(simd, packet, corners, active);
        let before = f32x16::from_slice(simd, &packet.t_max);
        hits.accepted.select(hits.t, before).store_slice(&mut packet.t_max);
    }
}

/// One ray after the other against sixteen triangles at a time, the nearest hit kept.
fn ray_triangle_block() -> usize {
    let mesh = triangles();
    let mut blocks = vec![TriangleBlock::EMPTY; PRIM_COUNT / LANES];
    for idx in 0..PRIM_COUNT {
        blocks[idx / LANES].set(idx % LANES, mesh.corners(idx));
    }
    let mut rays = rays().map(|ray| ShearedRay::new(&ray));
    let level = SimdLevel::best().level();
    measured_part(|| dispatch!(level, simd => block_nearest(simd, &mut rays, &blocks)));
    LANES * PRIM_COUNT
}

#[inline(always)]
fn block_nearest<S: Simd>(simd: S, rays: &mut [ShearedRay], blocks: &[TriangleBlock]) {
    let active = mask32x16::from_bitmask(simd, 0xffff);
    for ray in rays {
        for block in blocks {
            let hits = intersect_block(simd, ray, block, active);
            let mut accepted = hits.accepted.to_bitmask();
            while accepted != 0 {
                ray.t_max = ray.t_max.min(hits.t[accepted.trailing_zeros() as usize]);
                accepted &= accepted - 1;
            }
        }
    }
}

/// Sixteen rays against one sphere after the other, the nearest hit kept.
fn ray_sphere() -> usize {
    let spheres = spheres();
    let mut rays_by_lane = SphereRays::EMPTY;
    for (lane, ray) in rays().iter().enumerate() {
        rays_by_lane.set(lane, ray);
    }
    let level = SimdLevel::best().level();
    measured_part(|| dispatch!(level, simd => sphere_nearest(simd, &rays_by_lane, &spheres)));
    LANES * PRIM_COUNT
}

#[inline(always)]
fn sphere_nearest<S: Simd>(simd: S, rays: &SphereRays, spheres: &[Sphere]) -> [f32; LANES] {
    let active = mask32x16::from_bitmask(simd, 0xffff);
    let mut nearest = f32x16::splat(simd, f32::INFINITY);
    for sphere in spheres {
        let (accepted, t) = intersect_sphere(simd, rays, sphere, active);
        nearest = (accepted & t.simd_lt(nearest)).select(t, nearest);
    }
    let mut t = [0.0; LANES];
    nearest.store_slice(&mut t);
    t
}

/// The cones of sixteen bundles of rays against sixteen bounding spheres at a time.
fn cone_sphere() -> usize {
    let spheres = spheres();
    let mut blocks = vec![SphereBlock::EMPTY; PRIM_COUNT / LANES];
    for (idx, sphere) in spheres.iter().enumerate() {
        blocks[idx / LANES].set(idx % LANES, sphere);
    }
    let cones = rays().map(|ray| {
        let sideways = Vec3::new(0.02, 0.01, 0.0);
        let bundle = [-1.0, 1.0].map(|side| {
            let origin = ray.origin + side * sideways;
            (origin, (ray.direction + 2.0 * side * sideways).normalize())
        });
        SphereCone::around_rays(bundle.into_iter())
    });
    let level = SimdLevel::best().level();
    measured_part(|| dispatch!(level, simd => count_touched(simd, &cones, &blocks)));
    LANES * PRIM_COUNT
}

#[inline(always)]
fn count_touched<S: Simd>(simd: S, cones: &[SphereCone], blocks: &[SphereBlock]) -> u32 {
    let reach = Reach { near: 0.0, far: 10.0 };
    let mut touched = 0;
    for cone in cones {
        for block in blocks {
            let (kept, _) = touches(simd, cone, reach, SLACK, &block.load(simd));
            touched += kept.to_bitmask().count_ones();
        }
    }
    touched
}
