//! Tests of spheres that stand for geometry.

mod accuracy;
mod common;
mod following;
mod pictures;
