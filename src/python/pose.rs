//! The Python class `Pose`, and the conversion of pose arguments.

use numpy::{IntoPyArray, PyArray2, ndarray::Array2};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use super::arrays::{numbers, short_repr, type_name};
use super::number::Argument;
use super::{Recipe, recipe};
use crate::error::check_number;
use crate::{Twist, integrate, interpolate, trace, yaw_from_quaternion};

/// Position [m] and heading [rad] of one frame in another frame.
///
/// A pose unpacks as `x, y, yaw`, and NumPy reads it as a row of three numbers. Every function that takes a pose also takes
/// a sequence of three numbers `(x, y, yaw)`. The product of two poses composes them. Name a transform target first, so
/// that neighbouring names match: `map_from_laser = map_from_base * base_from_laser`.
///
/// Args:
///     x: Position along x [m].
///     y: Position along y [m].
///     yaw: Heading [rad], counter-clockwise from the x axis. It is stored as given, not wrapped.
///
/// Raises:
///     ValueError: A coordinate is not finite.
///
/// Examples:
///     >>> from mobile_robot_simulator import Pose
///     >>> Pose(1.0, 2.0, 0.0) * Pose(3.0, 0.5, 0.25)
///     Pose(4.0, 2.5, 0.25)
///     >>> x, y, yaw = Pose(1.0, 2.0, 0.5)
// `sequence` makes NumPy read a pose as an array of its three numbers.
#[pyclass(frozen, eq, sequence, module = "mobile_robot_simulator", from_py_object)]
#[derive(Clone, Copy, PartialEq)]
pub struct Pose(pub crate::Pose);

