//! Commands for the robots of a fleet, as arrays of NumPy.

use numpy::PyUntypedArrayMethods;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::python::arrays::{Rows, pairs_of, rows, rows_of_rows, shape, typed};
use crate::{DriveCommands, Fleet};

/// Name of what is read from an array, in an error.
const WHAT: &str = "the commands of a fleet";

/// Velocities `(vx, vy, wz)`, or speeds and steering angles.
pub enum Commands<'py> {
    Twists(Rows<'py>),
    Steered(Vec<[f64; 2]>),
}

impl<'py> Commands<'py> {
    /// Returns the commands of an array of shape `(count, 3)`, or `(count, 2)` for robots with an Ackermann drive.
    pub fn of_robots(value: &Bound<'py, PyAny>, fleet: &Fleet) -> PyResult<Self> {
        let (array, count, steers) = (typed::<f64>("commands", value)?, fleet.len(), fleet.steers());
        match *array.shape() {
            [rows, 2] if rows == count && steers => pairs_of(WHAT, &array).map(Self::Steered),
            [given, 3] if given == count => rows("commands", array.as_any(), None).map(Self::Twists),
            [given, 2] if given == count => Err(crate::Error::Steered.into()),
            _ => {
                let needed = [3, 2].map(|width| shape(&[count, width]));
                Err(wrong_shape(&needed[..=usize::from(steers)], array.shape()))
            }
        }
    }

    /// Returns the commands of an array of shape `(K, T, 3)`, or `(K, T, 2)` for an Ackermann drive, with K and T.
    pub fn of_rollouts(value: &Bound<'py, PyAny>, fleet: &Fleet) -> PyResult<(Self, [usize; 2])> {
        let (array, steers) = (typed::<f64>("commands", value)?, fleet.steers());
        match *array.shape() {
            [count, steps, 2] if steers => Ok((Self::Steered(pairs_of(WHAT, &array)?), [count, steps])),
            [_, _, 2] => Err(crate::Error::Steered.into()),
            [_, _, 3] => {
                let (rows, dimensions) = rows_of_rows("commands", array.as_any())?;
                Ok((Self::Twists(rows), dimensions))
            }
            _ => {
                let needed = ["(K, T, 3)", "(K, T, 2)"].map(str::to_owned);
                Err(wrong_shape(&needed[..=usize::from(steers)], array.shape()))
            }
        }
    }

    /// Returns the commands for the core.
    pub fn of_core(&self) -> DriveCommands<'_> {
        match self {
            Self::Twists(rows) => DriveCommands::Twists(rows),
            Self::Steered(rows) => DriveCommands::Steered(rows),
        }
    }
}

/// Returns the error for commands of a wrong shape.
fn wrong_shape(needed: &[String], got: &[usize]) -> PyErr {
    PyValueError::new_err(format!("commands must have shape {}, got {}", needed.join(" or "), shape(got)))
}
