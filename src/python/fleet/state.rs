//! The Python class `FleetState`.

use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use crate::memory;
use crate::python::arrays::{fill, typed};
use crate::python::{Recipe, recipe};

/// The state of some robots of a `Fleet`, as `Fleet.save` returns it.
///
/// Args:
///     words: (M, K) uint64, the words of an earlier state.
///
/// Raises:
///     ValueError: The words are not those of a state.
///     TypeError: The words are no array of integers.
///
/// Examples:
///     >>> import numpy as np
///     >>> import mobile_robot_simulator as mrs
///     >>> grid = mrs.OccupancyGrid(np.zeros((9, 9), np.int8), resolution=1.0)
///     >>> mrs.Fleet(grid, [(1.0, 1.0, 0.0), (2.0, 2.0, 0.0)]).save([False, True]).robots
///     array([1])
#[pyclass(frozen, module = "mobile_robot_simulator")]
pub struct FleetState(pub(super) crate::FleetState);

#[pymethods]
impl FleetState {
    #[new]
    fn new(words: &Bound<'_, PyAny>) -> PyResult<Self> {
        let words = typed::<u64>("words", words)?;
        let words = memory::collected("the words", words.as_array().iter().copied())?;
        Ok(Self(crate::FleetState::from_words(&words)?))
    }

    /// The state as words, to store it: (M, K) uint64. Their meaning can change with the version of this package.
    #[getter]
    fn words<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let (words, count) = (self.0.to_words(), self.0.robots().len());
        fill(py, None, &[count, words.len().checked_div(count).unwrap_or(0)], |numbers: &mut [u64]| {
            numbers.copy_from_slice(&words);
            Ok(())
        })
    }

    /// Indices of the saved robots in their fleet: (M,) int64.
    #[getter]
    fn robots<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let robots = self.0.robots();
        fill(py, None, &[robots.len()], |numbers: &mut [i64]| {
            numbers.iter_mut().zip(robots).for_each(|(number, &robot)| *number = robot as i64);
            Ok(())
        })
    }

    fn __len__(&self) -> usize {
        self.0.robots().len()
    }

    fn __repr__(&self) -> String {
        format!("FleetState({} robots)", self.__len__())
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Recipe<'py>> {
        recipe::<Self>(py, PyTuple::new(py, [self.words(py)?])?, PyDict::new(py))
    }
}
