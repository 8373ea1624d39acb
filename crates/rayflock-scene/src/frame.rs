//! A scene at one time.

use glam::Affine3A;
use rayflock_geom::{FrameChanges, Geometry};

use crate::{Deformation, LightKind, SurfaceMesh};

/// What an [`Evaluator`](crate::Evaluator) makes of a scene at one time.
#[derive(Clone, Debug, Default)]
pub struct SceneFrame {
    /// The time in seconds.
    pub time: f64,
    /// What can be hit. Object `i` of the scene has `ObjectId(i)`.
    pub geometry: Geometry,
    /// How `geometry` differs from the frame that the same evaluator made before.
    pub changes: FrameChanges,
    /// What hits look like: `surfaces[i]` belongs to `ObjectId(i)` and shares its mesh.
    pub surfaces: Vec<SurfaceMesh>,
    /// How those meshes came about: as many as there are surfaces, or none.
    pub deformations: Vec<Deformation>,
    /// The scene's lights in world space, in the order of [`Scene::lights`](crate::Scene::lights).
    pub lights: Vec<LightKind>,
    /// Where each of [`Scene::cameras`](crate::Scene::cameras) is: `world_from_camera`.
    pub cameras: Vec<Affine3A>,
}
