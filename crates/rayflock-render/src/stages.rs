//! The stages of the wavefront renderer, in the order in which they run.
//!
//! ```text
//! band of rows, sample:  camera_rays
//! wave of rays:            engine: closest_hit
//!                          shade_surface  -> unshadowed light, lit points,
//!                            mirror_rays     mirrored rays,
//!                            refraction_rays refracted rays
//! light:                   shadow_rays -> engine: occluded -> accumulate
//! next bounce:             group_rays: mirrored and refracted rays, as one wave
//!
//! path tracer: scatter_paths in place of shade_surface, mirror_rays and refraction_rays
//! ```
//!
//! Stages work on runs of [`RUN`] rays in parallel; what the runs give is put together in their
//! order, so the picture does not depend on the number of threads.

pub(crate) mod accumulate;
pub(crate) mod camera_rays;
pub(crate) mod draw_spheres;
pub(crate) mod group_rays;
pub(crate) mod light_dots;
pub(crate) mod mirror_rays;
pub(crate) mod refraction_rays;
pub(crate) mod runs;
pub(crate) mod scatter_paths;
pub(crate) mod shade_surface;
pub(crate) mod shadow_rays;
pub(crate) mod show;

/// Rays that one task shades.
pub(crate) const RUN: usize = 2048;
