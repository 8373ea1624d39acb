//! From a scene and a time to a frame.

use std::sync::Arc;

use glam::{Affine3A, Mat3A};
use rayflock_geom::{Aabb, FrameChanges, Geometry, GeometryObject, ObjectId};

use crate::pose::Pose;
use crate::track::ObjectTrack;
use crate::validate;
use crate::{
    Clip, LightKind, MotionKind, NodeIdx, Scene, SceneError, SceneFrame, SceneObject, SurfaceMesh,
};

/// Turns a scene into frames, one time after another.
///
/// What did not change from one frame to the next keeps its `Arc<Mesh>`, so that
/// [`SceneFrame::changes`] says exactly what did.
#[derive(Clone, Debug)]
pub struct Evaluator {
    scene: Arc<Scene>,
    clip_idx: Option<usize>,
    pose: Pose,
    tracks: Vec<ObjectTrack>,
    frame: SceneFrame,
}

impl Evaluator {
    /// An evaluator that plays the clip of this name; without a name the first, if there is one.
    ///
    /// # Errors
    /// [`SceneError::UnknownClip`], [`SceneError::CyclicNodes`], and the other variants for
    /// whatever in the scene or the clip does not hang together.
    pub fn new(scene: Arc<Scene>, clip: Option<&str>) -> Result<Self, SceneError> {
        let clip_idx = scene.clip_idx(clip)?;
        let clip = clip_idx.map(|clip_idx| &scene.clips[clip_idx]);
        validate::check(&scene, clip)?;
        let pose = Pose::new(&scene.nodes, clip)?;
        let tracks = scene.objects.iter().map(ObjectTrack::new).collect();
        Ok(Self { scene, clip_idx, pose, tracks, frame: SceneFrame::default() })
    }

    /// The scene.
    pub fn scene(&self) -> &Arc<Scene> {
        &self.scene
    }

    /// The clip that is played.
    pub fn clip(&self) -> Option<&Clip> {
        self.clip_idx.map(|clip_idx| &self.scene.clips[clip_idx])
    }

    /// How each object moves over the clip, in the order of [`Scene::objects`].
    pub fn motion_kinds(&self) -> Vec<MotionKind> {
        let motion = |(object, track): (&SceneObject, &ObjectTrack)| {
            let rides =
                !track.is_skinned() && object.node.is_some_and(|node| self.pose.moves(node));
            let whole = if rides { MotionKind::Rigid } else { MotionKind::Static };
            track.motion(&self.pose).max(whole)
        };
        self.scene.objects.iter().zip(&self.tracks).map(motion).collect()
    }

    /// The frame at `time` in seconds, with what changed since the frame that this evaluator
    /// made before; in the first frame, all objects are added.
    ///
    /// # Errors
    /// [`SceneError::AnimatedMesh`], or another variant when an animated mesh does not hang
    /// together, and [`SceneError::Geometry`]. The frame before then stays.
    pub fn evaluate(&mut self, time: f64) -> Result<&SceneFrame, SceneError> {
        if let Some(clip_idx) = self.clip_idx {
            let clip = &self.scene.clips[clip_idx];
            self.pose.set_time(&self.scene.nodes, clip, clip.local_time(time));
        }
        let surfaces = self
            .tracks
            .iter_mut()
            .map(|track| track.surface_at(&self.pose, time, self.scene.materials.len()));
        let surfaces = surfaces.collect::<Result<Vec<_>, _>>()?;
        let geometry = self.geometry(&surfaces)?;
        self.frame = SceneFrame {
            time,
            changes: FrameChanges::between(&self.frame.geometry, &geometry),
            geometry,
            surfaces,
            lights: self.lights(),
            cameras: self.cameras(),
        };
        Ok(&self.frame)
    }

    /// The box around everything over the whole clip, in world space.
    ///
    /// # Errors
    /// As [`evaluate`](Self::evaluate).
    pub fn bounds_over_clip(&mut self) -> Result<Aabb, SceneError> {
        Ok(self.clone().evaluate(0.0)?.geometry.bounds())
    }

    /// The objects in the world.
    fn geometry(&self, surfaces: &[SurfaceMesh]) -> Result<Geometry, SceneError> {
        let object =
            |((id, object), surface): ((u32, &SceneObject), &SurfaceMesh)| GeometryObject {
                id: ObjectId(id),
                mask: object.mask,
                shape: Arc::clone(&surface.mesh),
                world_from_object: object.node.map(|node| self.pose.world_from_node(node)),
            };
        let objects = (0..).zip(&self.scene.objects).zip(surfaces).map(object);
        Ok(Geometry::new(objects.collect())?)
    }

    /// The lights in world space.
    fn lights(&self) -> Vec<LightKind> {
        let lights = self.scene.lights.iter();
        lights.map(|light| light.kind.transformed(&self.world_from(light.node))).collect()
    }

    /// Where the cameras are, without the scale of their nodes.
    fn cameras(&self) -> Vec<Affine3A> {
        let cameras = self.scene.cameras.iter();
        cameras
            .map(|camera| without_scale(self.world_from(camera.node) * camera.node_from_camera))
            .collect()
    }

    /// Where a node is in the world; the world itself for none.
    fn world_from(&self, node: Option<NodeIdx>) -> Affine3A {
        node.map_or(Affine3A::IDENTITY, |node| self.pose.world_from_node(node))
    }
}

/// The rotation and translation of a camera whose node may be scaled or mirrored: it looks the
/// same way, with the same side up. Left alone where it has no such axes.
fn without_scale(world_from_camera: Affine3A) -> Affine3A {
    let Affine3A { matrix3, translation } = world_from_camera;
    let back = matrix3.z_axis.normalize_or_zero();
    let right = matrix3.y_axis.cross(back).normalize_or_zero();
    let axes = Mat3A::from_cols(right, back.cross(right), back);
    if axes.determinant() < 0.5 {
        return world_from_camera;
    }
    Affine3A { matrix3: axes, translation }
}
