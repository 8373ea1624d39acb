//! NPZ: arrays for NumPy.
//!
//! | Array | Shape | Type | Holds |
//! |---|---|---|---|
//! | `vertices` | V, 3 | float32 | positions in the first frame |
//! | `triangles` | F, 3 | uint32 | vertices of each face |
//! | `hours` | F or V | float64 | hours of each face or vertex |
//! | `times` | S | int64 | middle of each step with the sun up, in seconds since 1970 by UTC |
//! | `to_sun` | S, 3 | float32 | unit vector towards the sun in each of them |
//! | `step_hours` | S | float64 | what each of them adds to the hours of a sample that is lit |

use std::fs::File;
use std::path::Path;

use anyhow::Result;
use glam::Vec3;
use ndarray::{ArrayView1, ArrayView2};
use ndarray_npy::NpzWriter;

use crate::commands::sun::hours::SunHours;

/// Writes the arrays, compressed.
pub(super) fn write(path: &Path, hours: &SunHours<'_>) -> Result<()> {
    let (mesh, steps) = (&hours.mesh, hours.steps);
    let vertices: Vec<f32> = mesh.vertices().iter().flat_map(Vec3::to_array).collect();
    let triangles = mesh.triangles().as_flattened();
    let times: Vec<i64> = steps.iter().map(|step| step.time.as_second()).collect();
    let to_sun: Vec<f32> = steps.iter().flat_map(|step| step.to_sun.to_array()).collect();
    let step_hours: Vec<f64> =
        steps.iter().map(|step| step.seconds * hours.hours_per_second).collect();

    let mut npz = NpzWriter::new_compressed(File::create(path)?);
    npz.add_array("vertices", &ArrayView2::from_shape((vertices.len() / 3, 3), &vertices)?)?;
    npz.add_array("triangles", &ArrayView2::from_shape((triangles.len() / 3, 3), triangles)?)?;
    npz.add_array("hours", &ArrayView1::from(&hours.hours))?;
    npz.add_array("times", &ArrayView1::from(&times))?;
    npz.add_array("to_sun", &ArrayView2::from_shape((steps.len(), 3), &to_sun)?)?;
    npz.add_array("step_hours", &ArrayView1::from(&step_hours))?;
    npz.finish()?;
    Ok(())
}
