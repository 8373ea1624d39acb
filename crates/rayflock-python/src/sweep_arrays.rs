//! Sweeps as NumPy arrays.

use glam::{Affine3A, Mat4, Vec3};
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rayflock::render::sensor::Sweep;

/// The columns of a sweep under the names of the fields of the Python class `Sweep`, which are
/// those of arrays in the files that the program writes.
pub(crate) fn sweep_arrays(py: Python<'_>, sweep: Sweep) -> PyResult<Bound<'_, PyDict>> {
    let step_time: Vec<f64> = sweep.steps.iter().map(|step| step.time).collect();
    // Row by row, as NumPy has it.
    let matrix = |place: Affine3A| Mat4::from(place).transpose().to_cols_array();
    let poses = sweep.steps.iter().flat_map(|step| matrix(step.world_from_sensor)).collect();
    let poses = PyArray1::from_vec(py, poses).reshape([sweep.steps.len(), 4, 4])?;

    let dict = PyDict::new(py);
    dict.set_item("position", points(py, &sweep.position)?)?;
    dict.set_item("position_in_sensor", points(py, &sweep.position_in_sensor)?)?;
    dict.set_item("normal", points(py, &sweep.normal)?)?;
    dict.set_item("range", PyArray1::from_vec(py, sweep.range))?;
    dict.set_item("intensity", PyArray1::from_vec(py, sweep.intensity))?;
    dict.set_item("time", PyArray1::from_vec(py, sweep.time))?;
    dict.set_item("object_id", PyArray1::from_vec(py, sweep.object_id))?;
    dict.set_item("prim_id", PyArray1::from_vec(py, sweep.prim_id))?;
    dict.set_item("beam", PyArray1::from_vec(py, sweep.beam_idx))?;
    dict.set_item("row", PyArray1::from_vec(py, sweep.row))?;
    dict.set_item("column", PyArray1::from_vec(py, sweep.column))?;
    dict.set_item("return_number", PyArray1::from_vec(py, sweep.return_number))?;
    dict.set_item("return_count", PyArray1::from_vec(py, sweep.return_count))?;
    dict.set_item("step_time", PyArray1::from_vec(py, step_time))?;
    dict.set_item("world_from_sensor", poses)?;
    Ok(dict)
}

fn points<'py>(py: Python<'py>, points: &[Vec3]) -> PyResult<Bound<'py, PyArray2<f32>>> {
    let coordinates = points.iter().flat_map(Vec3::to_array).collect();
    PyArray1::from_vec(py, coordinates).reshape([points.len(), 3])
}
