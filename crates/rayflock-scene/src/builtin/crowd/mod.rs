//! `crowd`: twelve skinned figures stroll around a fountain.
//!
//! Each figure is one mesh with its own skin of fifteen joints; one clip of keyframes moves all.
//! The feet do not slide: the walk is made from where each foot must be (see [`walk`]), and a
//! figure's path is as long as a whole number of its strides.
//!
//! **Invariants.** The clip closes on itself; no two figures meet; weights sum to 1.

mod body;
mod figure;
mod path;
mod plaza;
mod skeleton;
mod tube;
mod walk;

use std::f32::consts::TAU;
use std::sync::Arc;

use glam::{Affine3A, Vec3};

use super::keyed_path::{camera_channels, key_times};
use super::{node, object};
use crate::{
    Background, Camera, Channel, Clip, Light, LightKind, NodeIdx, Projection, Scene, SceneObject,
    Shape,
};

/// Frames of the clip.
pub(super) const FRAME_COUNT: usize = 360;
const FRAME_RATE: f32 = 24.0;
/// Length of the clip in seconds.
const DURATION: f32 = FRAME_COUNT as f32 / FRAME_RATE;

const CAMERA_NODE: NodeIdx = NodeIdx(0);

/// The scene.
pub(super) fn build() -> Scene {
    let times = key_times(DURATION, FRAME_COUNT);
    let mut scene = Scene {
        name: "crowd".to_owned(),
        nodes: vec![node("camera", None, Vec3::ZERO)],
        objects: vec![
            object("plaza", None, plaza::surface()),
            object("crowns", None, plaza::crowns()),
        ],
        materials: plaza::materials(),
        lights: vec![sun()],
        cameras: vec![camera()],
        ambient: Vec3::new(0.34, 0.38, 0.46),
        background: Some(Background::Gradient {
            zenith: Vec3::new(0.25, 0.45, 0.85),
            horizon: Vec3::new(0.85, 0.85, 0.85),
            ground: Vec3::new(0.35, 0.33, 0.30),
        }),
        frame_rate: Some(f64::from(FRAME_RATE)),
        ..Scene::default()
    };
    let mut channels = sway(&times);
    for figure in figure::FIGURES {
        let root = skeleton::add_nodes(&mut scene.nodes, figure);
        channels.extend(walk::channels(figure, root, &times));
        let first_material = scene.materials.len() as u32;
        scene.materials.extend(figure.materials());
        let (rest, skin) = body::build(figure, root, first_material);
        let shape = Shape::Deformed { rest, targets: Arc::default(), skin: Some(Arc::new(skin)) };
        let name = figure.name.to_owned();
        scene.objects.push(SceneObject { name, node: Some(root), mask: u32::MAX, shape });
    }
    scene.clips = vec![Clip { name: "stroll".to_owned(), channels }];
    scene
}

fn sun() -> Light {
    let direction = Vec3::new(0.72, -0.58, -0.38).normalize_or(Vec3::NEG_Y);
    let kind = LightKind::Directional { direction, irradiance: Vec3::new(3.3, 2.75, 2.0) };
    Light { name: "sun".to_owned(), node: None, kind }
}

fn camera() -> Camera {
    Camera {
        name: "camera".to_owned(),
        node: Some(CAMERA_NODE),
        node_from_camera: Affine3A::IDENTITY,
        projection: Projection::Perspective { vertical_fov: 36.0_f32.to_radians() },
    }
}

/// The camera sways to either side once.
fn sway(times: &[f32]) -> Vec<Channel> {
    let eye = |time: f32| {
        let (sin, cos) = (0.22 * (TAU * time / DURATION).sin()).sin_cos();
        Vec3::new(11.0 * sin, 4.3, 11.0 * cos)
    };
    camera_channels(CAMERA_NODE, times, eye, |_| Vec3::new(0.0, 0.75, 0.0))
}

#[cfg(test)]
mod tests {
    use std::collections::HashMap;

    use rayflock_geom::Mesh;

    use super::*;
    use crate::{Evaluator, SceneFrame};

    /// The figures' meshes: all objects with a skin.
    fn figures(scene: &Scene) -> impl Iterator<Item = (&crate::SurfaceMesh, &crate::Skin)> {
        scene.objects.iter().filter_map(|object| match &object.shape {
            Shape::Deformed { rest, skin: Some(skin), .. } => Some((rest, skin.as_ref())),
            _ => None,
        })
    }

    #[test]
    fn weights_sum_to_one() {
        let scene = build();
        assert_eq!(figures(&scene).count(), figure::FIGURES.len());
        for (rest, skin) in figures(&scene) {
            assert_eq!(skin.influences.len(), rest.mesh.vertices().len());
            assert_eq!(skin.joints.len(), skeleton::JOINT_COUNT);
            for influences in &skin.influences {
                let sum: f32 = influences.weights.iter().sum();
                assert!((sum - 1.0).abs() < 1e-5, "{influences:?}");
                assert!(influences.weights.iter().all(|&weight| weight >= 0.0));
                assert!(influences.joints.iter().all(|&j| usize::from(j) < skin.joints.len()));
            }
        }
    }

    /// Each edge is met once, and once the other way round.
    fn is_closed(mesh: &Mesh) -> bool {
        let mut edges = HashMap::new();
        for [a, b, c] in mesh.triangles() {
            for edge in [(a, b), (b, c), (c, a)] {
                *edges.entry(edge).or_insert(0) += 1;
            }
        }
        edges.iter().all(|(&(a, b), &count)| count == 1 && edges.contains_key(&(b, a)))
    }

    #[test]
    fn figures_are_closed() {
        for (rest, _) in figures(&build()) {
            assert!(is_closed(&rest.mesh));
        }
    }

    #[test]
    fn there_are_ten_to_sixty_thousand_triangles() {
        let mut evaluator = Evaluator::new(Arc::new(build()), None).unwrap();
        let count = evaluator.evaluate(0.0).unwrap().geometry.prim_count();
        assert!((10_000..60_000).contains(&count), "{count}");
    }

    fn lowest(frame: &SceneFrame, object: usize) -> f32 {
        let part = &frame.geometry.objects()[object];
        part.bounds().min.y
    }

    #[test]
    fn feet_stay_on_the_ground() {
        let scene = Arc::new(build());
        let count = scene.objects.len();
        let mut evaluator = Evaluator::new(scene, None).unwrap();
        for frame in (0..FRAME_COUNT).step_by(5) {
            let frame = evaluator.evaluate(f64::from(frame as f32 / FRAME_RATE)).unwrap();
            for object in 2..count {
                let lowest = lowest(frame, object);
                assert!(lowest.abs() < 0.03, "figure {object} at {} s: {lowest}", frame.time);
            }
        }
    }
}
