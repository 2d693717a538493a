//! `Limits` for Python.

use pyo3::prelude::*;

/// The most that a robot can do along each axis (vx, vy, wz), forwards as backwards; infinite where there is no limit.
///
/// velocity: speed [m/s, m/s, rad/s]. acceleration, deceleration: growth and fall of speed [m/s², m/s², rad/s²].
/// Each axis by itself, acceleration before velocity, as in ros2_controllers' diff_drive_controller.
///
/// raises: ValueError for limits that are negative or NaN.
#[pyclass(frozen, eq, module = "mobile_robot_simulator", from_py_object)]
#[derive(Clone, Copy, PartialEq)]
pub struct Limits(pub crate::Limits);

const NONE: crate::Limits = crate::Limits::NONE;

#[pymethods]
impl Limits {
    #[new]
    #[pyo3(signature = (*, velocity = NONE.velocity(), acceleration = NONE.acceleration(), deceleration = NONE.deceleration()))]
    fn new(velocity: [f64; 3], acceleration: [f64; 3], deceleration: [f64; 3]) -> PyResult<Self> {
        Ok(Self(crate::Limits::new(velocity, acceleration, deceleration)?))
    }

    /// Limits on speed [m/s, m/s, rad/s].
    #[getter]
    fn velocity(&self) -> (f64, f64, f64) {
        self.0.velocity().into()
    }

    /// Limits on the growth of speed [m/s², m/s², rad/s²].
    #[getter]
    fn acceleration(&self) -> (f64, f64, f64) {
        self.0.acceleration().into()
    }

    /// Limits on the fall of speed [m/s², m/s², rad/s²].
    #[getter]
    fn deceleration(&self) -> (f64, f64, f64) {
        self.0.deceleration().into()
    }

    /// The velocity that a robot reaches in ``dt`` seconds when it is told to move at ``wanted`` and moves at ``current``.
    ///
    /// wanted, current: (vx, vy, wz) [m/s, rad/s]. returns: the same. An axis that changes its direction slows down to zero
    /// first, and speeds up in what is left of the time.
    /// raises: ValueError for velocities that are not finite or a negative dt.
    fn apply(&self, wanted: [f64; 3], current: [f64; 3], dt: f64) -> PyResult<(f64, f64, f64)> {
        Ok(self.0.apply(wanted.into(), current.into(), dt)?.to_array().into())
    }

    fn __repr__(&self) -> String {
        let (velocity, acceleration, deceleration) = (self.velocity(), self.acceleration(), self.deceleration());
        format!("Limits(velocity={velocity:?}, acceleration={acceleration:?}, deceleration={deceleration:?})")
    }

    #[allow(clippy::type_complexity, reason = "what pickle asks for")]
    fn __getnewargs_ex__<'py>(&self, py: Python<'py>) -> PyResult<((), Bound<'py, pyo3::types::PyDict>)> {
        let keywords = pyo3::types::PyDict::new(py);
        keywords.set_item("velocity", self.velocity())?;
        keywords.set_item("acceleration", self.acceleration())?;
        keywords.set_item("deceleration", self.deceleration())?;
        Ok(((), keywords))
    }
}
