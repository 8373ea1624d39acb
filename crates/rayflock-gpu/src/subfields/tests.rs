//! What only this engine has: subfields that last, rounds, and tiles.

use glam::{DVec2, DVec3, Vec3};
use rayflock_geom::{FrameChanges, Geometry, GeometryObject, Mesh, ObjectId, RayBatch};
use rayflock_testkit::Rng;
use rayflock_testkit::scenes::{SoupKind, spheres, triangle_soup};

use super::held::Held;
use super::{Config, Grid, MOST_CELLS, PRIM_BITS, Subfields};
use crate::GpuContext;
use crate::layout::{
    DeviceHit, DevicePrimitive, DeviceRay, SPHERE, Subfield, SubfieldCounters, TileRange,
};
use crate::method::{Method, Question, TestCounts};
use crate::primitives::PrimitiveStore;
use crate::slots::{Run, Slots};
use crate::stage_clock::StageClock;
use crate::testing::{contexts, near, read};
use crate::twins;

/// An engine with a frame.
struct Bench<'a> {
    context: &'a GpuContext,
    primitives: PrimitiveStore,
    subfields: Subfields,
    clock: StageClock,
    run: Run,
}

impl<'a> Bench<'a> {
    fn new(context: &'a GpuContext, config: Config, geometry: &Geometry) -> Self {
        let mut bench = Self {
            context,
            primitives: PrimitiveStore::default(),
            subfields: Subfields::new(context, config),
            clock: StageClock::new(context),
            run: Run::default(),
        };
        bench.commit(geometry);
        bench
    }

    /// The same device and frame with other settings.
    fn set(&mut self, config: Config) {
        let (set, shared) = (Held::new(&config), Held::new(&config));
        (self.subfields.config, self.subfields.set, self.subfields.shared) = (config, set, shared);
    }

    fn commit(&mut self, geometry: &Geometry) {
        let (context, changes) = (self.context, FrameChanges::all());
        self.primitives.commit(context, geometry, &changes, "gpu:subfields").unwrap();
        self.subfields.prepare(context, &mut self.clock, &self.primitives);
    }

    /// Nearest hits of a batch, and the tests they took.
    fn trace(&mut self, batch: &RayBatch<'_>) -> (Vec<DeviceHit>, TestCounts) {
        let mut slots = Slots::default();
        slots.assign(batch);
        self.run.fill(batch, &slots, 0, &|_| f32::INFINITY);
        let Self { context, primitives, subfields, clock, run } = self;
        let counts = subfields.trace(context, clock, primitives, run, Question::Closest).unwrap();
        let mut hits = vec![DeviceHit::none_before(f32::INFINITY); batch.len()];
        for (place, ray_idx) in run.ray_places(&slots) {
            hits[ray_idx] = run.hits[place];
        }
        (hits, counts)
    }
}

fn frame(rng: &mut Rng, triangle_count: usize) -> Geometry {
    let soup = triangle_soup(rng, SoupKind::Plain, triangle_count, Vec3::ZERO, 1.0);
    let mesh = soup.with_spheres(spheres(rng, triangle_count / 20, Vec3::ZERO, 0.5));
    Geometry::new(vec![GeometryObject::new(ObjectId(0), mesh)]).unwrap()
}

/// Rays from around the middle to all sides.
fn rays(rng: &mut Rng, count: usize) -> (Vec<Vec3>, Vec<Vec3>) {
    let origins = (0..count).map(|_| 2.0 * rng.in_cube()).collect();
    let directions = (0..count).map(|_| 3.0 * rng.on_sphere()).collect();
    (origins, directions)
}

const fn with_grid(direction_edge: usize, tile_edge: usize) -> Grid {
    Grid { direction_edge, tile_edge }
}

