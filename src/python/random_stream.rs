//! The Python class `RandomStream`.

use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyInt, PyTuple};

use super::arrays::type_name;
use super::{Recipe, recipe, stream_number, whole_number};
use crate::fork::Lock;

/// A seed that counts what has been drawn with it, so that no two calls draw the same noise.
///
/// It can be passed as `seed=` wherever a function takes a seed and an index. Each call then takes as many indices as it
/// draws scans, poses or steps, and the next call continues after them. The results are the same bytes as with `seed=` and
/// `first_index=` written out. Threads may share it: each call takes indices of its own, in the order of the calls.
///
/// Args:
///     seed: The seed, 0 to 2**64 - 1.
///     next_index: Index of the first draw, 0 to 2**64 - 1.
///
/// Raises:
///     ValueError: A number is out of range.
///     TypeError: A number is not an integer.
///
/// Examples:
///     Two batches of noisy scans, each with noise of its own:
///
///     >>> import numpy as np
///     >>> import mobile_robot_simulator as mrs
///     >>> grid = mrs.OccupancyGrid(np.array([[0, 0, 100]], np.int8), resolution=1.0)
///     >>> laser, noise, stream = mrs.LaserScanner(beam_count=1), mrs.BeamModel(), mrs.RandomStream(7)
///     >>> poses = [(0.5, 0.5, 0.0), (1.5, 0.5, 0.0)]
///     >>> first = laser.scan_batch(grid, poses, noise=noise, seed=stream)
///     >>> second = laser.scan_batch(grid, poses, noise=noise, seed=stream)
///     >>> stream, bool((first != second).all())
///     (RandomStream(7, next_index=4), True)
#[pyclass(frozen, module = "mobile_robot_simulator")]
pub struct RandomStream {
    seed: u64,
    next_index: Lock<u64>,
}

#[pymethods]
impl RandomStream {
    #[new]
    #[pyo3(signature = (seed, *, next_index = None), text_signature = "(seed, *, next_index=0)")]
    fn new(seed: &Bound<'_, PyAny>, next_index: Option<&Bound<'_, PyAny>>) -> PyResult<Self> {
        let next_index = stream_number("next_index", next_index)?;
        Ok(Self { seed: stream_number("seed", Some(seed))?, next_index: Lock::new(next_index) })
    }

    /// The seed.
    #[getter]
    fn seed(&self) -> u64 {
        self.seed
    }

    /// Index of the next draw.
    #[getter]
    fn next_index(&self) -> u64 {
        *self.next_index.lock()
    }

    /// Takes indices for draws of your own.
    ///
    /// Args:
    ///     count: Number of indices, at least 0.
    ///
    /// Returns:
    ///     The first of the indices taken. `next_index` grows by `count`.
    ///
    /// Raises:
    ///     ValueError: The count is negative, or fewer than `count` indices are left.
    ///
    /// Examples:
    ///     >>> import mobile_robot_simulator as mrs
    ///     >>> stream = mrs.RandomStream(7)
    ///     >>> stream.take(10), stream.take(5), stream.next_index
    ///     (0, 10, 15)
    fn take(&self, count: &Bound<'_, PyAny>) -> PyResult<u64> {
        self.reserve(whole_number("count", count, "at least 0")?)
    }

    fn __repr__(&self) -> String {
        format!("RandomStream({}, next_index={})", self.seed, self.next_index())
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Recipe<'py>> {
        let keywords = PyDict::new(py);
        keywords.set_item("next_index", self.next_index())?;
        recipe::<Self>(py, PyTuple::new(py, [self.seed])?, keywords)
    }
}

impl RandomStream {
    fn reserve(&self, count: u64) -> PyResult<u64> {
        let mut next_index = self.next_index.lock();
        let first = *next_index;
        *next_index = first.checked_add(count).ok_or_else(|| {
            PyValueError::new_err(format!("the random stream must have {count} indices left, got {}", u64::MAX - first))
        })?;
        Ok(first)
    }
}

/// A `seed=` argument: a number, or a [`RandomStream`].
pub struct SeedArgument<'py> {
    seed: Option<Bound<'py, PyAny>>,
    /// Name and value of the argument that goes with a number.
    index: (&'static str, Option<Bound<'py, PyAny>>),
}

impl<'py> SeedArgument<'py> {
    /// Returns the arguments `seed=` and, by its name, `first_index=` or `index=`.
    pub fn new(seed: Option<&Bound<'py, PyAny>>, name: &'static str, index: Option<&Bound<'py, PyAny>>) -> PyResult<Self> {
        let argument = Self { seed: seed.cloned(), index: (name, index.cloned()) };
        if argument.stream().is_some() {
            if index.is_some() {
                let message = format!("{name} must not be given with a RandomStream, which has it already");
                return Err(PyValueError::new_err(message));
            }
        } else {
            if let Some(seed) = seed
                && !seed.is_exact_instance_of::<PyInt>()
                && seed.call_method0("__index__").is_err()
            {
                let message = format!("seed must be an integer or a RandomStream, got {}", type_name(seed));
                return Err(PyTypeError::new_err(message));
            }
            stream_number("seed", seed)?;
            stream_number(name, index)?;
        }
        Ok(argument)
    }

    /// Returns true if there is no seed.
    pub fn is_none(&self) -> bool {
        self.seed.is_none()
    }

    /// Returns true if an index is given, or the seed counts for itself.
    pub fn has_index(&self) -> bool {
        self.stream().is_some() || self.index.1.is_some()
    }

    /// Returns the seed and the first index of `count` draws. A [`RandomStream`] then goes on after them.
    pub fn take(&self, count: usize) -> PyResult<(u64, u64)> {
        if let Some(stream) = self.stream() {
            return Ok((stream.seed, stream.reserve(count as u64)?));
        }
        Ok((stream_number("seed", self.seed.as_ref())?, stream_number(self.index.0, self.index.1.as_ref())?))
    }

    fn stream(&self) -> Option<&RandomStream> {
        self.seed.as_ref()?.cast::<RandomStream>().ok().map(Bound::get)
    }
}
