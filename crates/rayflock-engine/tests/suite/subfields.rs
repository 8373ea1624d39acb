//! What only the engine of subfields has: a budget of memory.

use rayflock_engine::RayEngine;
use rayflock_engine::subfields::{Config, SubfieldsEngine};
use rayflock_geom::{FrameChanges, Geometry, HitBuffer};
use rayflock_testkit::Rng;
use rayflock_testkit::rays::{RayForm, RaySet};
use rayflock_testkit::scenes::SceneRecipe;

fn geometry() -> Geometry {
    SceneRecipe { seed: 6, object_count: 4, prim_count: 2000, size: 1.0, offset: 0.0 }.geometry()
}

/// Bytes held after a batch that goes all ways, with so many directions.
fn bytes_held(budget: usize, direction_count: usize) -> usize {
    let geometry = geometry();
    let config = Config { budget, direction_count: Some(direction_count), ..Config::default() };
    let mut engine = SubfieldsEngine::new(config);
    engine.commit(&geometry, &FrameChanges::all()).unwrap();
    let set = RaySet::random(&mut Rng::new(7), &geometry, RayForm::PerRay, 4096);
    let mut hits = HitBuffer::new(4096);
    engine.closest_hit(&set.batch(), &mut hits.as_hits());
    engine.memory_usage()
}

#[test]
fn memory_stays_within_the_budget() {
    let one = bytes_held(0, 1);
    let budget = 8 << 20;
    let (bounded, unbounded) = (bytes_held(budget, 300), bytes_held(usize::MAX, 300));
    assert!(unbounded > 4 * budget, "300 directions take {unbounded} bytes");
    assert!(bounded < one + 2 * budget, "{bounded} bytes of {unbounded}, one takes {one}");
}
