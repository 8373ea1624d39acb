//! Everything a file or a generator describes.

use glam::Vec3;
use thiserror::Error;

use crate::{Background, Camera, Clip, Light, Material, Node, SceneObject, Texture};

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
    /// Number of frames of a source that is finite by nature (a sequence of files); `None` where
    /// clips repeat or nothing moves.
    pub frame_count: Option<usize>,
}

/// Why a scene cannot be evaluated.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum SceneError {
    /// The node hierarchy loops.
    #[error("node {node_idx} (\"{name}\") is its own ancestor")]
    CyclicNodes {
        /// A node on the loop.
        node_idx: u32,
        /// Its name.
        name: String,
    },
    /// An animated mesh could not be had.
    #[error("object \"{object}\" at {time} s: {reason}")]
    AnimatedMesh {
        /// The object's name.
        object: String,
        /// The time asked for, in seconds.
        time: String,
        /// What went wrong.
        reason: String,
    },
    /// The clip does not exist.
    #[error("no clip is called \"{name}\"; there are: {available}")]
    UnknownClip {
        /// The name asked for.
        name: String,
        /// The names there are.
        available: String,
    },
    /// The camera does not exist.
    #[error("no camera is called \"{name}\"; there are: {available}")]
    UnknownCamera {
        /// The name asked for.
        name: String,
        /// The names there are.
        available: String,
    },
    /// The objects do not make a geometry.
    #[error(transparent)]
    Geometry(#[from] rayflock_geom::GeometryError),
}
