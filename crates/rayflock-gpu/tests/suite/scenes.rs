//! Geometry that devices can trace, and the engine that defines the answer.

use rayflock_engine::{EngineKind, RayEngine, create};
use rayflock_geom::{FrameChanges, Geometry};
use rayflock_testkit::scenes::SceneRecipe;

/// The frames of a recipe, without objects that have user primitives.
pub(crate) fn frames(recipe: &SceneRecipe, count: usize) -> Vec<Geometry> {
    let is_held = |geometry: &Geometry| geometry.subset(|object| object.shape.user().is_none());
    recipe.frames(count).iter().map(is_held).collect()
}

/// The engine that defines the answer, with a frame.
pub(crate) fn definition(geometry: &Geometry) -> Box<dyn RayEngine> {
    let mut engine = create(EngineKind::Brute);
    engine.commit(geometry, &FrameChanges::all()).unwrap();
    engine
}
