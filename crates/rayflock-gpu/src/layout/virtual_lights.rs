//! Virtual lights and what hides them.

use bytemuck::{Pod, Zeroable};
use rayflock_geom::simd::segment_spheres::SoftSphere;
use rayflock_geom::simd::segment_walls::Wall;
use rayflock_render::vpl::{VirtualLight, VirtualLights};

/// `VirtualLight` of `frame/virtual_light.wgsl`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct DeviceVirtualLight {
    pub(crate) position: [f32; 3],
    pub(crate) kind: u32,
    pub(crate) normal: [f32; 3],
    pub(crate) evenness: f32,
    pub(crate) intensity: [f32; 3],
    pub(crate) shininess: f32,
    pub(crate) to_source: [f32; 3],
    pub(crate) varnish: f32,
    pub(crate) highlight: [f32; 3],
    pub(crate) unused: u32,
}

/// `PLAIN`, `LOBED` and `DISTANT` of `frame/virtual_light.wgsl`.
pub(crate) const PLAIN: u32 = 0;
pub(crate) const LOBED: u32 = 1;
pub(crate) const DISTANT: u32 = 2;

/// `SoftSphere` of `frame/past_spheres.wgsl`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct DeviceSoftSphere {
    pub(crate) center: [f32; 3],
    pub(crate) outer: f32,
    pub(crate) flatness: [f32; 3],
    pub(crate) opacity: f32,
    pub(crate) peak: f32,
    pub(crate) slope: f32,
    pub(crate) unused_a: u32,
    pub(crate) unused_b: u32,
}

/// `Wall` of `frame/past_spheres.wgsl`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct DeviceWall {
    pub(crate) corner: [f32; 3],
    pub(crate) opacity: f32,
    pub(crate) normal: [f32; 3],
    pub(crate) unused_a: u32,
    pub(crate) axis_a: [f32; 3],
    pub(crate) unused_b: u32,
    pub(crate) axis_b: [f32; 3],
    pub(crate) unused_c: u32,
}

/// `GatherParams` of `frame/gather_lights.wgsl`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct GatherParams {
    pub(crate) bound: f32,
    pub(crate) distance: f32,
    pub(crate) first_light: u32,
    pub(crate) end_light: u32,
    pub(crate) sphere_count: u32,
    pub(crate) wall_count: u32,
    pub(crate) first_sum: u32,
    pub(crate) unused: u32,
}

impl DeviceVirtualLight {
    /// Light `light_idx`.
    pub(crate) fn new(lights: &VirtualLights, light_idx: usize) -> Self {
        let VirtualLight { position, normal, evenness, intensity } = lights.get(light_idx);
        let plain = Self {
            position: position.to_array(),
            kind: if lights.is_distant(light_idx) { DISTANT } else { PLAIN },
            normal: normal.to_array(),
            evenness,
            intensity: intensity.to_array(),
            ..Self::default()
        };
        match lights.lobe(light_idx) {
            Some(lobe) => Self {
                kind: LOBED,
                shininess: lobe.shininess,
                to_source: lobe.to_source.to_array(),
                varnish: lobe.varnish,
                highlight: lobe.highlight.to_array(),
                ..plain
            },
            None => plain,
        }
    }
}

impl From<&SoftSphere> for DeviceSoftSphere {
    fn from(sphere: &SoftSphere) -> Self {
        let slope = sphere.slope();
        Self {
            center: sphere.center.to_array(),
            outer: sphere.outer,
            flatness: sphere.flatness.to_array(),
            opacity: sphere.opacity,
            peak: sphere.outer * sphere.outer * slope,
            slope,
            ..Self::default()
        }
    }
}

impl From<&Wall> for DeviceWall {
    fn from(wall: &Wall) -> Self {
        let [axis_a, axis_b] = wall.axes().map(|axis| axis.to_array());
        Self {
            corner: wall.corner().to_array(),
            opacity: wall.opacity(),
            normal: wall.normal().to_array(),
            axis_a,
            axis_b,
            ..Self::default()
        }
    }
}
