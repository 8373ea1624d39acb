//! What Embree reads and writes in memory, declared by hand after `rtcore_ray.h`,
//! `rtcore_scene.h` and their kin.
//!
//! **Invariants.** Sizes and offsets are checked when this is compiled, their meaning by the
//! engine's tests. Embree 4.3 added the last field of a hit; older libraries do not touch it, and
//! nothing stands behind it, so that one declaration serves every Embree 4.

use std::mem::offset_of;

/// Rays of a packet.
pub(super) const WIDTH: usize = 16;

/// No geometry, no primitive, no instance.
pub(super) const INVALID_ID: u32 = u32::MAX;

/// One ray.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C, align(16))]
pub(super) struct Ray {
    /// Origin.
    pub(super) org: [f32; 3],
    /// Start of the interval.
    pub(super) t_near: f32,
    /// Direction.
    pub(super) dir: [f32; 3],
    /// Always 0: there is no motion within a frame.
    pub(super) time: f32,
    /// End of the interval; Embree writes the distance of a hit, `-inf` when occluded.
    pub(super) t_far: f32,
    /// Which geometries are seen.
    pub(super) mask: u32,
    /// Unused.
    pub(super) id: u32,
    /// Always 0.
    pub(super) flags: u32,
}

/// One ray and what it hit.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C, align(16))]
pub(super) struct RayHit {
    /// The ray.
    pub(super) ray: Ray,
    /// Not normalised; unused.
    pub(super) normal: [f32; 3],
    /// Barycentric coordinate of vertex 1.
    pub(super) u: f32,
    /// Barycentric coordinate of vertex 2.
    pub(super) v: f32,
    /// The primitive within its geometry.
    pub(super) prim_id: u32,
    /// The geometry; [`INVALID_ID`] before, and after for a miss.
    pub(super) geom_id: u32,
    /// The instance.
    pub(super) inst_id: u32,
    /// The instance within an array of them; unused.
    pub(super) inst_prim_id: u32,
}

/// Sixteen rays.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C, align(64))]
pub(super) struct Ray16 {
    /// Origins, by axis.
    pub(super) org: [[f32; WIDTH]; 3],
    /// Starts of the intervals.
    pub(super) t_near: [f32; WIDTH],
    /// Directions, by axis.
    pub(super) dir: [[f32; WIDTH]; 3],
    /// Always 0.
    pub(super) time: [f32; WIDTH],
    /// Ends of the intervals, as in [`Ray`].
    pub(super) t_far: [f32; WIDTH],
    /// Which geometries are seen.
    pub(super) mask: [u32; WIDTH],
    /// Unused.
    pub(super) id: [u32; WIDTH],
    /// Always 0.
    pub(super) flags: [u32; WIDTH],
}

/// Sixteen rays and what they hit; fields as in [`RayHit`].
#[derive(Clone, Copy, Debug, Default)]
#[repr(C, align(64))]
pub(super) struct RayHit16 {
    pub(super) ray: Ray16,
    pub(super) normal: [[f32; WIDTH]; 3],
    pub(super) u: [f32; WIDTH],
    pub(super) v: [f32; WIDTH],
    pub(super) prim_id: [u32; WIDTH],
    pub(super) geom_id: [u32; WIDTH],
    pub(super) inst_id: [u32; WIDTH],
    pub(super) inst_prim_id: [u32; WIDTH],
}

/// Which rays of a packet are traced: -1 those that are, 0 the others.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(super) struct Valid(pub(super) [i32; WIDTH]);

/// How to trace. The fields that would hold addresses of callbacks and contexts are numbers, so
/// that they can only be null.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C)]
pub(super) struct Arguments {
    /// [`RAY_QUERY_COHERENT`] or 0.
    flags: u32,
    /// What the scene may hold: the `FEATURE_` constants.
    feature_mask: u32,
    context: usize,
    filter: usize,
    callback: usize,
    min_width_distance_factor: f32,
}

