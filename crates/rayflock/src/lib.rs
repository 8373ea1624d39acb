//! Ray tracing for scenes that never hold still.
//!
//! Hand an engine this frame's triangles and a batch of rays; get hits. Triangles may all move,
//! appear or vanish from frame to frame: no structure is built over them, so there is nothing to
//! refit, to rebuild or to tune. On top stand scenes that move, importers and a renderer.
//!
//! | Part | Use it when |
//! |---|---|
//! | [`geom`] | you describe what can be hit, and ask about rays |
//! | [`engine`] | you want hits: several engines, one answer |
//! | [`OwnEngine`] | an engine is named by a user, settings included |
//! | `gpu` (with the feature `gpu`) | a graphics card should trace |
//! | [`scene`] | things have materials and move: clips, skins, morph targets, built-in scenes |
//! | [`import`] | a scene is in files: glTF, OBJ, PLY, STL, VTK, AFF, NumPy, sequences, caches |
//! | [`render`] | you want pictures, hours of sun, or what sensors see |
//! | [`prelude`] | you want all of the usual names at once |
//!
//! # Hits
//!
//! ```
//! use rayflock::prelude::*;
//!
//! let triangle = Mesh::from_triangles(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 1, 2]])?;
//! let frame = Geometry::new(vec![GeometryObject::new(ObjectId(7), triangle)])?;
//! let mut engine = rayflock::engine::create(EngineKind::Auto);
//! engine.commit(&frame, &FrameChanges::all())?;
//!
//! let origins = [Vec3::new(0.25, 0.25, 2.0), Vec3::new(2.0, 2.0, 2.0)];
//! let mut hits = HitBuffer::new(origins.len());
//! engine.closest_hit(&RayBatch::new(&origins[..], -Vec3::Z)?, &mut hits.as_hits());
//! assert_eq!((hits.get(0).t, hits.get(0).object_id), (2.0, ObjectId(7)));
//! assert!(hits.get(1).is_miss());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Pictures
//!
//! ```
//! use rayflock::prelude::*;
//! use std::sync::Arc;
//!
//! let scene = rayflock::scene::builtin::build("cornell").ok_or("no such scene")?;
//! let mut evaluator = Evaluator::new(Arc::new(scene), None)?;
//! let mut renderer = WhittedRenderer::new(rayflock::engine::create(EngineKind::Auto));
//! let mut film = Film::new(32, 24);
//! for frame in 0..2 {
//!     let scene = Arc::clone(evaluator.scene());
//!     let now = evaluator.evaluate(f64::from(frame) / 24.0)?;
//!     renderer.commit(&scene, now)?;
//!     let view = View::new(now.cameras[0], scene.cameras[0].projection);
//!     renderer.render(&view, &RenderSettings::default(), &mut film);
//! }
//! let bytes = rayflock::render::tonemap::to_srgb8(&film, 0.0, ToneMap::Srgb);
//! assert_eq!(bytes.len(), 3 * 32 * 24);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
#![forbid(unsafe_code)]

mod own_engine;

pub use own_engine::{OwnEngine, OwnEngineError};
pub use rayflock_engine as engine;
pub use rayflock_geom as geom;
#[cfg(feature = "gpu")]
pub use rayflock_gpu as gpu;
pub use rayflock_import as import;
pub use rayflock_render as render;
pub use rayflock_scene as scene;

/// The names that most programs need: `use rayflock::prelude::*`.
pub mod prelude {
    pub use glam::{Affine3A, Vec3};

    pub use crate::engine::{EngineKind, RayEngine, TraceStats};
    pub use crate::geom::{
        FrameChanges, Geometry, GeometryObject, Hit, HitBuffer, Hits, Mesh, ObjectChange, ObjectId,
        PrimId, RayBatch, RayOrder, Sphere,
    };
    pub use crate::render::tonemap::ToneMap;
    pub use crate::render::{
        Film, FrameRenderer, FrameStats, RenderSettings, View, WhittedRenderer,
    };
    pub use crate::scene::{Evaluator, Scene, SceneFrame};
}
