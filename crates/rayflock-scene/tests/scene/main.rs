//! Scenes over time, seen from outside: what frames hold and what they say has changed.

mod bad_scenes;
mod build;
mod changes;
mod deformation;
mod frames;
mod history;
