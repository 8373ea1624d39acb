//! Whole scenes from a seed, as values that proptest can shrink.

use std::sync::Arc;

use glam::{Affine3A, Mat3A, Quat, Vec3};
use proptest::prelude::*;
use rayflock_geom::{Aabb, Geometry, GeometryObject, Mesh, ObjectId};

use super::closed::ClosedMesh;
use super::soup::{SoupKind, spheres, triangle_soup};
use super::user_boxes::UserBoxes;
use super::{geometry, mesh};
use crate::Rng;

/// What a random scene is made from: the same recipe always makes the same scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SceneRecipe {
    /// Names the scene among those of the same size.
    pub seed: u64,
    /// Number of objects.
    pub object_count: usize,
    /// Largest number of primitives of one kind in an object.
    pub prim_count: usize,
    /// Half the edge of the scene.
    pub size: f32,
    /// Distance of the scene from the origin, in multiples of its size.
    pub offset: f32,
}

/// Recipes of up to `object_count` objects with up to `prim_count` primitives of a kind, of sizes
/// from 1e-6 to 1e6, some of them ten thousand times their size from the origin.
pub fn scene_recipe(object_count: usize, prim_count: usize) -> impl Strategy<Value = SceneRecipe> {
    let size = prop_oneof![2 => Just(1.0_f32), 1 => (-6..=6_i32).prop_map(|e| 10.0_f32.powi(e))];
    let offset = prop_oneof![3 => Just(0.0_f32), 1 => (1..=4_i32).prop_map(|e| 10.0_f32.powi(e))];
    (any::<u64>(), 0..=object_count, 1..=prim_count, size, offset).prop_map(
        |(seed, object_count, prim_count, size, offset)| SceneRecipe {
            seed,
            object_count,
            prim_count,
            size,
            offset,
        },
    )
}

impl SceneRecipe {
    /// The scene, as one frame.
    pub fn geometry(&self) -> Geometry {
        let mut rng = Rng::new(self.seed);
        let objects = (0..self.object_count).map(|idx| self.object(&mut rng, 3 * idx as u32));
        geometry(objects.collect())
    }

    /// Where the scene's middle is.
    pub fn center(&self) -> Vec3 {
        self.offset * self.size * Vec3::new(0.6, -0.48, 0.64)
    }

    /// A random object of the scene, with a random transform and mask.
    pub(super) fn object(&self, rng: &mut Rng, id: u32) -> GeometryObject {
        let shape = self.shape(rng);
        let rigid = !shape.spheres().is_empty();
        let object = GeometryObject::new(ObjectId(id), shape);
        let object = if rng.one_in(3) { object.with_mask(1 << rng.below(3)) } else { object };
        self.moved(rng, object, rigid)
    }

    /// The object somewhere else: in world space, or under a transform.
    pub(super) fn moved(
        &self,
        rng: &mut Rng,
        mut object: GeometryObject,
        keeps_spheres: bool,
    ) -> GeometryObject {
        object.world_from_object = match rng.below(4) {
            0 | 1 => None,
            2 => Some(self.similarity(rng)),
            _ if keeps_spheres => Some(self.similarity(rng)),
            _ => Some(self.similarity(rng) * distortion(rng)),
        };
        object
    }

    /// A rotation about the scene's middle, a uniform scale, now and then a reflection, a small
    /// translation.
    fn similarity(&self, rng: &mut Rng) -> Affine3A {
        let turn = Quat::from_axis_angle(rng.on_sphere(), rng.between(-3.0, 3.0));
        let flip = if rng.one_in(4) { -1.0 } else { 1.0 };
        let linear = Mat3A::from_quat(turn) * (flip * rng.between(0.5, 1.5));
        let center = self.center();
        let translation = center - linear * center + 0.3 * self.size * rng.in_cube();
        Affine3A::from_mat3_translation(linear.into(), translation)
    }

    /// Primitives of one kind, or of all kinds.
    pub(super) fn shape(&self, rng: &mut Rng) -> Arc<Mesh> {
        let count = 1 + rng.below(self.prim_count);
        let kind = SoupKind::ALL[rng.below(SoupKind::ALL.len())];
        let mesh = match rng.below(8) {
            0 => self.closed(rng),
            1 => Mesh::from_spheres(spheres(rng, count, self.center(), self.size)),
            2 => Mesh::from_user(Arc::new(self.boxes(rng, count.min(8)))),
            3 => triangle_soup(rng, SoupKind::Plain, count, self.center(), self.size)
                .with_spheres(spheres(rng, count.min(8), self.center(), self.size))
                .with_user(Arc::new(self.boxes(rng, 2))),
            4 if rng.one_in(4) => mesh(Vec::new(), Vec::new()),
            _ => triangle_soup(rng, kind, count, self.center(), self.size),
        };
        Arc::new(mesh)
    }

    fn closed(&self, rng: &mut Rng) -> Mesh {
        let shape = match rng.below(3) {
            0 => ClosedMesh::cube(),
            1 => ClosedMesh::icosphere(rng.below(3) as u32),
            _ => ClosedMesh::tetrahedron().with_needles(rng, 20),
        };
        shape.placed(self.center(), rng.between(0.2, 1.0) * self.size).mesh()
    }

    fn boxes(&self, rng: &mut Rng, count: usize) -> UserBoxes {
        let mut aabb = || {
            let middle = self.center() + self.size * rng.in_cube();
            let half = 0.2 * self.size * rng.in_cube();
            // One in eight is empty where a half edge is negative.
            let half = if rng.one_in(2) { half } else { half.abs() };
            Aabb { min: middle - half, max: middle + half }
        };
        UserBoxes((0..count).map(|_| aabb()).collect())
    }
}

/// An uneven scale and a shear; now and then one that flattens everything.
fn distortion(rng: &mut Rng) -> Affine3A {
    let scale = match rng.below(12) {
        0 => Vec3::new(1.0, 0.0, 1.0),
        1 => Vec3::new(1.0, 1e-3, 1.0),
        _ => Vec3::new(rng.between(0.5, 2.0), rng.between(0.5, 2.0), rng.between(0.5, 2.0)),
    };
    let mut linear = Mat3A::from_diagonal(scale);
    linear.y_axis.x += 0.5 * rng.signed();
    Affine3A::from_mat3(linear.into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_recipe_makes_one_scene_and_seeds_differ() {
        let recipe =
            SceneRecipe { seed: 5, object_count: 6, prim_count: 20, size: 1.0, offset: 0.0 };
        let text = |recipe: &SceneRecipe| format!("{:?}", recipe.geometry());
        assert_eq!(text(&recipe), text(&recipe));
        assert_ne!(text(&recipe), text(&SceneRecipe { seed: 6, ..recipe }));
    }

    #[test]
    fn all_kinds_of_primitives_occur() {
        let mut found = [false; 5];
        for seed in 0..20 {
            let recipe =
                SceneRecipe { seed, object_count: 5, prim_count: 5, size: 1.0, offset: 0.0 };
            for object in recipe.geometry().objects() {
                found[0] |= !object.shape.triangles().is_empty();
                found[1] |= !object.shape.spheres().is_empty();
                found[2] |= object.shape.user().is_some();
                found[3] |= object.world_from_object.is_some();
                found[4] |= object.mask != u32::MAX;
            }
        }
        assert_eq!(found, [true; 5]);
    }
}
