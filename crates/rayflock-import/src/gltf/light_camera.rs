//! Cameras, and lights of `KHR_lights_punctual`, on the nodes that carry them.

use glam::{Affine3A, Vec3};
use gltf::json::Root;
use gltf::json::camera::{Camera as JsonCamera, Type as CameraType};
use gltf::json::extensions::scene::khr_lights_punctual::{Light as JsonLight, Type as LightType};
use gltf::json::validation::Checked;
use rayflock_scene::{Camera, Falloff, Light, LightKind, NodeIdx, Projection, Scene};

use super::label;
use crate::ImportError;
use crate::job::Job;

/// Adds the cameras and lights of the nodes that are drawn.
pub(super) fn load(
    root: &Root,
    drawn: &[NodeIdx],
    scene: &mut Scene,
    job: &mut Job<'_>,
) -> Result<(), ImportError> {
    let extension = root.extensions.as_ref().and_then(|all| all.khr_lights_punctual.as_ref());
    for &node_idx in drawn {
        let node = &root.nodes[node_idx.0 as usize];
        if let Some(camera) = node.camera {
            let json = &root.cameras[camera.value()];
            let name = json.name.clone().or(node.name.clone());
            let name = name.unwrap_or_else(|| format!("camera{}", scene.cameras.len()));
            let element = label("camera", camera.value(), json.name.as_ref());
            let projection = projection(json, &element, job)?;
            let (node, node_from_camera) = (Some(node_idx), Affine3A::IDENTITY);
            scene.cameras.push(Camera { name, node, node_from_camera, projection });
        }
        let light = node.extensions.as_ref().and_then(|all| all.khr_lights_punctual.as_ref());
        let light = light.zip(extension).and_then(|(on_node, all)| {
            all.lights.get(on_node.light.value()).map(|json| (on_node.light.value(), json))
        });
        if let Some((idx, json)) = light {
            let name = json.name.clone().or(node.name.clone()).unwrap_or_default();
            let element = label("light", idx, json.name.as_ref());
            let kind = light_kind(json, &element, job)?;
            scene.lights.push(Light { name, node: Some(node_idx), kind });
        }
    }
    Ok(())
}

fn projection(json: &JsonCamera, element: &str, job: &Job<'_>) -> Result<Projection, ImportError> {
    let Checked::Valid(kind) = json.type_ else {
        return Err(job.invalid(element, "an unknown type", "perspective or orthographic"));
    };
    match (kind, &json.perspective, &json.orthographic) {
        (CameraType::Perspective, Some(lens), _) => {
            if lens.yfov > 0.0 && lens.yfov < std::f32::consts::PI {
                return Ok(Projection::Perspective { vertical_fov: lens.yfov });
            }
            let found = format!("a yfov of {}", lens.yfov);
            Err(job.invalid(element, found, "an angle between 0 and pi"))
        }
        (CameraType::Orthographic, _, Some(lens)) => {
            if lens.ymag.abs() > 0.0 && lens.ymag.is_finite() {
                return Ok(Projection::Orthographic { height: 2.0 * lens.ymag.abs() });
            }
            let found = format!("a ymag of {}", lens.ymag);
            Err(job.invalid(element, found, "a finite number other than 0"))
        }
        _ => Err(job.invalid(element, "no projection of the stated type", "one")),
    }
}

fn light_kind(json: &JsonLight, element: &str, job: &Job<'_>) -> Result<LightKind, ImportError> {
    let Checked::Valid(kind) = json.type_ else {
        return Err(job.invalid(element, "an unknown type", "directional, point or spot"));
    };
    let intensity = json.intensity * Vec3::from(json.color);
    if !intensity.is_finite() || intensity.min_element() < 0.0 {
        let found = format!("the intensity {intensity}");
        return Err(job.invalid(element, found, "finite numbers, none negative"));
    }
    let (position, direction) = (Vec3::ZERO, Vec3::NEG_Z);
    Ok(match kind {
        LightType::Directional => LightKind::Directional { direction, irradiance: intensity },
        LightType::Point => {
            LightKind::Point { position, intensity, falloff: Falloff::InverseSquare }
        }
        LightType::Spot => {
            let Some(spot) = &json.spot else {
                return Err(job.invalid(element, "no spot", "the angles of the cone"));
            };
            let (inner, outer) = (spot.inner_cone_angle, spot.outer_cone_angle);
            if !(0.0 <= inner && inner < outer && outer <= std::f32::consts::FRAC_PI_2) {
                let found = format!("cone angles {inner} and {outer}");
                return Err(job.invalid(element, found, "0 <= inner < outer <= pi / 2"));
            }
            let (cos_inner, cos_outer) = (inner.cos(), outer.cos());
            LightKind::Spot { position, direction, intensity, cos_inner, cos_outer }
        }
    })
}
