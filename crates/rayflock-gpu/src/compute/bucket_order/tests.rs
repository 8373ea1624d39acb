//! Each primitive has the place of its cell, and a good order is kept.

use glam::Vec3;
use rayflock_geom::{FrameChanges, Geometry, GeometryObject, Mesh, ObjectId, Sphere};
use rayflock_testkit::Rng;
use rayflock_testkit::scenes::{SoupKind, triangle_soup};

use super::{BucketOrder, cell_params};
use crate::GpuContext;
use crate::layout::DevicePrimitive;
use crate::pass::StageEncoder;
use crate::primitives::PrimitiveStore;
use crate::stage_clock::StageClock;
use crate::testing::{contexts, read};
use crate::twins;

fn order(context: &GpuContext, geometry: &Geometry) -> (BucketOrder, PrimitiveStore) {
    let mut primitives = PrimitiveStore::default();
    primitives.commit(context, geometry, &FrameChanges::all(), "gpu:compute").unwrap();
    let (mut order, mut clock) = (BucketOrder::new(context), StageClock::new(context));
    let mut encoder = StageEncoder::new(context, &mut clock);
    order.order(&mut encoder, &primitives);
    encoder.submit();
    (order, primitives)
}

fn of(meshes: Vec<Mesh>) -> Geometry {
    let objects = (0..).zip(meshes);
    let objects = objects.map(|(id, mesh)| GeometryObject::new(ObjectId(id), mesh));
    Geometry::new(objects.collect()).unwrap()
}

/// Triangles of all sizes, spheres and what is ignored: more cells than a workgroup places.
fn mixed() -> Geometry {
    let mut rng = Rng::new(61);
    let soup = triangle_soup(&mut rng, SoupKind::Plain, 9000, Vec3::ZERO, 1.0);
    let large = triangle_soup(&mut rng, SoupKind::Plain, 10, Vec3::ZERO, 20.0);
    let spheres = (0..200).map(|_| Sphere::new(rng.in_cube(), 0.02)).collect();
    let nothing = Mesh::from_triangles(vec![Vec3::ONE; 3], vec![[0, 1, 2]; 30]).unwrap();
    of(vec![soup, nothing, large, Mesh::from_spheres(spheres)])
}

#[test]
fn primitives_lie_where_their_cells_say() {
    let geometry = mixed();
    let prim_count = geometry.prim_count();
    let params = cell_params(prim_count);
    for context in contexts() {
        let (order, primitives) = order(context, &geometry);
        let prims = primitives.host();
        let bounds = twins::bound_scene(prims);
        let places: Vec<[u32; 2]> = read(context, order.places.buffer(), prim_count);
        let mut counts = vec![0; params.cell_count as usize];
        for (prim, [cell, _]) in prims.iter().zip(&places) {
            counts[*cell as usize] += 1;
            if prim.mask == 0 {
                assert_eq!(*cell, params.cell_count - 1);
                continue;
            }
            let (expected, margin) = twins::count_cells(prim, bounds, params.finest);
            assert!(*cell == expected || margin < 1e-3, "{prim:?}: {cell}, not {expected}");
        }
        let firsts: Vec<u32> = read(context, order.cells.buffer(), counts.len());
        assert_eq!(firsts, twins::place_cells(&counts));
        let ordered: Vec<DevicePrimitive> = read(context, order.ordered_buffer(0), prim_count);
        for (prim, [cell, place]) in prims.iter().zip(places) {
            assert_eq!(ordered[(firsts[cell as usize] + place) as usize], *prim);
        }
    }
}

/// Sheets of sixteen small triangles each, one beside the other.
fn patches() -> Mesh {
    let corners = (0..64_u32).flat_map(|patch| {
        let origin = Vec3::new((patch % 8) as f32, 0.0, (patch / 8) as f32) * 1.37;
        (0..16_u32).flat_map(move |idx| {
            let at = origin + Vec3::new((idx % 4) as f32, 0.0, (idx / 4) as f32) * 0.1;
            [at, at + 0.1 * Vec3::X, at + 0.1 * Vec3::Z]
        })
    });
    let corners: Vec<Vec3> = corners.collect();
    let triangles: Vec<_> = (0..1024).map(|idx| [3 * idx, 3 * idx + 1, 3 * idx + 2]).collect();
    Mesh::from_triangles(corners, triangles).unwrap()
}

#[test]
fn a_good_order_is_kept_and_a_bad_one_is_not() {
    let mut rng = Rng::new(62);
    let soup = triangle_soup(&mut rng, SoupKind::Plain, 1000, Vec3::ZERO, 1.0);
    for (mesh, is_good) in [(patches(), true), (soup, false)] {
        let geometry = of(vec![mesh]);
        for context in contexts() {
            let (order, primitives) = order(context, &geometry);
            let prims = primitives.host();
            let ordered: Vec<DevicePrimitive> = read(context, order.ordered_buffer(0), prims.len());
            assert_eq!(ordered == prims, is_good);
            let chunk_count = prims.len().div_ceil(16);
            let chunks: Vec<twins::DeviceSphere> =
                read(context, order.chunk_buffer(0), chunk_count);
            for (chunk, prims) in chunks.iter().zip(ordered.chunks(16)) {
                assert!(crate::testing::near(chunk, &twins::bound_chunks(prims)));
            }
        }
    }
}
