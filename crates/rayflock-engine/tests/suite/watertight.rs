//! No ray that starts inside a closed mesh leaves it, not even through vertices and edges.
//!
//! `RAYFLOCK_WATERTIGHT_RAYS` sets the number of rays for each engine at its best SIMD level;
//! the other levels get a sixteenth.

use glam::Vec3;
use rayflock_engine::count_ignored;
use rayflock_geom::{
    FrameChanges, Geometry, GeometryObject, HitBuffer, ObjectId, RayBatch, RayOrder,
};
use rayflock_testkit::Rng;
use rayflock_testkit::scenes::ClosedMesh;

use crate::engines::Subject;

/// Rays for each engine unless the environment says otherwise.
const DEFAULT_RAYS: usize = 400_000;

/// Rays traced at a time.
const BATCH: usize = 4096;

fn ray_count() -> usize {
    match std::env::var("RAYFLOCK_WATERTIGHT_RAYS") {
        Ok(text) => text.parse().expect("RAYFLOCK_WATERTIGHT_RAYS must be a number of rays"),
        Err(_) => DEFAULT_RAYS,
    }
}

/// A closed surface and where its middle is.
struct Room {
    surface: ClosedMesh,
    center: Vec3,
    size: f32,
}

fn rooms() -> Vec<Room> {
    let mut rng = Rng::new(21);
    let mut rooms = Vec::new();
    for (offset, size) in [(0.0, 1.0), (100.0, 1.0), (10_000.0, 1.0), (30.0, 1e-6), (3.0, 1e6)] {
        let center = offset * size * Vec3::new(0.6, -0.48, 0.64);
        let shapes = [ClosedMesh::cube(), ClosedMesh::tetrahedron(), ClosedMesh::icosphere(2)];
        for shape in shapes {
            let plain = shape.placed(center, size);
            let needles = plain.clone().with_needles(&mut rng, 60);
            rooms.extend([plain, needles].map(|surface| Room { surface, center, size }));
        }
    }
    rooms
}

fn geometry(surface: &ClosedMesh) -> Geometry {
    Geometry::new(vec![GeometryObject::new(ObjectId(0), surface.mesh())]).unwrap()
}

impl Room {
    /// A point well inside: the meshes hold the cube of 0.3.
    fn inside(&self, rng: &mut Rng) -> Vec3 {
        self.center + 0.3 * self.size * rng.in_cube()
    }

    /// A vertex or a point of an edge, as near as `f32` can name it.
    fn target(&self, rng: &mut Rng) -> Vec3 {
        let face = self.surface.triangles[rng.below(self.surface.triangles.len())];
        let [a, b, _] = face.map(|corner| self.surface.vertices[corner as usize]);
        match rng.below(4) {
            0 => a,
            1 => 0.5 * (a + b),
            _ => a.lerp(b, rng.unit()),
        }
    }
}

/// Traces `count` rays and fails at the first that escapes.
fn check_room(
    subject: &mut Subject,
    rng: &mut Rng,
    room: &Room,
    geometry: &Geometry,
    count: usize,
) {
    subject.commit(geometry, &FrameChanges::all());
    assert_eq!(count_ignored(geometry).count(), 0, "an ignored triangle would be a hole");
    let mut hits = HitBuffer::default();
    for start in (0..count).step_by(BATCH) {
        let len = BATCH.min(count - start);
        let shared = rng.one_in(2).then(|| room.inside(rng));
        let origins: Vec<Vec3> =
            (0..len).map(|_| shared.unwrap_or_else(|| room.inside(rng))).collect();
        let directions: Vec<Vec3> =
            origins.iter().map(|&origin| room.target(rng) - origin).collect();
        let batch = match shared {
            Some(origin) => RayBatch::new(origin, &directions),
            None => RayBatch::new(&origins, &directions),
        };
        let batch = batch.unwrap().with_order(rng.pick(&[RayOrder::Unordered, RayOrder::Coherent]));
        hits.reset(len);
        subject.trace_into(&batch, &mut hits);
        let escaped = (0..len).find(|&idx| hits.get(idx).is_miss()).map(|idx| batch.ray(idx));
        let (center, size, name) = (room.center, room.size, &subject.name);
        assert_eq!(escaped, None, "{name}: escaped from the room at {center} of size {size}");
    }
}

fn check_rooms(mut subject: Subject, count: usize) {
    let rooms = rooms();
    let mut rng = Rng::new(22);
    for room in &rooms {
        let geometry = geometry(&room.surface);
        check_room(&mut subject, &mut rng, room, &geometry, count.div_ceil(rooms.len()));
    }
}

#[test]
fn no_ray_escapes_at_the_best_level() {
    Subject::best().into_iter().for_each(|subject| check_rooms(subject, ray_count()));
}

#[test]
fn no_ray_escapes_at_any_level() {
    Subject::all().into_iter().for_each(|subject| check_rooms(subject, ray_count() / 16));
}

/// The test must be able to fail: through a missing side rays do escape.
#[test]
#[should_panic(expected = "escaped from the room")]
fn rays_escape_through_a_hole() {
    let mut open = ClosedMesh::cube();
    open.triangles.truncate(10);
    let room = Room { surface: ClosedMesh::cube(), center: Vec3::ZERO, size: 1.0 };
    for mut subject in Subject::best() {
        check_room(&mut subject, &mut Rng::new(23), &room, &geometry(&open), BATCH);
    }
}
