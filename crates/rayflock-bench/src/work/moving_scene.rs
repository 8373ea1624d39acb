//! The moving triangles in their room, at any time.

use std::sync::Arc;

use rayflock::prelude::*;
use rayon::prelude::*;

use super::definition::Definition;
use super::random::Random;
use super::room;
use super::surfaces::{self, Corners};

/// Triangles that move between shapes in a room.
///
/// At time 0 and every four keys later they are a cloud, then a pyramid, a sphere and a plane.
/// Between two keys every vertex moves in a straight line at constant speed.
#[derive(Debug)]
pub struct MovingScene {
    /// Vertices at the keys, three a triangle.
    keys: [Vec<Vec3>; 4],
    frames_apart: f64,
    room: Arc<Mesh>,
    moving: Mesh,
    view: View,
}

impl MovingScene {
    /// The object that never moves.
    pub const ROOM: ObjectId = ObjectId(0);
    /// The object whose every triangle moves.
    pub const MOVING: ObjectId = ObjectId(1);

    /// The scene of `definition` with `triangles` moving triangles.
    pub fn new(definition: &Definition, triangles: usize) -> Self {
        let (shapes, seed) = (&definition.shapes, definition.seed);
        let cloud = surfaces::cloud(shapes, triangles, &mut Random::of_item(seed, 0));
        let surface = |idx: usize, mut triangles: Vec<Corners>| {
            Random::of_item(seed, idx).shuffle(&mut triangles);
            triangles.into_flattened()
        };
        let keys = [
            cloud.into_flattened(),
            surface(1, surfaces::pyramid(shapes, triangles)),
            surface(2, surfaces::sphere(shapes, triangles)),
            surface(3, surfaces::plane(shapes, triangles)),
        ];
        let corners: Vec<[u32; 3]> =
            (0..triangles as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        let Ok(moving) = Mesh::from_triangles(keys[0].clone(), corners) else {
            unreachable!("three vertices a triangle")
        };
        Self {
            keys,
            frames_apart: shapes.frames_apart,
            room: Arc::new(room::build(&definition.room)),
            moving,
            view: definition.camera.view(),
        }
    }

    /// The geometry at `time`, in frames: the room, always the same mesh, and the moving
    /// triangles, always another one that shares its list of triangles.
    ///
    /// # Panics
    /// When `time` is not finite.
    pub fn geometry(&self, time: f64) -> Geometry {
        assert!(time.is_finite(), "time {time} must be finite");
        let key_time = (time / self.frames_apart).rem_euclid(self.keys.len() as f64);
        let (key, share) = (key_time.floor() as usize % self.keys.len(), key_time.fract() as f32);
        let (from, to) = (&self.keys[key], &self.keys[(key + 1) % self.keys.len()]);
        let pairs = from.par_iter().zip(to);
        let vertices = pairs.map(|(from, to)| from.lerp(*to, share)).collect();
        let Ok(moving) = self.moving.with_vertices(vertices) else {
            unreachable!("all keys have as many vertices")
        };
        let objects = vec![
            GeometryObject::new(Self::ROOM, Arc::clone(&self.room)),
            GeometryObject::new(Self::MOVING, moving),
        ];
        let Ok(geometry) = Geometry::new(objects) else {
            unreachable!("the ids differ, and a definition's triangles can be counted")
        };
        geometry
    }

    /// The camera.
    pub const fn view(&self) -> View {
        self.view
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn vertices(geometry: &Geometry) -> &[Vec3] {
        geometry.object(MovingScene::MOVING).unwrap().shape.vertices()
    }

    fn scene(triangles: usize) -> MovingScene {
        MovingScene::new(&Definition::default_map(), triangles)
    }

    #[test]
    fn areas_add_up_at_every_key() {
        for count in [1 << 10, 1 << 14] {
            let scene = scene(count);
            for key in 0..=4 {
                let geometry = scene.geometry(32.0 * f64::from(key));
                let corners = vertices(&geometry).chunks_exact(3);
                let total: f32 = corners.map(|c| surfaces::area([c[0], c[1], c[2]])).sum();
                assert!((total / 60.0 - 1.0).abs() < 0.02, "{total} at key {key}");
            }
        }
    }

    #[test]
    fn every_vertex_moves_between_any_two_measured_frames() {
        let definition = Definition::default_map();
        let scene = scene(1 << 10);
        let phases = definition.phases.iter();
        let times: Vec<f64> =
            phases.flat_map(|p| p.frames.iter().copied().chain([p.before])).collect();
        assert_eq!(times.len(), 6);
        for (idx, &time) in times.iter().enumerate() {
            for &other in &times[..idx] {
                let (a, b) = (scene.geometry(time), scene.geometry(other));
                let moved = |(a, b): (&Vec3, &Vec3)| a.distance(*b) > 1e-4;
                let count = vertices(&a).iter().zip(vertices(&b)).filter(|&p| moved(p)).count();
                assert_eq!(count, 3 << 10, "{time} and {other}");
            }
        }
    }

    #[test]
    fn neighbours_in_one_shape_are_none_in_the_next() {
        let scene = scene(1 << 10);
        let keys: Vec<Geometry> = (0..4).map(|key| scene.geometry(32.0 * f64::from(key))).collect();
        let place = |key: usize, idx: usize| vertices(&keys[key])[3 * idx];
        let mean = |key: usize, pairs: &mut dyn Iterator<Item = (usize, usize)>| {
            let lengths: Vec<f32> =
                pairs.map(|(a, b)| place(key, a).distance(place(key, b))).collect();
            lengths.iter().sum::<f32>() / lengths.len() as f32
        };
        let nearest = |key: usize, idx: usize| {
            let others = (0..1 << 10).filter(|&other| other != idx);
            let distance = |other: usize| place(key, idx).distance(place(key, other));
            others.min_by(|&a, &b| distance(a).total_cmp(&distance(b))).unwrap()
        };
        for key in 0..4 {
            let next = (key + 1) % 4;
            let strangers = mean(next, &mut (0..512).map(|idx| (idx, idx + 512)));
            let neighbours = mean(next, &mut (0..1 << 10).map(|idx| (idx, nearest(key, idx))));
            assert!(neighbours > 0.85 * strangers, "{neighbours} of {strangers} at key {next}");
            // Nor are neighbours in memory any nearer than strangers.
            let in_memory = mean(key, &mut (1..1 << 10).map(|idx| (idx - 1, idx)));
            let strangers = mean(key, &mut (0..512).map(|idx| (idx, idx + 512)));
            assert!(in_memory > 0.85 * strangers, "{in_memory} of {strangers} at key {key}");
        }
    }

    #[test]
    fn a_seed_names_one_scene() {
        let mut definition = Definition::default_map();
        let at = |definition: &Definition, time| {
            vertices(&MovingScene::new(definition, 64).geometry(time)).to_vec()
        };
        let times = [0.0, 32.0, 64.0, 96.0];
        let before = times.map(|time| at(&definition, time));
        assert_eq!(before, times.map(|time| at(&definition, time)));
        definition.seed += 1;
        for (time, before) in times.into_iter().zip(before) {
            assert_ne!(at(&definition, time), before, "at {time}");
        }
    }

    #[test]
    fn meshes_are_shared_as_far_as_they_stay() {
        let scene = scene(16);
        let (a, b) = (scene.geometry(3.0), scene.geometry(3.0));
        let shape = |geometry: &Geometry, id| Arc::clone(&geometry.object(id).unwrap().shape);
        assert!(Arc::ptr_eq(&shape(&a, MovingScene::ROOM), &shape(&b, MovingScene::ROOM)));
        let moving = [&a, &b].map(|geometry| shape(geometry, MovingScene::MOVING));
        assert!(!Arc::ptr_eq(&moving[0], &moving[1]));
        assert!(moving[0].has_topology_of(&moving[1]));
    }

    #[test]
    fn motion_is_straight_and_repeats_after_four_keys() {
        let scene = scene(16);
        let vertex = |time| vertices(&scene.geometry(time))[7];
        assert_eq!(vertex(128.0), vertex(0.0));
        assert_eq!(vertex(-32.0), vertex(96.0));
        assert!(vertex(16.0).abs_diff_eq(vertex(0.0).midpoint(vertex(32.0)), 1e-5));
        assert!(vertex(120.0).abs_diff_eq(vertex(96.0).lerp(vertex(0.0), 0.75), 1e-5));
    }
}
