//! The Python module `mobile_robot_simulator._core`: arrays in, the core's call without the GIL, arrays out.
#![allow(clippy::doc_markdown, reason = "documentation of classes and functions is Python's docstrings")]
#![allow(clippy::needless_pass_by_value, clippy::unused_self, reason = "the shapes that PyO3 calls")]

mod arrays;
mod beam_model;
mod contact;
mod grid;
mod limits;
mod motion;
mod motion_noise;
mod obstacles;
mod pose;
mod raycast;
mod scanner;
mod shape;

use pyo3::exceptions::{PyOSError, PyTypeError, PyValueError};
use pyo3::prelude::*;

use crate::Error;

impl From<Error> for PyErr {
    fn from(error: Error) -> Self {
        match error {
            Error::Threads { .. } => PyOSError::new_err(error.to_string()),
            _ => PyValueError::new_err(error.to_string()),
        }
    }
}

/// A Python integer as a Rust one; `needed` says which ones will do.
fn whole_number<'py, T: FromPyObjectOwned<'py>>(name: &str, value: &Bound<'py, PyAny>, needed: &str) -> PyResult<T> {
    let number = value
        .call_method0("__index__")
        .map_err(|_| PyTypeError::new_err(format!("{name} must be an integer, got {}", arrays::type_name(value))))?;
    number.extract().map_err(|_| PyValueError::new_err(format!("{name} must be {needed}, got {number}")))
}

fn stream_number(name: &str, value: Option<&Bound<'_, PyAny>>) -> PyResult<u64> {
    value.map_or(Ok(0), |value| whole_number(name, value, "in 0..2**64 - 1"))
}

fn thread_count(threads: Option<&Bound<'_, PyAny>>) -> PyResult<Option<usize>> {
    threads.map(|value| whole_number("threads", value, "in 1..1024")).transpose()
}

#[pymodule]
mod _core {
    use pyo3::prelude::*;

    #[pymodule_export]
    use super::beam_model::BeamModel;
    #[pymodule_export]
    use super::contact::{Contact, advance, clearance, touches};
    #[pymodule_export]
    use super::grid::OccupancyGrid;
    #[pymodule_export]
    use super::limits::Limits;
    #[pymodule_export]
    use super::motion::integrate_twist;
    #[pymodule_export]
    use super::motion_noise::MotionNoise;
    #[pymodule_export]
    use super::pose::Pose;
    #[pymodule_export]
    use super::raycast::cast_rays;
    #[pymodule_export]
    use super::scanner::LaserScanner;
    #[pymodule_export]
    use super::shape::Shape;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