impl Arguments {
    /// Arguments with these flags.
    pub(super) fn new(flags: u32, feature_mask: u32) -> Self {
        Self { flags, feature_mask, ..Self::default() }
    }
}

/// A box as Embree tells it: lower corner, padding, upper corner, padding.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C, align(16))]
pub(super) struct Bounds {
    /// Lower corner; the fourth number is padding.
    pub(super) lower: [f32; 4],
    /// Upper corner; the fourth number is padding.
    pub(super) upper: [f32; 4],
}

const _: () = {
    assert!(size_of::<Ray>() == 48 && offset_of!(Ray, dir) == 16 && offset_of!(Ray, t_far) == 32);
    assert!(size_of::<RayHit>() == 96 && offset_of!(RayHit, normal) == 48);
    assert!(offset_of!(RayHit, prim_id) == 68 && offset_of!(RayHit, inst_prim_id) == 80);
    assert!(size_of::<Ray16>() == 12 * 64 && offset_of!(Ray16, t_far) == 8 * 64);
    assert!(size_of::<RayHit16>() == 21 * 64 && offset_of!(RayHit16, prim_id) == 17 * 64);
    assert!(size_of::<Bounds>() == 32);
    assert!(offset_of!(Arguments, context) == 8 && offset_of!(Arguments, callback) == 24);
};

/// Flag of [`Arguments`]: the rays of a packet go similar ways.
pub(super) const RAY_QUERY_COHERENT: u32 = 1 << 16;

/// Scenes hold triangles.
pub(super) const FEATURE_TRIANGLE: u32 = 1 << 1;
/// Scenes hold spheres.
pub(super) const FEATURE_SPHERE_POINT: u32 = 1 << 20;
/// Scenes hold instances.
pub(super) const FEATURE_INSTANCE: u32 = 1 << 23;

/// `RTCGeometryType`.
pub(super) const GEOMETRY_TRIANGLE: u32 = 0;
/// `RTCGeometryType`.
pub(super) const GEOMETRY_SPHERE_POINT: u32 = 50;
/// `RTCGeometryType`.
pub(super) const GEOMETRY_INSTANCE: u32 = 121;

/// `RTCBufferType`.
pub(super) const BUFFER_INDEX: u32 = 0;
/// `RTCBufferType`.
pub(super) const BUFFER_VERTEX: u32 = 1;

/// `RTCFormat`.
pub(super) const FORMAT_UINT3: u32 = 0x5003;
/// `RTCFormat`.
pub(super) const FORMAT_FLOAT3: u32 = 0x9003;
/// `RTCFormat`.
pub(super) const FORMAT_FLOAT4: u32 = 0x9004;

/// `RTCBuildQuality`.
pub(super) const QUALITY_LOW: u32 = 0;
/// `RTCBuildQuality`.
pub(super) const QUALITY_MEDIUM: u32 = 1;
/// `RTCBuildQuality`.
pub(super) const QUALITY_REFIT: u32 = 3;

/// `RTCSceneFlags`: the scene will change, so what building needs is kept.
pub(super) const SCENE_DYNAMIC: u32 = 1 << 0;
/// `RTCSceneFlags`.
pub(super) const SCENE_ROBUST: u32 = 1 << 2;

/// `RTCDeviceProperty`: the three numbers of the version.
pub(super) const PROPERTY_VERSION: [u32; 3] = [1, 2, 3];
/// `RTCDeviceProperty`: whether eight rays fill a register.
pub(super) const PROPERTY_NATIVE_RAY8: u32 = 33;
/// `RTCDeviceProperty`: whether sixteen rays fill a register.
pub(super) const PROPERTY_NATIVE_RAY16: u32 = 34;
/// `RTCDeviceProperty`: whether rays and geometries have masks.
pub(super) const PROPERTY_RAY_MASK: u32 = 64;
/// `RTCDeviceProperty`: whether there are spheres.
pub(super) const PROPERTY_POINT_GEOMETRY: u32 = 101;
