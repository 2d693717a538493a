//! Conversion of NumPy arrays to core values, with errors that say what was needed and what was given.

use std::ops::Deref;

use numpy::{
    Element, IntoPyArray, PyArray1, PyArrayDescrMethods, PyArrayMethods, PyReadonlyArrayDyn, PyReadwriteArrayDyn,
    PyUntypedArray, PyUntypedArrayMethods, dtype,
};
use pyo3::exceptions::{PyMemoryError, PyTypeError, PyValueError};
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::PyTuple;

use crate::{Error, memory};

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

/// Number of rows up to which a batch is copied, so that it may change during the call.
const MAX_COPIED: usize = 5_000;

/// Name of what is read from an array, in an error.
const WHAT: &str = "the rows of an array";

/// Returns a batch of shape `(N, 3)` from anything that NumPy converts to `float64` without loss.
///
/// A large batch in C order is read in place. Any other is copied, also one that may share memory with `out`.
pub fn rows<'py>(name: &str, value: &Bound<'py, PyAny>, out: Option<&Bound<'py, PyAny>>) -> PyResult<Rows<'py>> {
    let array = typed::<f64>(name, value)?;
    let [_, 3] = *array.shape() else {
        return Err(PyValueError::new_err(format!("{name} must have shape (N, 3), got {}", shape(array.shape()))));
    };
    rows_of(array, out)
}

/// Returns a batch of shape `(N, 3)`, or `(N, beam_count, 3)`; true if it has this second shape, whose rows follow each other.
pub fn rows_or_beam_rows<'py>(
    name: &str,
    value: &Bound<'py, PyAny>,
    beam_count: usize,
    out: Option<&Bound<'py, PyAny>>,
) -> PyResult<(Rows<'py>, bool)> {
    let array = typed::<f64>(name, value)?;
    let has_beams = array.ndim() == 3;
    let is_good = match *array.shape() {
        [_, 3] => true,
        [_, beams, 3] => beams == beam_count,
        _ => false,
    };
    if !is_good {
        let needed = if has_beams {
            format!(" for each beam must have shape (N, {beam_count}, 3)")
        } else {
            " must have shape (N, 3)".into()
        };
        return Err(PyValueError::new_err(format!("{name}{needed}, got {}", shape(array.shape()))));
    }
    Ok((rows_of(array, out)?, has_beams))
}

/// Returns the rows of an array whose last dimension is 3.
fn rows_of<'py>(array: PyReadonlyArrayDyn<'py, f64>, out: Option<&Bound<'py, PyAny>>) -> PyResult<Rows<'py>> {
    let count = array.len() / 3;
    if count > MAX_COPIED && array.is_c_contiguous() && !may_overlap(array.as_any(), out)? {
        return Ok(Rows::Borrowed(array));
    }
    let view = array.as_array();
    let rows = match view.as_slice() {
        Some(numbers) => memory::collected(WHAT, numbers.as_chunks().0.iter().copied())?,
        None => memory::collected(WHAT, view.rows().into_iter().map(|row| [row[0], row[1], row[2]]))?,
    };
    Ok(Rows::Copied(rows))
}

/// Returns the rows of an array of shape `(K, T, 3)`, one after another, and K and T.
pub fn rows_of_rows<'py>(name: &str, value: &Bound<'py, PyAny>) -> PyResult<(Rows<'py>, [usize; 2])> {
    let array = typed::<f64>(name, value)?;
    let [count, length, 3] = *array.shape() else {
        return Err(PyValueError::new_err(format!("{name} must have shape (K, T, 3), got {}", shape(array.shape()))));
    };
    Ok((rows_of(array, None)?, [count, length]))
}

/// Returns the rows of an array of shape `(K, 4)`.
pub fn waypoints(name: &str, value: &Bound<'_, PyAny>) -> PyResult<Vec<[f64; 4]>> {
    let array = typed::<f64>(name, value)?;
    let [_, 4] = *array.shape() else {
        return Err(PyValueError::new_err(format!("{name} must have shape (K, 4), got {}", shape(array.shape()))));
    };
    Ok(memory::collected(WHAT, array.as_array().rows().into_iter().map(|row| [row[0], row[1], row[2], row[3]]))?)
}

