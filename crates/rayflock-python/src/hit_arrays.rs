//! Lists of hits as NumPy arrays.

use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rayflock::engine::HitList;

use crate::errors::Failure;

/// The columns of a list under the names of Open3D; `primitive_uvs` lies flat.
pub(crate) fn hit_arrays(py: Python<'_>, list: HitList) -> PyResult<Bound<'_, PyDict>> {
    let HitList { splits, ray_idx, hits } = list;
    let dict = PyDict::new(py);
    dict.set_item("ray_splits", PyArray1::from_vec(py, narrow(&splits)?))?;
    dict.set_item("ray_ids", PyArray1::from_vec(py, narrow(&ray_idx)?))?;
    dict.set_item("t_hit", PyArray1::from_vec(py, hits.t))?;
    dict.set_item("geometry_ids", PyArray1::from_vec(py, hits.object_id))?;
    dict.set_item("primitive_ids", PyArray1::from_vec(py, hits.prim_id))?;
    dict.set_item("primitive_uvs", PyArray1::from_vec(py, hits.uv.into_flattened()))?;
    Ok(dict)
}

fn narrow(places: &[usize]) -> Result<Vec<u32>, Failure> {
    let narrowed: Result<_, _> = places.iter().map(|&place| u32::try_from(place)).collect();
    narrowed.map_err(|_| Failure::value("there are 2^32 hits or more: ask fewer rays at once"))
}
