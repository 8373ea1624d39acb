//! Geometry that devices can trace, and engines that tell the answer.

use rayflock_engine::{EngineKind, RayEngine, create};
use rayflock_geom::{FrameChanges, Geometry};
use rayflock_testkit::scenes::SceneRecipe;

/// The frames of a recipe, without objects that have user primitives.
pub(crate) fn frames(recipe: &SceneRecipe, count: usize) -> Vec<Geometry> {
    let is_held = |geometry: &Geometry| geometry.subset(|object| object.shape.user().is_none());
    recipe.frames(count).iter().map(is_held).collect()
}

/// An engine on the CPU, with a frame.
pub(crate) fn commit_to(kind: EngineKind, geometry: &Geometry) -> Box<dyn RayEngine> {
    let mut engine = create(kind);
    engine.commit(geometry, &FrameChanges::all()).unwrap();
    engine
}