/// Returns the elements of an array of shape `(count,)`.
pub fn elements<T: Element + Copy>(name: &str, value: &Bound<'_, PyAny>, count: Option<usize>) -> PyResult<Vec<T>> {
    let array = typed::<T>(name, value)?;
    if array.ndim() != 1 || count.is_some_and(|count| array.len() != count) {
        let needed = count.map_or_else(|| "(N,)".to_owned(), |count| shape(&[count]));
        return Err(PyValueError::new_err(format!("{name} must have shape {needed}, got {}", shape(array.shape()))));
    }
    let view = array.as_array();
    Ok(match view.as_slice() {
        Some(elements) => memory::collected(WHAT, elements.iter().copied())?,
        None => memory::collected(WHAT, view.iter().copied())?,
    })
}

/// Returns the rows of an array of shape `(count, 2)`.
pub fn pairs(name: &str, value: &Bound<'_, PyAny>, count: Option<usize>) -> PyResult<Vec<[f64; 2]>> {
    let array = typed::<f64>(name, value)?;
    if !matches!(*array.shape(), [rows, 2] if count.is_none_or(|count| rows == count)) {
        let rows = count.map_or_else(|| "N".to_owned(), |count| count.to_string());
        return Err(PyValueError::new_err(format!("{name} must have shape ({rows}, 2), got {}", shape(array.shape()))));
    }
    pairs_of(WHAT, &array)
}

/// Returns the rows of an array whose last dimension is 2.
pub fn pairs_of(what: &'static str, array: &PyReadonlyArrayDyn<'_, f64>) -> PyResult<Vec<[f64; 2]>> {
    let view = array.as_array();
    Ok(match view.as_slice() {
        Some(numbers) => memory::collected(what, numbers.as_chunks().0.iter().copied())?,
        None => memory::collected(what, view.rows().into_iter().map(|row| [row[0], row[1]]))?,
    })
}

/// Returns the numbers of an array of integers of shape `(count,)`, none of them negative.
pub fn whole_numbers(name: &str, value: &Bound<'_, PyAny>, count: Option<usize>) -> PyResult<Vec<u64>> {
    let array = base_array(name, value)?;
    if array.dtype().kind() == b'u' {
        return elements(name, array.as_any(), count);
    }
    let numbers = elements::<i64>(name, array.as_any(), count)?;
    if let Some((row, number)) = numbers.iter().enumerate().find(|(_, number)| **number < 0) {
        return Err(PyValueError::new_err(format!("{name} must be at least 0, got {number} in row {row}")));
    }
    Ok(numbers.into_iter().map(i64::unsigned_abs).collect())
}

/// Returns the numbers of an array of shape `(N,)`.
pub fn numbers(name: &str, value: &Bound<'_, PyAny>) -> PyResult<Vec<f64>> {
    elements(name, value, None)
}

fn may_overlap<'py>(array: &Bound<'py, PyAny>, out: Option<&Bound<'py, PyAny>>) -> PyResult<bool> {
    out.map_or(Ok(false), |out| numpy(array.py())?.call_method1("may_share_memory", (array, out))?.extract())
}

fn numpy(py: Python<'_>) -> PyResult<Bound<'_, PyModule>> {
    static NUMPY: PyOnceLock<Py<PyModule>> = PyOnceLock::new();
    NUMPY.get_or_try_init(py, || Ok(py.import("numpy")?.unbind())).map(|module| module.bind(py).clone())
}

/// Returns the rows of an array of shape `(3, 3)`.
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
    // Not extracted as a vector, which would trust a length that the object only claims to have.
    let pairs = value.len().and_then(|_| value.try_iter()).map_err(needed)?;
    let mut points = Vec::new();
    for pair in pairs {
        memory::push("the points", &mut points, pair.and_then(|pair| pair.extract()).map_err(needed)?)?;
    }
    Ok(points)
}

/// Largest number of dimensions that arrays can have here. NumPy allows 64.
const MAX_DIMENSIONS: usize = 32;

