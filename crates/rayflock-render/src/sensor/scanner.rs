//! A sensor at work: time step by time step through any engine.

use std::ops::Range;
use std::sync::Arc;

use glam::{Affine3A, Vec3};
use rayflock_engine::{CommitStats, RayEngine, TraceStats};
use rayflock_scene::{Evaluator, Scene, SceneFrame};
use tracing::debug_span;

use super::beams::Beams;
use super::draws::Draws;
use super::layout::Layout;
use super::sweep::SweepPoint;
use super::trace_beams::{BeamWave, Common, Echo};
use super::{Sensor, SensorError, StepPose, Sweep};
use crate::frame_shading::FrameShading;

/// Sweeps with a sensor, through any engine.
///
/// [`Scanner::sweep`] does it all. Whoever makes frames by other means than an [`Evaluator`] calls
/// [`Scanner::begin`], and then [`Scanner::trace_step`] for each step.
#[derive(Debug)]
pub struct Scanner {
    engine: Box<dyn RayEngine>,
    sensor: Sensor,
    layout: Layout,
    step_count: usize,
    /// Those of the sweep that was begun.
    beams: Beams,
    /// When that sweep starts.
    start: f64,
    draws: Draws,
    buffers: Buffers,
}

/// Working memory, kept from step to step.
#[derive(Debug, Default)]
struct Buffers {
    wave: BeamWave,
    echoes: Vec<Echo>,
    /// Echoes of one beam that are told, each with its number among all of the beam's.
    told: Vec<(u32, Echo)>,
}

/// What a time step took.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct StepStats {
    /// What the engine found in the frame.
    pub commit: CommitStats,
    /// What the engine counted.
    pub trace: TraceStats,
}

impl Scanner {
    /// A scanner that traces with `engine`, about to sweep from time 0.
    ///
    /// # Errors
    /// [`SensorError::Value`] where no such sensor can be.
    pub fn new(engine: Box<dyn RayEngine>, sensor: Sensor) -> Result<Self, SensorError> {
        sensor.check()?;
        let layout = sensor.pattern.layout();
        let steps = sensor.settings.time_steps.map(|steps| steps as usize);
        Ok(Self {
            engine,
            step_count: steps.unwrap_or(layout.most_steps()),
            beams: sensor.pattern.beams(0.0),
            start: 0.0,
            draws: Draws::new(sensor.settings.seed, 0.0),
            layout,
            sensor,
            buffers: Buffers::default(),
        })
    }

    /// The sensor.
    pub const fn sensor(&self) -> &Sensor {
        &self.sensor
    }

    /// Beams of a sweep.
    pub const fn beam_count(&self) -> usize {
        self.layout.beam_count
    }

    /// What the user should hear of the engine, though every question is answered.
    pub fn notice(&self) -> Option<&str> {
        self.engine.notice()
    }

    /// Time steps of a sweep.
    pub const fn step_count(&self) -> usize {
        self.step_count
    }

    /// The time of a step of the sweep that was begun, in seconds of the scene.
    pub fn step_time(&self, step_idx: usize) -> f64 {
        self.start + self.layout.time_of_step(step_idx, self.step_count)
    }

    /// Fills `sweep` with the sweep that starts at `start` seconds. Returns what each step took,
    /// in all: the counts of `commit` are those of the first step.
    ///
    /// # Errors
    /// [`SensorError::Scene`], [`SensorError::Camera`], [`SensorError::Frame`] and
    /// [`SensorError::Engine`]; `sweep` then holds the steps before.
    pub fn sweep(
        &mut self,
        evaluator: &mut Evaluator,
        start: f64,
        sweep: &mut Sweep,
    ) -> Result<StepStats, SensorError> {
        let _span = debug_span!("sweep").entered();
        self.begin(start, sweep);
        let scene = Arc::clone(evaluator.scene());
        let mut sum = StepStats::default();
        for step_idx in 0..self.step_count {
            let time = self.step_time(step_idx);
            let evaluated = evaluator.evaluate(time);
            let frame = evaluated.map_err(|source| SensorError::Scene { time, source })?;
            let stats = self.trace_step(step_idx, &scene, frame, sweep)?;
            if step_idx == 0 {
                sum.commit = stats.commit;
            }
            sum.trace += stats.trace;
        }
        Ok(sum)
    }

    /// Begins the sweep that starts at `start` seconds, and empties `sweep` for it.
    pub fn begin(&mut self, start: f64, sweep: &mut Sweep) {
        if !self.sensor.pattern.repeats() {
            self.beams = self.sensor.pattern.beams(start);
        }
        self.draws = Draws::new(self.sensor.settings.seed, start);
        self.start = start;
        sweep.clear();
    }

