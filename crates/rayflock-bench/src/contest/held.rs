//! What an engine holds, so that it can be told what changes.

use rayflock::engine::{EngineError, RayEngine};
use rayflock::geom::{FrameChanges, Geometry};

use super::meter::{Cost, Meter};

/// The geometry that one engine has committed.
#[derive(Clone, Debug, Default)]
pub(super) struct Held {
    geometry: Option<Geometry>,
    meter: Meter,
}

impl Held {
    /// Nothing yet; commits are measured by `meter`.
    pub(super) fn new(meter: Meter) -> Self {
        Self { geometry: None, meter }
    }

    /// Makes `geometry` the current one of `engine` and tells what that cost. The engine is
    /// told exactly what differs; finding that out is not measured.
    pub(super) fn commit(
        &mut self,
        engine: &mut dyn RayEngine,
        geometry: &Geometry,
    ) -> Result<Cost, EngineError> {
        let changes = match self.geometry.take() {
            Some(before) => FrameChanges::between(&before, geometry),
            None => FrameChanges::all(),
        };
        let (stats, cost) = self.meter.measure(|| engine.commit(geometry, &changes));
        let stats = stats?;
        self.geometry = Some(geometry.clone());
        Ok(cost.without(stats.conversion_ns))
    }

    /// Makes `engine` begin anew in the frame `before`: whatever it keeps from frame to frame is
    /// of that frame. It gets an empty frame first, then a `later` one, from which it learns what
    /// moves: Embree builds the tree that it will refit when an object first does.
    pub(super) fn begin_with(
        &mut self,
        engine: &mut dyn RayEngine,
        before: &Geometry,
        later: &Geometry,
    ) -> Result<(), EngineError> {
        for geometry in [&Geometry::default(), later, before] {
            self.commit(engine, geometry)?;
        }
        Ok(())
    }
}
