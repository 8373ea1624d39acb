//! What host and device share, byte by byte.
//!
//! WGSL states each structure and constant once; tests compare these with it
//! (`src/shaders/tests.rs` reads sizes, offsets and values by naga).

use bytemuck::{Pod, Zeroable};
use glam::{Vec2, Vec3};

pub(crate) mod virtual_lights;

/// `Primitive` of `shared/primitive.wgsl`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct DevicePrimitive {
    pub(crate) a: [f32; 3],
    pub(crate) mask: u32,
    pub(crate) b: [f32; 3],
    pub(crate) kind: u32,
    pub(crate) c: [f32; 3],
    pub(crate) rank: u32,
}

/// `TRIANGLE` and `SPHERE` of `shared/primitive.wgsl`.
pub(crate) const TRIANGLE: u32 = 0;
pub(crate) const SPHERE: u32 = 1;

/// `Ray` of `shared/ray.wgsl`.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct DeviceRay {
    pub(crate) origin: [f32; 3],
    pub(crate) t_min: f32,
    pub(crate) direction: [f32; 3],
    pub(crate) t_max: f32,
    pub(crate) mask: u32,
    pub(crate) slot: u32,
    pub(crate) cell: u32,
    pub(crate) unused: u32,
}

impl DeviceRay {
    /// A ray that is not traced.
    pub(crate) const IDLE: Self = Self {
        origin: [0.0; 3],
        t_min: 1.0,
        direction: [0.0, 0.0, 1.0],
        t_max: 0.0,
        mask: 0,
        slot: 0,
        cell: 0,
        unused: 0,
    };

    /// Whether the ray is traced.
    pub(crate) fn is_active(&self) -> bool {
        self.t_min <= self.t_max
    }
}

/// `Hit` of `shared/intersect.wgsl`.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct DeviceHit {
    pub(crate) t: f32,
    pub(crate) u: f32,
    pub(crate) v: f32,
    pub(crate) rank: u32,
}

/// Stands for no primitive.
pub(crate) const NO_RANK: u32 = u32::MAX;

impl DeviceHit {
    /// Nothing is hit before `t`.
    pub(crate) const fn none_before(t: f32) -> Self {
        Self { t, u: 0.0, v: 0.0, rank: NO_RANK }
    }
}

/// `Cone` of `shared/cone.wgsl`.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Cone {
    pub(crate) center: [f32; 3],
    pub(crate) radius: f32,
    pub(crate) axis: [f32; 3],
    pub(crate) sin: f32,
}

/// `Params` of `compute/params.wgsl`.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Params {
    pub(crate) tile_count: u32,
    pub(crate) block_count: u32,
    pub(crate) pair_capacity: u32,
    pub(crate) question: u32,
}

/// `CellParams` of `compute/cells.wgsl`.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct CellParams {
    pub(crate) finest: u32,
    pub(crate) cell_count: u32,
    pub(crate) unused_a: u32,
    pub(crate) unused_b: u32,
}

/// `Counters` of `compute/params.wgsl`.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Counters {
    pub(crate) root_pairs: u32,
    pub(crate) node_pairs: u32,
    pub(crate) tile_pairs: u32,
    pub(crate) cone_tests: u32,
    pub(crate) ray_tests: u32,
    pub(crate) triangle_tests: u32,
    pub(crate) sphere_tests: u32,
}

/// `Pair` of `compute/params.wgsl`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Pair {
    pub(crate) cone_idx: u32,
    pub(crate) block_idx: u32,
}

/// `TileRange` of `compute/params.wgsl`, and `SubfieldTile` of `subfields/params.wgsl`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct TileRange {
    pub(crate) first: u32,
    pub(crate) count: u32,
}

/// `SubfieldParams` of `subfields/params.wgsl`.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct SubfieldParams {
    pub(crate) shared_direction: [f32; 3],
    pub(crate) is_shared: u32,
    pub(crate) direction_edge: u32,
    pub(crate) tile_edge: u32,
    pub(crate) subfield_capacity: u32,
    pub(crate) entry_capacity: u32,
    pub(crate) prim_count: u32,
    pub(crate) question: u32,
    pub(crate) unused_a: u32,
    pub(crate) unused_b: u32,
}

/// `SubfieldCounters` of `subfields/params.wgsl`.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct SubfieldCounters {
    pub(crate) entries: u32,
    pub(crate) entries_high: u32,
    pub(crate) subfield_count: u32,
    pub(crate) first_new: u32,
    pub(crate) is_placed: u32,
    pub(crate) left_count: u32,
    pub(crate) triangle_tests: u32,
    pub(crate) triangle_tests_high: u32,
    pub(crate) sphere_tests: u32,
    pub(crate) sphere_tests_high: u32,
}

/// `Subfield` of `subfields/params.wgsl`.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Subfield {
    pub(crate) column: [f32; 3],
    pub(crate) column_pad: f32,
    pub(crate) row: [f32; 3],
    pub(crate) row_pad: f32,
    pub(crate) depth: [f32; 3],
    pub(crate) depth_pad: f32,
    pub(crate) center: [f32; 3],
    pub(crate) radius: f32,
}

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

/// `Attributes` of `frame/surface_point.wgsl`.
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
