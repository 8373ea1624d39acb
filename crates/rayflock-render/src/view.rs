//! Where a picture is seen from.

use glam::Affine3A;
use rayflock_scene::Projection;

/// A camera at its place: what a picture is rendered from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Where the camera is; it looks along its -Z with +Y up.
    pub world_from_camera: Affine3A,
    /// How the picture is formed; its width follows from the film's aspect ratio.
    pub projection: Projection,
}

impl View {
    /// A camera with `projection` at `world_from_camera`.
    pub const fn new(world_from_camera: Affine3A, projection: Projection) -> Self {
        Self { world_from_camera, projection }
    }
}
