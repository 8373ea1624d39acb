//! Indirect light for a renderer: lights are shot once a picture and gathered wave by wave.

use rayflock_engine::RayEngine;
use rayflock_geom::simd::segment_spheres::SoftSphere;
use rayflock_geom::{Aabb, Geometry};
use rayflock_scene::{Background, LightKind};

use super::exact_visibility::{ExactVisibility, RayBuffers};
use super::gather::{GatherBuffers, GatherStats, gather};
use super::gather_by_cuts::CutGatherer;
use super::gather_from_lookouts::{LookoutGatherer, SeenLights};
use super::gather_past_spheres::{GroupedLights, gather_past_spheres};
use super::resample::{Eyes, gather_chosen};
use super::shoot::{ShootBuffers, shoot};
use super::sources::Sources;
use super::sphere_visibility::{DISTANCE, SphereVisibility};
use super::{
    ChosenRays, PairTile, PairVisibility, VirtualLights, Visibility, VisibilityStats, VplSettings,
};
use crate::Indirect;
use crate::frame_shading::FrameShading;
use crate::lightcuts::{Exact, Open, PastSpheres};
use crate::occluders::{SceneSpheres, SphereSettings, SphereTree};
use crate::stats::{FrameStats, Stage, Stopwatch};
use crate::wave::ShadedRun;

/// Virtual lights and the memory to make and gather them, kept from picture to picture.
#[derive(Debug, Default)]
pub(crate) struct IndirectLight {
    lights: VirtualLights,
    /// What the lights were made of; `None` when they are out of date.
    made_of: Option<MadeOf>,
    bound: f32,
    shoot: ShootBuffers,
    gather: GatherBuffers,
    rays: RayBuffers,
    /// What there is in the frame, for spheres.
    geometry: Geometry,
    spheres: Option<Spheres>,
    /// No spheres, for light that nothing is in the way of.
    open_air: SphereTree,
    grouped: GroupedLights,
    lookouts: LookoutGatherer,
    cuts: CutGatherer,
}

/// Spheres in place of geometry.
#[derive(Debug)]
struct Spheres {
    settings: SphereSettings,
    scene: SceneSpheres,
    /// Whether they are where the frame is.
    is_current: bool,
}

/// What lights depend on besides the frame.
#[derive(Clone, Debug, PartialEq)]
struct MadeOf {
    light_count: u32,
    lights: Vec<LightKind>,
    background: Background,
}

impl IndirectLight {
    /// The frame has changed.
    pub(crate) fn invalidate(&mut self, geometry: &Geometry) {
        self.made_of = None;
        self.geometry = geometry.clone();
        self.spheres.iter_mut().for_each(|spheres| spheres.is_current = false);
    }

    /// The lights.
    pub(crate) const fn lights(&self) -> &VirtualLights {
        &self.lights
    }

    /// The largest geometry term that counts.
    pub(crate) const fn bound(&self) -> f32 {
        self.bound
    }

    /// How far away distant lights are taken to be.
    pub(crate) const fn distance(&self) -> f32 {
        DISTANCE * self.lights.reach()
    }

    /// The spheres and walls that the last picture with such light was made with, if any.
    pub(crate) fn tree(&self, visibility: Visibility) -> Option<&SphereTree> {
        let Visibility::Spheres(_) = visibility else { return None };
        self.spheres.as_ref().map(|spheres| spheres.scene.tree())
    }

    /// The spheres that the last picture with such light was made with.
    pub(crate) fn spheres(&self, indirect: &Indirect) -> &[SoftSphere] {
        let tree = indirect.lights().and_then(|lights| self.tree(lights.visibility));
        tree.map_or(&[], SphereTree::spheres)
    }

    /// Shoots virtual lights, unless those of the last picture are still right.
    pub(crate) fn shoot(
        &mut self,
        engine: &mut dyn RayEngine,
        frame: &FrameShading,
        (lights, background): (&[LightKind], Background),
        bounds: &Aabb,
        settings: &VplSettings,
        stats: &mut FrameStats,
    ) {
        let stopwatch = Stopwatch::start();
        let diagonal = bounds.size().length();
        let per_area = settings.walk_count() as f32 / (diagonal * diagonal);
        // No geometry, no diagonal: nothing is gathered then.
        self.bound = settings.bound * per_area.min(f32::MAX);
        let light_count = settings.light_count;
        let made_of = MadeOf { light_count, lights: lights.to_vec(), background };
        if self.made_of.as_ref() != Some(&made_of) {
            let sources = Sources::new(lights, &frame.lights.emitters, background, bounds);
            let counts = (settings.walk_count(), settings.sky_count());
            let shot =
                shoot(engine, frame, &sources, counts, diagonal, &mut self.shoot, &mut self.lights);
            stats.add_traced(Stage::Indirect, shot.traced);
            stats.rays.indirect += shot.rays;
            self.made_of = Some(made_of);
            self.grouped.assign(&self.lights);
            self.cuts.invalidate();
        }
        stats.indirect.lights = self.lights.len() as u64;
        stats.indirect.shoot_seconds += stopwatch.seconds();
    }

    /// Brings spheres to where the frame is, if visibility is asked of them.
    pub(crate) fn fit(&mut self, visibility: Visibility, stats: &mut FrameStats) {
        let Visibility::Spheres(settings) = visibility else { return };
        let stopwatch = Stopwatch::start();
        let spheres = match &mut self.spheres {
            Some(spheres) if spheres.settings == settings => spheres,
            spheres => spheres.insert(Spheres {
                settings,
                scene: SceneSpheres::new(settings),
                is_current: false,
            }),
        };
        if !spheres.is_current {
            spheres.scene.commit(&self.geometry);
            spheres.is_current = true;
        }
        stats.indirect.spheres = spheres.scene.tree().spheres().len() as u64;
        stats.indirect.fit_seconds += stopwatch.seconds();
    }

