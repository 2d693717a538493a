//! Commands for the robots of a fleet, as arrays of NumPy.

use numpy::{PyReadonlyArrayDyn, PyUntypedArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use super::arrays::{Rows, rows, rows_of_rows, shape, typed};
use crate::{DriveCommands, memory};

/// Name of what is read from an array, in an error.
const WHAT: &str = "the commands of a fleet";

/// Velocities `(vx, vy, wz)`, or speeds and steering angles.
pub enum Commands<'py> {
    Twists(Rows<'py>),
    Steered(Vec<[f64; 2]>),
}

impl<'py> Commands<'py> {
    /// Returns the commands of an array of shape `(count, 3)` or `(count, 2)`.
    pub fn of_robots(value: &Bound<'py, PyAny>, count: usize) -> PyResult<Self> {
        let array = typed::<f64>("commands", value)?;
        if array.ndim() == 2 && array.shape()[0] != count {
            let (needed, got) = (shape(&[count, array.shape()[1]]), shape(array.shape()));
            return Err(PyValueError::new_err(format!("commands must have shape {needed}, got {got}")));
        }
        match *array.shape() {
            [_, 2] => steered(&array).map(Self::Steered),
            _ => rows("commands", array.as_any(), None).map(Self::Twists),
        }
    }

    /// Returns the commands of an array of shape `(K, T, 3)` or `(K, T, 2)`, with K and T.
    pub fn of_rollouts(value: &Bound<'py, PyAny>) -> PyResult<(Self, [usize; 2])> {
        let array = typed::<f64>("commands", value)?;
        if let [count, steps, 2] = *array.shape() {
            return Ok((Self::Steered(steered(&array)?), [count, steps]));
        }
        let (rows, dimensions) = rows_of_rows("commands", array.as_any())?;
        Ok((Self::Twists(rows), dimensions))
    }

    /// Returns the commands for the core.
    pub fn of_core(&self) -> DriveCommands<'_> {
        match self {
            Self::Twists(rows) => DriveCommands::Twists(rows),
            Self::Steered(rows) => DriveCommands::Steered(rows),
        }
    }
}

/// Returns the rows of an array whose last dimension is 2.
fn steered(array: &PyReadonlyArrayDyn<'_, f64>) -> PyResult<Vec<[f64; 2]>> {
    Ok(memory::collected(WHAT, array.as_array().rows().into_iter().map(|row| [row[0], row[1]]))?)
}
