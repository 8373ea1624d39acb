//! Ray tracing for scenes that never hold still.
#![forbid(unsafe_code)]

pub use rayflock_engine as engine;
pub use rayflock_geom as geom;
pub use rayflock_import as import;
pub use rayflock_render as render;
pub use rayflock_scene as scene;