#[test]
fn entries_that_do_not_fit_are_never_dropped() {
    let mut rng = Rng::new(61);
    let geometry = frame(&mut rng, 1500);
    let prim_count = 1500 + 75;
    let (origins, directions) = rays(&mut rng, 1500);
    let batch = RayBatch::new(&origins, &directions).unwrap();
    for context in contexts() {
        let config = Config { grid: Some(with_grid(4, 24)), ..Config::default() };
        let mut bench = Bench::new(context, config, &geometry);
        let (expected, whole) = bench.trace(&batch);
        // Grown, traced in rounds, with larger tiles, and with room for the tiles of few subfields.
        let grown = Config { first_capacity: 64, ..config };
        let in_rounds = Config { largest_capacity: whole.pairs as usize / 3, ..grown };
        let coarse = Config { largest_capacity: prim_count, ..grown };
        let few_tiles = Config { most_tiles: 3 * 24 * 24, ..config };
        for config in [grown, in_rounds, coarse, few_tiles] {
            bench.set(config);
            let (found, counts) = bench.trace(&batch);
            assert_eq!(found, expected, "{config:?}");
            let is_coarse = config.largest_capacity == prim_count;
            assert_eq!(counts.pairs == whole.pairs, !is_coarse, "{config:?}: {counts:?}");
            // Entries of a tile stand in any order, so that a few more or less are tested.
            let is_near = counts.triangles.abs_diff(whole.triangles) < whole.triangles / 10;
            assert!(is_near || is_coarse, "a ray is traced once: {counts:?}, not {whole:?}");
        }
    }
}

/// Hits of a batch and the tests they took, with grids of other sizes.
fn trace_with_grids(
    context: &GpuContext,
    geometry: &Geometry,
    batch: &RayBatch<'_>,
    grids: &[(usize, usize)],
) -> Vec<(Vec<DeviceHit>, TestCounts)> {
    let mut bench = Bench::new(context, Config::default(), geometry);
    let trace = |&(direction_edge, tile_edge): &(usize, usize)| {
        let grid = Some(with_grid(direction_edge, tile_edge));
        bench.set(Config { grid, ..Config::default() });
        bench.trace(batch)
    };
    grids.iter().map(trace).collect()
}

/// With a single tile for all directions, every ray meets every primitive at its depth.
#[test]
fn grids_of_every_size_give_the_same_answer() {
    let mut rng = Rng::new(62);
    let geometry = frame(&mut rng, 300);
    let (origins, directions) = rays(&mut rng, 1000);
    let batch = RayBatch::new(&origins, &directions).unwrap();
    for context in contexts() {
        let grids = [(1, 1), (1, 40), (16, 7), (3, 200)];
        let mut traced = trace_with_grids(context, &geometry, &batch, &grids).into_iter();
        let (expected, all) = traced.next().unwrap();
        assert!(expected.iter().filter(|hit| hit.t < f32::INFINITY).count() > 300);
        for (found, counts) in traced {
            assert_eq!(found, expected);
            assert!(5 * counts.triangles < all.triangles, "{counts:?}, of {all:?}");
        }
    }
}

/// Rays along a shared direction, from near and far, and to all sides, through the corners of a
/// lattice on the borders of tiles: of six triangles that meet there, the one of lowest rank is hit.
#[test]
fn what_lies_on_the_border_of_a_tile_is_in_both() {
    const EDGE: u32 = 16;
    let place = |idx: u32| idx as f32 / (EDGE / 2) as f32 - 1.0;
    let corner = |idx: u32| Vec3::new(place(idx % (EDGE + 1)), place(idx / (EDGE + 1)), 0.0);
    let corners: Vec<_> = (0..(EDGE + 1) * (EDGE + 1)).map(corner).collect();
    let halves = |idx: u32| {
        let a = idx / EDGE * (EDGE + 1) + idx % EDGE;
        [[a, a + 1, a + EDGE + 2], [a, a + EDGE + 2, a + EDGE + 1]]
    };
    let triangles: Vec<_> = (0..EDGE * EDGE).flat_map(halves).collect();
    let mesh = Mesh::from_triangles(corners.clone(), triangles).unwrap();
    let geometry = Geometry::new(vec![GeometryObject::new(ObjectId(0), mesh)]).unwrap();

    let mut rng = Rng::new(66);
    let shared = Vec3::new(0.3, -0.5, 1.0);
    let directions: Vec<_> = corners.iter().map(|_| rng.in_cube() + 2.0 * Vec3::Z).collect();
    let back = |(at, way): (&Vec3, Vec3)| *at - (0.3 + rng.unit()) * way;
    let origins: Vec<_> = corners.iter().zip(directions.iter().copied()).map(back).collect();
    let back = |at: &Vec3| *at - (0.3 + rng.unit()) * shared;
    let shared_origins: Vec<_> = corners.iter().map(back).collect();
    let far_origins: Vec<_> = corners.iter().map(|at| *at - 2000.0 * shared).collect();
    let around = RayBatch::new(&origins, &directions).unwrap();
    let along = RayBatch::new(&shared_origins, shared).unwrap();
    let far = RayBatch::new(&far_origins, shared).unwrap();
    for context in contexts() {
        for batch in [&around, &along, &far] {
            let grids = [(1, 1), (1, 8), (1, 16), (1, 32)];
            let traced = trace_with_grids(context, &geometry, batch, &grids);
            let ranks =
                |hits: &[DeviceHit]| -> Vec<_> { hits.iter().map(|hit| hit.rank).collect() };
            for (found, _) in &traced[1..] {
                assert_eq!(ranks(found), ranks(&traced[0].0));
            }
        }
    }
}

