//! `integrate_twist` for Python.

use numpy::{IntoPyArray, PyArray2, ndarray::Array2};
use pyo3::prelude::*;

use super::arrays::rows;
use crate::integrate_batch;

/// Poses reached under constant twists after ``dt`` seconds: exact, not a step of Euler's.
///
/// poses: (N, 3) float64, x y [m] and yaw [rad]. twists: (N, 3) float64, vx vy [m/s] and wz [rad/s] in the robot's frame.
/// returns: (N, 3) float64; the yaw is not wrapped.
/// raises: ValueError for shapes that differ and numbers that are not finite; TypeError for another dtype.
/// method: the exponential of SE(2).
#[pyfunction]
pub fn integrate_twist<'py>(
    py: Python<'py>,
    poses: &Bound<'py, PyAny>,
    twists: &Bound<'py, PyAny>,
    dt: f64,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let (poses, twists) = (rows("poses", poses)?, rows("twists", twists)?);
    let (poses, twists): (&[[f64; 3]], &[[f64; 3]]) = (&poses, &twists);
    let moved = py.detach(|| integrate_batch(poses, twists, dt))?;
    Ok(Array2::from(moved).into_pyarray(py))
}