    /// Gathers light at the points of `runs`; what arrives is left as `lit` of each run, one entry
    /// a point. `sample_idx` counts the samples of a pixel.
    pub(crate) fn gather(
        &mut self,
        engine: &mut dyn RayEngine,
        (indirect, sample_idx): (&Indirect, u32),
        runs: &mut [ShadedRun],
        stats: &mut FrameStats,
    ) {
        let stopwatch = Stopwatch::start();
        let gathered = match *indirect {
            Indirect::Off => return,
            Indirect::Vpl(VplSettings { chosen: Some(chosen), visibility, .. }) => {
                self.gather_chosen(engine, visibility, (chosen, sample_idx), runs, stats)
            }
            Indirect::Vpl(settings) => self.gather_all(engine, settings.visibility, runs, stats),
            Indirect::Lightcuts { lights, error_bound } => {
                self.gather_by_cuts(engine, lights.visibility, error_bound, runs, stats)
            }
        };
        stats.rays.shadow += gathered.visibility.rays;
        stats.indirect.visibility += gathered.visibility;
        stats.indirect.gathered += gathered.gathered;
        stats.indirect.clamped += gathered.lost;
        stats.indirect.gather_seconds += stopwatch.seconds();
    }

    /// From all lights.
    fn gather_all(
        &mut self,
        engine: &mut dyn RayEngine,
        visibility: Visibility,
        runs: &mut [ShadedRun],
        stats: &mut FrameStats,
    ) -> GatherStats {
        let (lights, bound) = (&self.lights, self.bound);
        match (visibility, &self.spheres) {
            (Visibility::Spheres(_), Some(spheres)) => {
                gather_past_spheres(lights, &self.grouped, spheres.scene.tree(), bound, runs)
            }
            (Visibility::Exact, _) => {
                let mut exact = ExactVisibility::new(engine, &mut self.rays);
                let gathered = gather(lights, bound, &mut exact, runs, &mut self.gather);
                stats.add_traced(Stage::Indirect, exact.traced);
                gathered
            }
            (Visibility::Lookouts(settings), _) => {
                let seen = SeenLights { lights, grouped: &self.grouped, bound };
                let (gathered, traced) = self.lookouts.gather(engine, seen, settings, runs);
                stats.add_traced(Stage::Indirect, traced);
                gathered
            }
            _ => {
                self.open_air.build(&[], &[]);
                gather_past_spheres(lights, &self.grouped, &self.open_air, bound, runs)
            }
        }
    }

    /// From all lights, with few rays that correct a guess.
    fn gather_chosen(
        &mut self,
        engine: &mut dyn RayEngine,
        visibility: Visibility,
        chosen: (ChosenRays, u32),
        runs: &mut [ShadedRun],
        stats: &mut FrameStats,
    ) -> GatherStats {
        let mut past_spheres;
        let guess: &mut dyn PairVisibility = match (visibility, &self.spheres) {
            (Visibility::Spheres(_), Some(spheres)) => {
                past_spheres = SphereVisibility::new(spheres.scene.tree());
                &mut past_spheres
            }
            _ => &mut Unhindered,
        };
        let mut exact = ExactVisibility::new(engine, &mut self.rays);
        let mut eyes = Eyes { guess, exact: &mut exact };
        let (lights, bound) = (&self.lights, self.bound);
        let gathered = gather_chosen(lights, bound, chosen, &mut eyes, runs, &mut self.gather);
        stats.add_traced(Stage::Indirect, exact.traced);
        gathered
    }

    /// From clusters of lights.
    fn gather_by_cuts(
        &mut self,
        engine: &mut dyn RayEngine,
        visibility: Visibility,
        error_bound: f32,
        runs: &mut [ShadedRun],
        stats: &mut FrameStats,
    ) -> GatherStats {
        self.cuts.commit(&self.lights, error_bound, self.bound);
        let (lights, cutter) = (&self.lights, &mut self.cuts);
        let (gathered, cuts) = match (visibility, &self.spheres) {
            (Visibility::Spheres(_), Some(spheres)) => {
                cutter.gather(lights, &mut PastSpheres::new(spheres.scene.tree()), runs)
            }
            (Visibility::Exact | Visibility::Lookouts(_), _) => {
                let mut exact = Exact::new(engine);
                let gathered = cutter.gather(lights, &mut exact, runs);
                stats.add_traced(Stage::Indirect, exact.traced);
                gathered
            }
            _ => cutter.gather(lights, &mut Open, runs),
        };
        stats.indirect.cuts += cuts;
        gathered
    }

    /// Bytes held.
    pub(crate) fn memory_usage(&self) -> usize {
        self.lights.memory_usage()
            + self.shoot.memory_usage()
            + self.gather.memory_usage()
            + self.rays.memory_usage()
            + self.spheres.as_ref().map_or(0, |spheres| spheres.scene.memory_usage())
            + self.grouped.memory_usage()
            + self.lookouts.memory_usage()
            + self.cuts.memory_usage()
    }
}

/// Everything sees everything.
#[derive(Debug)]
struct Unhindered;

impl PairVisibility for Unhindered {
    fn multiply(&mut self, _tile: &PairTile<'_>, _shares: &mut [f32]) -> VisibilityStats {
        VisibilityStats::default()
    }
}