#[test]
fn what_a_frame_has_written_is_not_written_again() {
    let mut rng = Rng::new(63);
    let geometry = frame(&mut rng, 400);
    let (origins, directions) = rays(&mut rng, 600);
    let set = RayBatch::new(&origins, &directions).unwrap();
    let along = RayBatch::new(&origins, directions[0]).unwrap();
    let elsewhere = RayBatch::new(&origins, directions[1]).unwrap();
    for context in contexts() {
        let mut bench = Bench::new(context, Config::default(), &geometry);
        for batch in [&set, &along] {
            let (first, counts) = bench.trace(batch);
            assert!(counts.pairs > 400, "{counts:?}");
            let (again, counts) = bench.trace(batch);
            assert_eq!((counts.pairs, again), (0, first));
        }
        assert!(bench.trace(&elsewhere).1.pairs > 400);
        assert_eq!(bench.trace(&set).1.pairs, 0, "a shared direction took the place of the set");
        bench.commit(&geometry);
        assert!(bench.trace(&set).1.pairs > 400, "what is held is of the frame before");
    }
}

/// A batch that goes few ways has few subfields.
#[test]
fn only_directions_that_occur_are_written() {
    let mut rng = Rng::new(64);
    let geometry = frame(&mut rng, 400);
    let (origins, all) = rays(&mut rng, 640);
    let two: Vec<_> = (0..640).map(|idx| if idx % 2 == 0 { Vec3::X } else { Vec3::Y }).collect();
    let config = Config { grid: Some(with_grid(8, 10)), ..Config::default() };
    for context in contexts() {
        let mut bench = Bench::new(context, config, &geometry);
        let mut pairs = |directions: &Vec<Vec3>| {
            bench.set(config);
            bench.trace(&RayBatch::new(&origins, directions).unwrap()).1.pairs
        };
        let (two, all) = (pairs(&two), pairs(&all));
        assert!(two > 800 && 20 * two < all, "{two} of {all}");
    }
}

/// Stage by stage on one run: what each leaves in its buffers is what its twin makes of what it
/// was given.
#[test]
fn stages_agree_with_their_twins() {
    contexts().iter().for_each(|context| check_stages(context));
}

fn check_stages(context: &GpuContext) {
    let mut rng = Rng::new(65);
    let needles = triangle_soup(&mut rng, SoupKind::Needles, 40, Vec3::ZERO, 1.0);
    let mut objects = frame(&mut rng, 200).objects().to_vec();
    objects.push(GeometryObject::new(ObjectId(1), needles));
    let geometry = Geometry::new(objects).unwrap();
    let (origins, directions) = rays(&mut rng, 500);
    let batch = RayBatch::new(&origins, &directions).unwrap();
    let grid = with_grid(4, 12);
    let config = Config { grid: Some(grid), ..Config::default() };
    let mut bench = Bench::new(context, config, &geometry);
    bench.trace(&batch);

    check_bounds(&bench);
    check_marks(&bench, grid);
    check_tiles(&bench, grid);
}

