//! Conversion of arguments that are numbers, with errors that name the argument.

use pyo3::exceptions::{PyOverflowError, PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyString};

use super::arrays::short_repr;

/// A number, or a fixed count of numbers.
pub trait Numbers: for<'py> FromPyObjectOwned<'py, Error = PyErr> {
    /// What an argument of this type must be, for error messages.
    const NEEDED: &'static str;
}

impl Numbers for f64 {
    const NEEDED: &'static str = "a number";
}

impl Numbers for [f64; 2] {
    const NEEDED: &'static str = "two numbers";
}

impl Numbers for [f64; 3] {
    const NEEDED: &'static str = "three numbers";
}

impl Numbers for [f64; 5] {
    const NEEDED: &'static str = "five numbers";
}

/// What was given instead of numbers.
enum Refused {
    /// Something of another type.
    Type(String),
    /// Numbers of another count, or an integer that is too large for a float.
    Value(String),
}

/// An argument of numbers. PyO3 does not tell a conversion the name of its argument, so a wrong one is reported by `named`.
pub struct Argument<T>(Result<T, Refused>);

impl<T: Numbers> Argument<T> {
    /// Returns the numbers, or the error for an argument of this name.
    pub fn named(self, name: &str) -> PyResult<T> {
        self.0.map_err(|refused| match refused {
            Refused::Type(got) => PyTypeError::new_err(format!("{name} must be {}, got {got}", T::NEEDED)),
            Refused::Value(got) => PyValueError::new_err(format!("{name} must be {}, got {got}", T::NEEDED)),
        })
    }
}

/// For the defaults of arguments.
impl<T> From<T> for Argument<T> {
    fn from(numbers: T) -> Self {
        Self(Ok(numbers))
    }
}

impl<'py, T: Numbers> FromPyObject<'_, 'py> for Argument<T> {
    type Error = PyErr;

    fn extract(value: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        let py = value.py();
        // A boolean is no number, although Python would take it for 0 or 1.
        if value.is_instance_of::<PyBool>() {
            return Ok(Self(Err(Refused::Type(short_repr(&value)))));
        }
        match value.extract::<T>() {
            Ok(numbers) => Ok(Self(Ok(numbers))),
            // A text is a sequence too, and can have another length.
            Err(error) if error.is_instance_of::<PyTypeError>(py) || value.is_instance_of::<PyString>() => {
                Ok(Self(Err(Refused::Type(short_repr(&value)))))
            }
            Err(error) if error.is_instance_of::<PyValueError>(py) || error.is_instance_of::<PyOverflowError>(py) => {
                Ok(Self(Err(Refused::Value(short_repr(&value)))))
            }
            Err(error) => Err(error),
        }
    }
}
