//! Hits as NumPy arrays, which are written in place.

use numpy::ndarray::Dimension;
use numpy::{Element, PyReadwriteArray, PyReadwriteArray1, PyReadwriteArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rayflock::engine::{HitColumns, hit_normals};
use rayflock::geom::{Geometry, Hits, NO_ID, RayBatch};

use crate::arrays::{numbers_mut, rows_mut, writable};
use crate::errors::Failure;

/// Where hits go; `None` for what nobody wants.
pub(crate) struct Answer<'py> {
    t_hit: Option<PyReadwriteArray1<'py, f32>>,
    geometry_ids: Option<PyReadwriteArray1<'py, u32>>,
    primitive_ids: Option<PyReadwriteArray1<'py, u32>>,
    primitive_uvs: Option<PyReadwriteArray2<'py, f32>>,
    /// Made of all of the ids.
    primitive_normals: Option<PyReadwriteArray2<'py, f32>>,
}

impl<'py> Answer<'py> {
    /// Takes the dictionary that Python hands over, which has an item for each field.
    pub(crate) fn new(given: &Bound<'py, PyDict>) -> PyResult<Self> {
        Ok(Self {
            t_hit: wanted(given, "t_hit")?,
            geometry_ids: wanted(given, "geometry_ids")?,
            primitive_ids: wanted(given, "primitive_ids")?,
            primitive_uvs: wanted(given, "primitive_uvs")?,
            primitive_normals: wanted(given, "primitive_normals")?,
        })
    }
}

/// The array of this name, unless it is `None`.
fn wanted<'py, T: Element, D: Dimension>(
    given: &Bound<'py, PyDict>,
    name: &str,
) -> PyResult<Option<PyReadwriteArray<'py, T, D>>> {
    let array = given.as_any().get_item(name)?;
    if array.is_none() { Ok(None) } else { writable(&array, name).map(Some) }
}

/// The arrays of an answer, one entry a ray.
pub(crate) struct Columns<'a> {
    pub(crate) hits: Hits<'a>,
    normals: Option<&'a mut [[f32; 3]]>,
}

impl Answer<'_> {
    /// The arrays, for so many rays.
    pub(crate) fn columns(&mut self, ray_count: usize) -> Result<Columns<'_>, Failure> {
        let t_hit = self.t_hit.as_mut().ok_or_else(|| Failure::value("t_hit must be there"))?;
        let hits = Hits {
            t: numbers_mut(t_hit)?,
            uv: self.primitive_uvs.as_mut().map(rows_mut).transpose()?,
            object_id: self.geometry_ids.as_mut().map(numbers_mut).transpose()?,
            prim_id: self.primitive_ids.as_mut().map(numbers_mut).transpose()?,
        };
        let normals: Option<&mut [[f32; 3]]> =
            self.primitive_normals.as_mut().map(rows_mut).transpose()?;
        if !hits.has_len(ray_count) || normals.as_ref().is_some_and(|n| n.len() != ray_count) {
            let message =
                format!("every array of hits must have {ray_count} rows, one for each ray");
            return Err(Failure::value(message));
        }
        Ok(Columns { hits, normals })
    }
}

impl Columns<'_> {
    /// Makes all hits misses, which engines then replace.
    pub(crate) fn clear(&mut self) {
        let Hits { t, uv, object_id, prim_id } = &mut self.hits;
        t.fill(f32::INFINITY);
        uv.iter_mut().for_each(|uv| uv.fill([0.0; 2]));
        [object_id, prim_id].into_iter().flatten().for_each(|ids| ids.fill(NO_ID));
    }

    /// Writes the normals, if they are wanted.
    pub(crate) fn write_normals(self, geometry: &Geometry, rays: &RayBatch<'_>) {
        let Self { hits, normals } = self;
        if let (Some(normals), Some(object_id), Some(prim_id)) =
            (normals, &hits.object_id, &hits.prim_id)
        {
            let columns = HitColumns { t: hits.t, object_id, prim_id };
            hit_normals(geometry, rays, columns, normals);
        }
    }
}
