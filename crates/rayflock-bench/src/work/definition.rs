//! What the map measures, as a file says it.
//!
//! `bench/definitions/map.toml` explains every value. A file that says too much, too little or
//! something that cannot be is refused: nothing is guessed.

mod check;
mod form;

use std::fs;
use std::path::Path;

use rayflock::prelude::{Affine3A, Vec3, View};
use rayflock::scene::Projection;
use serde::Deserialize;

use super::{RayKind, Surroundings, surroundings};
use crate::BenchError;

/// The definition that is built in.
const MAP: &str = include_str!("../../../../bench/definitions/map.toml");
/// Its name in messages.
const MAP_NAME: &str = "bench/definitions/map.toml";

/// A workload: how many triangles and rays, of which kinds, in which surroundings.
#[derive(Clone, Debug)]
pub struct Definition {
    /// Moving triangles, one row of the map each.
    pub triangles: Vec<usize>,
    /// Rays a frame and kind, one column of the map each.
    pub rays: Vec<usize>,
    /// Kinds of rays, one table of the map each.
    pub kinds: Vec<RayKind>,
    /// What is measured and averaged.
    pub phases: Vec<Phase>,
    /// What every random number follows from.
    pub seed: u64,
    /// The room around the moving triangles.
    pub room: Room,
    /// What the moving triangles make up.
    pub shapes: Shapes,
    /// Where the picture is seen from.
    pub camera: Camera,
    /// What light comes from.
    pub lights: Lights,
    /// Rays that start or end at surfaces.
    pub secondary: Secondary,
    /// Rays straight down.
    pub orthographic: Orthographic,
    /// Rays all around.
    pub lidar: Lidar,
    text: String,
}

/// Frames that look alike, and the one that comes before them.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Phase {
    /// Its name in records.
    pub name: String,
    /// The times that are measured, in frames.
    pub frames: Vec<f64>,
    /// The time that engines get before those, in frames.
    pub before: f64,
}

/// A box of square cells with a square hole in its ceiling.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Room {
    /// Edge lengths.
    pub size: [f32; 3],
    /// Cells along the edges.
    pub cells: [usize; 3],
    /// Cells along an edge of the hole.
    pub skylight: usize,
}

/// The shapes that the triangles move between.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Shapes {
    /// Frames from one shape to the next.
    pub frames_apart: f64,
    /// The area of all triangles together, at each shape.
    pub area: f32,
    /// The middle of all shapes.
    pub center: [f32; 3],
    /// Radius of the ball that the cloud's triangles lie in.
    pub cloud_radius: f32,
    /// Height of the pyramid in edges of its bottom.
    pub pyramid_height: f32,
}

/// A pinhole camera.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Camera {
    /// Where it is.
    pub position: [f32; 3],
    /// What it looks at.
    pub target: [f32; 3],
    /// Angle between the top and the bottom of the picture.
    pub vertical_fov_degrees: f32,
}

/// Where light comes from.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Lights {
    /// Place of the point light.
    pub point: [f32; 3],
    /// Direction to the sun, of any length.
    pub to_sun: [f32; 3],
}

/// How rays start and end at surfaces.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Secondary {
    /// How far from the surface rays start.
    pub offset: f32,
    /// The share of the way to a surface at which rays from a light end.
    pub shadow_end: f32,
    /// The length of rays for ambient occlusion.
    pub ao_reach: f32,
}

/// Rays straight down.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Orthographic {
    /// The middle of the level square that they start from.
    pub position: [f32; 3],
    /// Its edge.
    pub edge: f32,
}

/// Rays from one point all around.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Lidar {
    /// Where they start.
    pub position: [f32; 3],
    /// Angles above the horizon of the lowest and the highest row.
    pub elevation_degrees: [f32; 2],
}

impl Definition {
    /// The map that the program measures when no other is named.
    pub fn default_map() -> Self {
        match Self::parse(MAP, Path::new(MAP_NAME)) {
            Ok(definition) => definition,
            Err(error) => unreachable!("the built-in definition is tested: {error}"),
        }
    }

    /// Reads a definition from a file.
    ///
    /// # Errors
    /// [`BenchError`] names the file, and what in it is wrong.
    pub fn read(path: &Path) -> Result<Self, BenchError> {
        let io = |source| BenchError::ReadDefinition { path: path.to_owned(), source };
        Self::parse(&fs::read_to_string(path).map_err(io)?, path)
    }

    fn parse(text: &str, path: &Path) -> Result<Self, BenchError> {
        let definition = form::parse(text, path)?;
        check::check(&definition, path)?;
        Ok(definition)
    }

    /// The text of the file, to be kept with what was measured.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// What rays are made from.
    pub fn surroundings(&self) -> Surroundings {
        Surroundings {
            view: self.camera.view(),
            point_light: self.lights.point.into(),
            to_sun: Vec3::from(self.lights.to_sun).normalize(),
            from_above: surroundings::from_above(
                self.orthographic.position.into(),
                self.orthographic.edge,
            ),
            lidar: self.lidar.position.into(),
            lidar_elevation: self.lidar.elevation_degrees.map(f32::to_radians),
            offset: self.secondary.offset,
            shadow_end: self.secondary.shadow_end,
            ao_reach: self.secondary.ao_reach,
        }
    }
}

impl Camera {
    /// The camera at its place, upright.
    pub fn view(&self) -> View {
        let position = Vec3::from(self.position);
        let ahead = (Vec3::from(self.target) - position).normalize();
        let right = ahead.cross(Vec3::Y).normalize();
        let columns = [right, right.cross(ahead), -ahead, position];
        let [x, y, z, translation] = columns.map(Into::into);
        let world_from_camera = Affine3A::from_cols(x, y, z, translation);
        let vertical_fov = self.vertical_fov_degrees.to_radians();
        View::new(world_from_camera, Projection::Perspective { vertical_fov })
    }
}

#[cfg(test)]
mod tests;
