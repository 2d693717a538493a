//! The Python class `Limits`.

use numpy::{IntoPyArray, PyArray2, ndarray::Array2};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use super::arrays::{numbers, type_name};
use super::number::Argument;
use super::pose::{Pose, PoseArgument};
use super::{Recipe, recipe};

/// Limits on velocity and acceleration along each axis (vx, vy, wz) of a robot.
///
/// A limit holds in both directions, and `inf` means no limit. The axes are independent. As in the `diff_drive_controller`
/// of ros2_controllers, the acceleration limits are applied first, then the velocity limits.
///
/// Args:
///     velocity: Largest speeds [m/s, m/s, rad/s]. No limits by default. 0 holds an axis still.
///     acceleration: Largest increases of speed [m/s², m/s², rad/s²]. No limits by default.
///     deceleration: Largest decreases of speed [m/s², m/s², rad/s²]. No limits by default. With 0, a moving axis never
///         stops.
///
/// Raises:
///     ValueError: A limit is negative or NaN.
///
/// Examples:
///     >>> import mobile_robot_simulator as mrs
///     >>> limits = mrs.Limits(acceleration=(0.5, 0.5, 2.0))
///     >>> limits.acceleration
///     (0.5, 0.5, 2.0)
///     >>> limits.velocity
///     (inf, inf, inf)
#[pyclass(frozen, eq, module = "mobile_robot_simulator", from_py_object)]
#[derive(Clone, Copy, PartialEq)]
pub struct Limits(pub crate::Limits);

/// An argument that must be limits.
pub struct LimitsArgument(pub Limits);

impl<'py> FromPyObject<'_, 'py> for LimitsArgument {
    type Error = PyErr;

    fn extract(value: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        let needed = |_| PyTypeError::new_err(format!("limits must be a Limits, got {}", type_name(&value)));
        value.cast::<Limits>().map(|limits| Self(*limits.get())).map_err(needed)
    }
}

const NONE: crate::Limits = crate::Limits::NONE;

