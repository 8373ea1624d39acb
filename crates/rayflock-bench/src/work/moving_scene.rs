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
