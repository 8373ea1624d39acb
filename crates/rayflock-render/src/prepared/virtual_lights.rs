//! Virtual lights of frames, and what hides them, for renderers that gather elsewhere.
//!
//! Lights are shot and spheres fitted by the code of [`WhittedRenderer`](crate::WhittedRenderer):
//! what it gathers is what is handed out here.
//!
//! **Cost.** Nothing but shared meshes is kept until lights are asked for. Then the frame is
//! committed to an engine `auto`; frames that no lights are asked for are not.

use rayflock_engine::{EngineKind, RayEngine, create};
use rayflock_geom::simd::segment_spheres::SoftSphere;
use rayflock_geom::simd::segment_walls::Wall;
use rayflock_geom::{Aabb, FrameChanges, Geometry};
use rayflock_scene::SceneFrame;

use super::PreparedFrame;
use crate::vpl::VirtualLights;
use crate::vpl::indirect::IndirectLight;
use crate::{FrameStats, RenderError, RenderSettings, View};

/// Shoots virtual lights and fits spheres, frame by frame.
#[derive(Debug)]
pub struct PreparedVirtualLights {
    /// What walks from the lights are traced with, once there are any.
    engine: Option<Box<dyn RayEngine>>,
    /// A frame that the engine does not have, and how it differs from what it has.
    pending: Option<(Geometry, FrameChanges)>,
    /// Around the geometry that the engine has.
    bounds: Aabb,
    indirect: IndirectLight,
}

/// What a picture is lit by besides its lights, and what is in the way of that.
#[derive(Clone, Copy, Debug)]
pub struct ShotLights<'a> {
    /// The virtual lights.
    pub lights: &'a VirtualLights,
    /// Geometry terms of lights at a place in the scene count up to this.
    pub bound: f32,
    /// Distant lights are taken to be so far away.
    pub distance: f32,
    /// In place of geometry, neighbours close to each other; none where everything sees everything.
    pub spheres: &'a [SoftSphere],
    /// What lies around all of the scene.
    pub walls: &'a [Wall],
}

impl Default for PreparedVirtualLights {
    fn default() -> Self {
        let indirect = IndirectLight::default();
        Self { engine: None, pending: None, bounds: Aabb::EMPTY, indirect }
    }
}

impl PreparedVirtualLights {
    /// Takes the next frame; nothing is computed yet.
    pub fn commit(&mut self, frame: &SceneFrame) {
        let has_previous = self.engine.is_some() && self.pending.is_none();
        let changes = if has_previous { frame.changes.clone() } else { FrameChanges::all() };
        self.pending = Some((frame.geometry.clone(), changes));
        self.indirect.invalidate(&frame.geometry);
    }

    /// Shoots the virtual lights that `settings` ask for in the frame that was committed last, of
    /// which `frame` was prepared, and fits spheres if visibility is asked of them. `stats` are
    /// told what that took.
    ///
    /// # Errors
    /// [`RenderError`] when the engine does not take the frame.
    pub fn shoot(
        &mut self,
        frame: &PreparedFrame,
        view: &View,
        settings: &RenderSettings,
        stats: &mut FrameStats,
    ) -> Result<ShotLights<'_>, RenderError> {
        let engine = self.engine.get_or_insert_with(|| create(EngineKind::Auto));
        if let Some((geometry, changes)) = &self.pending {
            engine.commit(geometry, changes)?;
            self.bounds = geometry.bounds();
            self.pending = None;
        }
        let picture = frame.lights(view, settings);
        let shining = (&picture.lights[..], picture.background);
        let mut tree = None;
        if let Some(lights) = settings.indirect.lights() {
            let (engine, bounds) = (&mut **engine, &self.bounds);
            self.indirect.shoot(engine, &frame.0, shining, bounds, lights, stats);
            self.indirect.fit(lights.visibility, stats);
            tree = self.indirect.tree(lights.visibility);
        }
        Ok(ShotLights {
            lights: self.indirect.lights(),
            bound: self.indirect.bound(),
            distance: self.indirect.distance(),
            spheres: tree.map_or(&[], |tree| tree.spheres()),
            walls: tree.map_or(&[], |tree| tree.walls()),
        })
    }

    /// Bytes held, meshes not included.
    pub fn memory_usage(&self) -> usize {
        self.engine.as_ref().map_or(0, |engine| engine.memory_usage())
            + self.indirect.memory_usage()
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use rayflock_scene::{Evaluator, builtin};

    use super::*;
    use crate::Indirect;
    use crate::occluders::SphereSettings;
    use crate::vpl::{Visibility, VplSettings};

    #[test]
    fn frames_between_that_shoot_nothing_change_nothing() {
        let scene = Arc::new(builtin::build("museum3").unwrap());
        let visibility = Visibility::Spheres(SphereSettings { count: 64 });
        let lights = VplSettings { light_count: 32, visibility, ..VplSettings::default() };
        let settings =
            RenderSettings { indirect: Indirect::Vpl(lights), ..RenderSettings::default() };
        let mut evaluator = Evaluator::new(Arc::clone(&scene), None).unwrap();
        let mut kept = PreparedVirtualLights::default();
        for (time, shoots) in [(0.5, true), (1.0, true), (1.5, false), (2.0, false), (2.5, true)] {
            let frame = evaluator.evaluate(time).unwrap();
            kept.commit(frame);
            if !shoots {
                continue;
            }
            let mut anew = PreparedVirtualLights::default();
            anew.commit(frame);
            let prepared = PreparedFrame::new(&scene, frame).unwrap();
            let view = View::new(frame.cameras[0], scene.cameras[0].projection);
            let [mut found_stats, mut expected_stats] = [FrameStats::default(); 2];
            let found = kept.shoot(&prepared, &view, &settings, &mut found_stats).unwrap();
            let expected = anew.shoot(&prepared, &view, &settings, &mut expected_stats).unwrap();
            assert!(found.lights.len() > 16 && found.bound > 0.0);
            assert_eq!((found.lights, found.bound), (expected.lights, expected.bound));
            assert_eq!(found.walls, expected.walls);
            assert_eq!(found_stats.rays.indirect, expected_stats.rays.indirect);
            // Those of what bends depend on the frames before.
            assert_eq!(found_stats.indirect.spheres, found.spheres.len() as u64);
            assert!(found.spheres.len() > 20 && found.spheres.len() < 100);
        }
        assert!(kept.memory_usage() > 0);
    }
}
