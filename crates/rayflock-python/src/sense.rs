//! What sensors see of scenes that move while they look.

use rayflock::engine::{EngineKind, create};
use rayflock::geom::{FrameChanges, Geometry};
use rayflock::render::sensor::{Scanner, SensorError, Sweep};
use rayflock::scene::{Evaluator, SceneFrame};

use crate::errors::Failure;
use crate::pool;
use crate::sensor_options::SensorOptions;
use crate::source::Source;
use crate::stage::Stage;
use crate::world::World;

/// How a scene is swept.
pub(crate) struct SenseQuestion {
    pub(crate) sensor: SensorOptions,
    /// When the sweep begins, in seconds; by default when the world is.
    pub(crate) start: Option<f64>,
    /// By default the world's own, as are the threads.
    pub(crate) engine: Option<EngineKind>,
    pub(crate) threads: Option<usize>,
}

/// Sweeps a world with a sensor. What the file moves, moves; the world stays at its time.
pub(crate) fn sense(world: &mut World, question: &SenseQuestion) -> Result<Sweep, Failure> {
    let pool = pool::with_threads(question.threads.unwrap_or(world.threads))?;
    let sensor = question.sensor.in_world(world)?;
    let engine = create(question.engine.unwrap_or(world.engine));
    let mut scanner = Scanner::new(engine, sensor)?;
    let now = world.source().map_or(0.0, |source| source.frame().time);
    let mut moving = Moving::of(world);
    pool.install(|| {
        let mut sweep = Sweep::default();
        scanner.begin(question.start.unwrap_or(now), &mut sweep);
        for step_idx in 0..scanner.step_count() {
            let frame = moving.frame_at(scanner.step_time(step_idx))?;
            scanner.trace_step(step_idx, &moving.stage.scene, &frame, &mut sweep)?;
        }
        for id in &mut sweep.object_id {
            *id = moving.stage.world_id(*id);
        }
        Ok(sweep)
    })
}

/// A world in motion.
struct Moving {
    stage: Stage,
    /// Moves what comes from a file.
    player: Option<Evaluator>,
    /// The frame before.
    before: Geometry,
}

impl Moving {
    fn of(world: &World) -> Self {
        let player = world.source().map(Source::player);
        Self { stage: Stage::of(world), player, before: Geometry::default() }
    }

    /// The world at a time, and how it differs from the time before.
    fn frame_at(&mut self, time: f64) -> Result<SceneFrame, Failure> {
        let of_file = match &mut self.player {
            Some(player) => {
                let evaluated = player.evaluate(time);
                evaluated.map_err(|source| SensorError::Scene { time, source })?.clone()
            }
            None => SceneFrame { time, ..SceneFrame::default() },
        };
        let mut frame = self.stage.dress(of_file)?;
        frame.changes = FrameChanges::between(&self.before, &frame.geometry);
        self.before = frame.geometry.clone();
        Ok(frame)
    }
}
