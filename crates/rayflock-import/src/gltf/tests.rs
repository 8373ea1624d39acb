//! Tests on tiny documents, put together from JSON and a buffer.

mod document;
mod files;
mod look;
mod meshes;
mod motion;