/// Returns a view of an array with element type `T`, from anything that NumPy converts to it without loss.
pub fn typed<'py, T: Element>(name: &str, value: &Bound<'py, PyAny>) -> PyResult<PyReadonlyArrayDyn<'py, T>> {
    let (py, needed) = (value.py(), dtype::<T>(value.py()));
    let array = base_array(name, value)?;
    if array.ndim() > MAX_DIMENSIONS {
        let message = format!("{name} must have at most {MAX_DIMENSIONS} dimensions, got {}", array.ndim());
        return Err(PyTypeError::new_err(message));
    }
    if !array.dtype().is_equiv_to(&needed) {
        // A boolean is no number, although NumPy would take it for 0 or 1.
        let can_cast = || numpy(py)?.call_method1("can_cast", (array.dtype(), &needed, "safe"))?.extract::<bool>();
        if array.dtype().kind() == b'b' || !can_cast()? {
            let hint =
                if array.dtype().kind() == b'f' { format!("; convert it with .astype(np.{needed})") } else { String::new() };
            let got = array.dtype();
            return Err(PyTypeError::new_err(format!("{name} must have dtype {needed}, got {got}{hint}")));
        }
        return array.call_method1("astype", (needed,))?.extract();
    }
    Ok(if is_aligned(&array)? { array.extract()? } else { array.call_method0("copy")?.extract()? })
}

/// Returns the value as an array of NumPy's own class: a view of an array, or a new array from a sequence or any object that
/// offers `__array__` or DLPack.
///
/// The methods of a derived class are not called.
fn base_array<'py>(name: &str, value: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyUntypedArray>> {
    let needed = |problem: &str| PyTypeError::new_err(format!("{name} must be an array of numbers, got {problem}"));
    if let Ok(array) = value.cast_exact::<PyUntypedArray>()
        && array.dtype().kind() != b'O'
    {
        return Ok(array.clone());
    }
    let numpy = numpy(value.py())?;
    let array = if value.hasattr("__dlpack__")? && !value.hasattr("__array__")? {
        numpy.call_method1("from_dlpack", (value,))
    } else {
        numpy.call_method1("asarray", (value,))
    };
    let array = array.map_err(|error| {
        if error.is_instance_of::<PyMemoryError>(value.py()) {
            return error;
        }
        // NumPy raises ValueError for rows of different lengths.
        if error.is_instance_of::<PyValueError>(value.py()) {
            PyValueError::new_err(format!("{name} must have rows of equal length, got {}", type_name(value)))
        } else {
            needed(&type_name(value))
        }
    })?;
    let array = array.cast_into::<PyUntypedArray>().map_err(|_| needed(&type_name(value)))?;
    // NumPy makes an array of objects of what it cannot convert.
    if array.dtype().kind() == b'O' { Err(needed(&type_name(value))) } else { Ok(array) }
}

