//! A frame checked and made ready for renderers that shade elsewhere, as on a graphics device: what
//! lights it, and what is seen where nothing is.
//!
//! Surfaces, materials and textures are those of the scene and the frame themselves; once they are
//! checked, every index in them is good.

mod virtual_lights;

use glam::{Vec2, Vec3};
use rayflock_scene::{Background, LightKind, Scene, SceneFrame};

pub use self::virtual_lights::{PreparedVirtualLights, ShotLights};
use crate::caustics::{CausticSettings, LightView, light_views};
use crate::frame_shading::FrameShading;
pub use crate::lights::emitters::{Emitter, EmitterShape};
use crate::lights::key_light::SKY_SHARE;
use crate::shading::sampling::subpixel;
use crate::{Indirect, RenderError, RenderSettings, View};

/// A frame whose parts fit together.
#[derive(Debug)]
pub struct PreparedFrame(FrameShading);

/// What lights a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct PictureLights {
    /// Lights in world space: those of the scene, or the key light of scenes without any.
    pub lights: Vec<LightKind>,
    /// Light from everywhere, as irradiance over pi; none where virtual lights are gathered.
    pub ambient: Vec3,
    /// What rays see that hit nothing.
    pub background: Background,
    /// The share of the background that lights surfaces, in place of lights that are not there; 0
    /// where virtual lights are gathered.
    pub sky_share: f32,
    /// Whether surfaces that would send back more light than arrives are scaled down, as they are
    /// where light goes on from surface to surface.
    pub conserves: bool,
}

/// Whence lights are thrown by mirrors and glass, and how what they throw is gathered.
#[derive(Clone, Debug, PartialEq)]
pub struct ThrownLight {
    /// Windows through which lights shine on what mirrors or lets light through, each with its
    /// light.
    pub views: Vec<(LightKind, LightView)>,
    /// How far from a point photons count, in scene units; more than 0.
    pub radius: f32,
    /// The least coordinates of the geometry.
    pub low: Vec3,
}

impl PreparedFrame {
    /// Checks a frame of `scene`.
    ///
    /// # Errors
    /// [`RenderError`] when surfaces, materials and textures do not fit together.
    pub fn new(scene: &Scene, frame: &SceneFrame) -> Result<Self, RenderError> {
        FrameShading::new(scene, frame).map(Self)
    }

    /// What lights a picture from `view`.
    pub fn lights(&self, view: &View, settings: &RenderSettings) -> PictureLights {
        let shading = &self.0;
        let is_direct = settings.indirect == Indirect::Off;
        let lights_by_sky = is_direct && shading.lights.are_missing();
        PictureLights {
            lights: shading.lights.seen_from(view),
            ambient: if is_direct { shading.lights.ambient } else { Vec3::ZERO },
            background: shading.background_of(settings),
            sky_share: if lights_by_sky { SKY_SHARE } else { 0.0 },
            conserves: !is_direct,
        }
    }

    /// Whence `lights` are thrown; `None` where there is no geometry, or none that throws them.
    pub fn thrown(&self, lights: &[LightKind], settings: &CausticSettings) -> Option<ThrownLight> {
        let (turning, bounds) = (self.0.turning_bounds(), self.0.bounds());
        let radius = settings.radius * bounds.size().length();
        let views = |light: &LightKind| {
            let views = light_views(light, &turning, &bounds, settings.photons);
            views.into_iter().map(|view| (*light, view)).collect::<Vec<_>>()
        };
        let views: Vec<_> = lights.iter().flat_map(views).collect();
        let is_thrown = radius > 0.0 && radius.is_finite() && !views.is_empty();
        is_thrown.then_some(ThrownLight { views, radius, low: bounds.min })
    }

    /// Primitives that emit, in world space.
    pub fn emitters(&self) -> &[Emitter] {
        self.0.lights.emitters.all()
    }
}

/// Where sample `sample_idx` lies in its pixel, in `0..1` from the top left; the first is the
/// centre.
pub fn sample_place(sample_idx: u32) -> Vec2 {
    subpixel(sample_idx)
}
