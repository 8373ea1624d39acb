//! Measures engines side by side: the same work in the same run, answers compared.
//!
//! | Part | Use it when |
//! |---|---|
//! | [`map`] | you want to know what any number of triangles and rays costs with each engine |
//! | [`museum`] | you want to know what whole pictures of an animation cost with each engine |
//! | [`scene`] | you want to know what rays of each kind cost over an animation |
//! | [`scaling`] | you want to know how cost grows with triangles, rays and threads |
//! | [`spheres`] | you want to know what spheres in place of geometry save and cost in indirect light |
//! | [`contest`] | you have work of your own and want engines measured on it |
//! | [`EngineSpec`], [`peer`] | you want another engine than ours |
//! | [`record`] | you keep or compare what was measured |
//! | [`work`] | you need the map's triangles and rays |
//! | [`allocations`] | you want to know how often an engine allocates |
//! | [`difference`] | you want to know how far one picture is from another |
//! | [`ratio`] | you want to know who is ahead, and by how much |
//! | [`table`], [`report`] | you read what was measured |
//! | [`compare`] | you want to know what has changed since an earlier record |
//!
//! Figures of one run are comparable with each other; those of two runs only as ratios.
//!
//! ```
//! use std::sync::Arc;
//!
//! use rayflock::engine::EngineKind;
//! use rayflock::prelude::*;
//! use rayflock_bench::museum::{self, MuseumBench};
//!
//! let scene = Arc::new(rayflock::scene::builtin::build("cornell").ok_or("no such scene")?);
//! let bench = MuseumBench {
//!     name: "cornell".to_owned(),
//!     engines: vec![EngineKind::Brute.into(), EngineKind::Hierarchy.into()],
//!     library: None,
//!     frames: vec![0, 60],
//!     frame_rate: scene.default_frame_rate(),
//!     size: [16, 12],
//!     run_count: 1,
//!     settings: RenderSettings::default(),
//! };
//! let mut evaluator = Evaluator::new(Arc::clone(&scene), None)?;
//! let view = |frame: &SceneFrame| View::new(frame.cameras[0], scene.cameras[0].projection);
//! let record = museum::measure(&bench, &mut evaluator, &view, &mut || ())?;
//! assert!(record.same_films());
//! println!("{}", rayflock_bench::table::format(&record));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
#![deny(unsafe_code)]

pub mod allocations;
pub mod compare;
pub mod contest;
pub mod difference;
mod engine_spec;
mod error;
pub mod map;
pub mod museum;
mod notes;
pub mod peer;
mod quartiles;
pub mod ratio;
pub mod record;
pub mod report;
pub mod scaling;
pub mod scene;
pub mod spheres;
pub mod table;
mod text;
pub mod work;

pub use allocations::AllocationCounter;
pub use engine_spec::EngineSpec;
pub use error::BenchError;
pub use quartiles::Quartiles;
