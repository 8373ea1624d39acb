//! What host and device share, byte by byte.
//!
//! WGSL states each structure and constant once; tests compare these with it
//! (`src/shaders/tests.rs` reads sizes, offsets and values by naga).

use bytemuck::{Pod, Zeroable};

mod frame;
pub(crate) mod virtual_lights;

pub(crate) use self::frame::{
    Attributes, BUCKET_BYTES, DEFORMED_VERTEX_BYTES, DIRECTIONAL, DeformedObject, DeviceEmitter,
    DeviceLight, EMITTERS, FrameParams, NOWHERE, PATH_BYTES, PHOTON_BYTES, PHOTONS_OFFSET, POINT,
    POINT_BYTES, PhotonParams, SPOT, ScanCounters, ScanParams,
};

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
    pub(crate) carried: u32,
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
        carried: 0,
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
