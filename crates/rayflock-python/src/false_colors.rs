//! Numbers as colours.

use colorgrad::Gradient;
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;

use crate::arrays::{numbers, readable};

/// The colour of what is NaN.
const NOTHING: [u8; 3] = [243; 3];

/// Viridis from 0 to 1 as rows of three bytes, and light grey for NaN.
#[pyfunction]
pub(crate) fn false_colors<'py>(
    py: Python<'py>,
    shares: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyArray2<u8>>> {
    let shares = readable(shares, "shares")?;
    let shares: &[f32] = numbers(&shares)?;
    let gradient = colorgrad::preset::viridis();
    let color = |share: &f32| {
        if share.is_nan() {
            return NOTHING;
        }
        let [red, green, blue, _] = gradient.at(*share).to_rgba8();
        [red, green, blue]
    };
    let colors: Vec<u8> = py.detach(|| shares.iter().flat_map(color).collect());
    PyArray1::from_vec(py, colors).reshape([shares.len(), 3])
}
