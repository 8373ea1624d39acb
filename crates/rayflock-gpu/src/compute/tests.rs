//! What only this engine has: buffers of pairs that overflow.

use std::sync::Arc;

use glam::Vec3;
use rayflock_engine::{EngineKind, create};
use rayflock_geom::{
    FrameChanges, Geometry, GeometryObject, HitBuffer, ObjectId, RayBatch, Sphere,
};
use rayflock_testkit::Rng;
use rayflock_testkit::scenes::{SoupKind, triangle_soup};

use super::{BLOCK_CHUNKS, CHUNK_PRIMS, Compute, Form};
use crate::GpuContext;
use crate::layout::{Cone, DeviceHit, DevicePrimitive, NO_RANK, TileRange};
use crate::method::{Method, Question};
use crate::primitives::PrimitiveStore;
use crate::slots::{Run, Slots};
use crate::stage_clock::StageClock;
use crate::testing::{contexts, near, read};
use crate::twins;

/// Hits of a batch by an engine with so much room for pairs at most, and the tests it took.
fn trace(
    context: &GpuContext,
    (form, most, question): (Form, usize, Question),
    geometry: &Geometry,
    batch: &RayBatch<'_>,
) -> (Vec<DeviceHit>, u64) {
    let mut primitives = PrimitiveStore::default();
    primitives.commit(context, geometry, &FrameChanges::all(), "gpu:compute").unwrap();
    let mut compute = Compute::with_capacity(context, form, [most.min(64), most]);
    let mut clock = StageClock::new(context);
    compute.prepare(context, &mut clock, &primitives);
    let (mut slots, mut run) = (Slots::default(), Run::default());
    slots.assign(batch);
    run.fill(batch, &slots, 0, &|_| f32::INFINITY);
    let counts = compute.trace(context, &mut clock, &primitives, &mut run, question).unwrap();
    let mut hits = vec![DeviceHit::none_before(f32::INFINITY); batch.len()];
    for (place, ray_idx) in run.ray_places(&slots) {
        hits[ray_idx] = run.hits[place];
    }
    (hits, counts.cones)
}

#[test]
fn pairs_that_do_not_fit_are_never_dropped() {
    let mut rng = Rng::new(51);
    let soup = triangle_soup(&mut rng, SoupKind::Plain, 3000, Vec3::ZERO, 1.0);
    let geometry = Geometry::new(vec![GeometryObject::new(ObjectId(0), soup)]).unwrap();
    let origins: Vec<_> = (0..2000).map(|_| 2.0 * rng.in_cube()).collect();
    let directions: Vec<_> = (0..2000).map(|_| rng.on_sphere()).collect();
    let batch = RayBatch::new(&origins, &directions).unwrap();
    let mut definition = create(EngineKind::Brute);
    definition.commit(&geometry, &FrameChanges::all()).unwrap();
    let mut expected = HitBuffer::new(2000);
    definition.closest_hit(&batch, &mut expected.as_hits());
    for context in contexts() {
        let form = Form::of(context);
        let (grown, grown_tests) =
            trace(context, (form, 1 << 20, Question::Closest), &geometry, &batch);
        let (split, split_tests) = trace(context, (form, 8, Question::Closest), &geometry, &batch);
        assert_eq!(grown, split);
        assert!(split_tests != grown_tests, "nothing was split");
        let same = (0..2000).filter(|&idx| grown[idx].rank == expected.prim_id[idx]).count();
        assert!(same >= 1998, "{same} of 2000");
    }
}

/// Rays that share everything and rays that share nothing, past triangles and spheres that are all
/// there twice, and others that no ray sees: of two alike the first is hit.
#[test]
fn all_forms_find_the_same_and_the_first_of_two_alike() {
    const COUNT: usize = 2500;
    let mut rng = Rng::new(53);
    let soup = triangle_soup(&mut rng, SoupKind::Plain, COUNT, Vec3::ZERO, 1.0);
    let spheres = (0..COUNT).map(|_| Sphere::new(rng.in_cube(), 0.05)).collect();
    let mesh = Arc::new(soup.with_spheres(spheres));
    let object = |id: u32| GeometryObject::new(ObjectId(id), Arc::clone(&mesh));
    let unseen = triangle_soup(&mut rng, SoupKind::Plain, COUNT, Vec3::ZERO, 1.0);
    let unseen = GeometryObject::new(ObjectId(2), unseen).with_mask(2);
    let geometry = Geometry::new(vec![object(0), object(1), unseen]).unwrap();
    let directions: Vec<_> = (0..64 * 20).map(|idx| spread(&mut rng, idx / 64)).collect();
    let batch = RayBatch::new(Vec3::new(0.1, 0.2, -3.0), &directions).unwrap();
    let batch = batch.with_mask(1).unwrap();
    for context in contexts() {
        let find = |form: Form, question: Question| {
            trace(context, (form, 1 << 20, question), &geometry, &batch).0
        };
        let expected = find(Form::Narrow, Question::Closest);
        let is_first = |hit: &&DeviceHit| (hit.rank as usize) < 2 * COUNT;
        let is_sphere = |hit: &&DeviceHit| is_first(hit) && hit.rank as usize >= COUNT;
        let [hit_count, sphere_count] =
            [expected.iter().filter(is_first).count(), expected.iter().filter(is_sphere).count()];
        assert!(
            sphere_count > 100 && hit_count > sphere_count + 100,
            "{sphere_count}, {hit_count}"
        );
        for form in Form::ALL {
            let found = find(form, Question::Closest);
            let numbers = |hit: &DeviceHit| [hit.t, hit.u, hit.v];
            let differs = |(a, b): &(&DeviceHit, &DeviceHit)| {
                a.rank != b.rank || (a.rank != NO_RANK && !near(&numbers(a), &numbers(b)))
            };
            let differing = found.iter().zip(&expected).filter(differs).count();
            assert!(differing <= 2, "{form:?}: {differing}");
            let is_wrong = |hit: &&DeviceHit| hit.rank != NO_RANK && !is_first(hit);
            assert_eq!(found.iter().find(is_wrong), None, "{form:?}");
            let any = find(form, Question::Occluded);
            let differs =
                |(a, b): &(&DeviceHit, &DeviceHit)| (a.rank == NO_RANK) != (b.rank == NO_RANK);
            let differing = any.iter().zip(&expected).filter(differs).count();
            assert!(differing <= 2, "{form:?}: {differing}");
            println!("{form:?} on {}", context.adapter());
        }
    }
}

