//! Pictures of scenes, rendered in batches by any engine.
//!
//! | Part | Use it when |
//! |---|---|
//! | [`WhittedRenderer`] | you want pictures: shadows, mirrors, glass |
//! | [`FrameRenderer`] | you take any renderer of frames |
//! | [`tonemap`] | you want to show or store a [`Film`] |
#![forbid(unsafe_code)]

mod error;
mod film;
mod frame_shading;
mod lights;
pub mod reference;
mod renderer;
mod settings;
mod shading;
mod stages;
mod stats;
pub mod tonemap;
mod view;
mod wave;
mod whitted;

pub use error::RenderError;
pub use film::Film;
pub use renderer::FrameRenderer;
pub use settings::RenderSettings;
pub use stats::{FrameStats, RayCounts};
pub use view::View;
pub use whitted::WhittedRenderer;
