//! Objects from one frame to the next: what they were made from, so that what stays the same is
//! shared.
//!
//! A mesh is formed anew only when what it is formed from has changed. It is then written over the
//! one before the last, if nobody else holds that any more, so that a scene in motion soon needs
//! no new memory.
//!
//! **Invariants.** Meshes of the same object at different times share their triangles. A mesh that
//! somebody else holds is never written to.

use std::sync::Arc;

use glam::Affine3A;

use crate::deform;
use crate::pose::Pose;
use crate::validate::check_surface;
use crate::{
    AnimatedMesh, Bend, Deformation, MorphTarget, MotionKind, NodeIdx, SceneError, SceneObject,
    Shape, Skin, SurfaceMesh,
};

/// One object from frame to frame.
#[derive(Clone, Debug)]
pub(crate) enum ObjectTrack {
    /// The mesh stays.
    Fixed(SurfaceMesh),
    /// The mesh follows weights and joints.
    Deformed(DeformedTrack),
    /// The mesh follows time.
    Animated(AnimatedTrack),
}

impl ObjectTrack {
    /// The object before its first frame.
    pub(crate) fn new(object: &SceneObject) -> Self {
        match &object.shape {
            Shape::Fixed(surface) => Self::Fixed(surface.clone()),
            // Nothing bends it: instances of it go on sharing their mesh.
            Shape::Deformed { rest, targets, skin } if targets.is_empty() && skin.is_none() => {
                Self::Fixed(rest.clone())
            }
            Shape::Deformed { rest, targets, skin } => Self::Deformed(DeformedTrack {
                rest: rest.clone(),
                targets: Arc::clone(targets),
                skin: skin.clone(),
                node: object.node,
                source: DeformSource::default(),
                current: None,
                retired: None,
            }),
            Shape::Animated(mesh) => Self::Animated(AnimatedTrack {
                name: object.name.clone(),
                mesh: Arc::clone(mesh),
                current: None,
            }),
        }
    }

    /// The object's mesh where the nodes are as in `pose`, at `time` in seconds, in a
    /// scene of this many materials.
    ///
    /// # Errors
    /// [`SceneError::AnimatedMesh`], and others when an animated mesh does not hang together.
    pub(crate) fn surface_at(
        &mut self,
        pose: &Pose,
        time: f64,
        material_count: usize,
    ) -> Result<SurfaceMesh, SceneError> {
        match self {
            Self::Fixed(surface) => Ok(surface.clone()),
            Self::Deformed(track) => Ok(track.surface_at(pose)),
            Self::Animated(track) => track.surface_at(time, material_count),
        }
    }

    /// How the mesh of the last call of [`Self::surface_at`] came about.
    pub(crate) fn deformation(&self) -> Deformation {
        match self {
            Self::Fixed(_) => Deformation::None,
            Self::Deformed(track) => Deformation::Bent(track.bend()),
            Self::Animated(track) => {
                let span = |(time, _): &(f64, SurfaceMesh)| track.mesh.span_at(*time);
                track
                    .current
                    .as_ref()
                    .and_then(span)
                    .map_or(Deformation::None, Deformation::Between)
            }
        }
    }

    /// How the mesh moves by itself, whatever its node does.
    pub(crate) fn motion(&self, pose: &Pose) -> MotionKind {
        match self {
            Self::Fixed(_) => MotionKind::Static,
            Self::Deformed(track) => track.motion(pose),
            Self::Animated(track) => track.mesh.motion(),
        }
    }

    /// The time range of an animated mesh.
    pub(crate) fn time_range(&self) -> Option<(f64, f64)> {
        match self {
            Self::Animated(track) => Some(track.mesh.time_range()),
            Self::Fixed(_) | Self::Deformed(_) => None,
        }
    }

    /// Whether joints place the mesh, not its node.
    pub(crate) fn is_skinned(&self) -> bool {
        matches!(self, Self::Deformed(track) if track.skin.is_some())
    }
}

/// A mesh bent by morph targets and joints.
#[derive(Clone, Debug)]
pub(crate) struct DeformedTrack {
    rest: SurfaceMesh,
    targets: Arc<[MorphTarget]>,
    skin: Option<Arc<Skin>>,
    node: Option<NodeIdx>,
    /// What `current` was made from.
    source: DeformSource,
    current: Option<SurfaceMesh>,
    /// The mesh before `current`, to be written over.
    retired: Option<SurfaceMesh>,
}