fn check_bounds(bench: &Bench<'_>) {
    let words: Vec<u32> = read(bench.context, bench.subfields.boxes.buffer(), 6);
    let number =
        |bits: u32| f32::from_bits(if bits >> 31 == 0 { !bits } else { bits & !(1 << 31) });
    let found: Vec<_> = words.into_iter().map(number).collect();
    let [low, high] = twins::bound_scene(bench.primitives.host());
    let expected = [high.to_array(), (-low).to_array()].concat();
    assert!(near(&found, &expected), "{found:?}, not {expected:?}");
}

fn check_marks(bench: &Bench<'_>, grid: Grid) {
    let buffers = &bench.subfields.buffers;
    let found: Vec<DeviceRay> = read(bench.context, buffers.ray_buffer(), bench.run.rays.len());
    let cells: Vec<u32> = read(bench.context, bench.subfields.set.cell_buffer(), 2 * MOST_CELLS);
    let edge = grid.direction_edge as u32;
    let mut is_marked = [false; MOST_CELLS];
    for ray in found.iter().filter(|ray| ray.is_active()) {
        is_marked[ray.cell as usize] = true;
        let place = twins::mark_directions(Vec3::from(ray.direction), edge);
        let cell = [ray.cell % edge, ray.cell / edge].map(|idx| idx as f32);
        for (place, first) in place.into_iter().zip(cell) {
            assert!((first - 1e-4..=first + 1.0 + 1e-4).contains(&place), "{ray:?}");
        }
    }
    for (cell, is_marked) in is_marked.into_iter().enumerate() {
        assert_eq!(cells[MOST_CELLS + cell] != 0, is_marked, "{cell}");
    }
}

fn check_tiles(bench: &Bench<'_>, grid: Grid) {
    let (context, held) = (bench.context, &bench.subfields.set);
    let counters: Vec<SubfieldCounters> = read(context, held.counter_buffer(), 1);
    let count = counters[0].subfield_count as usize;
    assert_eq!(count, grid.direction_count(), "rays go everywhere");
    let fields: Vec<Subfield> = read(context, held.subfield_buffer(), count);
    let tiles: Vec<TileRange> = read(context, held.tile_buffer(), count * grid.tile_count());
    let entries: Vec<u32> = read(context, held.entry_buffer(), counters[0].entries as usize);
    let mut is_taken = vec![false; entries.len()];
    let prims = bench.primitives.host();
    for (tile_idx, tile) in tiles.iter().enumerate() {
        let range = tile.first as usize..(tile.first + tile.count) as usize;
        let free = is_taken[range.clone()].iter_mut();
        free.for_each(|taken| assert!(!std::mem::replace(taken, true), "tiles share an entry"));
        let listed: Vec<_> = entries[range].iter().map(|entry| entry % (1 << PRIM_BITS)).collect();
        let field = &fields[tile_idx / grid.tile_count()];
        let place = tile_idx % grid.tile_count();
        let cell = [place % grid.tile_edge, place / grid.tile_edge].map(|idx| idx as f64 + 0.5);
        for (prim_idx, prim) in prims.iter().enumerate().filter(|(_, prim)| prim.mask != 0) {
            let places = places_of(prim, field, grid);
            let apart = twins::write_tiles(prim, places, DVec2::from(cell));
            let is_listed = listed.contains(&(prim_idx as u32));
            assert!(is_listed || apart > 0.0, "{prim_idx} is missing from tile {tile_idx}");
            assert!(!is_listed || apart < 0.01, "{prim_idx} is too much in tile {tile_idx}");
        }
    }
    assert!(is_taken.into_iter().all(|taken| taken), "an entry is in no tile");
}

/// A primitive as a subfield sees it.
fn places_of(prim: &DevicePrimitive, field: &Subfield, grid: Grid) -> [DVec2; 3] {
    let [column, row, center] =
        [field.column, field.row, field.center].map(|v| Vec3::from(v).as_dvec3());
    let seen = |v: DVec3| DVec2::new(v.dot(column), v.dot(row));
    let middle = DVec2::splat(0.5 * grid.tile_edge as f64);
    let [a, b, c] = [prim.a, prim.b, prim.c]
        .map(|corner| seen(Vec3::from(corner).as_dvec3() - center) + middle);
    if prim.kind == SPHERE {
        let axes = f64::from(prim.b[0]) * DVec2::new(column.length(), row.length());
        return [a, axes, axes];
    }
    [a, b, c]
}
