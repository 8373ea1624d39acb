//! Which engine traces, and where the library is that some engines need.

#[cfg(feature = "bench")]
use std::path::PathBuf;

use clap::Args;
use rayflock::engine::{EngineKind, RayEngine};
#[cfg(feature = "bench")]
use rayflock_bench::peer::{PeerError, embree::EmbreeLibrary};

/// An engine by name: ours.
#[cfg(not(feature = "bench"))]
pub(crate) use rayflock::{OwnEngine as EngineSpec, OwnEngineError};
/// An engine by name: ours, or one of others.
#[cfg(feature = "bench")]
pub(crate) use rayflock_bench::EngineSpec;

/// Which engine traces the rays.
#[derive(Clone, Debug, Args)]
pub(crate) struct EngineChoice {
    /// The engine that traces the rays: auto asks whichever of brute, hierarchy, bvh and
    /// subfields should answer soonest; to compare, in a program that has the command bench, also
    /// embree, embree:SETTING and obvhs; in one built with --features gpu also gpu:compute,
    /// gpu:subfields, gpu:raster and gpu:brute.
    ///
    /// Our own engines give the same picture in every bit, those of others nearly the same.
    /// subfields:SETTING sets how subfields are kept: on-demand, eager or locked; list; flat;
    /// icosahedron; 160 for so many directions; 10-a-tile; joined by +. The SETTING of embree is
    /// how it is used: low, medium or refit; kept, instances or merged; single or packets;
    /// coherent; robust; joined by +. gpu:compute@1 and gpu:compute@NAME say which graphics adapter
    /// of those that `rayflock info --devices` lists.
    #[arg(long, value_name = "NAME", default_value_t = EngineKind::Auto.into())]
    pub(crate) engine: EngineSpec,

    /// The library Embree 4, for the engine embree [default: EMBREE_LIB, else what
    /// `cargo xtask embree` fetched].
    #[cfg(feature = "bench")]
    #[arg(long, value_name = "PATH")]
    pub(crate) embree_lib: Option<PathBuf>,
}

impl EngineChoice {
    /// The engine, with an empty frame.
    #[cfg(feature = "bench")]
    pub(crate) fn create(&self) -> Result<Box<dyn RayEngine>, PeerError> {
        let load = || EmbreeLibrary::load(self.embree_lib.as_deref());
        let library = self.engine.needs_embree().then(load).transpose()?;
        self.engine.create(library.as_ref())
    }

    /// The engine, with an empty frame.
    #[cfg(not(feature = "bench"))]
    pub(crate) fn create(&self) -> Result<Box<dyn RayEngine>, OwnEngineError> {
        self.engine.create()
    }
}
