//! NumPy arrays as slices of Rust, in place.
//!
//! The borrows are those of the crate `numpy`: an array that one call writes cannot be read or
//! written by another at the same time, which is an exception there. What Python does to an array
//! by itself while a call runs is not watched; the worst that comes of it is a wrong hit.

use numpy::ndarray::Dimension;
use numpy::{
    BorrowError, Element, PyArray, PyArrayMethods, PyReadonlyArray, PyReadonlyArray1,
    PyReadonlyArray2, PyReadwriteArray, PyReadwriteArray1, PyReadwriteArray2,
    PyUntypedArrayMethods,
};
use pyo3::prelude::*;

use crate::errors::Failure;

/// An array to be read.
pub(crate) fn readable<'py, T: Element, D: Dimension>(
    array: &Bound<'py, PyAny>,
    name: &str,
) -> PyResult<PyReadonlyArray<'py, T, D>> {
    let array = array.cast::<PyArray<T, D>>()?;
    Ok(array.try_readonly().map_err(|error| not_free(name, &error))?)
}

/// An array to be written.
pub(crate) fn writable<'py, T: Element, D: Dimension>(
    array: &Bound<'py, PyAny>,
    name: &str,
) -> PyResult<PyReadwriteArray<'py, T, D>> {
    let array = array.cast::<PyArray<T, D>>()?;
    Ok(array.try_readwrite().map_err(|error| not_free(name, &error))?)
}

fn not_free(name: &str, error: &BorrowError) -> Failure {
    Failure::value(match error {
        BorrowError::NotWriteable => format!("{name} is read-only: it cannot be written"),
        _ => format!(
            "{name} shares memory with an array that is written at the same time, by this call or \
             by another thread: give each its own"
        ),
    })
}

/// The values of an array.
pub(crate) fn numbers<'a, T: Element>(
    array: &'a PyReadonlyArray1<'_, T>,
) -> Result<&'a [T], Failure> {
    array.as_slice().map_err(|_| not_contiguous())
}

/// The values of an array, to be written.
pub(crate) fn numbers_mut<'a, T: Element>(
    array: &'a mut PyReadwriteArray1<'_, T>,
) -> Result<&'a mut [T], Failure> {
    array.as_slice_mut().map_err(|_| not_contiguous())
}

/// The rows of an array of `N` columns.
pub(crate) fn rows<'a, T: Element, const N: usize>(
    array: &'a PyReadonlyArray2<'_, T>,
) -> Result<&'a [[T; N]], Failure> {
    check_rows(array.shape(), array.is_c_contiguous(), N)?;
    Ok(array.as_slice().map_err(|_| not_contiguous())?.as_chunks().0)
}

/// The rows of an array of `N` columns, to be written.
pub(crate) fn rows_mut<'a, T: Element, const N: usize>(
    array: &'a mut PyReadwriteArray2<'_, T>,
) -> Result<&'a mut [[T; N]], Failure> {
    check_rows(array.shape(), array.is_c_contiguous(), N)?;
    Ok(array.as_slice_mut().map_err(|_| not_contiguous())?.as_chunks_mut().0)
}

fn check_rows(shape: &[usize], is_c_contiguous: bool, columns: usize) -> Result<(), Failure> {
    match shape {
        [_, found] if *found == columns && is_c_contiguous => Ok(()),
        [_, found] if *found == columns => Err(not_contiguous()),
        _ => Err(Failure::value(format!(
            "expected an array of shape (n, {columns}), found {shape:?}"
        ))),
    }
}

fn not_contiguous() -> Failure {
    Failure::value("expected an aligned, C-contiguous array: numpy.ascontiguousarray makes one")
}
