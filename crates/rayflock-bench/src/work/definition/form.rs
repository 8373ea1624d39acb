//! From the text of a definition to its values.

use std::path::Path;

use serde::Deserialize;
use toml::Value;

use super::super::{RayKind, parse_count};
use super::{Camera, Definition, Lidar, Lights, Orthographic, Phase, Room, Secondary, Shapes};
use crate::BenchError;

/// A definition as it is written, counts and kinds not yet read.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Form {
    triangles: Vec<Value>,
    rays: Vec<Value>,
    kinds: Vec<String>,
    phases: Vec<Phase>,
    seed: u64,
    room: Room,
    shapes: Shapes,
    camera: Camera,
    lights: Lights,
    secondary: Secondary,
    orthographic: Orthographic,
    lidar: Lidar,
}

/// Reads `text`, which came from `path`.
pub(super) fn parse(text: &str, path: &Path) -> Result<Definition, BenchError> {
    let form: Form = toml::from_str(text).map_err(|source| BenchError::DefinitionForm {
        path: path.to_owned(),
        source: Box::new(source),
    })?;
    Ok(Definition {
        triangles: counts("triangles", &form.triangles, path)?,
        rays: counts("rays", &form.rays, path)?,
        kinds: kinds(&form.kinds, path)?,
        phases: form.phases,
        seed: form.seed,
        room: form.room,
        shapes: form.shapes,
        camera: form.camera,
        lights: form.lights,
        secondary: form.secondary,
        orthographic: form.orthographic,
        lidar: form.lidar,
        text: text.to_owned(),
    })
}

fn counts(key: &str, values: &[Value], path: &Path) -> Result<Vec<usize>, BenchError> {
    let count = |(idx, value): (usize, &Value)| {
        let text = value.as_str().map_or_else(|| value.to_string(), str::to_owned);
        parse_count(&text).map_err(|_| BenchError::DefinitionValue {
            path: path.to_owned(),
            key: format!("{key}[{idx}]"),
            found: value.to_string(),
            expected: "a whole number above 0, or text like \"64K\" or \"1M\"".to_owned(),
        })
    };
    values.iter().enumerate().map(count).collect()
}

fn kinds(names: &[String], path: &Path) -> Result<Vec<RayKind>, BenchError> {
    let kind = |(idx, name): (usize, &String)| {
        name.parse().map_err(|_| BenchError::DefinitionValue {
            path: path.to_owned(),
            key: format!("kinds[{idx}]"),
            found: format!("{name:?}"),
            expected: format!("one of {}", RayKind::ALL.map(RayKind::name).join(", ")),
        })
    };
    names.iter().enumerate().map(kind).collect()
}
