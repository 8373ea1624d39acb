//! Tests of whole pictures.

mod agreement;
mod caustics;
mod common;
mod light;
mod paths;
mod shown;
mod virtual_lights;
