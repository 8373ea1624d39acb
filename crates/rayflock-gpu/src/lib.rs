//! Rayflock's ray engines and a renderer of whole frames, on the graphics card.
//!
//! They answer what the engines of [`rayflock_engine`] answer, by the same trait, on whatever
//! wgpu finds: Vulkan, Metal or DX12, cards or software. Distances agree with those of the CPU
//! within rounding.
//!
//! | Engine | What it is | Use it when |
//! |---|---|---|
//! | `gpu:brute` | every primitive is drawn over all rays | you want what the others are measured by |
//! | `gpu:raster` | primitives are drawn over the tiles of rays that may hit them | you want the hierarchical ray engine as published |
//! | `gpu:compute` | a tree of cones over the rays, pairs refined by compaction | you want hits |
//! | `gpu:subfields` | a grid of primitives for each direction that rays go, written on demand | many rays share a direction, or neighbours do not go alike |
//!
//! | Part | Use it when |
//! |---|---|
//! | [`GpuEngineSpec`] | you have the name of an engine: `gpu:brute`, `gpu:brute@1` |
//! | [`GpuEngine`] | you want hits |
//! | [`GpuRenderer`] | you want pictures, and nothing on its way back before they are done |
//! | [`PrimaryVisibility`] | you compare scan conversion with tracing |
//! | [`GpuContext`] | several engines share a device |
//! | [`list_adapters`] | you want to know what there is |
//!
//! ```
//! use rayflock_gpu::{GpuEngine, GpuEngineSpec, GpuError};
//!
//! let spec: GpuEngineSpec = "gpu:brute".parse()?;
//! match GpuEngine::open(&spec) {
//!     Ok(engine) => println!("{engine:?}"),
//!     Err(error) => println!("{error}"),
//! }
//! # Ok::<(), GpuError>(())
//! ```
#![forbid(unsafe_code)]

mod adapter;
mod brute;
mod buffer;
mod compute;
mod context;
mod engine;
mod error;
mod frame;
mod kind;
mod layout;
mod method;
mod pass;
mod pipeline;
mod primitives;
mod raster;
mod ray_textures;
mod shaders;
mod slots;
mod sort_rays;
mod stage_clock;
mod standby;
mod subfields;
#[cfg(test)]
mod testing;
#[cfg(test)]
mod twins;

pub use adapter::{AdapterChoice, AdapterSummary, list_adapters};
pub use context::GpuContext;
pub use engine::GpuEngine;
pub use error::GpuError;
pub use frame::{GpuRenderer, PrimaryVisibility};
pub use kind::{GpuEngineKind, GpuEngineSpec};
