//! What the device cannot render, and what the user is told then.

use rayflock_render::{RenderSettings, Shown};
use rayflock_scene::{Scene, SceneFrame};

use super::attributes::MOST_PRIMS;
use super::picture::MOST_COLUMNS;
use super::scene_data::MOST_TEXELS;
use super::virtual_lights::beyond_device;
use crate::GpuError;

/// Why the device cannot render a frame, if it cannot.
pub(super) fn refusal(frame: &SceneFrame, scene: &Scene) -> Option<String> {
    let shapes = || frame.geometry.objects().iter().map(|object| &object.shape);
    if shapes().any(|shape| shape.user().is_some_and(|user| !user.is_empty())) {
        return Some(cannot("user primitives"));
    }
    let prim_count: usize = shapes().map(|shape| shape.prim_count()).sum();
    let texel_count: usize = scene.textures.iter().map(|texture| texture.texels.len()).sum();
    let (most_prims, most_texels) = (MOST_PRIMS, MOST_TEXELS);
    if prim_count > most_prims {
        return Some(cannot(&format!("{prim_count} primitives, but {most_prims}")));
    }
    (texel_count > most_texels).then(|| cannot(&format!("{texel_count} texels, but {most_texels}")))
}

/// Why the device cannot render with these settings, if it cannot.
pub(super) fn unsupported(settings: &RenderSettings, width: usize) -> Option<String> {
    if settings.shown != Shown::Light {
        return Some(cannot(&format!("the view \"{}\"", settings.shown)));
    }
    if let Some(what) = beyond_device(&settings.indirect) {
        return Some(cannot(what));
    }
    (width > MOST_COLUMNS).then(|| cannot(&format!("rows of {width} pixels")))
}

pub(super) fn lost(fault: &GpuError) -> String {
    format!("{fault}; the renderer on the CPU goes on")
}

pub(super) fn cannot(what: &str) -> String {
    format!("the graphics device cannot render {what}; the renderer on the CPU does")
}
