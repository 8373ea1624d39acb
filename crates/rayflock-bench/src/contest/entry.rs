//! An engine as it was asked for: one contestant, or for `embree:best` several in each cell.

use super::contestant::Contestant;
use super::effort::Effort;
use super::meter::Meter;
use super::piece::Piece;
use super::screen::screen;
use super::summarize::{skipped, summarize};
use crate::peer::embree::{EmbreeEngine, EmbreeLibrary, Setting};
use crate::peer::floor::FloorEngine;
use crate::record::Cell;
use crate::{BenchError, EngineSpec};

/// One engine that was asked for.
#[derive(Debug)]
pub(super) struct Entry {
    name: String,
    /// Whether contestants are found anew for each cell.
    is_screened: bool,
    contestants: Vec<Contestant>,
    /// Why there are no contestants.
    failure: Option<String>,
    meter: Meter,
}

impl Entry {
    /// Makes the engine, unless it has to be found for each cell.
    pub(super) fn new(
        spec: EngineSpec,
        library: Option<&EmbreeLibrary>,
        meter: Meter,
    ) -> Result<Self, BenchError> {
        let is_own = spec.is_own();
        let setting = match spec {
            EngineSpec::Embree(setting) => setting.to_string(),
            EngineSpec::EmbreeBest => return Ok(Self::with(spec, Vec::new(), meter)),
            EngineSpec::Floor => {
                let floor = Box::new(FloorEngine::default());
                let floor = Contestant::new(&spec.to_string(), "", false, floor, meter);
                return Ok(Self::with(spec, vec![floor.unanswering()], meter));
            }
            _ => String::new(),
        };
        let engine = spec.create(library)?;
        let contestant = Contestant::new(&spec.to_string(), &setting, is_own, engine, meter);
        Ok(Self::with(spec, vec![contestant], meter))
    }

    fn with(spec: EngineSpec, contestants: Vec<Contestant>, meter: Meter) -> Self {
        let is_screened = spec == EngineSpec::EmbreeBest;
        Self { name: spec.to_string(), is_screened, contestants, failure: None, meter }
    }

    /// An entry for any engine.
    #[cfg(test)]
    pub(super) fn of(contestant: Contestant) -> Self {
        let name = contestant.name.clone();
        let meter = Meter::default();
        Self { name, is_screened: false, contestants: vec![contestant], failure: None, meter }
    }

    /// Gets ready for the next cell.
    pub(super) fn begin_cell(
        &mut self,
        library: Option<&EmbreeLibrary>,
        piece: &Piece,
        effort: &Effort,
        is_stopped: &dyn Fn() -> bool,
    ) -> Result<(), BenchError> {
        self.contestants.iter_mut().for_each(Contestant::begin_cell);
        let Some(library) = library.filter(|_| self.is_screened) else { return Ok(()) };
        self.failure = None;
        let finalist = |setting: Setting| {
            let engine = EmbreeEngine::new(library, setting)?;
            Ok(Contestant::new(
                &self.name,
                &setting.to_string(),
                false,
                Box::new(engine),
                self.meter,
            ))
        };
        match screen(library, piece, effort, is_stopped) {
            Ok(settings) => {
                let finalists = settings.into_iter().map(finalist);
                self.contestants = finalists.collect::<Result<_, BenchError>>()?;
            }
            Err(BenchError::Engine(error)) => self.failure = Some(error.to_string()),
            Err(error) => return Err(error),
        }
        Ok(())
    }

    /// Those that take turns.
    pub(super) fn contestants(&mut self) -> impl Iterator<Item = &mut Contestant> {
        self.contestants.iter_mut()
    }

    /// The cell of the best contestant. Those found for this cell are given up.
    pub(super) fn end_cell(&mut self, piece: &Piece) -> Cell {
        let cells = self.contestants.iter().map(|contestant| summarize(piece, contestant));
        let total = |cell: &Cell| cell.total_ms.unwrap_or(f64::INFINITY);
        let best = cells.min_by(|a, b| total(a).total_cmp(&total(b)));
        if self.is_screened {
            self.contestants.clear();
        }
        best.unwrap_or_else(|| {
            let reason = self.failure.take().unwrap_or_else(|| "no setting was tried".to_owned());
            skipped(piece, &self.name, reason)
        })
    }
}
