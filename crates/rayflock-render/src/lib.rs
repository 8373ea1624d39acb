//! Pictures of scenes and what sensors see of them, in batches by any engine.
//!
//! | Part | Use it when |
//! |---|---|
//! | [`WhittedRenderer`] | you want pictures: shadows, mirrors, glass, textures |
//! | [`PathTracer`] | you want all light there is, and can wait for it |
//! | [`mod@reference`] | you check a renderer: slow, plain, one ray at a time |
//! | [`FrameRenderer`] | your code takes any renderer of frames |
//! | [`prepared`] | your renderer shades elsewhere, as on a graphics device |
//! | [`tonemap`] | you show or store a [`Film`] |
//! | [`vpl`] | you want indirect light: virtual lights, and what points see of them |
//! | [`occluders`] | you want to know nearly, and soon, how much is in the way: spheres for geometry |
//! | [`lightcuts`] | you have thousands of lights: clusters of them, under an error bound |
//! | [`caustics`] | you want the light that mirrors and glass throw onto rough surfaces |
//! | [`sun`] | you want to know for how many hours the sun shines on each face or vertex |
//! | [`sensor`] | you simulate a LiDAR or a depth camera while the scene moves |
//!
//! # What is rendered
//!
//! Whitted's model: light of point, spot and directional lights and of surfaces that emit,
//! scattered once (Lambert and Blinn-Phong) and followed through mirrors and glass; ambient light
//! stands for the rest. Units are those of [`LightKind`](rayflock_scene::LightKind): a matte
//! surface of reflectance `k` sends back `k E / pi`. Surfaces are two-sided; triangle meshes of
//! glass must be closed and wound counter-clockwise as seen from outside.
//!
//! A scene without lights and without emission gets a key light, over the viewer's left shoulder
//! and turning with the camera's heading, and the light of the sky. A scene without background
//! gets a gradient: blue above, pale at the horizon, grey below. Shadows of smooth meshes with few
//! triangles fall as if the mesh were smooth; glass casts a full shadow.
//!
//! # Example
//!
//! ```
//! use std::sync::Arc;
//!
//! use rayflock_engine::{EngineKind, create};
//! use rayflock_render::tonemap::{ToneMap, to_srgb8};
//! use rayflock_render::{Film, FrameRenderer, RenderSettings, View, WhittedRenderer};
//! use rayflock_scene::{Evaluator, builtin};
//!
//! let scene = Arc::new(builtin::build("cornell").ok_or("no such scene")?);
//! let mut evaluator = Evaluator::new(Arc::clone(&scene), None)?;
//! let mut renderer = WhittedRenderer::new(create(EngineKind::Hierarchy));
//! let mut film = Film::new(32, 24);
//! for time in [0.0, 0.5] {
//!     let frame = evaluator.evaluate(time)?;
//!     renderer.commit(&scene, frame)?;
//!     let view = View::new(frame.cameras[0], scene.cameras[0].projection);
//!     renderer.render(&view, &RenderSettings::default(), &mut film);
//!     let bytes = to_srgb8(&film, 0.0, ToneMap::Agx);
//!     assert_eq!(bytes.len(), 3 * 32 * 24);
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
#![forbid(unsafe_code)]

pub mod caustics;
mod error;
mod film;
mod frame_shading;
mod lens;
pub mod lightcuts;
mod lights;
pub mod occluders;
mod path_tracer;
pub mod prepared;
pub mod reference;
mod renderer;
pub mod sensor;
mod settings;
mod shading;
mod shown;
mod stages;
mod stats;
pub mod sun;
pub mod tonemap;
mod triple;
mod view;
pub mod vpl;
mod wave;
mod whitted;

pub use error::RenderError;
pub use film::Film;
pub use lens::{FilmPlane, Lens};
pub use path_tracer::PathTracer;
pub use renderer::FrameRenderer;
pub use settings::{Indirect, RenderSettings};
pub use shown::Shown;
pub use stats::{CausticStats, FrameStats, IndirectStats, RayCounts, StageStats, TraceStages};
pub use view::View;
pub use whitted::WhittedRenderer;
