//! `Pose` for Python.

use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::PyTuple;

use super::arrays::type_name;
use crate::error::check_number;
use crate::{Twist, integrate, interpolate, yaw_from_quaternion};

/// Position [m] and heading [rad] of one frame in another; unpacks as ``x, y, yaw``.
///
/// Wherever a pose is asked for, a tuple ``(x, y, yaw)`` will do.
/// Named target first, so that neighbours match: ``map_from_laser = map_from_base * base_from_laser``.
///
/// raises: ValueError if a coordinate is not finite.
// A sequence, so that NumPy makes arrays of its numbers.
#[pyclass(frozen, eq, sequence, module = "mobile_robot_simulator", from_py_object)]
#[derive(Clone, Copy, PartialEq)]
pub struct Pose(pub crate::Pose);

#[pymethods]
impl Pose {
    #[new]
    #[pyo3(signature = (x = 0.0, y = 0.0, yaw = 0.0))]
    fn new(x: f64, y: f64, yaw: f64) -> PyResult<Self> {
        Ok(Self(crate::Pose::new(x, y, yaw).checked()?))
    }

    /// The pose at (x, y) whose heading is that of a quaternion of any length but zero; roll and pitch are passed over.
    ///
    /// raises: ValueError for a quaternion of length zero and numbers that are not finite.
    #[staticmethod]
    #[pyo3(signature = (x, y, *, qx, qy, qz, qw))]
    fn from_quaternion(x: f64, y: f64, qx: f64, qy: f64, qz: f64, qw: f64) -> PyResult<Self> {
        Self::new(x, y, yaw_from_quaternion(qx, qy, qz, qw)?)
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

    /// The heading as the parts ``(z, w)`` of a quaternion whose x and y are zero.
    #[getter]
    fn quaternion(&self) -> (f64, f64) {
        self.0.to_quaternion()
    }

    /// The pose of the parent frame in this one.
    fn inverse(&self) -> PyResult<Self> {
        Ok(Self(self.0.inverse().checked()?))
    }

    /// The same pose with its yaw in (-π, π].
    fn wrapped(&self) -> Self {
        Self(self.0.wrapped())
    }

    /// The pose reached under a constant twist ``(vx, vy, wz)`` [m/s, rad/s] after ``dt`` seconds, exactly.
    fn integrate(&self, twist: [f64; 3], dt: f64) -> PyResult<Self> {
        Ok(Self(integrate(self.0, Twist::from(twist), dt).checked()?))
    }

    /// The constant twist ``(vx, vy, wz)`` [m/s, rad/s] that leads from this pose to another in ``dt`` seconds, turning by half
    /// a turn at most.
    ///
    /// raises: ValueError for a dt that is not positive and finite.
    fn twist_to(&self, other: PoseArgument, dt: f64) -> PyResult<(f64, f64, f64)> {
        check_number("dt", dt, "positive", |value| value > 0.0)?;
        Ok(Twist::between(self.0, other.0, dt).to_array().into())
    }

    /// The pose on the arc from this one (fraction 0) to another (fraction 1), or beyond them.
    fn interpolate(&self, other: PoseArgument, fraction: f64) -> PyResult<Self> {
        Ok(Self(interpolate(self.0, other.0, fraction).checked()?))
    }

    fn __mul__(&self, inner: PoseArgument) -> PyResult<Self> {
        Ok(Self((self.0 * inner.0).checked()?))
    }

    fn __len__(&self) -> usize {
        3
    }

    fn __getitem__<'py>(&self, py: Python<'py>, index: isize) -> PyResult<Bound<'py, PyAny>> {
        self.__getnewargs__(py)?.as_any().get_item(index)
    }

    fn __iter__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        Ok(self.__getnewargs__(py)?.try_iter()?.into_any())
    }

    fn __hash__(&self, py: Python<'_>) -> PyResult<isize> {
        self.__getnewargs__(py)?.hash()
    }

    fn __repr__(&self) -> String {
        let [x, y, yaw] = self.0.to_array();
        format!("Pose(x={x:?}, y={y:?}, yaw={yaw:?})")
    }

    fn __getnewargs__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, self.0.to_array())
    }
}

/// A pose, or three numbers that are one.
pub struct PoseArgument(pub crate::Pose);

impl<'py> FromPyObject<'_, 'py> for PoseArgument {
    type Error = PyErr;

    fn extract(value: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        if let Ok(pose) = value.cast::<Pose>() {
            return Ok(Self(pose.get().0));
        }
        match value.extract::<[f64; 3]>() {
            Ok(numbers) => Ok(Self(crate::Pose::from(numbers).checked()?)),
            Err(_) => Err(PyTypeError::new_err(format!(
                "a pose must be three numbers (x, y, yaw), got {}: {}",
                type_name(&value),
                value.repr()?
            ))),
        }
    }
}
