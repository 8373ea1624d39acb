//! Seeded random scenes: soups, closed meshes, spheres, user primitives, and frames of them.
//!
//! [`SceneRecipe`] is a value that names a scene; [`scene_recipe`] is the proptest strategy.

mod closed;
mod recipe;
mod sequence;
mod soup;
mod user_boxes;

use glam::Vec3;
use rayflock_geom::{Geometry, GeometryObject, Mesh};

pub use closed::ClosedMesh;
pub use recipe::{SceneRecipe, scene_recipe};
pub use soup::{SoupKind, spheres, triangle_soup};
pub use user_boxes::UserBoxes;

fn mesh(vertices: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Mesh {
    match Mesh::from_triangles(vertices, triangles) {
        Ok(mesh) => mesh,
        Err(error) => unreachable!("scenes index their own vertices: {error}"),
    }
}

fn geometry(objects: Vec<GeometryObject>) -> Geometry {
    match Geometry::new(objects) {
        Ok(geometry) => geometry,
        Err(error) => unreachable!("ids are unique and spheres stay spheres: {error}"),
    }
}
