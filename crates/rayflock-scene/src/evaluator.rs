//! From a scene and a time to a frame.

use std::sync::Arc;

use glam::{Affine3A, Mat3A};
use rayflock_geom::{FrameChanges, Geometry, GeometryObject, Mesh, ObjectId};
use tracing::debug_span;

use crate::animation::FRAME_TOLERANCE;
use crate::pose::Pose;
use crate::track::ObjectTrack;
use crate::validate;
use crate::{
    Clip, Deformation, LightKind, MaterialIdx, MotionKind, NodeIdx, Scene, SceneError, SceneFrame,
    SceneObject, SurfaceMesh,
};

/// How long a mesh that moves for ever is looked at, in seconds.
const ENDLESS_SECONDS: f64 = 10.0;

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
    /// What hidden objects are made of.
    nothing: SurfaceMesh,
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
        let nothing = SurfaceMesh::new(Mesh::default(), MaterialIdx::default());
        Ok(Self { scene, clip_idx, pose, tracks, nothing, frame: SceneFrame::default() })
    }

    /// The scene.
    pub fn scene(&self) -> &Arc<Scene> {
        &self.scene
    }

    /// The clip that is played.
    pub fn clip(&self) -> Option<&Clip> {
        self.clip_idx.map(|clip_idx| &self.scene.clips[clip_idx])
    }

    /// The first and last time in seconds between which something can change: from 0 to the end
    /// of the clip, and the time ranges of all animated meshes. A mesh that moves for ever counts
    /// as if it did so from 0 to 10 seconds. Where [`Scene::frame_count`] is stated, the frames
    /// at the default rate.
    pub fn time_range(&self) -> (f64, f64) {
        if let Some(frame_count) = self.scene.frame_count {
            let last_frame = frame_count.saturating_sub(1) as f64;
            return (0.0, last_frame / self.scene.default_frame_rate());
        }
        let clip_end = self.clip().map_or(0.0, Clip::duration);
        let meshes = self.tracks.iter().filter_map(ObjectTrack::time_range);
        meshes.fold((0.0, clip_end), |(start, end): (f64, f64), (first, last)| {
            let first = if first.is_finite() { first } else { 0.0 };
            let last = if last.is_finite() { last } else { ENDLESS_SECONDS };
            (start.min(first), end.max(last))
        })
    }

    /// How many frames from time 0, at this many a second, show everything once: what
    /// [`Scene::frame_count`] states, or else the frames of one round of the clip or up to the
    /// last change of an animated mesh, whichever are more. At least 1.
    pub fn frame_count(&self, frame_rate: f64) -> usize {
        if let Some(frame_count) = self.scene.frame_count {
            return frame_count;
        }
        let clip_frames = self.clip().map_or(1, |clip| clip.frame_count(frame_rate));
        let mesh_frames = |last: f64| (last * frame_rate + FRAME_TOLERANCE) as usize;
        let meshes = self.tracks.iter().filter_map(ObjectTrack::time_range);
        meshes.fold(clip_frames, |frames, (_, last)| {
            let last = if last.is_finite() { last } else { ENDLESS_SECONDS };
            frames.max(mesh_frames(last).saturating_add(1))
        })
    }

    /// How each object moves over the clip, in the order of [`Scene::objects`].
    pub fn motion_kinds(&self) -> Vec<MotionKind> {
        let motion = |(object, track): (&SceneObject, &ObjectTrack)| {
            let rides =
                !track.is_skinned() && object.node.is_some_and(|node| self.pose.moves(node));
            let vanishes = object.node.is_some_and(|node| self.pose.hides(node));
            let whole = match (vanishes, rides) {
                (true, _) => MotionKind::Topology,
                (false, true) => MotionKind::Rigid,
                (false, false) => MotionKind::Static,
            };
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
        let _span = debug_span!("evaluate").entered();
        if let Some(clip_idx) = self.clip_idx {
            let clip = &self.scene.clips[clip_idx];
            let repeats = self.scene.frame_count.is_none();
            let clip_time = if repeats { clip.local_time(time) } else { time };
            self.pose.set_time(&self.scene.nodes, clip, clip_time);
        }
        let surfaces = self.surfaces(time)?;
        let deformations = self.deformations();
        let geometry = self.geometry(&surfaces)?;
        self.frame = SceneFrame {
            time,
            changes: FrameChanges::between(&self.frame.geometry, &geometry),
            geometry,
            surfaces,
            deformations,
            lights: self.lights(),
            cameras: self.cameras(),
        };
        Ok(&self.frame)
    }

    /// What the objects are made of; those on hidden nodes, of nothing.
    fn surfaces(&mut self, time: f64) -> Result<Vec<SurfaceMesh>, SceneError> {
        let objects = self.scene.objects.iter().zip(&mut self.tracks);
        let surface = |(object, track): (&SceneObject, &mut ObjectTrack)| {
            if object.node.is_some_and(|node| !self.pose.shows(node)) {
                return Ok(self.nothing.clone());
            }
            track.surface_at(&self.pose, time, self.scene.materials.len())
        };
        objects.map(surface).collect()
    }

    /// How the surfaces came about.
    fn deformations(&self) -> Vec<Deformation> {
        let deformation = |(object, track): (&SceneObject, &ObjectTrack)| {
            let is_shown = object.node.is_none_or(|node| self.pose.shows(node));
            if is_shown { track.deformation() } else { Deformation::None }
        };
        self.scene.objects.iter().zip(&self.tracks).map(deformation).collect()
    }

    /// The objects in the world.
    fn geometry(&self, surfaces: &[SurfaceMesh]) -> Result<Geometry, SceneError> {
        let objects = (0..).zip(&self.scene.objects).zip(&self.tracks).zip(surfaces);
        let objects = objects.map(|(((id, object), track), surface)| GeometryObject {
            id: ObjectId(id),
            mask: object.mask,
            shape: Arc::clone(&surface.mesh),
            world_from_object: self.world_from_object(object, track),
        });
        Ok(Geometry::new(objects.collect())?)
    }

    /// Where an object is; `None` where its vertices are in world space at all times.
    fn world_from_object(&self, object: &SceneObject, track: &ObjectTrack) -> Option<Affine3A> {
        let node = object.node.filter(|_| !track.is_skinned())?;
        let place = self.pose.world_from_node(node);
        (place != Affine3A::IDENTITY || self.pose.moves(node)).then_some(place)
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
