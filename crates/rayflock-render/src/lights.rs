//! What lights a frame: lights of the scene, surfaces that emit, ambient light, and the lights of
//! scenes that have none.

pub(crate) mod emitters;
pub(crate) mod incident;
pub(crate) mod key_light;
pub(crate) mod power;
pub(crate) mod sent_back;

use glam::Vec3;
use rayflock_geom::Geometry;
use rayflock_scene::LightKind;

use crate::View;
use crate::frame_shading::FrameShading;
use emitters::Emitters;
use key_light::key_light;

/// Everything that lights a frame.
#[derive(Clone, Debug, Default)]
pub(crate) struct Lights {
    /// Lights of the scene, in world space.
    pub(crate) lights: Vec<LightKind>,
    /// Surfaces that emit.
    pub(crate) emitters: Emitters,
    /// Light from everywhere, as irradiance over pi.
    pub(crate) ambient: Vec3,
}

impl Lights {
    pub(crate) fn new(
        shading: &FrameShading,
        geometry: &Geometry,
        lights: &[LightKind],
        ambient: Vec3,
    ) -> Self {
        let emitters = Emitters::new(shading, geometry);
        Self { lights: lights.to_vec(), emitters, ambient }
    }

    /// Whether nothing lights the frame but ambient light, so that the default lights do.
    pub(crate) fn are_missing(&self) -> bool {
        self.lights.is_empty() && self.emitters.is_empty()
    }

    /// The lights of a picture: in scenes without any, the key light.
    pub(crate) fn seen_from(&self, view: &View) -> Vec<LightKind> {
        if self.are_missing() {
            vec![key_light(&view.world_from_camera)]
        } else {
            self.lights.clone()
        }
    }

    pub(crate) fn memory_usage(&self) -> usize {
        size_of_val(&self.lights[..]) + self.emitters.memory_usage()
    }
}
