//! Tests of whole pictures.

mod agreement;
mod common;
mod light;
mod paths;
mod virtual_lights;
