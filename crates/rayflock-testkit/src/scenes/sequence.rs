//! Frames in which objects appear, vanish, move, deform, degenerate, change topology, or stay.

use std::sync::Arc;

use glam::Vec3;
use rayflock_geom::{Geometry, GeometryObject, Mesh};

use super::geometry;
use super::recipe::SceneRecipe;
use crate::Rng;

impl SceneRecipe {
    /// `count` frames, the first of them [`SceneRecipe::geometry`]. Meshes that stay are shared
    /// from frame to frame, so that `FrameChanges::between` can tell what changed.
    pub fn frames(&self, count: usize) -> Vec<Geometry> {
        let mut rng = Rng::new(!self.seed);
        let mut frames = vec![self.geometry()];
        while frames.len() < count {
            let next = frames.last().map(|frame| self.next_frame(&mut rng, frame));
            frames.extend(next);
        }
        frames
    }

    fn next_frame(&self, rng: &mut Rng, previous: &Geometry) -> Geometry {
        // Now and then everything vanishes, or nothing happens at all.
        if rng.one_in(12) {
            return Geometry::default();
        }
        if rng.one_in(12) {
            return previous.clone();
        }
        let mut objects: Vec<GeometryObject> =
            previous.objects().iter().filter_map(|object| self.next_object(rng, object)).collect();
        let id = rng.below(4 * self.object_count.max(1)) as u32;
        if objects.iter().all(|object| object.id.0 != id) {
            objects.push(self.object(rng, id));
        }
        geometry(objects)
    }

    /// The object in the next frame; `None` when it vanishes.
    fn next_object(&self, rng: &mut Rng, object: &GeometryObject) -> Option<GeometryObject> {
        let mut next = object.clone();
        let has_spheres = !object.shape.spheres().is_empty();
        match rng.below(10) {
            0 => return None,
            1 | 2 => next = self.moved(rng, next, has_spheres),
            3 | 4 => next.shape = self.deformed(rng, &object.shape),
            5 => next.shape = Arc::new(collapsed(rng, &object.shape)),
            6 => {
                next.world_from_object = None;
                next.shape = self.shape(rng);
            }
            7 => next.mask = 1 << rng.below(3),
            _ => {}
        }
        Some(next)
    }

    /// The same triangles with every vertex moved a little, spheres too.
    fn deformed(&self, rng: &mut Rng, shape: &Mesh) -> Arc<Mesh> {
        let mut nudge = |vertex: Vec3| vertex + 0.05 * self.size * rng.in_cube();
        let vertices = shape.vertices().iter().map(|&vertex| nudge(vertex)).collect();
        let mut spheres = shape.spheres().to_vec();
        for sphere in &mut spheres {
            sphere.center = nudge(sphere.center);
        }
        Arc::new(with_vertices(shape, vertices).with_spheres(spheres))
    }
}

/// The same triangles, many of them without area or without a finite vertex.
fn collapsed(rng: &mut Rng, shape: &Mesh) -> Mesh {
    let first = shape.vertices().first().copied().unwrap_or_default();
    let mut collapse = |vertex: Vec3| match rng.below(4) {
        0 => first,
        1 => rng.pick(&[Vec3::NAN, Vec3::INFINITY, vertex]),
        _ => vertex,
    };
    let vertices = shape.vertices().iter().map(|&vertex| collapse(vertex)).collect();
    with_vertices(shape, vertices)
}

fn with_vertices(shape: &Mesh, vertices: Vec<Vec3>) -> Mesh {
    match shape.with_vertices(vertices) {
        Ok(mesh) => mesh,
        Err(error) => unreachable!("as many vertices as before: {error}"),
    }
}

#[cfg(test)]
mod tests {
    use rayflock_geom::{FrameChanges, ObjectChange};

    use super::*;

    #[test]
    fn every_kind_of_change_occurs() {
        let recipe =
            SceneRecipe { seed: 9, object_count: 8, prim_count: 4, size: 1.0, offset: 0.0 };
        let frames = recipe.frames(30);
        let mut seen = Vec::new();
        for pair in frames.windows(2) {
            seen.extend(FrameChanges::between(&pair[0], &pair[1]).iter().map(|(_, change)| change));
        }
        for change in [
            ObjectChange::Unchanged,
            ObjectChange::Transformed,
            ObjectChange::Deformed,
            ObjectChange::Retopologised,
            ObjectChange::Added,
            ObjectChange::Removed,
        ] {
            assert!(seen.contains(&change), "{change:?} never occurs");
        }
    }
}
