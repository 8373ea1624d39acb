//! The renderer of the CPU, for what the device cannot render and for when it is lost.

use rayflock_engine::{CommitStats, EngineKind, create};
use rayflock_geom::FrameChanges;
use rayflock_render::{
    Film, FrameRenderer, FrameStats, RenderError, RenderSettings, View, WhittedRenderer,
};
use rayflock_scene::{Scene, SceneFrame};

/// A renderer on the CPU that is made when it is needed, and why it was.
#[derive(Debug, Default)]
pub(super) struct FrameStandby {
    /// What was committed last, and what shading needs of its scene; meshes and images are shared.
    latest: Option<(Scene, SceneFrame)>,
    renderer: Option<WhittedRenderer>,
    notice: Option<String>,
}

impl FrameStandby {
    /// Keeps a frame, and commits it where the renderer is at work.
    pub(super) fn commit(
        &mut self,
        scene: &Scene,
        frame: &SceneFrame,
    ) -> Result<Option<CommitStats>, RenderError> {
        let for_shading = Scene {
            materials: scene.materials.clone(),
            textures: scene.textures.clone(),
            ambient: scene.ambient,
            background: scene.background,
            ..Scene::default()
        };
        self.latest = Some((for_shading, frame.clone()));
        let renderer = self.renderer.as_mut();
        renderer.map(|renderer| renderer.commit(scene, frame)).transpose()
    }

    /// Has the renderer take the frame that is kept.
    pub(super) fn take_over(&mut self, reason: String) -> Result<CommitStats, RenderError> {
        let mut renderer = WhittedRenderer::new(create(EngineKind::Auto));
        let stats = match &mut self.latest {
            Some((scene, frame)) => {
                // It knows no earlier frame that this one could differ from.
                frame.changes = FrameChanges::all();
                renderer.commit(scene, frame)?
            }
            None => CommitStats::default(),
        };
        (self.renderer, self.notice) = (Some(renderer), Some(reason));
        Ok(stats)
    }

    /// Renders in place of the device.
    pub(super) fn render(
        &mut self,
        reason: Option<String>,
        view: &View,
        settings: &RenderSettings,
        film: &mut Film,
    ) -> FrameStats {
        if let (None, Some(reason)) = (&self.renderer, reason)
            && let Err(error) = self.take_over(reason)
        {
            self.notice = Some(format!("the renderer on the CPU failed: {error}"));
        }
        let mut without_frame = None;
        let renderer = self.renderer.as_mut().unwrap_or_else(|| {
            without_frame.insert(WhittedRenderer::new(create(EngineKind::Brute)))
        });
        renderer.render(view, settings, film)
    }

    pub(super) fn notice(&self) -> Option<&str> {
        self.notice.as_deref()
    }

    pub(super) fn memory_usage(&self) -> usize {
        self.renderer.as_ref().map_or(0, WhittedRenderer::memory_usage)
    }
}
