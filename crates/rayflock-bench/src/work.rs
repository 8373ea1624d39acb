//! The work that engines are measured with: moving triangles, and rays of many kinds.
//!
//! | Part | Use it when |
//! |---|---|
//! | [`Definition`] | you want to know, or to choose, what is measured |
//! | [`MovingScene`] | you need the map's geometry at some time |
//! | [`Surroundings`] | rays are to be made for the map or for any other scene |
//! | [`generate`] | you need rays of a [`RayKind`] |
//!
//! ```
//! use rayflock::prelude::*;
//! use rayflock_bench::work::{self, Definition, MovingScene, RayKind};
//!
//! let definition = Definition::default_map();
//! let scene = MovingScene::new(&definition, 1000);
//! let geometry = scene.geometry(64.0);
//! let mut engine = rayflock::engine::create(EngineKind::Hierarchy);
//! engine.commit(&geometry, &FrameChanges::all())?;
//!
//! let (size, surroundings) = (work::image_size(256), definition.surroundings());
//! let rays =
//!     work::generate(RayKind::Mirror, size, &surroundings, &geometry, engine.as_mut(), 1);
//! assert_eq!((rays.len(), rays.batches().count()), (256, 1));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod count;
pub mod definition;
mod generate;
mod moving_scene;
mod random;
mod ray_kind;
mod ray_set;
mod room;
mod surfaces;
mod surroundings;

pub use count::parse_count;
pub use definition::Definition;
pub use generate::{generate, image_size};
pub use moving_scene::MovingScene;
pub use ray_kind::{Question, RayKind};
pub use ray_set::RaySet;
pub use surroundings::Surroundings;
