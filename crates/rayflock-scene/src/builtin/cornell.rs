//! `cornell`: a glass sphere circles a mirror sphere in a closed box with coloured walls.
//!
//! The box follows the one that C. Goral, K. Torrance, D. Greenberg and B. Battaile showed
//! ("Modeling the Interaction of Light Between Diffuse Surfaces", SIGGRAPH 1984), but runs on
//! behind the camera and is closed there, so that the mirror shows a room and no ray leaves it.
//!
//! **Light.** A point light under the ceiling, not an emitting panel: one shadow ray a hit gives
//! the exact answer, so that a picture has no noise at one sample a pixel and two engines can be
//! compared pixel by pixel.

use std::f32::consts::TAU;

use glam::{Affine3A, Quat, Vec3};
use rayflock_geom::{Mesh, Sphere};

use super::keyed_path::{key_times, look_rotation, translation_channel};
use super::surface_builder::SurfaceBuilder;
use super::{matte, node, object, polished};
use crate::{
    Background, Camera, Clip, Falloff, Fresnel, Light, LightKind, Material, MaterialIdx, NodeIdx,
    Projection, Scene, SurfaceMesh,
};

/// Frames of one round of the glass sphere.
pub(super) const FRAME_COUNT: usize = 240;
const FRAME_RATE: f32 = 24.0;

/// The box: half the width, the height, and its ends along z. The camera is inside.
const HALF_WIDTH: f32 = 1.0;
const HEIGHT: f32 = 2.0;
const BACK: f32 = -1.0;
const FRONT: f32 = 4.0;

/// The light; a shade a little above keeps it off the ceiling and shines itself.
const LAMP: Vec3 = Vec3::new(0.0, 1.72, 0.3);

const MIRROR_SPHERE: Sphere = Sphere { center: Vec3::new(0.0, 0.92, -0.15), radius: 0.4 };
const GLASS_RADIUS: f32 = 0.27;

const WHITE: MaterialIdx = MaterialIdx(0);
const RED: MaterialIdx = MaterialIdx(1);
const GREEN: MaterialIdx = MaterialIdx(2);
const MIRROR: MaterialIdx = MaterialIdx(3);
const GLASS: MaterialIdx = MaterialIdx(4);
const BLUE: MaterialIdx = MaterialIdx(5);

/// The scene.
pub(super) fn build() -> Scene {
    let glass_node = NodeIdx(0);
    let mirror = Mesh::from_spheres(vec![MIRROR_SPHERE]);
    let glass = Mesh::from_spheres(vec![Sphere::new(Vec3::ZERO, GLASS_RADIUS)]);
    Scene {
        name: "cornell".to_owned(),
        nodes: vec![node("glass sphere", None, glass_center(0.0))],
        objects: vec![
            object("box", None, box_surface()),
            object("mirror sphere", None, SurfaceMesh::new(mirror, MIRROR)),
            object("glass sphere", Some(glass_node), SurfaceMesh::new(glass, GLASS)),
        ],
        materials: materials(),
        lights: vec![Light {
            name: "ceiling lamp".to_owned(),
            node: None,
            kind: LightKind::Point {
                position: LAMP,
                intensity: Vec3::new(3.9, 3.65, 3.2),
                falloff: Falloff::InverseSquare,
            },
        }],
        cameras: vec![camera()],
        clips: vec![orbit(glass_node)],
        ambient: Vec3::splat(0.2),
        background: Some(Background::Uniform(Vec3::ZERO)),
        frame_rate: Some(f64::from(FRAME_RATE)),
        ..Scene::default()
    }
}

fn materials() -> Vec<Material> {
    vec![
        matte("white wall", Vec3::new(0.73, 0.72, 0.68)),
        matte("red wall", Vec3::new(0.62, 0.07, 0.05)),
        matte("green wall", Vec3::new(0.13, 0.45, 0.10)),
        Material {
            mirror: Vec3::splat(0.88),
            specular: Vec3::splat(0.5),
            shininess: 300.0,
            ..matte("mirror", Vec3::splat(0.03))
        },
        Material {
            transmission: Vec3::ONE,
            specular: Vec3::splat(0.5),
            shininess: 300.0,
            ior: 1.5,
            absorption: Vec3::new(0.45, 0.12, 0.2),
            fresnel: Fresnel::Dielectric,
            ..matte("glass", Vec3::ZERO)
        },
        polished("blue plinth", Vec3::new(0.12, 0.20, 0.42), 0.06),
    ]
}

