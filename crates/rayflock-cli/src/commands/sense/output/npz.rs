//! NPZ: arrays for NumPy.
//!
//! | Array | Shape | Type | Holds |
//! |---|---|---|---|
//! | `position`, `position_in_sensor`, `normal` | N, 3 | float32 | of each point |
//! | `range`, `intensity` | N | float32 | of each point |
//! | `time` | N | float64 | of each point, in seconds |
//! | `object_id`, `prim_id`, `beam`, `row`, `column` | N | uint32 | of each point |
//! | `return_number`, `return_count` | N | uint8 | of each point |
//! | `step_time` | S | float64 | of each time step, in seconds |
//! | `world_from_sensor` | S, 4, 4 | float32 | where the sensor is in each time step |
//! | `range_image`, `depth_image`, `intensity_image` | R, C | float32 | of first returns; infinite, or 0, where there is none |

use std::fs::File;
use std::path::Path;

use anyhow::Result;
use glam::{Mat4, Vec3};
use ndarray::{ArrayView1, ArrayView2, ArrayView3};
use ndarray_npy::{NpzWriter, WritableElement};

use crate::commands::sense::scan::Scan;

/// Writes the arrays, compressed.
pub(super) fn write(path: &Path, scan: &Scan<'_>) -> Result<()> {
    let mut npz = NpzWriter::new_compressed(File::create(path)?);
    write_points(&mut npz, scan)?;
    write_steps(&mut npz, scan)?;
    if scan.pattern.is_picture() {
        write_pictures(&mut npz, scan)?;
    }
    npz.finish()?;
    Ok(())
}

fn write_points(npz: &mut NpzWriter<File>, scan: &Scan<'_>) -> Result<()> {
    let sweep = scan.sweep;
    for (name, column) in [
        ("position", &sweep.position),
        ("position_in_sensor", &sweep.position_in_sensor),
        ("normal", &sweep.normal),
    ] {
        let coordinates: Vec<f32> = column.iter().flat_map(Vec3::to_array).collect();
        npz.add_array(name, &ArrayView2::from_shape((column.len(), 3), &coordinates)?)?;
    }
    add_column(npz, "range", &sweep.range)?;
    add_column(npz, "intensity", &sweep.intensity)?;
    add_column(npz, "time", &sweep.time)?;
    add_column(npz, "object_id", &sweep.object_id)?;
    add_column(npz, "prim_id", &sweep.prim_id)?;
    add_column(npz, "beam", &sweep.beam_idx)?;
    add_column(npz, "row", &sweep.row)?;
    add_column(npz, "column", &sweep.column)?;
    add_column(npz, "return_number", &sweep.return_number)?;
    add_column(npz, "return_count", &sweep.return_count)
}

fn write_steps(npz: &mut NpzWriter<File>, scan: &Scan<'_>) -> Result<()> {
    let steps = &scan.sweep.steps;
    let times: Vec<f64> = steps.iter().map(|step| step.time).collect();
    add_column(npz, "step_time", &times)?;
    // Row by row, as NumPy has it.
    let matrix = |place: glam::Affine3A| Mat4::from(place).transpose().to_cols_array();
    let matrices: Vec<f32> = steps.iter().flat_map(|step| matrix(step.world_from_sensor)).collect();
    let matrices = ArrayView3::from_shape((steps.len(), 4, 4), &matrices)?;
    Ok(npz.add_array("world_from_sensor", &matrices)?)
}

fn write_pictures(npz: &mut NpzWriter<File>, scan: &Scan<'_>) -> Result<()> {
    let (sweep, shape) = (scan.sweep, scan.pattern.shape());
    for (name, picture) in [
        ("range_image", sweep.picture(shape, f32::INFINITY, |idx| sweep.range[idx])),
        ("depth_image", sweep.picture(shape, f32::INFINITY, |idx| sweep.depth(idx))),
        ("intensity_image", sweep.picture(shape, 0.0, |idx| sweep.intensity[idx])),
    ] {
        npz.add_array(name, &ArrayView2::from_shape(shape, &picture)?)?;
    }
    Ok(())
}

fn add_column<T: WritableElement>(
    npz: &mut NpzWriter<File>,
    name: &str,
    column: &[T],
) -> Result<()> {
    Ok(npz.add_array(name, &ArrayView1::from(column))?)
}
