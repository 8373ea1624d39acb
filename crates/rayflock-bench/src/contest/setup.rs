//! Who takes part, and by which rules.

use super::effort::Effort;
use crate::peer::embree::EmbreeLibrary;
use crate::record::Record;
use crate::{AllocationCounter, EngineSpec};

/// The engines of a contest and how they are measured.
#[derive(Clone, Debug)]
pub struct Setup {
    /// The engines in the order of their turns.
    pub engines: Vec<EngineSpec>,
    /// Where Embree is. Answers are compared with those of Embree, watertight; without it, with
    /// the first engine's.
    pub library: Option<EmbreeLibrary>,
    /// How much time it may take.
    pub effort: Effort,
    /// How allocations are counted.
    pub allocations: AllocationCounter,
}

impl Setup {
    /// Engines without Embree, and nothing counted.
    pub fn new(engines: Vec<EngineSpec>, effort: Effort) -> Self {
        Self { engines, library: None, effort, allocations: AllocationCounter::NONE }
    }

    /// A record for what is about to be measured.
    pub(crate) fn record(&self, benchmark: &str) -> Record {
        let mut record = Record::new(benchmark);
        if let Some(library) = &self.library {
            let mut note = |name: &str, value: &str| {
                record.versions.insert(name.to_owned(), value.to_owned());
            };
            note("embree", library.version());
            note("embree-isa", library.isa());
        }
        record
    }
}