fn box_surface() -> SurfaceMesh {
    let mut surface = SurfaceBuilder::default();
    let corner = |x: f32, y: f32, z: f32| Vec3::new(x * HALF_WIDTH, y * HEIGHT, z);
    let mut wall = |corners, material| surface.patch(corners, [8, 8], material);
    // Each wall is counter-clockwise as seen from inside.
    let [left, right] = [-1.0, 1.0];
    let sides = [
        ([(left, 0.0, FRONT), (right, 0.0, FRONT), (right, 0.0, BACK), (left, 0.0, BACK)], WHITE),
        ([(left, 1.0, BACK), (right, 1.0, BACK), (right, 1.0, FRONT), (left, 1.0, FRONT)], WHITE),
        ([(left, 0.0, BACK), (right, 0.0, BACK), (right, 1.0, BACK), (left, 1.0, BACK)], WHITE),
        ([(right, 0.0, FRONT), (left, 0.0, FRONT), (left, 1.0, FRONT), (right, 1.0, FRONT)], WHITE),
        ([(left, 0.0, FRONT), (left, 0.0, BACK), (left, 1.0, BACK), (left, 1.0, FRONT)], RED),
        ([(right, 0.0, BACK), (right, 0.0, FRONT), (right, 1.0, FRONT), (right, 1.0, BACK)], GREEN),
    ];
    for (corners, material) in sides {
        wall(corners.map(|(x, y, z)| corner(x, y, z)), material);
    }

    // The plinth ends where the mirror sphere rests on it.
    let top = MIRROR_SPHERE.center.y - MIRROR_SPHERE.radius;
    let turn = Affine3A::from_rotation_translation(
        Quat::from_rotation_y(0.35),
        Vec3::new(MIRROR_SPHERE.center.x, 0.0, MIRROR_SPHERE.center.z),
    );
    let ends = [Vec3::new(-0.28, 0.0, -0.28), Vec3::new(0.28, top, 0.28)];
    surface.block(ends, 2, &turn, BLUE);
    let shade = [LAMP + Vec3::new(-0.34, 0.1, -0.34), LAMP + Vec3::new(0.34, 0.13, 0.34)];
    surface.block(shade, 2, &Affine3A::IDENTITY, WHITE);
    surface.build()
}

fn camera() -> Camera {
    let (eye, target) = (Vec3::new(0.0, 1.05, 3.75), Vec3::new(0.0, 0.98, 0.0));
    Camera {
        name: "camera".to_owned(),
        node: None,
        node_from_camera: Affine3A::from_rotation_translation(look_rotation(target - eye), eye),
        projection: Projection::Perspective { vertical_fov: 40.0_f32.to_radians() },
    }
}

fn orbit(node: NodeIdx) -> Clip {
    let duration = FRAME_COUNT as f32 / FRAME_RATE;
    let times = key_times(duration, FRAME_COUNT);
    let center = |time: f32| glass_center(time / duration);
    Clip { name: "orbit".to_owned(), channels: vec![translation_channel(node, &times, center)] }
}

/// The centre of the glass sphere after `turn` rounds, from 0 to 1: an orbit around the mirror
/// sphere, low in front and high behind.
fn glass_center(turn: f32) -> Vec3 {
    let (sin, cos) = (TAU * (turn + 0.08)).sin_cos();
    MIRROR_SPHERE.center + Vec3::new(0.71 * sin, -0.36 * cos, 0.60 * cos + 0.03)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_glass_sphere_touches_nothing() {
        for frame in 0..FRAME_COUNT {
            let center = glass_center(frame as f32 / FRAME_COUNT as f32);
            let gap = center.distance(MIRROR_SPHERE.center) - MIRROR_SPHERE.radius;
            assert!(gap > GLASS_RADIUS, "frame {frame}: {gap} from the mirror sphere");
            assert!(center.x.abs() + GLASS_RADIUS < HALF_WIDTH, "frame {frame}");
            assert!(center.y > GLASS_RADIUS && center.y + GLASS_RADIUS < HEIGHT, "frame {frame}");
            assert!(center.z - GLASS_RADIUS > BACK, "frame {frame}");
        }
    }
}
