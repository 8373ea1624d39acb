//! The table after any sequence of frames, against one written plainly, primitive by primitive.

use std::sync::Arc;

use glam::{Affine3A, Vec3};
use proptest::prelude::*;
use rayflock_geom::simd::cone_sphere::SphereBlock;
use rayflock_geom::simd::{LANES, SimdLevel, dispatch};
use rayflock_geom::{
    FrameChanges, Geometry, GeometryObject, Mesh, ObjectId, PrimId, RayTransform, Sphere,
    is_degenerate_triangle, transform_point, transform_sphere,
};
use rayflock_testkit::Rng;
use rayflock_testkit::scenes::{SceneRecipe, scene_recipe};

use super::{BLOCKS_PER_READ, BlockReader, Ignored, PrimitiveTable};

/// Columns that are written in the plainest way.
#[derive(Default)]
struct Plain {
    /// Corners of the triangle slots, padding included.
    corners: Vec<[Vec3; 3]>,
    /// Bounding spheres of all slots; `None` for what nothing may touch.
    bounds: Vec<Option<Sphere>>,
    ranks: Vec<u32>,
    masks: Vec<u32>,
    prim_count: usize,
    ignored: Ignored,
}

impl Plain {
    fn new(geometry: &Geometry) -> Self {
        let mut plain = Self { prim_count: geometry.prim_count(), ..Self::default() };
        let mut first_rank = 0;
        for kind in 0..3 {
            first_rank = 0;
            for object in geometry.objects() {
                plain.add_object(object, kind, first_rank);
                first_rank += object.shape.prim_count();
            }
            plain.pad(kind == 0);
        }
        assert_eq!(first_rank, geometry.prim_count());
        plain
    }

    fn add_object(&mut self, object: &GeometryObject, kind: usize, first_rank: usize) {
        let (mesh, place) = (&object.shape, object.world_from_object);
        let (triangle_count, sphere_count) = (mesh.triangles().len(), mesh.spheres().len());
        match kind {
            0 => (0..triangle_count).for_each(|idx| {
                let corners = mesh.corners(idx);
                let corners = place.map_or(corners, |m| corners.map(|c| transform_point(&m, c)));
                self.add_triangle(corners, first_rank + idx, object.mask);
            }),
            1 => (0..sphere_count).for_each(|idx| {
                let sphere = mesh.spheres()[idx];
                let sphere = place.map_or(sphere, |m| transform_sphere(&m, &sphere));
                let is_finite = sphere.center.is_finite() && sphere.radius.is_finite();
                let bound = sphere.is_valid().then_some(sphere);
                self.add(bound, is_finite, first_rank + triangle_count + idx, object.mask);
            }),
            _ => (0..mesh.user().map_or(0, |user| user.len())).for_each(|idx| {
                let sphere = mesh.user().unwrap().bounding_sphere(idx);
                let in_world = |m: Affine3A| {
                    RayTransform::new(&m).map(|transform| transform.sphere_in_world(&m, &sphere))
                };
                let bound = place.map_or(Some(sphere), in_world);
                let is_finite = bound.is_none_or(|b| b.center.is_finite() && b.radius.is_finite());
                let bound = bound.filter(|bound| is_finite && bound.radius >= 0.0);
                let rank = first_rank + triangle_count + sphere_count + idx;
                self.add(bound, is_finite, rank, object.mask);
            }),
        }
    }

    fn add_triangle(&mut self, corners: [Vec3; 3], rank: usize, mask: u32) {
        let [a, b, c] = corners;
        let is_solid = !is_degenerate_triangle(corners);
        let is_finite = corners.iter().all(|corner| corner.is_finite());
        self.corners.push(if is_solid { corners } else { [Vec3::ZERO; 3] });
        self.add(is_solid.then(|| Sphere::around_triangle(a, b, c)), is_finite, rank, mask);
    }

