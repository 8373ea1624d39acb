//! What a caller can choose about a picture.

use rayflock_scene::Background;

use crate::Shown;
use crate::caustics::CausticSettings;
use crate::vpl::{Visibility, VplSettings};

/// How a frame is rendered. Values out of range are taken as the nearest one in range.
#[derive(Clone, Debug, PartialEq)]
pub struct RenderSettings {
    /// Rays through each pixel, `1..=65536`. The first goes through the pixel's centre.
    pub samples_per_pixel: u32,
    /// How many times a ray is mirrored or refracted at most, `0..=32`; 0 shows no reflections.
    pub depth: u32,
    /// Whether lights cast shadows; those of the path tracer do.
    pub shadows: bool,
    /// Points sampled on emitting surfaces for each visible point and sample, `1..=1024`. More
    /// make soft shadows less noisy. The path tracer samples one for each turn of a path.
    pub light_samples: u32,
    /// How light is found that was scattered before; the path tracer finds it anyhow.
    pub indirect: Indirect,
    /// Whether light is found that mirrors and glass throw onto rough surfaces, from point, spot and
    /// directional lights; surfaces that emit throw none. The path tracer finds that of surfaces
    /// that emit, and no other.
    pub caustics: Option<CausticSettings>,
    /// What the pixels tell; the path tracer shows nothing but light.
    pub shown: Shown,
    /// What rays that hit nothing see, instead of what the scene says.
    pub background: Option<Background>,
    /// How many rays are traced together at most, `1..=2^24`, but at least one row of pixels.
    /// Bounds the memory taken; changes no picture but, a little, those of light past spheres
    /// ([`Visibility::Spheres`]), where points that are shaded together share what they see.
    pub batch_rays: usize,
}

/// How light is found that reaches a surface from other surfaces and the sky.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub enum Indirect {
    /// It is not: ambient light stands for it.
    #[default]
    Off,
    /// From virtual lights, all of them at every point. Ambient light is left out; the background
    /// lights as a sky.
    Vpl(VplSettings),
    /// From virtual lights too, but clusters of them stand for all where that makes little
    /// difference: for many thousands of lights.
    Lightcuts {
        /// The lights.
        lights: VplSettings,
        /// No cluster may be wrong by more than this share of what a point gets, `0..=1`.
        error_bound: f32,
    },
}

impl Indirect {
    fn clamped(&self) -> Self {
        match self {
            Self::Off => Self::Off,
            Self::Vpl(settings) => Self::Vpl(settings.clamped()),
            Self::Lightcuts { lights, error_bound } => Self::Lightcuts {
                lights: lights.clamped(),
                error_bound: if error_bound.is_nan() { 0.0 } else { error_bound.clamp(0.0, 1.0) },
            },
        }
    }

    /// The same light with nothing approximate but the bound: that of every virtual light, with a
    /// shadow ray from each point. `None` where it is that already, or off.
    pub fn exact(&self) -> Option<Self> {
        let lights = VplSettings { visibility: Visibility::Exact, chosen: None, ..*self.lights()? };
        let exact = Self::Vpl(lights);
        (*self != exact).then_some(exact)
    }

    /// The virtual lights, if there are any.
    pub const fn lights(&self) -> Option<&VplSettings> {
        match self {
            Self::Off => None,
            Self::Vpl(lights) | Self::Lightcuts { lights, .. } => Some(lights),
        }
    }
}

impl Default for RenderSettings {
    /// One sample a pixel, five bounces, shadows, four light samples, ambient light in place of
    /// light that was scattered before, no light thrown by mirrors, the scene's background,
    /// and batches of `2^19` rays: an image of 800 x 600 pixels in one.
    fn default() -> Self {
        Self {
            samples_per_pixel: 1,
            depth: 5,
            shadows: true,
            light_samples: 4,
            indirect: Indirect::Off,
            caustics: None,
            shown: Shown::Light,
            background: None,
            batch_rays: 1 << 19,
        }
    }
}

impl RenderSettings {
    /// The same settings with every value in its range.
    pub fn clamped(&self) -> Self {
        Self {
            samples_per_pixel: self.samples_per_pixel.clamp(1, 1 << 16),
            depth: self.depth.min(32),
            light_samples: self.light_samples.clamp(1, 1024),
            indirect: self.indirect.clamped(),
            caustics: self.caustics.as_ref().map(CausticSettings::clamped),
            batch_rays: self.batch_rays.clamp(1, 1 << 24),
            ..self.clone()
        }
    }
}
