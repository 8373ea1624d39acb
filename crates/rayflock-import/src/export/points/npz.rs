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

use std::io::{Seek, Write};

use glam::Vec3;
use ndarray::{ArrayView1, ArrayView2, ArrayView3};
use ndarray_npy::{NpzWriter, WritableElement};

use super::{PointColumns, PointFileError, PointImages};

/// Writes the arrays, compressed.
pub(super) fn write(
    points: &PointColumns<'_>,
    out: &mut (impl Write + Seek),
) -> Result<(), PointFileError> {
    let mut npz = NpzWriter::new_compressed(out);
    write_points(&mut npz, points)?;
    write_steps(&mut npz, points)?;
    if let Some(images) = &points.images {
        write_images(&mut npz, images)?;
    }
    npz.finish()?;
    Ok(())
}

fn write_points<W: Write + Seek>(
    npz: &mut NpzWriter<W>,
    points: &PointColumns<'_>,
) -> Result<(), PointFileError> {
    for (name, column) in [
        ("position", points.position),
        ("position_in_sensor", points.position_in_sensor),
        ("normal", points.normal),
    ] {
        let coordinates: Vec<f32> = column.iter().flat_map(Vec3::to_array).collect();
        npz.add_array(name, &ArrayView2::from_shape((column.len(), 3), &coordinates)?)?;
    }
    add_column(npz, "range", points.range)?;
    add_column(npz, "intensity", points.intensity)?;
    add_column(npz, "time", points.time)?;
    add_column(npz, "object_id", points.object_id)?;
    add_column(npz, "prim_id", points.prim_id)?;
    add_column(npz, "beam", points.beam_idx)?;
    add_column(npz, "row", points.row)?;
    add_column(npz, "column", points.column)?;
    add_column(npz, "return_number", points.return_number)?;
    add_column(npz, "return_count", points.return_count)
}

fn write_steps<W: Write + Seek>(
    npz: &mut NpzWriter<W>,
    points: &PointColumns<'_>,
) -> Result<(), PointFileError> {
    add_column(npz, "step_time", &points.step_time)?;
    let matrices = &points.world_from_sensor;
    let matrices = ArrayView3::from_shape((matrices.len(), 4, 4), matrices.as_flattened())?;
    Ok(npz.add_array("world_from_sensor", &matrices)?)
}

fn write_images<W: Write + Seek>(
    npz: &mut NpzWriter<W>,
    images: &PointImages,
) -> Result<(), PointFileError> {
    for (name, image) in [
        ("range_image", &images.range),
        ("depth_image", &images.depth),
        ("intensity_image", &images.intensity),
    ] {
        npz.add_array(name, &ArrayView2::from_shape(images.shape, image)?)?;
    }
    Ok(())
}

fn add_column<W: Write + Seek, T: WritableElement>(
    npz: &mut NpzWriter<W>,
    name: &str,
    column: &[T],
) -> Result<(), PointFileError> {
    Ok(npz.add_array(name, &ArrayView1::from(column))?)
}