    fn add(&mut self, bound: Option<Sphere>, is_finite: bool, rank: usize, mask: u32) {
        if bound.is_none() {
            self.ignored.non_finite += usize::from(!is_finite);
            self.ignored.degenerate += usize::from(is_finite);
        }
        self.masks.push(if bound.is_some() { mask } else { 0 });
        self.bounds.push(bound);
        self.ranks.push(rank as u32);
    }

    fn pad(&mut self, triangles: bool) {
        while !self.ranks.len().is_multiple_of(LANES) {
            if triangles {
                self.corners.push([Vec3::ZERO; 3]);
            }
            self.bounds.push(None);
            self.ranks.push(u32::MAX);
            self.masks.push(0);
        }
    }

    /// Compares what a table holds of triangles, and of everything but bounds.
    fn check(&self, table: &PrimitiveTable) {
        for (slot, corners) in self.corners.iter().enumerate() {
            assert_eq!(bits(&table.triangle(slot as u32)), bits(corners), "slot {slot}");
        }
        assert_eq!(table.ranks.as_flattened(), self.ranks);
        assert_eq!(table.masks.as_flattened(), self.masks);
        assert_eq!(table.has_ignored(), self.ignored.count() > 0);
    }

    /// Compares the triangles that are read, some blocks at a time, and one by one.
    fn check_reading(&self, table: &PrimitiveTable, rng: &mut Rng) {
        let block_count = table.triangle_block_count();
        assert_eq!(block_count * LANES, self.corners.len());
        let mut end = rng.below(block_count + 1);
        let mut reader = BlockReader::new(table, end);
        while end < block_count {
            let count = 1 + rng.below(BLOCKS_PER_READ.min(block_count - end));
            let (blocks, slots) = (end..end + count, end * LANES..(end + count) * LANES);
            end = blocks.end;
            let read = dispatch!(table.simd().level(), simd => reader.read(simd, blocks));
            let triangles = read.corners.iter().flat_map(|block| (0..LANES).map(|i| block.get(i)));
            for ((slot, corners), &mask) in slots.zip(triangles).zip(read.masks.as_flattened()) {
                let expected = (bits(&self.corners[slot]), self.masks[slot]);
                let is_padding = self.ranks[slot] == u32::MAX;
                if is_padding || self.bounds[slot].is_some() {
                    assert_eq!((bits(&corners), mask), expected, "slot {slot}");
                }
            }
        }
        for (slot, corners) in self.corners.iter().enumerate() {
            if self.bounds[slot].is_some() {
                let (read, mask) = table.read_triangle(slot as u32);
                assert_eq!((bits(&read), mask), (bits(corners), self.masks[slot]), "slot {slot}");
            }
        }
        assert_eq!(table.count_ignored(), self.ignored);
    }

    fn check_bounds(&self, table: &PrimitiveTable) {
        let sphere = |blocks: &[SphereBlock], idx: usize| blocks[idx / LANES].get(idx % LANES);
        for (slot, expected) in self.bounds.iter().enumerate() {
            let found = sphere(&table.bounds, slot);
            match expected {
                Some(expected) => assert_eq!(found, *expected, "slot {slot}"),
                None => assert!(found.radius < 0.0, "slot {slot}: {found:?}"),
            }
        }
        for (block_idx, members) in self.bounds.chunks(LANES).enumerate() {
            let around = sphere(table.block_bounds(), block_idx);
            assert_eq!(around.radius >= 0.0, members.iter().any(Option::is_some));
            for member in members.iter().flatten() {
                let offset = member.center.as_dvec3() - around.center.as_dvec3();
                let reach = offset.length() + f64::from(member.radius);
                assert!(reach <= f64::from(around.radius), "block {block_idx}");
            }
        }
    }
}

fn bits(corners: &[Vec3; 3]) -> [[u32; 3]; 3] {
    corners.map(|corner| corner.to_array().map(f32::to_bits))
}

