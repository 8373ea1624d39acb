//! What host and device share of whole frames, byte by byte: see [`layout`](super).

use bytemuck::{Pod, Zeroable};
use glam::{Vec2, Vec3};

/// `FrameParams` of `frame/frame.wgsl`.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct FrameParams {
    pub(crate) top_left: [f32; 3],
    pub(crate) width: u32,
    pub(crate) right: [f32; 3],
    pub(crate) row_count: u32,
    pub(crate) down: [f32; 3],
    pub(crate) first_row: u32,
    pub(crate) eye: [f32; 3],
    pub(crate) is_parallel: u32,
    pub(crate) zenith: [f32; 3],
    pub(crate) sky_share: f32,
    pub(crate) horizon: [f32; 3],
    pub(crate) slot_count: u32,
    pub(crate) ground: [f32; 3],
    pub(crate) first_texture: u32,
    pub(crate) ambient: [f32; 3],
    pub(crate) goes_on: u32,
    pub(crate) subpixel: [f32; 2],
    pub(crate) conserves: u32,
    pub(crate) unused: u32,
}

/// `ScanParams` of `frame/scan.wgsl`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct ScanParams {
    pub(crate) column: [f32; 3],
    pub(crate) width: u32,
    pub(crate) row: [f32; 3],
    pub(crate) row_count: u32,
    pub(crate) depth: [f32; 3],
    pub(crate) is_parallel: u32,
    pub(crate) origin: [f32; 3],
    pub(crate) unused: u32,
    pub(crate) shift: [f32; 2],
    pub(crate) end: [u32; 2],
}

/// `ScanCounters` of `frame/scan.wgsl`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct ScanCounters {
    pub(crate) triangle_tests: u32,
    pub(crate) sphere_tests: u32,
}

/// Bytes of a `Path` and of a `LitPoint` of `frame/frame.wgsl`, which the device keeps to itself.
pub(crate) const PATH_BYTES: usize = 32;
pub(crate) const POINT_BYTES: usize = 96;

/// `PhotonParams` of `frame/photon_cells.wgsl`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct PhotonParams {
    pub(crate) low: [f32; 3],
    pub(crate) radius: f32,
    pub(crate) photon_count: u32,
    pub(crate) bucket_count: u32,
    pub(crate) unused: [u32; 2],
}

/// Bytes of a `Photon` and of what lies before those of a `PhotonStore` of `frame/photon.wgsl`, and
/// of a `Bucket` of `frame/photon_cells.wgsl`.
pub(crate) const PHOTON_BYTES: usize = 64;
pub(crate) const PHOTONS_OFFSET: usize = 16;
pub(crate) const BUCKET_BYTES: usize = 12;

/// `Attributes` of `frame/attributes.wgsl`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Attributes {
    pub(crate) normal_a: [f32; 3],
    pub(crate) material: u32,
    pub(crate) normal_b: [f32; 3],
    pub(crate) flags: u32,
    pub(crate) normal_c: [f32; 3],
    pub(crate) unused_a: u32,
    pub(crate) color_a: [f32; 3],
    pub(crate) unused_b: u32,
    pub(crate) color_b: [f32; 3],
    pub(crate) unused_c: u32,
    pub(crate) color_c: [f32; 3],
    pub(crate) unused_d: u32,
    pub(crate) uv_a: [f32; 2],
    pub(crate) uv_b: [f32; 2],
    pub(crate) uv_c: [f32; 2],
    pub(crate) unused_e: [u32; 2],
}

impl Attributes {
    /// Of corners with these normals, colours and texture coordinates.
    pub(crate) fn new(normals: [Vec3; 3], colors: [Vec3; 3], uvs: [Vec2; 3]) -> Self {
        let [normal_a, normal_b, normal_c] = normals.map(|normal| normal.to_array());
        let [color_a, color_b, color_c] = colors.map(|color| color.to_array());
        let [uv_a, uv_b, uv_c] = uvs.map(|uv| uv.to_array());
        Self {
            normal_a,
            normal_b,
            normal_c,
            color_a,
            color_b,
            color_c,
            uv_a,
            uv_b,
            uv_c,
            ..Self::default()
        }
    }
}

/// `DeformedObject` of `frame/deformed_object.wgsl`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct DeformedObject {
    pub(crate) x_axis: [f32; 3],
    pub(crate) first_vertex: u32,
    pub(crate) y_axis: [f32; 3],
    pub(crate) vertex_count: u32,
    pub(crate) z_axis: [f32; 3],
    pub(crate) first_triangle: u32,
    pub(crate) translation: [f32; 3],
    pub(crate) triangle_count: u32,
    pub(crate) first_rank: u32,
    pub(crate) mask: u32,
    pub(crate) corners: u32,
    pub(crate) positions: u32,
    pub(crate) normals: u32,
    pub(crate) next_positions: u32,
    pub(crate) next_normals: u32,
    pub(crate) share: f32,
    pub(crate) influences: u32,
    pub(crate) joints: u32,
    pub(crate) targets: u32,
    pub(crate) target_count: u32,
}

/// Bytes of a `DeformedVertex` of `frame/deformed_object.wgsl`, which the device keeps to itself.
pub(crate) const DEFORMED_VERTEX_BYTES: usize = 32;

/// `NOWHERE` of `frame/deformed_object.wgsl`.
pub(crate) const NOWHERE: u32 = u32::MAX;

/// `Light` of `frame/light.wgsl`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct DeviceLight {
    pub(crate) position: [f32; 3],
    pub(crate) kind: u32,
    pub(crate) direction: [f32; 3],
    pub(crate) is_constant: u32,
    pub(crate) intensity: [f32; 3],
    pub(crate) cos_inner: f32,
    pub(crate) cos_outer: f32,
    pub(crate) sample_idx: u32,
    pub(crate) sample_count: u32,
    pub(crate) emitter_count: u32,
}

/// `POINT`, `DIRECTIONAL`, `SPOT` and `EMITTERS` of `frame/light.wgsl`.
pub(crate) const POINT: u32 = 0;
pub(crate) const DIRECTIONAL: u32 = 1;
pub(crate) const SPOT: u32 = 2;
pub(crate) const EMITTERS: u32 = 3;

/// `Emitter` of `frame/light.wgsl`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct DeviceEmitter {
    pub(crate) a: [f32; 3],
    pub(crate) kind: u32,
    pub(crate) b: [f32; 3],
    pub(crate) weight: f32,
    pub(crate) c: [f32; 3],
    pub(crate) cumulative: f32,
    pub(crate) radiance: [f32; 3],
    pub(crate) unused: u32,
}