#[pymethods]
impl Pose {
    #[new]
    #[pyo3(
        text_signature = "(x=0.0, y=0.0, yaw=0.0)",
        signature = (x = 0.0.into(), y = 0.0.into(), yaw = 0.0.into())
    )]
    fn new(x: Argument<f64>, y: Argument<f64>, yaw: Argument<f64>) -> PyResult<Self> {
        Ok(Self(crate::Pose::new(x.named("x")?, y.named("y")?, yaw.named("yaw")?).checked()?))
    }

    /// Returns the pose at (x, y) with the heading of a quaternion.
    ///
    /// The quaternion need not have length 1. Its roll and pitch are ignored.
    ///
    /// Args:
    ///     x: Position along x [m].
    ///     y: Position along y [m].
    ///     qx: Quaternion component x.
    ///     qy: Quaternion component y.
    ///     qz: Quaternion component z.
    ///     qw: Quaternion component w, the scalar part.
    ///
    /// Returns:
    ///     The pose, with its yaw in [-π, π].
    ///
    /// Raises:
    ///     ValueError: The quaternion has length zero, or a number is not finite.
    ///
    /// Examples:
    ///     >>> from mobile_robot_simulator import Pose
    ///     >>> Pose.from_quaternion(1.0, 2.0, qx=0.0, qy=0.0, qz=1.0, qw=0.0)
    ///     Pose(1.0, 2.0, 3.141592653589793)
    #[staticmethod]
    #[pyo3(signature = (x, y, *, qx, qy, qz, qw))]
    fn from_quaternion(
        x: Argument<f64>,
        y: Argument<f64>,
        qx: Argument<f64>,
        qy: Argument<f64>,
        qz: Argument<f64>,
        qw: Argument<f64>,
    ) -> PyResult<Self> {
        let yaw = yaw_from_quaternion(qx.named("qx")?, qy.named("qy")?, qz.named("qz")?, qw.named("qw")?)?;
        Self::new(x, y, yaw.into())
    }

    /// Position along x [m].
    #[getter]
    fn x(&self) -> f64 {
        self.0.position.x
    }

    /// Position along y [m].
    #[getter]
    fn y(&self) -> f64 {
        self.0.position.y
    }

    /// Heading [rad], counter-clockwise from x.
    #[getter]
    fn yaw(&self) -> f64 {
        self.0.yaw
    }

    /// The heading as the components `(z, w)` of a unit quaternion; its x and y are zero.
    ///
    /// Examples:
    ///     >>> from mobile_robot_simulator import Pose
    ///     >>> Pose(1.0, 2.0, 0.0).quaternion
    ///     (0.0, 1.0)
    #[getter]
    fn quaternion(&self) -> (f64, f64) {
        self.0.to_quaternion()
    }

    /// Returns the inverse transform: the pose of the parent frame in this frame.
    ///
    /// Raises:
    ///     ValueError: A coordinate of the result is not finite.
    ///
    /// Examples:
    ///     >>> from mobile_robot_simulator import Pose
    ///     >>> pose = Pose(2.0, 1.0, 0.0)
    ///     >>> pose * pose.inverse()
    ///     Pose(0.0, 0.0, 0.0)
    fn inverse(&self) -> PyResult<Self> {
        Ok(Self(self.0.inverse().checked()?))
    }

    /// Returns the same pose with its yaw in (-π, π].
    ///
    /// Examples:
    ///     >>> from mobile_robot_simulator import Pose
    ///     >>> Pose(0.0, 0.0, 7.0).wrapped().yaw  # 7 - 2π
    ///     0.7168146928204138
    fn wrapped(&self) -> Self {
        Self(self.0.wrapped())
    }

    /// Returns the pose reached after `dt` seconds at a constant twist.
    ///
    /// The arc is exact, not an Euler step. It is the exponential map of SE(2): with φ = wz·dt, the position changes by
    /// dt · sin(φ/2)/(φ/2) · R(yaw + φ/2) · (vx, vy) and the yaw by φ. For many poses at once, see `integrate_twist`.
    ///
    /// Args:
    ///     twist: Velocity (vx, vy, wz) in the robot's frame [m/s, m/s, rad/s].
    ///     dt: Duration [s]. A negative one goes backwards in time.
    ///
    /// Returns:
    ///     The pose reached. Its yaw is not wrapped.
    ///
    /// Raises:
    ///     ValueError: The pose reached is not finite, because a number in the twist or `dt` is not finite or too large.
    ///
    /// Examples:
    ///     A quarter of a circle with a radius of 1 m:
    ///
    ///     >>> import math
    ///     >>> from mobile_robot_simulator import Pose
    ///     >>> x, y, yaw = Pose().integrate((1.0, 0.0, 1.0), dt=math.pi / 2)
    ///     >>> round(x, 9), round(y, 9)
    ///     (1.0, 1.0)
    fn integrate(&self, twist: Argument<[f64; 3]>, dt: Argument<f64>) -> PyResult<Self> {
        Ok(Self(integrate(self.0, Twist::from(twist.named("twist")?), dt.named("dt")?).checked()?))
    }

    /// Returns the poses reached at several times at a constant twist: those of `integrate`.
    ///
    /// Args:
    ///     twist: Velocity (vx, vy, wz) in the robot's frame [m/s, m/s, rad/s].
    ///     times: (N,) times [s] from this pose on. Anything that NumPy can convert to float64 without loss.
    ///
    /// Returns:
    ///     (N, 3) float64, one row (x, y, yaw) per time [m, m, rad]. Yaws are not wrapped.
    ///
    /// Raises:
    ///     ValueError: `times` is not one-dimensional, or a number or a pose reached is not finite.
    ///     TypeError: `times` cannot be converted to float64 without loss.
    ///
    /// Examples:
    ///     >>> from mobile_robot_simulator import Pose
    ///     >>> Pose(1.0, 2.0, 0.0).trace((0.5, 0.0, 0.0), times=[0.0, 2.0, 4.0])
    ///     array([[1., 2., 0.],
    ///            [2., 2., 0.],
    ///            [3., 2., 0.]])
    fn trace<'py>(
        &self,
        py: Python<'py>,
        twist: Argument<[f64; 3]>,
        times: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let poses = trace(self.0, Twist::from(twist.named("twist")?), &numbers("times", times)?)?;
        Ok(Array2::from(poses).into_pyarray(py))
    }

    /// Returns the constant twist that leads from this pose to another pose in `dt` seconds.
    ///
    /// It is the inverse of `integrate`, and turns the shorter way: by at most half a turn.
    ///
    /// Args:
    ///     other: Pose to reach, in the same frame as this pose.
    ///     dt: Duration [s].
    ///
    /// Returns:
    ///     The twist (vx, vy, wz) in the robot's frame [m/s, m/s, rad/s].
    ///
    /// Raises:
    ///     ValueError: `dt` is not positive and finite, or `other` is not finite.
    ///
    /// Examples:
    ///     >>> from mobile_robot_simulator import Pose
    ///     >>> Pose().twist_to((2.0, 0.0, 0.0), dt=4.0)
    ///     (0.5, 0.0, 0.0)
    fn twist_to(&self, other: PoseArgument, dt: Argument<f64>) -> PyResult<(f64, f64, f64)> {
        let dt = dt.named("dt")?;
        check_number("dt", dt, "positive", |value| value > 0.0)?;
        Ok(Twist::between(self.0, other.0, dt).to_array().into())
    }

    /// Returns the pose at a fraction of the arc from this pose to another pose.
    ///
    /// The arc has a constant twist and turns the shorter way: by at most half a turn.
    ///
    /// Args:
    ///     other: Pose at fraction 1, in the same frame as this pose.
    ///     fraction: Fraction of the arc. Values below 0 and above 1 continue the arc beyond its ends.
    ///
    /// Returns:
    ///     The pose, with its yaw in (-π, π].
    ///
    /// Raises:
    ///     ValueError: `other` or `fraction` is not finite.
    ///
    /// Examples:
    ///     >>> from mobile_robot_simulator import Pose
    ///     >>> Pose().interpolate((2.0, 0.0, 0.0), 0.25)
    ///     Pose(0.5, 0.0, 0.0)
    fn interpolate(&self, other: PoseArgument, fraction: Argument<f64>) -> PyResult<Self> {
        Ok(Self(interpolate(self.0, other.0, fraction.named("fraction")?).checked()?))
    }

    fn __mul__(&self, inner: PoseArgument) -> PyResult<Self> {
        Ok(Self((self.0 * inner.0).checked()?))
    }

    fn __len__(&self) -> usize {
        3
    }

    fn __getitem__<'py>(&self, py: Python<'py>, index: isize) -> PyResult<Bound<'py, PyAny>> {
        self.to_tuple(py)?.as_any().get_item(index)
    }

    fn __iter__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        Ok(self.to_tuple(py)?.try_iter()?.into_any())
    }

    fn __hash__(&self, py: Python<'_>) -> PyResult<isize> {
        self.to_tuple(py)?.hash()
    }

    fn __repr__(&self) -> String {
        let [x, y, yaw] = self.0.to_array();
        format!("Pose({x:?}, {y:?}, {yaw:?})")
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Recipe<'py>> {
        recipe::<Self>(py, self.to_tuple(py)?, PyDict::new(py))
    }
}