    /// Adds what the beams of step `step_idx` bring back from `frame`, which is `scene` at
    /// [`Scanner::step_time`].
    ///
    /// # Errors
    /// [`SensorError::Camera`], [`SensorError::Frame`] and [`SensorError::Engine`].
    ///
    /// # Panics
    /// When `step_idx >= step_count()`.
    pub fn trace_step(
        &mut self,
        step_idx: usize,
        scene: &Scene,
        frame: &SceneFrame,
        sweep: &mut Sweep,
    ) -> Result<StepStats, SensorError> {
        let _span = debug_span!("trace_step").entered();
        assert!(step_idx < self.step_count, "step {step_idx} of {}", self.step_count);
        let world_from_sensor = self.sensor.path.at(frame)?;
        let shading = FrameShading::unlit(scene, frame)?;
        let commit = self.engine.commit(&frame.geometry, &frame.changes)?;

        let time = self.step_time(step_idx);
        sweep.steps.push(StepPose { time, world_from_sensor });
        let beams = self.layout.beams_of_step(step_idx, self.step_count);
        self.aim(&world_from_sensor, beams);
        let Buffers { wave, echoes, .. } = &mut self.buffers;
        let trace = wave.trace(&mut *self.engine, &shading, &self.sensor.settings, echoes);
        self.tell(time, &world_from_sensor, sweep);
        Ok(StepStats { commit, trace })
    }

    /// Brings the beams into the world.
    fn aim(&mut self, world_from_sensor: &Affine3A, beams: Range<usize>) {
        let wave = &mut self.buffers.wave;
        wave.order = self.layout.order(&beams);
        wave.beam_idxs.clear();
        wave.beam_idxs.extend(beams.start as u32..beams.end as u32);
        wave.varying.clear();
        match &self.beams {
            Beams::FromPoint(directions) => {
                wave.common = Common::Origin(world_from_sensor.translation.into());
                let turned = directions[beams].iter().map(|to| turned(world_from_sensor, *to));
                wave.varying.extend(turned);
            }
            Beams::Parallel(origins) => {
                wave.common = Common::Direction(turned(world_from_sensor, Vec3::NEG_Z));
                let moved =
                    origins[beams].iter().map(|from| world_from_sensor.transform_point3(*from));
                wave.varying.extend(moved);
            }
        }
    }

    /// Adds the returns of all echoes.
    fn tell(&mut self, time: f64, world_from_sensor: &Affine3A, sweep: &mut Sweep) {
        let _span = debug_span!("tell_returns").entered();
        let mut told = std::mem::take(&mut self.buffers.told);
        let echoes = &self.buffers.echoes;
        for echoes in echoes.chunk_by(|a, b| a.beam_idx == b.beam_idx) {
            told.clear();
            told.extend((0..).zip(echoes.iter().copied()).filter(|told| self.notices(told)));
            self.sensor.settings.returns.choose(&mut told, |(_, echo)| echo.intensity);
            let return_count = told.len() as u8;
            for (return_number, told) in (1..).zip(&told) {
                let point = self.point(told, world_from_sensor);
                sweep.push(&SweepPoint { time, return_number, return_count, ..point });
            }
        }
        self.buffers.told = told;
    }

    /// Whether an echo, which is the so manieth of its beam, is not lost.
    fn notices(&self, (echo_idx, echo): &(u32, Echo)) -> bool {
        let settings = &self.sensor.settings;
        if !(settings.min_range..=settings.max_range).contains(&echo.range)
            || echo.intensity < settings.min_intensity
        {
            return false;
        }
        let chance = settings.drop_out_chance(echo.range, echo.cos);
        chance <= 0.0 || self.draws.drop_out(echo.beam_idx, *echo_idx) >= chance
    }

    /// The only return of its beam that an echo becomes, at time 0.
    fn point(&self, (echo_idx, echo): &(u32, Echo), world_from_sensor: &Affine3A) -> SweepPoint {
        let deviation = self.sensor.settings.deviation(echo.range);
        let mut range = echo.range;
        if deviation > 0.0 {
            let noise = self.draws.noise(echo.beam_idx, *echo_idx) as f32;
            range = (range + deviation * noise).max(0.0);
        }
        let beam_idx = echo.beam_idx as usize;
        let (from, to) = self.beams.get(beam_idx);
        let origin = world_from_sensor.transform_point3(from);
        SweepPoint {
            beam_idx: echo.beam_idx,
            place: self.layout.place(beam_idx),
            time: 0.0,
            range,
            position: origin + range * turned(world_from_sensor, to),
            position_in_sensor: from + range * to,
            normal: echo.normal,
            intensity: echo.intensity,
            object_id: echo.object_id,
            prim_id: echo.prim_id,
            return_number: 1,
            return_count: 1,
        }
    }
}

/// A direction of the sensor in the world, of unit length.
fn turned(world_from_sensor: &Affine3A, direction: Vec3) -> Vec3 {
    world_from_sensor.transform_vector3(direction).normalize_or(Vec3::NEG_Z)
}
