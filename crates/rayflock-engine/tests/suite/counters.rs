//! Counters on scenes so small that they can be worked out by hand.
//!
//! The scene is one triangle right ahead, the rays a bundle of parallel ones that all hit it; so
//! every cone touches the block and the primitive in it, and every list has one candidate.

use glam::Vec3;
use rayflock_engine::{EngineKind, TraceStats, create};
use rayflock_geom::{
    FrameChanges, Geometry, GeometryObject, HitBuffer, Mesh, ObjectId, RayBatch, RayOrder, Sphere,
};

/// What a test reads of one triangle: nine coordinates, rank and mask.
const TRIANGLE: u64 = 44;
/// What a test reads of one sphere: four numbers, rank and mask.
const SPHERE: u64 = 24;
/// Sixteen bounding spheres.
const BOUNDS: u64 = 256;
/// What is written of a candidate: sphere, slot, distance.
const CANDIDATE: u64 = 24;
/// What is read of a list: sixteen spheres and slots.
const LIST_BLOCK: u64 = 320;
/// Slot and distance read, key written.
const SORTED: u64 = 16;

fn triangle() -> Mesh {
    let corners =
        vec![Vec3::new(-9.0, -9.0, 50.0), Vec3::new(9.0, -9.0, 50.0), Vec3::new(0.0, 9.0, 50.0)];
    Mesh::from_triangles(corners, vec![[0, 1, 2]]).unwrap()
}

/// The counts of `ray_count` rays at `mesh` on one thread; all of them must hit.
fn count(kind: EngineKind, mesh: Mesh, ray_count: usize, order: RayOrder) -> TraceStats {
    let geometry = Geometry::new(vec![GeometryObject::new(ObjectId(0), mesh)]).unwrap();
    let origins: Vec<_> = (0..ray_count).map(|idx| 1e-4 * idx as f32 * Vec3::X).collect();
    // A direction each: nothing that an engine can tell to be shared.
    let directions = vec![Vec3::Z; ray_count];
    let rays = RayBatch::new(&origins, &directions).unwrap().with_order(order);
    let mut engine = create(kind);
    let mut hits = HitBuffer::new(ray_count);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let stats = pool.install(|| {
        engine.commit(&geometry, &FrameChanges::all()).unwrap();
        engine.closest_hit(&rays, &mut hits.as_hits())
    });
    assert!((0..ray_count).all(|idx| !hits.get(idx).is_miss()));
    stats
}

#[test]
fn brute_reads_the_whole_block_for_each_ray() {
    let stats = count(EngineKind::Brute, triangle(), 20, RayOrder::Coherent);
    let expected = TraceStats {
        rays: 20,
        triangle_tests: 20 * 16,
        bytes: 20 * 16 * TRIANGLE,
        ..TraceStats::default()
    };
    assert_eq!(stats, expected);
}

#[test]
fn brute_reads_a_sphere_once_for_sixteen_rays() {
    let ball = Mesh::from_spheres(vec![Sphere::new(5.0 * Vec3::Z, 1.0)]);
    let stats = count(EngineKind::Brute, ball, 32, RayOrder::Coherent);
    let expected =
        TraceStats { rays: 32, sphere_tests: 32, bytes: 2 * SPHERE, ..TraceStats::default() };
    assert_eq!(stats, expected);
}

#[test]
fn hierarchy_with_one_tile_asks_the_block_then_its_member() {
    let stats = count(EngineKind::Hierarchy, triangle(), 16, RayOrder::Coherent);
    let expected = TraceStats {
        rays: 16,
        cone_tests: 16 + 16,
        triangle_tests: 16,
        pairs: 1,
        bytes: 2 * BOUNDS + CANDIDATE + SORTED + TRIANGLE,
        ..TraceStats::default()
    };
    assert_eq!(stats, expected);
}

/// With one thread, the tasks are the sixteen nodes above the 64 tiles.
#[test]
fn hierarchy_hands_the_list_of_a_node_to_its_four_tiles() {
    let stats = count(EngineKind::Hierarchy, triangle(), 64 * 16, RayOrder::Coherent);
    let node = 2 * BOUNDS + CANDIDATE;
    let tile = LIST_BLOCK + CANDIDATE + SORTED + TRIANGLE;
    let expected = TraceStats {
        rays: 64 * 16,
        cone_tests: 16 * 32 + 64 * 16,
        triangle_tests: 64 * 16,
        pairs: 16 + 64,
        bytes: 16 * node + 64 * tile,
        ..TraceStats::default()
    };
    assert_eq!(stats, expected);
}

/// Rays to all sides in one tile: each is its own cone, and gets a list of its own.
#[test]
fn hierarchy_counts_single_rays_where_a_tile_is_too_wide() {
    let geometry = Geometry::new(vec![GeometryObject::new(ObjectId(0), triangle())]).unwrap();
    let directions: Vec<_> =
        (0..16).map(|idx| if idx % 2 == 0 { Vec3::Z } else { Vec3::NEG_Z }).collect();
    let origins = [Vec3::ZERO; 16];
    let rays = RayBatch::new(&origins[..], &directions).unwrap().with_order(RayOrder::Coherent);
    let mut engine = create(EngineKind::Hierarchy);
    engine.commit(&geometry, &FrameChanges::all()).unwrap();
    let stats = engine.closest_hit(&rays, &mut HitBuffer::new(16).as_hits());
    let hit = 2 * BOUNDS + CANDIDATE + SORTED + TRIANGLE;
    let expected = TraceStats {
        rays: 16,
        cone_tests: 8 * 32 + 8 * 16,
        triangle_tests: 8 * 16,
        pairs: 8,
        bytes: 8 * hit + 8 * BOUNDS,
        ..TraceStats::default()
    };
    assert_eq!(stats, expected);
}
