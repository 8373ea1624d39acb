//! Everything a file or a generator describes.

use glam::Vec3;

use crate::{Background, Camera, Clip, Light, Material, Node, SceneError, SceneObject, Texture};

/// A world: what is in it, what it looks like and how it moves.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    /// Name of the file or generator.
    pub name: String,
    /// The node hierarchy; acyclic.
    pub nodes: Vec<Node>,
    /// What can be seen.
    pub objects: Vec<SceneObject>,
    /// What surfaces look like; at least one when there are objects.
    pub materials: Vec<Material>,
    /// Images that materials refer to.
    pub textures: Vec<Texture>,
    /// Lights besides emitting surfaces; empty for the default lights of a renderer.
    pub lights: Vec<Light>,
    /// Cameras; empty for one that frames the scene.
    pub cameras: Vec<Camera>,
    /// Animations of nodes; one is played at a time.
    pub clips: Vec<Clip>,
    /// Light that comes from everywhere, as irradiance divided by pi.
    pub ambient: Vec3,
    /// What rays that hit nothing see; `None` for the default of a renderer.
    pub background: Option<Background>,
    /// Frames a second that the source states.
    pub frame_rate: Option<f64>,
    /// Number of frames of a source that is finite by nature (a sequence of files, an AFF file);
    /// its clips do not repeat, but rest before and after. `None` where clips repeat or nothing
    /// moves.
    pub frame_count: Option<usize>,
}

/// Frames a second where the source states none.
const DEFAULT_FRAME_RATE: f64 = 24.0;

impl Scene {
    /// Frames a second: what the source states, if that is a positive number, or else 24.
    pub fn default_frame_rate(&self) -> f64 {
        let usable = |rate: &f64| rate.is_finite() && *rate > 0.0;
        self.frame_rate.filter(usable).unwrap_or(DEFAULT_FRAME_RATE)
    }

    /// The position in [`cameras`](Self::cameras) of the first camera with this name; without a
    /// name the first camera, `None` where there are none.
    ///
    /// # Errors
    /// [`SceneError::UnknownCamera`] when no camera has the name.
    pub fn camera_idx(&self, name: Option<&str>) -> Result<Option<usize>, SceneError> {
        let names = || self.cameras.iter().map(|camera| camera.name.as_str());
        first_or_named(name, names).map_err(|available| SceneError::UnknownCamera {
            name: name.unwrap_or_default().to_owned(),
            available,
        })
    }

    /// The position in [`clips`](Self::clips) of the first clip with this name; without a name
    /// the first clip, `None` where there are none.
    ///
    /// # Errors
    /// [`SceneError::UnknownClip`] when no clip has the name.
    pub fn clip_idx(&self, name: Option<&str>) -> Result<Option<usize>, SceneError> {
        let names = || self.clips.iter().map(|clip| clip.name.as_str());
        first_or_named(name, names).map_err(|available| SceneError::UnknownClip {
            name: name.unwrap_or_default().to_owned(),
            available,
        })
    }
}

/// The position of `name`, or of the first name where none is asked for; on failure the list of
/// names, for a message.
fn first_or_named<'a, I: Iterator<Item = &'a str>>(
    name: Option<&str>,
    names: impl Fn() -> I,
) -> Result<Option<usize>, String> {
    let Some(name) = name else { return Ok(names().next().map(|_| 0)) };
    if let Some(idx) = names().position(|candidate| candidate == name) {
        return Ok(Some(idx));
    }
    let quoted: Vec<String> = names().map(|candidate| format!("\"{candidate}\"")).collect();
    Err(if quoted.is_empty() { "none".to_owned() } else { quoted.join(", ") })
}
