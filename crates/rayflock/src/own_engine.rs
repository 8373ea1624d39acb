//! Engines of ours by name, settings included: what users write after `--engine`.

use std::fmt;
use std::str::FromStr;

use rayflock_engine::subfields::{self, SubfieldsEngine};
use rayflock_engine::{EngineError, EngineKind, RayEngine, create};
#[cfg(feature = "gpu")]
use rayflock_gpu::{GpuEngine, GpuEngineSpec, GpuError};
use thiserror::Error;

const GPU: &str = "gpu";
const SUBFIELDS: &str = EngineKind::Subfields.name();

/// An engine of ours as it is asked for: `hierarchy`, `subfields:eager+list`, `gpu:raster@1`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum OwnEngine {
    /// One of the engines on the CPU.
    Kind(EngineKind),
    /// Parallel subfields with these settings.
    Subfields(subfields::Config),
    /// One on the graphics card.
    #[cfg(feature = "gpu")]
    Gpu(GpuEngineSpec),
}

/// Why an engine of ours cannot be had.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum OwnEngineError {
    /// The text names no engine.
    #[error(
        "unknown engine \"{0}\"; there are: {own}, subfields:SETTING",
        own = EngineKind::ALL.map(EngineKind::name).join(", ")
    )]
    Unknown(String),
    /// A setting is not known.
    #[error(transparent)]
    Setting(EngineError),
    /// An engine on the graphics card cannot be had.
    #[cfg(feature = "gpu")]
    #[error(transparent)]
    Gpu(#[from] GpuError),
    /// The program cannot use graphics cards.
    #[cfg(not(feature = "gpu"))]
    #[error(
        "the engine \"{0}\" wants a program that can use graphics cards; build it with \
         --features gpu"
    )]
    BuiltWithoutGpu(String),
}

impl OwnEngine {
    /// Makes the engine with an empty frame.
    ///
    /// # Errors
    /// [`OwnEngineError`] when the graphics adapter cannot be had.
    pub fn create(&self) -> Result<Box<dyn RayEngine>, OwnEngineError> {
        match *self {
            Self::Kind(kind) => Ok(create(kind)),
            Self::Subfields(config) => Ok(Box::new(SubfieldsEngine::new(config))),
            #[cfg(feature = "gpu")]
            Self::Gpu(spec) => Ok(Box::new(GpuEngine::open(&spec)?)),
        }
    }

    /// Whether the engine is on the CPU, where all engines agree to the bit.
    pub const fn is_on_cpu(&self) -> bool {
        matches!(self, Self::Kind(_) | Self::Subfields(_))
    }

    /// Whether the engine can tell what it chose, or what it holds.
    pub const fn explains(&self) -> bool {
        match self {
            Self::Kind(kind) => matches!(kind, EngineKind::Auto | EngineKind::Subfields),
            Self::Subfields(_) => true,
            #[cfg(feature = "gpu")]
            Self::Gpu(_) => false,
        }
    }
}

impl From<EngineKind> for OwnEngine {
    fn from(kind: EngineKind) -> Self {
        Self::Kind(kind)
    }
}

impl fmt::Display for OwnEngine {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Kind(kind) => write!(f, "{kind}"),
            Self::Subfields(config) => write!(f, "{SUBFIELDS}:{config}"),
            #[cfg(feature = "gpu")]
            Self::Gpu(spec) => write!(f, "{spec}"),
        }
    }
}

impl FromStr for OwnEngine {
    type Err = OwnEngineError;

    fn from_str(text: &str) -> Result<Self, OwnEngineError> {
        match text.split_once(':') {
            #[cfg(feature = "gpu")]
            Some((GPU, _)) => Ok(Self::Gpu(text.parse()?)),
            #[cfg(not(feature = "gpu"))]
            Some((GPU, _)) => Err(OwnEngineError::BuiltWithoutGpu(text.to_owned())),
            Some((SUBFIELDS, setting)) => {
                setting.parse().map(Self::Subfields).map_err(OwnEngineError::Setting)
            }
            _ => {
                let unknown = |_: EngineError| OwnEngineError::Unknown(text.to_owned());
                text.parse().map(Self::Kind).map_err(unknown)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_parsed_as_they_are_printed() {
        let kinds = EngineKind::ALL.map(OwnEngine::Kind);
        let subfields = "eager+list+40".parse().map(OwnEngine::Subfields).unwrap();
        for engine in kinds.into_iter().chain([subfields]) {
            assert_eq!(engine.to_string().parse(), Ok(engine));
            assert!(engine.is_on_cpu() && engine.create().is_ok());
        }
        assert!(subfields.explains() && !OwnEngine::Kind(EngineKind::Brute).explains());
    }

    #[test]
    fn unknown_names_are_told_which_there_are() {
        for text in ["warp", "embree", ""] {
            let message = text.parse::<OwnEngine>().unwrap_err().to_string();
            assert!(message.contains(&format!("\"{text}\"; there are: auto")), "{message}");
        }
        let message = "subfields:egaer".parse::<OwnEngine>().unwrap_err().to_string();
        assert!(message.contains("\"egaer\""), "{message}");
    }

    #[cfg(feature = "gpu")]
    #[test]
    fn engines_on_the_graphics_card_are_parsed_as_they_are_printed() {
        for text in ["gpu:brute", "gpu:raster@1", "gpu:compute@llvmpipe", "gpu:subfields"] {
            let engine: OwnEngine = text.parse().unwrap();
            assert!(engine.to_string() == text && !engine.is_on_cpu());
        }
        let message = "gpu:warp".parse::<OwnEngine>().unwrap_err().to_string();
        assert!(message.contains("\"gpu:warp\""), "{message}");
    }

    #[cfg(not(feature = "gpu"))]
    #[test]
    fn a_program_without_the_graphics_card_says_how_to_build_it_in() {
        let message = "gpu:compute".parse::<OwnEngine>().unwrap_err().to_string();
        assert!(message.contains("\"gpu:compute\"") && message.contains("--features gpu"));
    }
}
