//! Conversion of NumPy arrays to core values, with errors that say what was needed and what was given.

use std::ops::Deref;

use numpy::{
    Element, IntoPyArray, PyArray1, PyArrayDescrMethods, PyArrayMethods, PyReadonlyArrayDyn, PyUntypedArray,
    PyUntypedArrayMethods, dtype,
};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::PyTuple;

use crate::Error;

/// A batch `(N, 3)` of `float64`: the caller's array, or a copy if the array is not in C order.
pub enum Rows<'py> {
    Borrowed(PyReadonlyArrayDyn<'py, f64>),
    Copied(Vec<[f64; 3]>),
}

impl Deref for Rows<'_> {
    type Target = [[f64; 3]];

    fn deref(&self) -> &[[f64; 3]] {
        match self {
            Self::Borrowed(array) => array.as_slice().expect("in C order").as_chunks().0,
            Self::Copied(rows) => rows,
        }
    }
}

/// Returns a batch from a `float64` array of shape `(N, 3)`.
pub fn rows<'py>(name: &str, array: &Bound<'py, PyAny>) -> PyResult<Rows<'py>> {
    let array = typed::<f64>(name, array)?;
    let view = array.as_array();
    let [_, 3] = *view.shape() else {
        return Err(PyValueError::new_err(format!("{name} must have shape (N, 3), got {}", shape(view.shape()))));
    };
    if array.is_c_contiguous() {
        return Ok(Rows::Borrowed(array));
    }
    Ok(Rows::Copied(view.rows().into_iter().map(|row| [row[0], row[1], row[2]]).collect()))
}

/// Returns the rows of a `float64` array of shape `(3, 3)`.
pub fn matrix(name: &str, array: &Bound<'_, PyAny>) -> PyResult<[[f64; 3]; 3]> {
    let array = typed::<f64>(name, array)?;
    let rows = array.as_array();
    if rows.shape() != [3, 3] {
        return Err(PyValueError::new_err(format!("{name} must have shape (3, 3), got {}", shape(rows.shape()))));
    }
    Ok([0, 1, 2].map(|row| [0, 1, 2].map(|col| rows[[row, col]])))
}

/// Returns points from an array of shape `(N, 2)` or a sequence of number pairs.
pub fn points(name: &str, value: &Bound<'_, PyAny>) -> PyResult<Vec<[f64; 2]>> {
    if let Ok(array) = value.cast::<PyUntypedArray>()
        && !matches!(array.shape(), [_, 2])
    {
        return Err(PyValueError::new_err(format!("{name} must have shape (N, 2), got {}", shape(array.shape()))));
    }
    let needed =
        |_| PyTypeError::new_err(format!("{name} must be an (N, 2) array or number pairs, got {}", type_name(value)));
    value.extract().map_err(needed)
}

/// Returns a view of an array with element type `T`. An array that is not aligned is copied.
pub fn typed<'py, T: Element>(name: &str, array: &Bound<'py, PyAny>) -> PyResult<PyReadonlyArrayDyn<'py, T>> {
    let array = check_dtype::<T>(name, array)?;
    if is_aligned(array)? { array.extract() } else { array.call_method0("copy")?.extract() }
}

/// Runs `work` on an array of the given shape and returns the array: `out`, or a new one if `out` is `None`.
pub fn fill<'py, T: Element>(
    py: Python<'py>,
    out: Option<Bound<'py, PyAny>>,
    dimensions: &[usize],
    work: impl FnOnce(&mut [T]) -> Result<(), Error> + Send,
) -> PyResult<Bound<'py, PyAny>> {
    // NumPy raises MemoryError if memory runs out, and uses huge pages for large arrays.
    static ZEROS: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
    let new = || ZEROS.import(py, "numpy", "zeros")?.call1((PyTuple::new(py, dimensions)?, dtype::<T>(py)));
    let out = out.map_or_else(new, Ok)?;
    let array = check_dtype::<T>("out", &out)?;
    if array.shape() != dimensions {
        let (needed, got) = (shape(dimensions), shape(array.shape()));
        return Err(PyValueError::new_err(format!("out must have shape {needed}, got {got}")));
    }
    if !array.is_c_contiguous() {
        return Err(PyValueError::new_err("out must be in C order, got an array that is not C-contiguous"));
    }
    if !is_aligned(array)? {
        return Err(PyValueError::new_err("out must be aligned, got an array that is not"));
    }
    let mut array = out
        .cast::<numpy::PyArrayDyn<T>>()?
        .try_readwrite()
        .map_err(|_| PyValueError::new_err("out must be writeable, got a read-only array or one that is already in use"))?;
    let elements = array.as_slice_mut()?;
    py.detach(|| work(elements))?;
    Ok(out)
}

/// Returns true if all elements are aligned in memory. Fields of packed records are not.
fn is_aligned(array: &Bound<'_, PyUntypedArray>) -> PyResult<bool> {
    array.getattr("flags")?.getattr("aligned")?.extract()
}

/// Returns a new one-dimensional array.
pub fn vector<T: Element>(py: Python<'_>, elements: Vec<T>) -> Bound<'_, PyArray1<T>> {
    elements.into_pyarray(py)
}

/// Formats the shape of an array as a Python tuple.
pub fn shape(shape: &[usize]) -> String {
    let sizes: Vec<String> = shape.iter().map(ToString::to_string).collect();
    if let [size] = &sizes[..] { format!("({size},)") } else { format!("({})", sizes.join(", ")) }
}

/// Returns the name of a value's type.
pub fn type_name(value: &Bound<'_, PyAny>) -> String {
    value.get_type().name().map_or_else(|_| "another type".to_owned(), |name| name.to_string())
}

/// Checks that a value is an array with element type `T`.
fn check_dtype<'a, 'py, T: Element>(name: &str, array: &'a Bound<'py, PyAny>) -> PyResult<&'a Bound<'py, PyUntypedArray>> {
    let needed = dtype::<T>(array.py());
    let Ok(array) = array.cast::<PyUntypedArray>() else {
        return Err(PyTypeError::new_err(format!("{name} must be a NumPy array of {needed}, got {}", type_name(array))));
    };
    if !array.dtype().is_equiv_to(&needed) {
        return Err(PyTypeError::new_err(format!("{name} must have dtype {needed}, got {}", array.dtype())));
    }
    Ok(array)
}
