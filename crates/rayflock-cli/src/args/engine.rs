//! Which engine traces, and where the library is that some engines need.

use std::path::PathBuf;

use clap::Args;
use rayflock::engine::{EngineKind, RayEngine};
use rayflock_bench::EngineSpec;
use rayflock_bench::peer::PeerError;
use rayflock_bench::peer::embree::EmbreeLibrary;

/// Which engine traces the rays.
#[derive(Clone, Debug, Args)]
pub(crate) struct EngineChoice {
    /// The engine that traces the rays: auto asks whichever of brute, hierarchy, bvh and
    /// subfields should answer soonest; to compare, also embree, embree:SETTING and obvhs; in a
    /// program built with --features gpu also gpu:compute, gpu:raster and gpu:brute.
    ///
    /// Our own engines give the same picture in every bit, those of others nearly the same.
    /// subfields:SETTING sets how subfields are kept: on-demand, eager or locked; list; flat;
    /// icosahedron; 160 for so many directions; 10-a-tile; joined by +. The SETTING of embree is
    /// how it is used: low, medium or refit; kept, instances or merged; single or packets;
    /// coherent; robust; joined by +. gpu:compute@1 and gpu:compute@NAME say which graphics adapter
    /// of those that `rayflock devices` lists.
    #[arg(long, value_name = "NAME", default_value_t = EngineKind::Auto.into())]
    pub(crate) engine: EngineSpec,

    /// The library Embree 4, for the engine embree [default: EMBREE_LIB, else what
    /// `cargo xtask embree` fetched].
    #[arg(long, value_name = "PATH")]
    pub(crate) embree_lib: Option<PathBuf>,
}

impl EngineChoice {
    /// The engine, with an empty frame.
    pub(crate) fn create(&self) -> Result<Box<dyn RayEngine>, PeerError> {
        let load = || EmbreeLibrary::load(self.embree_lib.as_deref());
        let library = self.engine.needs_embree().then(load).transpose()?;
        self.engine.create(library.as_ref())
    }
}
