//! `MotionNoise` for Python.

use glam::DMat3;
use numpy::{IntoPyArray, PyArray2, ndarray::Array2};
use pyo3::prelude::*;

use super::arrays::matrix;
use super::pose::{Pose, PoseArgument};
use super::{stream_number, whole_number};

/// The error of odometry: the velocity motion model of Probabilistic Robotics (Thrun, Burgard & Fox 2006), table 5.3.
///
/// alpha1, alpha2: variance of the speed by speed² and turn rate². alpha3, alpha4: that of the turn rate.
/// alpha5, alpha6: that of the final turn rate. As in the book, each step draws anew and all of it scales with the step's length:
/// the error of a drive depends on how long its steps are.
///
/// raises: ValueError for parameters that are negative or not finite.
#[pyclass(frozen, eq, module = "mobile_robot_simulator", from_py_object)]
#[derive(Clone, Copy, PartialEq)]
pub struct MotionNoise(pub crate::MotionNoise);

fn default() -> [f64; 6] {
    crate::MotionNoise::default().alpha()
}

#[pymethods]
impl MotionNoise {
    #[new]
    #[pyo3(signature = (
        *,
        alpha1 = default()[0],
        alpha2 = default()[1],
        alpha3 = default()[2],
        alpha4 = default()[3],
        alpha5 = default()[4],
        alpha6 = default()[5],
    ))]
    fn new(alpha1: f64, alpha2: f64, alpha3: f64, alpha4: f64, alpha5: f64, alpha6: f64) -> PyResult<Self> {
        Ok(Self(crate::MotionNoise::new([alpha1, alpha2, alpha3, alpha4, alpha5, alpha6])?))
    }

    /// The parameters alpha1 to alpha6.
    #[getter]
    fn alpha(&self) -> (f64, f64, f64, f64, f64, f64) {
        self.0.alpha().into()
    }

    /// A pose reached in ``dt`` seconds by a robot that was told to move at a twist.
    ///
    /// pose: (x, y, yaw). twist: (vx, vy, wz) in the robot's frame [m/s, rad/s]; the speed's error is along the direction of
    /// travel, or forward for a robot that turns in place. seed, index: name the draw, index being that of the step.
    /// returns: Pose, its yaw not wrapped. raises: ValueError for numbers that are not finite.
    /// method: sample_motion_model_velocity, Probabilistic Robotics, table 5.3; the arc is exact for any turn rate.
    #[pyo3(signature = (pose, twist, dt, *, seed, index))]
    fn sample(
        &self,
        pose: PoseArgument,
        twist: [f64; 3],
        dt: f64,
        seed: &Bound<'_, PyAny>,
        index: &Bound<'_, PyAny>,
    ) -> PyResult<Pose> {
        let seed = stream_number("seed", Some(seed))?;
        let index = whole_number("index", index, "in 0..2**64 - 1")?;
        Ok(Pose(self.0.sample_from(pose.0, twist.into(), dt, seed, index)?))
    }

    /// Covariance of (x, y, yaw) after a step, from that before it, to first order in the errors.
    ///
    /// covariance: (3, 3) float64 before the step [m², m rad, rad²]. pose: (x, y, yaw) at the start of the step. twist, dt: as in
    /// ``sample``. returns: (3, 3) float64, symmetric.
    /// raises: ValueError for another shape and numbers that are not finite; TypeError for another dtype.
    /// method: F P Fᵀ + V M Vᵀ with the exact derivatives of the arc, Probabilistic Robotics, table 7.2, and M from table 5.3.
    fn propagate<'py>(
        &self,
        py: Python<'py>,
        covariance: &Bound<'py, PyAny>,
        pose: PoseArgument,
        twist: [f64; 3],
        dt: f64,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let before = DMat3::from_cols_array_2d(&matrix("covariance", covariance)?);
        let after = self.0.propagate(before.transpose(), pose.0, twist.into(), dt)?;
        Ok(Array2::from(after.transpose().to_cols_array_2d().to_vec()).into_pyarray(py))
    }

    fn __repr__(&self) -> String {
        let [a1, a2, a3, a4, a5, a6] = self.0.alpha();
        format!("MotionNoise(alpha1={a1:?}, alpha2={a2:?}, alpha3={a3:?}, alpha4={a4:?}, alpha5={a5:?}, alpha6={a6:?})")
    }

    #[allow(clippy::type_complexity, reason = "what pickle asks for")]
    fn __getnewargs_ex__<'py>(&self, py: Python<'py>) -> PyResult<((), Bound<'py, pyo3::types::PyDict>)> {
        let keywords = pyo3::types::PyDict::new(py);
        let names = ["alpha1", "alpha2", "alpha3", "alpha4", "alpha5", "alpha6"];
        for (name, value) in names.into_iter().zip(self.0.alpha()) {
            keywords.set_item(name, value)?;
        }
        Ok(((), keywords))
    }
}
