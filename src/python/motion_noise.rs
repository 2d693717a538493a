//! The Python class `MotionNoise`.

use glam::DMat3;
use numpy::{IntoPyArray, PyArray2, ndarray::Array2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use super::arrays::matrix;
use super::number::Argument;
use super::pose::{Pose, PoseArgument};
use super::random_stream::SeedArgument;
use super::{Recipe, recipe};

/// Odometry noise: the velocity motion model of Probabilistic Robotics (Thrun, Burgard & Fox 2006), table 5.3.
///
/// At speed v and turn rate ω, a step has three independent normal errors: of the speed, with variance alpha1·v² +
/// alpha2·ω²; of the turn rate, with variance alpha3·v² + alpha4·ω²; and of an extra turn rate, with variance alpha5·v² +
/// alpha6·ω², that turns the robot at the end of the step. As in the book, each step draws new errors, which hold for the
/// whole step. The error of a drive therefore depends on the length of its steps, unless a reference step is given: the
/// variances then hold for a step of this duration, and those of a step of `dt` seconds are larger by `reference_step / dt`,
/// so that the errors of a drive do not depend on its division into steps. All parameters are 0 by default: no noise.
///
/// Args:
///     alpha1: Variance of the speed per v² [1].
///     alpha2: Variance of the speed per ω² [m²/rad²].
///     alpha3: Variance of the turn rate per v² [rad²/m²].
///     alpha4: Variance of the turn rate per ω² [1].
///     alpha5: Variance of the extra turn rate per v² [rad²/m²].
///     alpha6: Variance of the extra turn rate per ω² [1].
///     reference_step: Duration of the step for which the variances hold [s]; None: they hold for every step.
///
/// Raises:
///     ValueError: A parameter is negative or not finite, or the reference step is not positive.
///
/// Examples:
///     >>> from mobile_robot_simulator import MotionNoise
///     >>> MotionNoise(alpha1=0.01, alpha4=0.02).alpha
///     (0.01, 0.0, 0.0, 0.02, 0.0, 0.0)
#[pyclass(frozen, eq, module = "mobile_robot_simulator", from_py_object)]
#[derive(Clone, Copy, PartialEq)]
pub struct MotionNoise(pub crate::MotionNoise);

fn default() -> [f64; 6] {
    crate::MotionNoise::default().alpha()
}

#[pymethods]
impl MotionNoise {
    #[new]
    // The text repeats the core's defaults for `help()`; a test compares the two.
    #[pyo3(
        text_signature = "(*, alpha1=0.0, alpha2=0.0, alpha3=0.0, alpha4=0.0, alpha5=0.0, alpha6=0.0, reference_step=None)",
        signature = (
            *,
            alpha1 = default()[0].into(),
            alpha2 = default()[1].into(),
            alpha3 = default()[2].into(),
            alpha4 = default()[3].into(),
            alpha5 = default()[4].into(),
            alpha6 = default()[5].into(),
            reference_step = None,
        )
    )]
    #[allow(clippy::too_many_arguments, reason = "keywords in Python")]
    fn new(
        alpha1: Argument<f64>,
        alpha2: Argument<f64>,
        alpha3: Argument<f64>,
        alpha4: Argument<f64>,
        alpha5: Argument<f64>,
        alpha6: Argument<f64>,
        reference_step: Option<Argument<f64>>,
    ) -> PyResult<Self> {
        let noise = crate::MotionNoise::new([
            alpha1.named("alpha1")?,
            alpha2.named("alpha2")?,
            alpha3.named("alpha3")?,
            alpha4.named("alpha4")?,
            alpha5.named("alpha5")?,
            alpha6.named("alpha6")?,
        ])?;
        Ok(Self(match reference_step {
            Some(step) => noise.with_reference_step(step.named("reference_step")?)?,
            None => noise,
        }))
    }

    /// The parameters (alpha1, ..., alpha6).
    #[getter]
    fn alpha(&self) -> (f64, f64, f64, f64, f64, f64) {
        self.0.alpha().into()
    }

    /// Duration of the step for which the variances hold [s]; None if they hold for every step.
    #[getter]
    fn reference_step(&self) -> Option<f64> {
        self.0.reference_step()
    }

    /// Returns a random pose that a robot may reach in `dt` seconds when it is commanded to move at a twist.
    ///
    /// This is `sample_motion_model_velocity` of Probabilistic Robotics, table 5.3, with an arc that is exact at every turn
    /// rate. The speed error points along the direction of travel, or forward if the robot turns in place.
    ///
    /// Args:
    ///     pose: Pose (x, y, yaw) at the start of the step [m, m, rad].
    ///     twist: Commanded velocity (vx, vy, wz) in the robot's frame [m/s, m/s, rad/s].
    ///     dt: Duration of the step [s].
    ///     seed: Seed of the random stream, 0 to 2**64 - 1, or a `RandomStream`, which counts the steps of all calls.
    ///     index: Index of the step, 0 to 2**64 - 1. The same seed and index give the same errors on every machine. Must be
    ///         given with a number as seed.
    ///
    /// Returns:
    ///     The pose reached. Its yaw is not wrapped.
    ///
    /// Raises:
    ///     ValueError: An argument or the pose reached is not finite, or the seed or index is out of range.
    ///     TypeError: The seed or index is not an integer.
    ///
    /// Examples:
    ///     Without noise, the pose is exact:
    ///
    ///     >>> from mobile_robot_simulator import MotionNoise
    ///     >>> MotionNoise().sample((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), 2.0, seed=1, index=0)
    ///     Pose(2.0, 0.0, 0.0)
    #[pyo3(signature = (pose, twist, dt, *, seed, index = None))]
    fn sample(
        &self,
        pose: PoseArgument,
        twist: Argument<[f64; 3]>,
        dt: Argument<f64>,
        seed: &Bound<'_, PyAny>,
        index: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Pose> {
        let (twist, dt) = (twist.named("twist")?, dt.named("dt")?);
        let seed = SeedArgument::new(Some(seed), "index", index)?;
        if !seed.has_index() {
            return Err(PyValueError::new_err(
                "a seed needs an index: give index= the number of steps before, or seed=RandomStream(7), which counts them",
            ));
        }
        let (seed, index) = seed.take(1)?;
        Ok(Pose(self.0.sample_from(pose.0, twist.into(), dt, seed, index)?))
    }

    /// Returns the covariance of (x, y, yaw) after a step, given the covariance before it.
    ///
    /// The result is F·P·Fᵀ + V·M·Vᵀ, to first order in the errors (Probabilistic Robotics, table 7.2, lines 3 to 7). F and
    /// V are the exact derivatives of the arc with respect to the pose and to the three errors; M holds the variances of the
    /// errors (table 5.3). First order is accurate while the standard deviation of the yaw is below about 0.2 rad.
    ///
    /// Args:
    ///     covariance: (3, 3), covariance of (x, y, yaw) before the step [m², m·rad, rad²].
    ///     pose: True or estimated pose (x, y, yaw) at the start of the step [m, m, rad].
    ///     twist: Commanded velocity (vx, vy, wz) in the robot's frame [m/s, m/s, rad/s].
    ///     dt: Duration of the step [s].
    ///
    /// Returns:
    ///     (3, 3) float64, the covariance after the step. It is exactly symmetric.
    ///
    /// Raises:
    ///     ValueError: The covariance has another shape, or an argument or the result is not finite.
    ///     TypeError: The covariance cannot be converted to float64 without loss.
    ///
    /// Examples:
    ///     At 2 m/s, the variance of the speed is 0.01 · 2²:
    ///
    ///     >>> import numpy as np
    ///     >>> from mobile_robot_simulator import MotionNoise
    ///     >>> MotionNoise(alpha1=0.01).propagate(np.zeros((3, 3)), (0.0, 0.0, 0.0), (2.0, 0.0, 0.0), dt=1.0)
    ///     array([[0.04, 0.  , 0.  ],
    ///            [0.  , 0.  , 0.  ],
    ///            [0.  , 0.  , 0.  ]])
    fn propagate<'py>(
        &self,
        py: Python<'py>,
        covariance: &Bound<'py, PyAny>,
        pose: PoseArgument,
        twist: Argument<[f64; 3]>,
        dt: Argument<f64>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let (twist, dt) = (twist.named("twist")?, dt.named("dt")?);
        let before = DMat3::from_cols_array_2d(&matrix("covariance", covariance)?);
        let after = self.0.propagate(before.transpose(), pose.0, twist.into(), dt)?;
        Ok(Array2::from(after.transpose().to_cols_array_2d().to_vec()).into_pyarray(py))
    }

    /// Returns the covariance of the mean velocity (vx, vy, wz) in a step.
    ///
    /// The mean velocity is the constant twist between the poses at the start and at the end of the step; see
    /// `Pose.twist_to`. The covariance is to first order in the errors and in the turn during the step.
    ///
    /// Args:
    ///     twist: Commanded velocity (vx, vy, wz) in the robot's frame [m/s, m/s, rad/s].
    ///     dt: Duration of the step [s].
    ///
    /// Returns:
    ///     (3, 3) float64 [m²/s², m·rad/s², rad²/s²].
    ///
    /// Raises:
    ///     ValueError: An argument or the result is not finite.
    ///
    /// Examples:
    ///     >>> from mobile_robot_simulator import MotionNoise
    ///     >>> noise = MotionNoise(alpha1=0.01, alpha4=0.02, reference_step=0.1)
    ///     >>> noise.twist_covariance((2.0, 0.0, 1.0), dt=0.1).diagonal().tolist()
    ///     [0.04, 0.0, 0.02]
    fn twist_covariance<'py>(
        &self,
        py: Python<'py>,
        twist: Argument<[f64; 3]>,
        dt: Argument<f64>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let covariance = self.0.twist_covariance(twist.named("twist")?.into(), dt.named("dt")?)?;
        Ok(Array2::from(covariance.to_cols_array_2d().to_vec()).into_pyarray(py))
    }

    fn __repr__(&self) -> String {
        let [a1, a2, a3, a4, a5, a6] = self.0.alpha();
        let step = self.0.reference_step().map_or(String::new(), |step| format!(", reference_step={step:?}"));
        format!(
            "MotionNoise(alpha1={a1:?}, alpha2={a2:?}, alpha3={a3:?}, alpha4={a4:?}, alpha5={a5:?}, alpha6={a6:?}{step})"
        )
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Recipe<'py>> {
        let keywords = PyDict::new(py);
        let names = ["alpha1", "alpha2", "alpha3", "alpha4", "alpha5", "alpha6"];
        for (name, value) in names.into_iter().zip(self.0.alpha()) {
            keywords.set_item(name, value)?;
        }
        keywords.set_item("reference_step", self.0.reference_step())?;
        recipe::<Self>(py, PyTuple::empty(py), keywords)
    }
}
