//! Pure functions of shading: what happens at one point to one ray.
//!
//! No function here knows of batches, bands or threads, so the wavefront stages and the
//! reference renderer can share them.

pub(crate) mod background;
pub(crate) mod fresnel;
pub(crate) mod luminance;
pub(crate) mod sampling;
pub(crate) mod scatter;
pub(crate) mod surface_point;
pub(crate) mod surface_points;
pub(crate) mod texture;
pub(crate) mod turns;