/// What a deformed mesh depends on.
#[derive(Clone, Debug, Default, PartialEq)]
struct DeformSource {
    /// A weight a morph target.
    weights: Vec<f32>,
    /// From the mesh at rest by each joint to the world.
    world_from_rest: Vec<Affine3A>,
}

impl DeformedTrack {
    fn surface_at(&mut self, pose: &Pose) -> SurfaceMesh {
        let source = self.source_at(pose);
        if let Some(current) = &self.current
            && self.source == source
        {
            return current.clone();
        }
        let surface = self.deform(&source);
        self.retired = self.current.replace(surface.clone());
        self.source = source;
        surface
    }

    /// Weights and joints where the nodes are as in `pose`. Targets without weight have 0.
    fn source_at(&self, pose: &Pose) -> DeformSource {
        let given = self.node.map_or(&[][..], |node| pose.weights(node));
        let weights = given.iter().copied().chain(std::iter::repeat(0.0));
        let joints = self.skin.iter().flat_map(|skin| &skin.joints);
        let world_from_rest = |(joint, joint_from_rest): &(NodeIdx, Affine3A)| {
            pose.world_from_node(*joint) * *joint_from_rest
        };
        DeformSource {
            weights: weights.take(self.targets.len()).collect(),
            world_from_rest: joints.map(world_from_rest).collect(),
        }
    }

    /// The mesh at rest, bent. Writes over the retired one where only this track holds it.
    fn deform(&mut self, source: &DeformSource) -> SurfaceMesh {
        let rest = &self.rest;
        let mut surface = self.retired.take().unwrap_or_else(|| rest.clone());
        let positions = Arc::make_mut(&mut surface.mesh).vertices_mut();
        let normals = Arc::make_mut(&mut surface.normals);

        let weighted = || self.targets.iter().zip(source.weights.iter().copied());
        let offsets = weighted().map(|(target, weight)| (&target.positions[..], weight));
        deform::morph(rest.mesh.vertices(), offsets, positions);
        let offsets = weighted().map(|(target, weight)| (&target.normals[..], weight));
        deform::morph(&rest.normals, offsets, normals);

        if let Some(skin) = &self.skin {
            deform::skin(&source.world_from_rest, &skin.influences, positions, normals);
        }
        deform::normalize(&rest.normals, normals);
        surface
    }

    /// What bends the current mesh.
    fn bend(&self) -> Bend {
        let DeformSource { weights, world_from_rest } = self.source.clone();
        let (rest, targets) = (self.rest.clone(), Arc::clone(&self.targets));
        Bend { rest, targets, weights, skin: self.skin.clone(), world_from_rest }
    }

    fn motion(&self, pose: &Pose) -> MotionKind {
        let joints = self.skin.iter().flat_map(|skin| &skin.joints);
        let joints_move = joints.into_iter().any(|&(joint, _)| pose.moves(joint));
        let morphs = !self.targets.is_empty() && self.node.is_some_and(|node| pose.morphs(node));
        if joints_move || morphs { MotionKind::Deforming } else { MotionKind::Static }
    }
}

/// A mesh that is a function of time.
#[derive(Clone, Debug)]
pub(crate) struct AnimatedTrack {
    /// The object's name, for messages.
    name: String,
    mesh: Arc<dyn AnimatedMesh>,
    /// The last mesh and its time, within the mesh's time range.
    current: Option<(f64, SurfaceMesh)>,
}

impl AnimatedTrack {
    fn surface_at(&mut self, time: f64, material_count: usize) -> Result<SurfaceMesh, SceneError> {
        let (first, last) = self.mesh.time_range();
        let time = time.max(first).min(last);
        if let Some((current_time, surface)) = &self.current
            && *current_time == time
        {
            return Ok(surface.clone());
        }
        let surface = self.mesh.at(time).map_err(|reason| SceneError::AnimatedMesh {
            object: self.name.clone(),
            time: time.to_string(),
            reason,
        })?;
        check_surface(&surface, &self.name, material_count)?;
        self.current = Some((time, surface.clone()));
        Ok(surface)
    }
}
