//! Engines by name, ours and those of others.

use std::fmt;
use std::str::FromStr;

use rayflock::engine::{EngineKind, RayEngine};
use rayflock::{OwnEngine, OwnEngineError};

use crate::peer::PeerError;
use crate::peer::embree::{EmbreeEngine, EmbreeLibrary, Setting};
use crate::peer::obvhs::ObvhsEngine;

const EMBREE: &str = "embree";
const BEST: &str = "best";
const OBVHS: &str = "obvhs";
const FLOOR: &str = "floor";

/// An engine as it is asked for: `hierarchy`, `subfields:eager+list`, `embree`,
/// `embree:low+instances+packets`, `embree:best`, `obvhs`, `floor`, `gpu:compute`, `gpu:raster@1`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum EngineSpec {
    /// One of ours.
    Own(OwnEngine),
    /// Embree, used in this way.
    Embree(Setting),
    /// Embree in the way that is best for the work, found by trying.
    EmbreeBest,
    /// The library obvhs.
    Obvhs,
    /// What every engine takes at least, and no answers.
    Floor,
}

impl EngineSpec {
    /// Makes the engine with an empty frame. `library` is needed by Embree only; without it, it is
    /// looked for.
    ///
    /// # Errors
    /// [`PeerError`] when Embree or the adapter cannot be had, and for [`Self::EmbreeBest`] and
    /// [`Self::Floor`], which are no engines but a contest and a bound.
    pub fn create(&self, library: Option<&EmbreeLibrary>) -> Result<Box<dyn RayEngine>, PeerError> {
        match *self {
            Self::Own(engine) => Ok(engine.create()?),
            Self::Embree(setting) => {
                let library = library.cloned().map_or_else(|| EmbreeLibrary::load(None), Ok)?;
                Ok(Box::new(EmbreeEngine::new(&library, setting)?))
            }
            Self::EmbreeBest => Err(PeerError::BestOutsideBenchmark),
            Self::Obvhs => Ok(Box::new(ObvhsEngine::new())),
            Self::Floor => Err(PeerError::FloorOutsideBenchmark),
        }
    }

    /// Whether the engine is one of ours on the CPU, which all agree to the bit.
    pub const fn is_own(&self) -> bool {
        matches!(self, Self::Own(engine) if engine.is_on_cpu())
    }

    /// Whether the engine can tell what it chose, or what it holds.
    pub const fn explains(&self) -> bool {
        matches!(self, Self::Own(engine) if engine.explains())
    }

    /// Whether the engine needs the library Embree.
    pub const fn needs_embree(&self) -> bool {
        matches!(self, Self::Embree(_) | Self::EmbreeBest)
    }
}

impl From<EngineKind> for EngineSpec {
    fn from(kind: EngineKind) -> Self {
        Self::Own(kind.into())
    }
}

impl fmt::Display for EngineSpec {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Own(engine) => write!(f, "{engine}"),
            Self::Embree(setting) => write!(f, "{EMBREE}:{setting}"),
            Self::EmbreeBest => write!(f, "{EMBREE}:{BEST}"),
            Self::Obvhs => f.write_str(OBVHS),
            Self::Floor => f.write_str(FLOOR),
        }
    }
}

impl FromStr for EngineSpec {
    type Err = PeerError;

    fn from_str(text: &str) -> Result<Self, PeerError> {
        match text.split_once(':') {
            None if text == EMBREE => Ok(Self::Embree(Setting::default())),
            None if text == OBVHS => Ok(Self::Obvhs),
            None if text == FLOOR => Ok(Self::Floor),
            Some((EMBREE, BEST)) => Ok(Self::EmbreeBest),
            Some((EMBREE, setting)) => setting.parse().map(Self::Embree),
            _ => match text.parse() {
                Ok(engine) => Ok(Self::Own(engine)),
                Err(OwnEngineError::Unknown(text)) => Err(PeerError::UnknownEngine(text)),
                Err(error) => Err(PeerError::Own(error)),
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> Result<EngineSpec, PeerError> {
        text.parse()
    }

    #[test]
    fn names_are_parsed_as_they_are_printed() {
        let own = EngineKind::ALL.map(EngineSpec::from);
        let embree = Setting::all().into_iter().map(EngineSpec::Embree);
        let subfields = parse("subfields:eager+list+40").unwrap();
        let others = [subfields, EngineSpec::EmbreeBest, EngineSpec::Obvhs, EngineSpec::Floor];
        for spec in own.into_iter().chain(embree).chain(others) {
            assert_eq!(parse(&spec.to_string()), Ok(spec));
        }
        assert_eq!(parse("embree"), Ok(EngineSpec::Embree(Setting::default())));
    }

    #[test]
    fn unknown_names_are_told_which_there_are() {
        for text in ["warp", "obvhs:fast", "embre:best", ""] {
            let message = parse(text).unwrap_err().to_string();
            assert!(message.contains(&format!("\"{text}\"")), "{message}");
            assert!(message.contains("subfields, subfields:SETTING, embree"), "{message}");
        }
        assert!(parse("embree:bset").unwrap_err().to_string().contains("\"bset\""));
        assert!(parse("subfields:egaer").unwrap_err().to_string().contains("\"egaer\""));
    }

    #[test]
    fn the_best_setting_and_the_floor_are_no_engines() {
        let error = |spec: EngineSpec| spec.create(None).unwrap_err();
        assert_eq!(error(EngineSpec::EmbreeBest), PeerError::BestOutsideBenchmark);
        assert_eq!(error(EngineSpec::Floor), PeerError::FloorOutsideBenchmark);
        assert!(EngineSpec::EmbreeBest.needs_embree() && !EngineSpec::Obvhs.needs_embree());
    }
}
