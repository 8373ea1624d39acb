//! Finds what the engines of a benchmark need.

use anyhow::anyhow;
use rayflock_bench::contest::{Effort, Setup};
use rayflock_bench::peer::embree::EmbreeLibrary;
use rayflock_bench::{AllocationCounter, EngineSpec};

use crate::allocations;
use crate::args::EngineArguments;
use crate::failure::{Blame, Failure};
use crate::terminal;

/// The library Embree: always where an engine needs it or the user says where it is, and where it
/// is found, because answers are compared with its.
pub(super) fn library(args: &EngineArguments) -> Result<Option<EmbreeLibrary>, Failure> {
    let is_needed = args.engines.iter().any(EngineSpec::needs_embree);
    match EmbreeLibrary::load(args.embree_lib.as_deref()) {
        Ok(library) => Ok(Some(library)),
        Err(error) if is_needed => {
            let advice = "to measure without Embree, leave it out of --engines";
            Err(anyhow!("{error}; {advice}")).blame_input()
        }
        Err(error) if args.embree_lib.is_some() => Err(error).blame_input(),
        Err(_) => {
            terminal::say(format_args!(
                "without Embree: answers are compared with the first engine's"
            ));
            Ok(None)
        }
    }
}

/// Who takes part, and how.
pub(super) fn setup(
    args: &EngineArguments,
    library: Option<EmbreeLibrary>,
    effort: Effort,
) -> Setup {
    let allocations = allocations::reader();
    let allocations = allocations.map_or(AllocationCounter::NONE, AllocationCounter::new);
    Setup { engines: args.engines.clone(), library, effort, allocations }
}