/// Commits frames, with exact changes or without; has triangles and bounds written now and then.
fn check_frames(frames: &[Geometry], simd: SimdLevel, exactly: bool, rng: &mut Rng) {
    let mut table = PrimitiveTable::new(simd);
    let mut previous = Geometry::default();
    for frame in frames {
        let exact = FrameChanges::between(&previous, frame);
        let changes = if exactly { exact } else { FrameChanges::all() };
        let stats = table.commit(frame, &changes);
        let plain = Plain::new(frame);
        assert_eq!(stats.prim_count, plain.prim_count);
        plain.check_reading(&table, rng);
        if rng.one_in(2) {
            table.write_triangles();
            plain.check(&table);
            plain.check_reading(&table, rng);
        }
        if rng.one_in(2) {
            table.write_bounds();
            plain.check(&table);
            plain.check_bounds(&table);
        }
        check_ids(&table, frame);
        previous = frame.clone();
    }
}

fn check_ids(table: &PrimitiveTable, frame: &Geometry) {
    let mut rank = 0;
    for object in frame.objects() {
        for prim_idx in 0..object.shape.prim_count() as u32 {
            assert_eq!(table.object_of_rank(rank).ids(rank), (object.id, PrimId(prim_idx)));
            rank += 1;
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    #[test]
    fn any_sequence_of_frames_leaves_what_a_plain_writer_writes(
        recipe in scene_recipe(6, 120),
        exactly in any::<bool>(),
    ) {
        let frames = recipe.frames(6);
        for simd in SimdLevel::available() {
            check_frames(&frames, simd, exactly, &mut Rng::new(recipe.seed));
        }
    }
}

/// Objects that span several tasks and share blocks.
#[test]
fn large_objects_are_written_as_by_a_plain_writer() {
    let recipe = SceneRecipe { seed: 8, object_count: 5, prim_count: 3000, size: 1.0, offset: 0.0 };
    let frames = recipe.frames(3);
    for simd in SimdLevel::available() {
        check_frames(&frames, simd, true, &mut Rng::new(1));
    }
}

/// Triangles of a mesh whose rows lie in memory as they are wanted, and of one where they do not.
#[test]
fn vertices_are_read_in_the_order_of_the_triangles() {
    let mut rng = Rng::new(5);
    let vertices: Vec<Vec3> = (0..300).map(|_| rng.in_cube()).collect();
    let soup: Vec<[u32; 3]> = (0..100).map(|idx| [3 * idx, 3 * idx + 1, 3 * idx + 2]).collect();
    let turned: Vec<[u32; 3]> = soup.iter().rev().map(|&[a, b, c]| [b, c, a]).collect();
    for triangles in [soup, turned] {
        let mesh = Arc::new(Mesh::from_triangles(vertices.clone(), triangles).unwrap());
        let objects = (0..3).map(|id| GeometryObject::new(ObjectId(id), Arc::clone(&mesh)));
        let frame = Geometry::new(objects.collect()).unwrap();
        check_frames(&[frame], SimdLevel::best(), true, &mut rng);
    }
}

/// An object at its second place takes no memory that it did not have at its first.
#[test]
fn moving_keeps_the_memory() {
    let recipe = SceneRecipe { seed: 3, object_count: 4, prim_count: 99, size: 1.0, offset: 0.0 };
    let here = recipe.geometry();
    let moved = here.objects().iter().map(|object| {
        let shift = Affine3A::from_translation(Vec3::X);
        object.clone().with_transform(shift)
    });
    let there = Geometry::new(moved.collect()).unwrap();
    let mut table = PrimitiveTable::new(SimdLevel::best());
    table.commit(&here, &FrameChanges::all());
    table.write_bounds();
    let places = |table: &PrimitiveTable| {
        (table.corners.as_ptr(), table.bounds.as_ptr(), table.masks.as_ptr(), table.memory_usage())
    };
    let before = places(&table);
    table.commit(&there, &FrameChanges::all());
    table.write_bounds();
    assert_eq!(places(&table), before);
}
