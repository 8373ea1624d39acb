//! The facts about a scene.

use anyhow::Result;
use rayflock::engine::{Ignored, count_ignored};
use rayflock::scene::{
    Camera, Clip, Evaluator, Light, LightKind, MotionKind, Projection, Scene, SceneFrame,
    SceneObject, SurfaceMesh,
};
use serde::Serialize;

use crate::args::InputArguments;
use crate::frames::FrameRange;
use crate::input::Input;

/// Everything that `info` tells. Fields are added later, never renamed.
#[derive(Debug, Serialize)]
pub(super) struct Report {
    /// INPUT as given.
    pub(super) input: String,
    /// Nodes of the hierarchy.
    pub(super) nodes: usize,
    /// What can be seen, in order.
    pub(super) objects: Vec<ObjectReport>,
    /// Triangles in frame 0.
    pub(super) triangles: usize,
    /// Vertices in frame 0.
    pub(super) vertices: usize,
    /// Spheres in frame 0.
    pub(super) spheres: usize,
    /// Materials.
    pub(super) materials: usize,
    /// Textures.
    pub(super) textures: usize,
    /// Clips; the chosen one is marked.
    pub(super) clips: Vec<ClipReport>,
    /// Frames a second.
    pub(super) frame_rate: f64,
    /// The frames that show the whole motion once: first and last.
    pub(super) frames: [u32; 2],
    /// Whether there are no frames beyond those.
    pub(super) finite: bool,
    /// The box around everything over the whole motion; none when there is nothing.
    pub(super) bounds: Option<BoundsReport>,
    /// Cameras.
    pub(super) cameras: Vec<CameraReport>,
    /// Lights.
    pub(super) lights: Vec<LightReport>,
    /// What is wrong without making the scene useless.
    pub(super) warnings: Vec<String>,
}

/// One object.
#[derive(Debug, Serialize)]
pub(super) struct ObjectReport {
    /// Its name.
    pub(super) name: String,
    /// How it moves: static, rigid, deforming or topology.
    pub(super) motion: &'static str,
    /// Its primitives in frame 0.
    pub(super) primitives: usize,
}

/// One clip.
#[derive(Debug, Serialize)]
pub(super) struct ClipReport {
    /// Its name.
    pub(super) name: String,
    /// Its length in seconds.
    pub(super) seconds: f64,
    /// Properties it moves.
    pub(super) channels: usize,
    /// Whether this report is about it.
    pub(super) chosen: bool,
}

/// Corners of a box, in world space.
#[derive(Debug, Serialize)]
pub(super) struct BoundsReport {
    /// Smallest.
    pub(super) min: [f32; 3],
    /// Largest.
    pub(super) max: [f32; 3],
}

/// One camera.
#[derive(Debug, Serialize)]
pub(super) struct CameraReport {
    /// Its name.
    pub(super) name: String,
    /// Perspective or orthographic.
    pub(super) projection: &'static str,
}

/// One light.
#[derive(Debug, Serialize)]
pub(super) struct LightReport {
    /// Its name.
    pub(super) name: String,
    /// Point, directional or spot.
    pub(super) kind: &'static str,
}

impl Report {
    /// Reads INPUT and looks at the chosen clip.
    pub(super) fn new(args: &InputArguments, clip: Option<&str>) -> Result<Self> {
        let input = Input::open(args)?;
        let mut evaluator = Evaluator::new(input.scene.clone(), clip)?;
        let bounds = evaluator.bounds_over_clip()?;
        let motion = evaluator.motion_kinds();
        let chosen = evaluator.clip().map(|clip| clip.name.clone());
        let frame_rate = input.scene.default_frame_rate();
        let count = input.whole_motion(evaluator.clip(), frame_rate);
        let whole = FrameRange::first_frames(count);
        let frame = evaluator.evaluate(0.0)?;

        let scene = &*input.scene;
        let mut warnings = input.warnings;
        warnings.extend(ignored_warning(&args.name, frame));
        let meshes = || frame.surfaces.iter().map(|surface| &surface.mesh);
        Ok(Self {
            input: input.name,
            nodes: scene.nodes.len(),
            objects: object_reports(scene, frame, &motion),
            triangles: meshes().map(|mesh| mesh.triangles().len()).sum(),
            vertices: meshes().map(|mesh| mesh.vertices().len()).sum(),
            spheres: meshes().map(|mesh| mesh.spheres().len()).sum(),
            materials: scene.materials.len(),
            textures: scene.textures.len(),
            clips: clip_reports(scene, chosen.as_deref()),
            frame_rate,
            frames: [whole.first, whole.last],
            finite: scene.frame_count.is_some(),
            bounds: (!bounds.is_empty())
                .then(|| BoundsReport { min: bounds.min.to_array(), max: bounds.max.to_array() }),
            cameras: camera_reports(scene),
            lights: light_reports(scene),
            warnings,
        })
    }
}

fn object_reports(scene: &Scene, frame: &SceneFrame, motion: &[MotionKind]) -> Vec<ObjectReport> {
    let objects = scene.objects.iter().zip(&frame.surfaces).zip(motion);
    let report =
        |((object, surface), motion): ((&SceneObject, &SurfaceMesh), &MotionKind)| ObjectReport {
            name: object.name.clone(),
            motion: motion_name(*motion),
            primitives: surface.mesh.prim_count(),
        };
    objects.map(report).collect()
}

fn motion_name(motion: MotionKind) -> &'static str {
    match motion {
        MotionKind::Static => "static",
        MotionKind::Rigid => "rigid",
        MotionKind::Deforming => "deforming",
        MotionKind::Topology => "topology",
    }
}

fn clip_reports(scene: &Scene, chosen: Option<&str>) -> Vec<ClipReport> {
    let report = |clip: &Clip| ClipReport {
        name: clip.name.clone(),
        seconds: clip.duration(),
        channels: clip.channels.len(),
        chosen: Some(clip.name.as_str()) == chosen,
    };
    scene.clips.iter().map(report).collect()
}

fn camera_reports(scene: &Scene) -> Vec<CameraReport> {
    let report = |camera: &Camera| CameraReport {
        name: camera.name.clone(),
        projection: match camera.projection {
            Projection::Perspective { .. } => "perspective",
            Projection::Orthographic { .. } => "orthographic",
        },
    };
    scene.cameras.iter().map(report).collect()
}

fn light_reports(scene: &Scene) -> Vec<LightReport> {
    let report = |light: &Light| LightReport {
        name: light.name.clone(),
        kind: match light.kind {
            LightKind::Point { .. } => "point",
            LightKind::Directional { .. } => "directional",
            LightKind::Spot { .. } => "spot",
        },
    };
    scene.lights.iter().map(report).collect()
}

/// Primitives of frame 0 that engines ignore.
fn ignored_warning(input: &str, frame: &SceneFrame) -> Option<String> {
    let ignored = count_ignored(&frame.geometry);
    let Ignored { non_finite, degenerate } = ignored;
    (ignored.count() > 0).then(|| {
        format!(
            "{input}: frame 0: {non_finite} primitives with a coordinate that is not finite and \
             {degenerate} without area are ignored"
        )
    })
}
