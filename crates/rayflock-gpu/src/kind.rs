//! The engines on the graphics card, by name.

use std::fmt;
use std::str::FromStr;

use crate::{AdapterChoice, GpuError};

/// A way to find hits on the graphics card.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum GpuEngineKind {
    /// The ray engine: every primitive is drawn over all rays.
    Brute,
    /// The hierarchical ray engine, as published: primitives are drawn over tiles of rays.
    Raster,
    /// A tree of cones over the rays, and pairs refined by compaction.
    Compute,
    /// A grid of primitives for each direction that rays go, written on the device.
    Subfields,
}

impl GpuEngineKind {
    /// Every engine of this crate.
    pub const ALL: [Self; 4] = [Self::Brute, Self::Raster, Self::Compute, Self::Subfields];

    /// The name on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Brute => "gpu:brute",
            Self::Raster => "gpu:raster",
            Self::Compute => "gpu:compute",
            Self::Subfields => "gpu:subfields",
        }
    }
}

impl fmt::Display for GpuEngineKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// An engine and the adapter it works on: `gpu:brute`, `gpu:brute@1`, `gpu:brute@llvmpipe`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct GpuEngineSpec {
    /// The engine.
    pub kind: GpuEngineKind,
    /// The adapter.
    pub adapter: AdapterChoice,
}

impl FromStr for GpuEngineSpec {
    type Err = GpuError;

    fn from_str(text: &str) -> Result<Self, GpuError> {
        let (name, adapter) = match text.split_once('@') {
            Some((name, adapter)) => (name, adapter.parse()?),
            None => (text, AdapterChoice::Best),
        };
        let kind = GpuEngineKind::ALL.into_iter().find(|kind| kind.name() == name);
        kind.map(|kind| Self { kind, adapter }).ok_or_else(|| GpuError::UnknownEngine {
            found: name.to_owned(),
            there: GpuEngineKind::ALL.map(GpuEngineKind::name).join(", "),
        })
    }
}

impl fmt::Display for GpuEngineSpec {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.adapter {
            AdapterChoice::Best => write!(f, "{}", self.kind),
            adapter => write!(f, "{}@{adapter}", self.kind),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_parsed_as_they_are_printed() {
        for kind in GpuEngineKind::ALL {
            for adapter in ["", "@2", "@llvmpipe"] {
                let text = format!("{kind}{adapter}");
                assert_eq!(text.parse::<GpuEngineSpec>().unwrap().to_string(), text);
            }
        }
    }

    #[test]
    fn unknown_names_are_told_which_there_are() {
        let error = "gpu:warp@0".parse::<GpuEngineSpec>().unwrap_err();
        assert!(error.to_string().contains("\"gpu:warp\"; there are: gpu:brute"), "{error}");
    }

    #[test]
    fn an_adapter_must_be_named_after_the_sign_for_it() {
        let error = "gpu:brute@".parse::<GpuEngineSpec>().unwrap_err();
        assert!(
            error.to_string().contains("expected its number, or a part of its name"),
            "{error}"
        );
    }
}
