//! The Python module `mobile_robot_simulator._core`.
//!
//! Each function converts its arguments, calls the core without the GIL and converts the result. Doc comments of Python
//! classes and functions are Python docstrings, in Google style.
#![allow(clippy::doc_markdown, reason = "the doc comments are Python docstrings")]
#![allow(clippy::needless_pass_by_value, clippy::unused_self, reason = "PyO3 needs these signatures")]

mod arrays;
mod beam_fit;
mod beam_model;
mod contact;
mod drive;
mod fleet;
mod grid;
mod interrupt;
mod learning;
mod likelihood_field;
mod limits;
mod material;
mod motion;
mod motion_noise;
mod mount;
mod number;
mod obstacles;
mod pose;
mod preset;
mod random_stream;
mod raycast;
mod scan_each;
mod scanner;
mod scanner_options;
mod shape;
mod surface_model;
mod sweep;
mod wheel_motion;

use pyo3::PyTypeInfo;
use pyo3::exceptions::{PyMemoryError, PyOSError, PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyInt, PyTuple, PyType};

use crate::Error;

impl From<Error> for PyErr {
    fn from(error: Error) -> Self {
        match error {
            Error::Threads { .. } => PyOSError::new_err(error.to_string()),
            Error::Interrupted => interrupt::exception(),
            Error::Memory { .. } => PyMemoryError::new_err(error.to_string()),
            _ => PyValueError::new_err(error.to_string()),
        }
    }
}

/// Converts a Python integer; `needed` describes the valid range in the error message.
fn whole_number<'py, T: FromPyObjectOwned<'py>>(name: &str, value: &Bound<'py, PyAny>, needed: &str) -> PyResult<T> {
    // Most are plain integers, and asking those for `__index__` takes longer than all else.
    let number = if value.is_exact_instance_of::<PyInt>() { value.clone() } else { index_of(name, value)? };
    number
        .extract()
        .map_err(|_| PyValueError::new_err(format!("{name} must be {needed}, got {}", arrays::short_repr(&number))))
}

/// Returns what `__index__` of a value returns, or an error that the argument of this name must be an integer.
fn index_of<'py>(name: &str, value: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
    value
        .call_method0("__index__")
        .map_err(|_| PyTypeError::new_err(format!("{name} must be an integer, got {}", arrays::type_name(value))))
}

/// Converts a seed or an index of a random stream; `None` means 0.
fn stream_number(name: &str, value: Option<&Bound<'_, PyAny>>) -> PyResult<u64> {
    value.map_or(Ok(0), |value| whole_number(name, value, "in 0..2**64 - 1"))
}

/// Converts a number of threads; `None` means one per core.
fn thread_count(threads: Option<&Bound<'_, PyAny>>) -> PyResult<Option<usize>> {
    threads.map(|value| whole_number("threads", value, "in 1..1024")).transpose()
}

/// How pickle and copy make an object: they call the function with the class, its positional and its keyword arguments.
type Recipe<'py> = (Bound<'py, PyAny>, (Bound<'py, PyType>, Bound<'py, PyTuple>, Bound<'py, PyDict>));

/// Returns what `__reduce__` has to return for an object of class `T` that these arguments make. Every protocol takes it.
fn recipe<'py, T: PyTypeInfo>(
    py: Python<'py>,
    arguments: Bound<'py, PyTuple>,
    keywords: Bound<'py, PyDict>,
) -> PyResult<Recipe<'py>> {
    Ok((py.import("copyreg")?.getattr("__newobj_ex__")?, (py.get_type::<T>(), arguments, keywords)))
}

/// Compiled core of mobile_robot_simulator: grids, scanners, noise, contact and motion.
#[pymodule]
mod _core {
    use pyo3::prelude::*;

    #[pymodule_export]
    use super::beam_fit::BeamFit;
    #[pymodule_export]
    use super::beam_model::BeamModel;
    #[pymodule_export]
    use super::contact::{Contact, advance, clearance, clearance_batch, stays_clear, touches};
    #[pymodule_export]
    use super::drive::Drive;
    #[pymodule_export]
    use super::fleet::{Fleet, FleetState, FleetStep};
    #[pymodule_export]
    use super::grid::OccupancyGrid;
    #[pymodule_export]
    use super::learning::{commands_from_actions, judge_steps};
    #[pymodule_export]
    use super::likelihood_field::LikelihoodField;
    #[pymodule_export]
    use super::limits::Limits;
    #[pymodule_export]
    use super::material::Material;
    #[pymodule_export]
    use super::motion::integrate_twist;
    #[pymodule_export]
    use super::motion_noise::MotionNoise;
    #[pymodule_export]
    use super::obstacles::Obstacles;
    #[pymodule_export]
    use super::pose::Pose;
    #[pymodule_export]
    use super::preset::laser_presets;
    #[pymodule_export]
    use super::random_stream::RandomStream;
    #[pymodule_export]
    use super::raycast::cast_rays;
    #[pymodule_export]
    use super::scan_each::scan_each;
    #[pymodule_export]
    use super::scanner::LaserScanner;
    #[pymodule_export]
    use super::shape::Shape;
    #[pymodule_export]
    use super::surface_model::SurfaceModel;
    #[pymodule_export]
    use super::wheel_motion::WheelMotion;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        crate::interrupt::set_hook(super::interrupt::handle_signals);
        module.add("MAX_COMMAND", crate::MAX_COMMAND)?;
        module.add("FULL_TURN_TOLERANCE", crate::FULL_TURN_TOLERANCE)?;
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
