//! Which engines are measured, for every subcommand of `bench` alike.

use std::path::PathBuf;

use clap::Args;
use rayflock_bench::EngineSpec;

use crate::args::thread_count;

/// Which engines take turns, and where they find what they need.
#[derive(Clone, Debug, Args)]
#[command(next_help_heading = "Engines")]
pub(crate) struct EngineArguments {
    /// The engines, separated by commas, in the order of their turns.
    ///
    /// Ours: auto, brute, hierarchy, bvh, subfields, subfields:SETTING (such as
    /// subfields:eager+list+40). Others: embree:best (every setting is tried, the best one counts),
    /// embree:SETTING (such as embree:low+instances+packets+coherent), obvhs; and floor, which
    /// answers nothing but reads and writes what every engine has to: the bound of what can be won.
    #[arg(
        long,
        value_name = "NAMES",
        value_delimiter = ',',
        default_value = "embree:best,auto,hierarchy,bvh"
    )]
    pub(crate) engines: Vec<EngineSpec>,

    /// The library Embree 4 [default: the variable EMBREE_LIB, else where `cargo xtask embree`
    /// put it].
    #[arg(long, value_name = "FILE")]
    pub(crate) embree_lib: Option<PathBuf>,

    /// Threads to work with, the same for all engines [default: one a core].
    #[arg(long, value_name = "N", value_parser = thread_count())]
    pub(crate) threads: Option<u16>,
}
