//! Cameras.

use glam::Affine3A;

use crate::NodeIdx;

/// A camera at the origin of its node, looking along -Z with +Y up.
#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    /// Name in the file, to be chosen by.
    pub name: String,
    /// The node that carries it; `None` for the world.
    pub node: Option<NodeIdx>,
    /// Where the camera is within its node.
    pub node_from_camera: Affine3A,
    /// How the picture is formed.
    pub projection: Projection,
}

/// How a camera forms its picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projection {
    /// From one point.
    Perspective {
        /// Angle between the top and the bottom of the picture.
        vertical_fov: f32,
    },
    /// Along one direction.
    Orthographic {
        /// Height of the picture in scene units.
        height: f32,
    },
}