/// Stage by stage on one run: what each leaves in its buffers is what its twin makes of what it
/// was given.
#[test]
fn stages_agree_with_their_twins() {
    contexts().iter().for_each(|context| check_stages(context));
}

fn check_stages(context: &GpuContext) {
    let mut rng = Rng::new(52);
    let soup = triangle_soup(&mut rng, SoupKind::Plain, 2500, Vec3::ZERO, 1.0);
    let geometry = Geometry::new(vec![GeometryObject::new(ObjectId(0), soup)]).unwrap();
    let directions: Vec<_> = (0..64 * 300).map(|idx| spread(&mut rng, idx / 64)).collect();
    let batch = RayBatch::new(Vec3::new(0.1, 0.2, -3.0), &directions).unwrap();
    let mut primitives = PrimitiveStore::default();
    primitives.commit(context, &geometry, &FrameChanges::all(), "gpu:compute").unwrap();
    let mut compute = Compute::new(context);
    let mut clock = StageClock::new(context);
    compute.prepare(context, &mut clock, &primitives);
    let (mut slots, mut run) = (Slots::default(), Run::default());
    slots.assign(&batch);
    run.fill(&batch, &slots, 0, &|_| f32::INFINITY);
    compute.trace(context, &mut clock, &primitives, &mut run, Question::Closest).unwrap();

    // The last one is not full.
    let chunk_count = 2500_usize.div_ceil(CHUNK_PRIMS);
    let chunks: Vec<twins::DeviceSphere> =
        read(context, compute.order.chunk_buffer(0), chunk_count);
    let ordered: Vec<DevicePrimitive> = read(context, compute.order.ordered_buffer(0), 2500);
    let prims = ordered.chunks(CHUNK_PRIMS);
    for (chunk_idx, (chunk, prims)) in chunks.iter().zip(prims).enumerate() {
        let expected = twins::bound_chunks(prims);
        assert!(near(chunk, &expected), "chunk {chunk_idx}: {chunk:?}, not {expected:?}");
    }
    let blocks: Vec<twins::DeviceSphere> =
        read(context, compute.blocks[0].buffer(), chunk_count.div_ceil(BLOCK_CHUNKS));
    for (block_idx, (block, chunks)) in blocks.iter().zip(chunks.chunks(BLOCK_CHUNKS)).enumerate() {
        let expected = twins::bound_blocks(chunks);
        assert!(near(block, &expected), "block {block_idx}: {block:?}, not {expected:?}");
    }
    let buffers = &compute.buffers;
    let cones: Vec<Cone> = read(context, buffers.cone_buffer(), 300);
    let ranges: Vec<TileRange> = read(context, buffers.range_buffer(), 300);
    let list: Vec<u32> = read(context, buffers.list_buffer(), 1 << 16);
    let counts: Vec<_> = ranges.iter().map(|range| range.count).collect();
    assert_eq!(ranges, twins::plan_lists(&counts));
    for (tile_idx, cone) in cones.iter().enumerate() {
        let expected = twins::bound_tiles(&run.rays[64 * tile_idx..][..64]);
        let numbers = |cone: &Cone| bytemuck::cast::<Cone, [f32; 8]>(*cone);
        assert!(near(&numbers(cone), &numbers(&expected)), "{cone:?}, not {expected:?}");
        let range = ranges[tile_idx];
        let listed = &list[range.first as usize..][..range.count as usize];
        if expected.sin > 1.0 {
            assert!(listed.is_empty(), "tile {tile_idx} needs no list");
            continue;
        }
        for (block_idx, block) in blocks.iter().enumerate() {
            let apart = twins::refine(cone, *block);
            let is_listed = listed.contains(&(block_idx as u32));
            // What is neither clearly apart nor clearly touched may be on either side.
            assert!(is_listed || apart > 1e-6, "{block_idx} is missing from tile {tile_idx}");
            assert!(!is_listed || apart < 1e-4, "{block_idx} is too much in tile {tile_idx}");
        }
    }
}

/// A direction near that of its tile; every tenth tile goes to all sides.
fn spread(rng: &mut Rng, tile_idx: usize) -> Vec3 {
    let angle = tile_idx as f32 * 0.02;
    let main = Vec3::new(0.4 * angle.sin(), 0.4 * angle.cos(), 1.0);
    let width = if tile_idx.is_multiple_of(10) { 3.0 } else { 0.05 };
    main + width * rng.in_cube()
}
