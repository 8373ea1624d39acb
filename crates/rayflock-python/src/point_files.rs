//! Sweeps as files of points, written by the library from the arrays of the Python class `Sweep`.

use std::fs::File;
use std::io::{self, BufWriter};
use std::path::{Path, PathBuf};

use numpy::{Element, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rayflock::import::export::points::{
    PointColumns, PointFileError, PointFormat, PointImages, write_points,
};

use crate::arrays::{numbers, readable, rows};
use crate::errors::Failure;

/// Writes points to the file of a path, by its extension. `columns` has an array for each column,
/// `images` three arrays and their shape, unless beams make no picture.
#[pyfunction]
pub(crate) fn save_points(
    py: Python<'_>,
    path: PathBuf,
    columns: &Bound<'_, PyDict>,
    images: Option<&Bound<'_, PyDict>>,
) -> PyResult<()> {
    let arrays = PointArrays::new(columns)?;
    let images = images.map(point_images).transpose()?;
    let points = PointColumns { images, ..arrays.columns()? };
    let written = py.detach(|| write(&path, &points).map_err(|error| (path, error)));
    written.map_err(|(path, error)| to_exception(&path, error))
}

fn write(path: &Path, points: &PointColumns<'_>) -> Result<(), PointFileError> {
    let format = PointFormat::of_path(path)?;
    write_points(points, format, &mut BufWriter::new(File::create(path)?))
}

/// The arrays of a sweep, borrowed.
struct PointArrays<'py> {
    position: PyReadonlyArray2<'py, f32>,
    position_in_sensor: PyReadonlyArray2<'py, f32>,
    normal: PyReadonlyArray2<'py, f32>,
    range: PyReadonlyArray1<'py, f32>,
    intensity: PyReadonlyArray1<'py, f32>,
    time: PyReadonlyArray1<'py, f64>,
    object_id: PyReadonlyArray1<'py, u32>,
    prim_id: PyReadonlyArray1<'py, u32>,
    beam: PyReadonlyArray1<'py, u32>,
    row: PyReadonlyArray1<'py, u32>,
    column: PyReadonlyArray1<'py, u32>,
    return_number: PyReadonlyArray1<'py, u8>,
    return_count: PyReadonlyArray1<'py, u8>,
    color: PyReadonlyArray2<'py, u8>,
    step_time: PyReadonlyArray1<'py, f64>,
    /// Matrices, a row each.
    world_from_sensor: PyReadonlyArray2<'py, f32>,
}

impl<'py> PointArrays<'py> {
    fn new(given: &Bound<'py, PyDict>) -> PyResult<Self> {
        Ok(Self {
            position: table(given, "position")?,
            position_in_sensor: table(given, "position_in_sensor")?,
            normal: table(given, "normal")?,
            range: column(given, "range")?,
            intensity: column(given, "intensity")?,
            time: column(given, "time")?,
            object_id: column(given, "object_id")?,
            prim_id: column(given, "prim_id")?,
            beam: column(given, "beam")?,
            row: column(given, "row")?,
            column: column(given, "column")?,
            return_number: column(given, "return_number")?,
            return_count: column(given, "return_count")?,
            color: table(given, "color")?,
            step_time: column(given, "step_time")?,
            world_from_sensor: table(given, "world_from_sensor")?,
        })
    }

    fn columns(&self) -> Result<PointColumns<'_>, Failure> {
        Ok(PointColumns {
            position: bytemuck::cast_slice(rows::<f32, 3>(&self.position)?),
            position_in_sensor: bytemuck::cast_slice(rows::<f32, 3>(&self.position_in_sensor)?),
            normal: bytemuck::cast_slice(rows::<f32, 3>(&self.normal)?),
            range: numbers(&self.range)?,
            intensity: numbers(&self.intensity)?,
            time: numbers(&self.time)?,
            object_id: numbers(&self.object_id)?,
            prim_id: numbers(&self.prim_id)?,
            beam_idx: numbers(&self.beam)?,
            row: numbers(&self.row)?,
            column: numbers(&self.column)?,
            return_number: numbers(&self.return_number)?,
            return_count: numbers(&self.return_count)?,
            color: rows::<u8, 3>(&self.color)?.to_vec(),
            step_time: numbers(&self.step_time)?.to_vec(),
            world_from_sensor: rows::<f32, 16>(&self.world_from_sensor)?.to_vec(),
            images: None,
        })
    }
}

fn column<'py, T: Element>(
    given: &Bound<'py, PyDict>,
    name: &str,
) -> PyResult<PyReadonlyArray1<'py, T>> {
    readable(&given.as_any().get_item(name)?, name)
}

fn table<'py, T: Element>(
    given: &Bound<'py, PyDict>,
    name: &str,
) -> PyResult<PyReadonlyArray2<'py, T>> {
    readable(&given.as_any().get_item(name)?, name)
}

fn point_images(given: &Bound<'_, PyDict>) -> PyResult<PointImages> {
    let image = |name: &str| -> PyResult<Vec<f32>> { Ok(numbers(&column(given, name)?)?.to_vec()) };
    Ok(PointImages {
        shape: given.as_any().get_item("shape")?.extract()?,
        range: image("range")?,
        depth: image("depth")?,
        intensity: image("intensity")?,
    })
}

/// What Python would raise: an `OSError` of the right kind where the file cannot be written.
fn to_exception(path: &Path, error: PointFileError) -> PyErr {
    match error {
        PointFileError::Io(error) => {
            let message = format!("cannot write {}: {error}", path.display());
            io::Error::new(error.kind(), message).into()
        }
        error => PyValueError::new_err(error.to_string()),
    }
}