impl Pose {
    fn to_tuple(self, py: Python<'_>) -> PyResult<Bound<'_, PyTuple>> {
        PyTuple::new(py, self.0.to_array())
    }
}

/// A pose argument: a `Pose`, or a sequence of three numbers.
pub struct PoseArgument(pub crate::Pose);

impl<'py> FromPyObject<'_, 'py> for PoseArgument {
    type Error = PyErr;

    fn extract(value: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        if let Ok(pose) = value.cast::<Pose>() {
            return Ok(Self(pose.get().0));
        }
        if let Ok(numbers) = value.extract::<[f64; 3]>() {
            return Ok(Self(crate::Pose::from(numbers).checked()?));
        }
        let text = format!("a pose must be three numbers (x, y, yaw), got {}: {}", type_name(&value), short_repr(&value));
        Err(refused(&value, text, &[3]))
    }
}

/// Returns the error for an argument that is not as many numbers as needed.
///
/// Numbers of a wrong count are a wrong value; anything else is a wrong type.
pub fn refused(value: &Bound<'_, PyAny>, text: String, counts: &[usize]) -> PyErr {
    let is_number = |item: PyResult<Bound<'_, PyAny>>| item.is_ok_and(|item| item.extract::<f64>().is_ok());
    let are_numbers = value.len().is_ok_and(|count| !counts.contains(&count))
        && value.try_iter().is_ok_and(|items| items.take(8).all(is_number));
    if are_numbers { PyValueError::new_err(text) } else { PyTypeError::new_err(text) }
}