/// Returns views of two named arrays, broadcast against each other.
pub fn broadcast<'py, T: Element, const N: usize>(
    arrays: [(&str, PyReadonlyArrayDyn<'py, T>); N],
) -> PyResult<[PyReadonlyArrayDyn<'py, T>; N]> {
    let [(_, first), rest @ ..] = &arrays[..] else { return Ok(arrays.map(|(_, array)| array)) };
    if rest.iter().all(|(_, array)| array.shape() == first.shape()) {
        return Ok(arrays.map(|(_, array)| array));
    }
    let given = PyTuple::new(first.py(), arrays.iter().map(|(_, array)| array.as_any()))?;
    let all = numpy(first.py())?.call_method1("broadcast_arrays", given).map_err(|_| {
        let names = arrays.each_ref().map(|(name, _)| *name).join(" and ");
        let shapes = arrays.each_ref().map(|(_, array)| shape(array.shape())).join(" and ");
        PyValueError::new_err(format!("{names} must have shapes that broadcast, got {shapes}"))
    })?;
    let mut broadcast = arrays.map(|(_, array)| array);
    for (index, array) in broadcast.iter_mut().enumerate() {
        *array = all.get_item(index)?.extract()?;
    }
    Ok(broadcast)
}

/// Checks that `out`, if it is given, can take a result of this shape.
pub fn check_out<T: Element>(out: Option<&Bound<'_, PyAny>>, dimensions: &[usize]) -> PyResult<()> {
    out.map_or(Ok(()), |out| check_array::<T>("out", out, dimensions))
}

/// Checks that a value is an array that can take a result of this shape.
pub fn check_array<T: Element>(name: &str, value: &Bound<'_, PyAny>, dimensions: &[usize]) -> PyResult<()> {
    let needed = dtype::<T>(value.py());
    if value.cast::<PyUntypedArray>().is_err() {
        return Err(PyTypeError::new_err(format!("{name} must be a NumPy array of {needed}, got {}", type_name(value))));
    }
    let array = base_array(name, value)?;
    if !array.dtype().is_equiv_to(&needed) {
        return Err(PyTypeError::new_err(format!("{name} must have dtype {needed}, got {}", array.dtype())));
    }
    if array.shape() != dimensions {
        let (needed, got) = (shape(dimensions), shape(array.shape()));
        return Err(PyValueError::new_err(format!("{name} must have shape {needed}, got {got}")));
    }
    if !array.is_c_contiguous() {
        return Err(PyValueError::new_err(format!("{name} must be in C order, got an array that is not C-contiguous")));
    }
    if !is_aligned(&array)? {
        return Err(PyValueError::new_err(format!("{name} must be aligned, got an array that is not")));
    }
    Ok(())
}

/// Returns the length of one dimension of an array; 0 if the value has no such dimension.
pub fn length(value: &Bound<'_, PyAny>, dimension: usize) -> usize {
    value.cast::<PyUntypedArray>().ok().and_then(|array| array.shape().get(dimension).copied()).unwrap_or(0)
}

/// Returns a new array of zeros.
pub fn zeros<'py, T: Element>(py: Python<'py>, dimensions: &[usize]) -> PyResult<Bound<'py, PyAny>> {
    // NumPy raises MemoryError if memory runs out, and uses huge pages for large arrays.
    static ZEROS: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
    ZEROS.import(py, "numpy", "zeros")?.call1((PyTuple::new(py, dimensions)?, dtype::<T>(py)))
}

/// Returns the elements of `out`, to be written, after a check that it can take a result of this shape.
pub fn writable<'py, T: Element>(out: &Bound<'py, PyAny>, dimensions: &[usize]) -> PyResult<PyReadwriteArrayDyn<'py, T>> {
    check_out::<T>(Some(out), dimensions)?;
    let array = out.cast::<numpy::PyArrayDyn<T>>()?.try_readwrite();
    array.map_err(|_| PyValueError::new_err("out must be writeable, got a read-only array or one that is already in use"))
}

/// Runs `work` on an array of the given shape and returns the array: `out`, or a new one if `out` is `None`.
pub fn fill<'py, T: Element>(
    py: Python<'py>,
    out: Option<Bound<'py, PyAny>>,
    dimensions: &[usize],
    work: impl FnOnce(&mut [T]) -> Result<(), Error> + Send,
) -> PyResult<Bound<'py, PyAny>> {
    let (out, mut array) = if let Some(out) = out {
        let array = writable(&out, dimensions)?;
        (out, array)
    } else {
        // A new array needs no checks.
        let out = zeros::<T>(py, dimensions)?;
        let array = out.cast::<numpy::PyArrayDyn<T>>()?.readwrite();
        (out, array)
    };
    let elements = array.as_slice_mut()?;
    py.detach(|| work(elements))?;
    Ok(out)
}

/// Returns true if all elements are aligned in memory. Fields of packed records are not.
fn is_aligned(array: &Bound<'_, PyUntypedArray>) -> PyResult<bool> {
    array.getattr(intern!(array.py(), "flags"))?.getattr(intern!(array.py(), "aligned"))?.extract()
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

/// Returns the `repr` of a value, cut to a length that can be read. Large containers and numbers are cut while it is made.
pub fn short_repr(value: &Bound<'_, PyAny>) -> String {
    let repr = || -> PyResult<String> { value.py().import("reprlib")?.call_method1("repr", (value,))?.extract() };
    repr().unwrap_or_else(|_| type_name(value))
}

/// Returns the name of a value's type.
pub fn type_name(value: &Bound<'_, PyAny>) -> String {
    value.get_type().name().map_or_else(|_| "another type".to_owned(), |name| name.to_string())
}