#[pymethods]
impl Limits {
    #[new]
    // The text shows the defaults in `help()`. It is an expression that Python can evaluate; a test compares the values.
    #[pyo3(
        text_signature = "(*, velocity=(1e999, 1e999, 1e999), acceleration=(1e999, 1e999, 1e999), \
                          deceleration=(1e999, 1e999, 1e999))",
        signature = (
            *,
            velocity = NONE.velocity().into(),
            acceleration = NONE.acceleration().into(),
            deceleration = NONE.deceleration().into(),
        )
    )]
    fn new(
        velocity: Argument<[f64; 3]>,
        acceleration: Argument<[f64; 3]>,
        deceleration: Argument<[f64; 3]>,
    ) -> PyResult<Self> {
        let (velocity, acceleration) = (velocity.named("velocity")?, acceleration.named("acceleration")?);
        Ok(Self(crate::Limits::new(velocity, acceleration, deceleration.named("deceleration")?)?))
    }

    /// Largest speeds along (vx, vy, wz) [m/s, m/s, rad/s].
    #[getter]
    fn velocity(&self) -> (f64, f64, f64) {
        self.0.velocity().into()
    }

    /// Largest increases of speed along (vx, vy, wz) [m/s², m/s², rad/s²].
    #[getter]
    fn acceleration(&self) -> (f64, f64, f64) {
        self.0.acceleration().into()
    }

    /// Largest decreases of speed along (vx, vy, wz) [m/s², m/s², rad/s²].
    #[getter]
    fn deceleration(&self) -> (f64, f64, f64) {
        self.0.deceleration().into()
    }

    /// Returns the velocity that a robot reaches in `dt` seconds.
    ///
    /// An axis that reverses its direction first slows down to zero, then speeds up in the remaining time.
    ///
    /// Args:
    ///     wanted: Commanded velocity (vx, vy, wz) in the robot's frame [m/s, m/s, rad/s].
    ///     current: Velocity at the start, in the same form.
    ///     dt: Duration [s]. With 0, only the velocity limits apply, to the current velocity.
    ///
    /// Returns:
    ///     The velocity (vx, vy, wz) after `dt` seconds [m/s, m/s, rad/s].
    ///
    /// Raises:
    ///     ValueError: A velocity or `dt` is not finite, or `dt` is negative.
    ///
    /// Examples:
    ///     >>> import mobile_robot_simulator as mrs
    ///     >>> limits = mrs.Limits(acceleration=(0.5, 0.5, 2.0))
    ///     >>> limits.apply((1.0, 0.0, 0.0), (0.0, 0.0, 0.0), dt=0.5)
    ///     (0.25, 0.0, 0.0)
    fn apply(
        &self,
        wanted: Argument<[f64; 3]>,
        current: Argument<[f64; 3]>,
        dt: Argument<f64>,
    ) -> PyResult<(f64, f64, f64)> {
        let (wanted, current) = (wanted.named("wanted")?, current.named("current")?);
        Ok(self.0.apply(wanted.into(), current.into(), dt.named("dt")?)?.to_array().into())
    }

    /// Returns the pose that a robot reaches in `dt` seconds while its velocity follows `apply`.
    ///
    /// Args:
    ///     pose: Pose at the start.
    ///     wanted: Commanded velocity (vx, vy, wz) in the robot's frame [m/s, m/s, rad/s].
    ///     current: Velocity of the wheels at the start, in the same form.
    ///     dt: Duration [s].
    ///     grip: Share of the motion of the wheels that the robot makes; 1 without slip.
    ///
    /// Returns:
    ///     The pose after `dt` seconds. Its yaw is not wrapped.
    ///
    /// Raises:
    ///     ValueError: A number or the resulting pose is not finite, or `dt` is negative.
    ///
    /// Examples:
    ///     From 1 m/s to a stop at 1 m/s² takes half a metre:
    ///
    ///     >>> import mobile_robot_simulator as mrs
    ///     >>> limits = mrs.Limits(deceleration=(1.0, 1.0, 1.0))
    ///     >>> limits.integrate(mrs.Pose(), (0.0, 0.0, 0.0), (1.0, 0.0, 0.0), dt=5.0)
    ///     Pose(0.5, 0.0, 0.0)
    #[pyo3(
        text_signature = "($self, pose, wanted, current, dt, *, grip=1.0)",
        signature = (pose, wanted, current, dt, *, grip = 1.0.into())
    )]
    fn integrate(
        &self,
        pose: PoseArgument,
        wanted: Argument<[f64; 3]>,
        current: Argument<[f64; 3]>,
        dt: Argument<f64>,
        grip: Argument<f64>,
    ) -> PyResult<Pose> {
        let (wanted, current) = (wanted.named("wanted")?, current.named("current")?);
        let (dt, grip) = (dt.named("dt")?, grip.named("grip")?);
        Ok(Pose(self.0.integrate(pose.0, wanted.into(), current.into(), dt, grip)?))
    }

    /// Returns the poses that a robot reaches at several times while its velocity follows `apply`: those of `integrate`.
    ///
    /// Args:
    ///     pose: Pose at the start.
    ///     wanted: Commanded velocity (vx, vy, wz) in the robot's frame [m/s, m/s, rad/s].
    ///     current: Velocity of the wheels at the start, in the same form.
    ///     times: (N,) times from the start on [s]. Anything that NumPy can convert to float64 without loss.
    ///     grip: Share of the motion of the wheels that the robot makes; 1 without slip.
    ///
    /// Returns:
    ///     (N, 3) float64, one row (x, y, yaw) per time [m, m, rad]. Yaws are not wrapped.
    ///
    /// Raises:
    ///     ValueError: `times` is not one-dimensional, a time is negative, or a number or a pose reached is not finite.
    ///     TypeError: `times` cannot be converted to float64 without loss.
    ///
    /// Examples:
    ///     >>> import mobile_robot_simulator as mrs
    ///     >>> limits = mrs.Limits(deceleration=(1.0, 1.0, 1.0))
    ///     >>> limits.trace(mrs.Pose(), (0.0, 0.0, 0.0), (1.0, 0.0, 0.0), times=[0.0, 1.0, 5.0])
    ///     array([[0. , 0. , 0. ],
    ///            [0.5, 0. , 0. ],
    ///            [0.5, 0. , 0. ]])
    #[pyo3(
        text_signature = "($self, pose, wanted, current, times, *, grip=1.0)",
        signature = (pose, wanted, current, times, *, grip = 1.0.into())
    )]
    fn trace<'py>(
        &self,
        py: Python<'py>,
        pose: PoseArgument,
        wanted: Argument<[f64; 3]>,
        current: Argument<[f64; 3]>,
        times: &Bound<'py, PyAny>,
        grip: Argument<f64>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let (wanted, current) = (wanted.named("wanted")?, current.named("current")?);
        let grip = grip.named("grip")?;
        let poses = self.0.trace(pose.0, wanted.into(), current.into(), &numbers("times", times)?, grip)?;
        Ok(Array2::from(poses).into_pyarray(py))
    }

    /// Returns the length of the path that a robot drives in `dt` seconds while its velocity follows `apply`.
    ///
    /// Args:
    ///     wanted: Commanded velocity (vx, vy, wz) in the robot's frame [m/s, m/s, rad/s].
    ///     current: Velocity at the start, in the same form.
    ///     dt: Duration [s].
    ///
    /// Returns:
    ///     The length of the path [m]. Turning in place adds nothing.
    ///
    /// Raises:
    ///     ValueError: A velocity or `dt` is not finite, or `dt` is negative.
    ///
    /// Examples:
    ///     >>> import mobile_robot_simulator as mrs
    ///     >>> limits = mrs.Limits(velocity=(1.0, 1.0, 2.0), acceleration=(0.5, 0.5, 2.0))
    ///     >>> limits.distance((2.0, 0.0, 0.0), (0.0, 0.0, 0.0), dt=4.0)
    ///     3.0
    fn distance(&self, wanted: Argument<[f64; 3]>, current: Argument<[f64; 3]>, dt: Argument<f64>) -> PyResult<f64> {
        let (wanted, current) = (wanted.named("wanted")?, current.named("current")?);
        Ok(self.0.distance(wanted.into(), current.into(), dt.named("dt")?)?)
    }

    pub fn __repr__(&self) -> String {
        let (velocity, acceleration, deceleration) = (self.velocity(), self.acceleration(), self.deceleration());
        format!("Limits(velocity={velocity:?}, acceleration={acceleration:?}, deceleration={deceleration:?})")
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Recipe<'py>> {
        let keywords = PyDict::new(py);
        keywords.set_item("velocity", self.velocity())?;
        keywords.set_item("acceleration", self.acceleration())?;
        keywords.set_item("deceleration", self.deceleration())?;
        recipe::<Self>(py, PyTuple::empty(py), keywords)
    }
}
