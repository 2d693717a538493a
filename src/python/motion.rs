//! The Python function `integrate_twist`.

use numpy::{IntoPyArray, PyArray2, ndarray::Array2};
use pyo3::prelude::*;

use super::arrays::rows;
use super::number::Argument;
use crate::integrate_batch;

/// Returns the pose that each robot of a batch reaches after `dt` seconds at a constant twist.
///
/// The arcs are exact, not Euler steps: the exponential map of SE(2). `Pose.integrate` gives the formula.
///
/// Args:
///     poses: (N, 3), one row (x, y, yaw) per robot [m, m, rad]. Anything that NumPy can convert to float64 without loss.
///     twists: (N, 3), one row (vx, vy, wz) per robot, in the robot's frame [m/s, m/s, rad/s], as for `poses`.
///     dt: Duration [s]. A negative one goes backwards in time.
///
/// Returns:
///     (N, 3) float64, one row (x, y, yaw) per robot. The yaw is not wrapped.
///
/// Raises:
///     ValueError: A shape is wrong, the lengths differ, or an argument or a pose reached is not finite.
///     TypeError: An array cannot be converted to float64 without loss.
///
/// Examples:
///     >>> import numpy as np
///     >>> import mobile_robot_simulator as mrs
///     >>> mrs.integrate_twist(np.array([[1.0, 2.0, 0.0]]), np.array([[0.5, 0.0, 0.0]]), dt=4.0)
///     array([[3., 2., 0.]])
#[pyfunction]
pub fn integrate_twist<'py>(
    py: Python<'py>,
    poses: &Bound<'py, PyAny>,
    twists: &Bound<'py, PyAny>,
    dt: Argument<f64>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let dt = dt.named("dt")?;
    let (poses, twists) = (rows("poses", poses, None)?, rows("twists", twists, None)?);
    let (poses, twists): (&[[f64; 3]], &[[f64; 3]]) = (&poses, &twists);
    let moved = py.detach(|| integrate_batch(poses, twists, dt))?;
    Ok(Array2::from(moved).into_pyarray(py))
}
