//! The Python class `BeamModel`.

use numpy::{PyArrayMethods, PyReadonlyArrayDyn};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use super::arrays::{broadcast, type_name, typed, vector};
use super::beam_fit::BeamFit;
use super::number::Argument;
use super::{Recipe, recipe};
use crate::{BeamModelOptions, memory};

/// Noise of a range finder: the beam model of Probabilistic Robotics (Thrun, Burgard & Fox 2006), table 6.1.
///
/// A reading is drawn from a mixture of four parts:
///
/// - hit: normal around the true range, truncated to [0, max_range];
/// - short: exponential, for unexpected objects, truncated to [0, true range];
/// - max: exactly max_range, for failures;
/// - random: uniform over [0, max_range), for unexplained readings.
///
/// A beam that hits nothing reads exactly max_range in the hit part; its short and random readings are drawn with a true
/// range of max_range. The defaults are those of the ROS package mobile_robot_simulator.
///
/// Args:
///     sigma_hit: Standard deviation of the hit part [m].
///     lambda_short: Rate of the short part [1/m].
///     z_hit: Weight of the hit part. The four weights are scaled to sum to 1.
///     z_short: Weight of the short part.
///     z_max: Weight of the max part.
///     z_rand: Weight of the random part.
///     range_offset: Distance by which hits lie behind the true range [m]; negative for in front of it. The sum is kept within
///         [0, max_range].
///     range_sigma_base: Together with `range_sigma_per_metre`: the standard deviation of a hit is at least
///         `range_sigma_base + range_sigma_per_metre * true_range` [m].
///     range_sigma_per_metre: Growth of that standard deviation with the true range [m/m].
///     range_step: Readings are rounded to multiples of this step [m]; 0 for none. Readings of `max_range` stay as they are.
///     range_step_share: Largest share of a reading that its step may be, 0 to 0.5, if that is more than `range_step`: with
///         0.01, the step doubles where it is 1/100 of the reading. 0 for steps that do not grow.
///
/// Raises:
///     ValueError: `sigma_hit` or `lambda_short` is not positive, a weight or another number but `range_offset` is negative, no
///         weight is positive, `range_step_share` is more than 0.5, or a number is not finite.
///
/// Examples:
///     >>> from mobile_robot_simulator import BeamModel
///     >>> BeamModel(z_hit=3.0, z_max=1.0).z_hit
///     0.75
#[pyclass(frozen, module = "mobile_robot_simulator", from_py_object)]
#[derive(Clone, Copy)]
pub struct BeamModel(pub crate::BeamModel);

fn default() -> BeamModelOptions {
    BeamModelOptions::default()
}

#[pymethods]
impl BeamModel {
    #[new]
    // The text repeats the core's defaults for `help()`; a test compares the two.
    #[pyo3(
        text_signature = "(*, sigma_hit=0.005, lambda_short=2.0, z_hit=0.995, z_short=0.0, z_max=0.005, z_rand=0.0, \
                          range_offset=0.0, range_sigma_base=0.0, range_sigma_per_metre=0.0, range_step=0.0, \
                          range_step_share=0.0)",
        signature = (
            *,
            sigma_hit = default().sigma_hit.into(),
            lambda_short = default().lambda_short.into(),
            z_hit = default().z_hit.into(),
            z_short = default().z_short.into(),
            z_max = default().z_max.into(),
            z_rand = default().z_rand.into(),
            range_offset = default().range_offset.into(),
            range_sigma_base = default().range_sigma_base.into(),
            range_sigma_per_metre = default().range_sigma_per_metre.into(),
            range_step = default().range_step.into(),
            range_step_share = default().range_step_share.into(),
        )
    )]
    #[allow(clippy::too_many_arguments, reason = "they are keyword arguments in Python")]
    fn new(
        sigma_hit: Argument<f64>,
        lambda_short: Argument<f64>,
        z_hit: Argument<f64>,
        z_short: Argument<f64>,
        z_max: Argument<f64>,
        z_rand: Argument<f64>,
        range_offset: Argument<f64>,
        range_sigma_base: Argument<f64>,
        range_sigma_per_metre: Argument<f64>,
        range_step: Argument<f64>,
        range_step_share: Argument<f64>,
    ) -> PyResult<Self> {
        let options = BeamModelOptions {
            sigma_hit: sigma_hit.named("sigma_hit")?,
            lambda_short: lambda_short.named("lambda_short")?,
            z_hit: z_hit.named("z_hit")?,
            z_short: z_short.named("z_short")?,
            z_max: z_max.named("z_max")?,
            z_rand: z_rand.named("z_rand")?,
            range_offset: range_offset.named("range_offset")?,
            range_sigma_base: range_sigma_base.named("range_sigma_base")?,
            range_sigma_per_metre: range_sigma_per_metre.named("range_sigma_per_metre")?,
            range_step: range_step.named("range_step")?,
            range_step_share: range_step_share.named("range_step_share")?,
        };
        Ok(Self(crate::BeamModel::new(options)?))
    }

    /// Returns the noise of a scanner that is sold. What is not known of it has the default.
    ///
    /// Args:
    ///     name: Name of the preset, such as hokuyo_utm30lx; `laser_presets` lists all.
    ///
    /// Raises:
    ///     ValueError: There is no such preset.
    ///
    /// Examples:
    ///     >>> import mobile_robot_simulator as mrs
    ///     >>> mrs.BeamModel.preset("hokuyo_utm30lx").sigma_hit
    ///     0.018
    #[staticmethod]
    fn preset(name: &str) -> PyResult<Self> {
        Ok(Self(crate::BeamModel::preset(name)?))
    }

    /// Standard deviation of the hit part [m].
    #[getter]
    fn sigma_hit(&self) -> f64 {
        self.0.options().sigma_hit
    }

    /// Rate of the short part [1/m].
    #[getter]
    fn lambda_short(&self) -> f64 {
        self.0.options().lambda_short
    }

    /// Weight of the hit part, after scaling.
    #[getter]
    fn z_hit(&self) -> f64 {
        self.0.options().z_hit
    }

    /// Weight of the short part, after scaling.
    #[getter]
    fn z_short(&self) -> f64 {
        self.0.options().z_short
    }

    /// Weight of the max part, after scaling.
    #[getter]
    fn z_max(&self) -> f64 {
        self.0.options().z_max
    }

    /// Weight of the random part, after scaling.
    #[getter]
    fn z_rand(&self) -> f64 {
        self.0.options().z_rand
    }

    /// Distance by which hits lie behind the true range [m].
    #[getter]
    fn range_offset(&self) -> f64 {
        self.0.options().range_offset
    }

    /// Least standard deviation of a hit at a true range of 0 [m].
    #[getter]
    fn range_sigma_base(&self) -> f64 {
        self.0.options().range_sigma_base
    }

    /// Growth of that standard deviation with the true range [m/m].
    #[getter]
    fn range_sigma_per_metre(&self) -> f64 {
        self.0.options().range_sigma_per_metre
    }

    /// Smallest step between readings [m]; 0 for none.
    #[getter]
    fn range_step(&self) -> f64 {
        self.0.options().range_step
    }

    /// Largest share of a reading that its step may be; 0 for steps that do not grow.
    #[getter]
    fn range_step_share(&self) -> f64 {
        self.0.options().range_step_share
    }

    /// Returns the likelihood of each reading, given the true range of its beam.
    ///
    /// Args:
    ///     readings: float32 of any shape, measured ranges [m].
    ///     true_ranges: float32, true ranges [m]. A true range of `max_range` or more means that the beam hits nothing. The
    ///         shapes of both arrays are broadcast, as by NumPy.
    ///     max_range: Maximum range of the scanner [m].
    ///     min_range: Smallest valid range of the scanner [m].
    ///
    /// Returns:
    ///     float64 of the broadcast shape. A reading of `max_range` and above, +inf too, has the probability of a beam
    ///         without a return; one below `min_range`, -inf too, that of such a reading. Any other has a probability density
    ///         [1/m], except that 0 has a probability if the true range is 0. If readings are rounded, it is the mean density over
    ///         all that are rounded to the same step. NaN has 1, so that it does not count in a product.
    ///
    /// Raises:
    ///     ValueError: The shapes cannot be broadcast, `max_range` is not positive and finite, `min_range` is not in
    ///         [0, max_range), or a true range is negative or NaN.
    ///     TypeError: An array cannot be converted to float32 without loss.
    ///
    /// Examples:
    ///     The probability of reading the maximum, for a beam that hits a wall and for one that hits nothing:
    ///
    ///     >>> import numpy as np
    ///     >>> from mobile_robot_simulator import BeamModel
    ///     >>> model = BeamModel(z_hit=0.9, z_max=0.1)
    ///     >>> model.likelihood(np.array([30, 30], np.float32), np.array([5, 30], np.float32), max_range=30.0)
    ///     array([0.1, 1. ])
    #[pyo3(
        text_signature = "($self, readings, true_ranges, max_range, *, min_range=0.0)",
        signature = (readings, true_ranges, max_range, *, min_range = 0.0.into())
    )]
    fn likelihood<'py>(
        &self,
        py: Python<'py>,
        readings: &Bound<'py, PyAny>,
        true_ranges: &Bound<'py, PyAny>,
        max_range: Argument<f64>,
        min_range: Argument<f64>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let limits = (min_range.named("min_range")?, max_range.named("max_range")?);
        let (readings, ranges) = (typed::<f32>("readings", readings)?, typed::<f32>("true_ranges", true_ranges)?);
        let [readings, ranges] = broadcast([("readings", readings), ("true_ranges", ranges)])?;
        let (readings, ranges) = (readings.as_array(), ranges.as_array());
        let likelihoods = self.0.likelihoods(readings.iter().copied(), ranges.iter().copied(), limits)?;
        Ok(vector(py, likelihoods).reshape(readings.shape().to_vec())?.into_any())
    }

    /// Returns the model of greatest likelihood for measured readings.
    ///
    /// It has one standard deviation for all true ranges, no offset and no steps: `range_offset` and the other `range_...` are 0.
    /// Method: expectation maximization, as in table 6.2 of the book, with the truncation of the hit and the short part taken into
    /// account, and with leaps (Varadhan & Roland, 2008). NaN is left out, and so are readings with a true range of 0.
    ///
    /// Args:
    ///     true_ranges: float32 of any shape, true ranges [m]. A true range of `max_range` or more means that the beam hits
    ///         nothing. The shapes of both arrays are broadcast, as by NumPy.
    ///     readings: float32, measured ranges [m]. Readings of `max_range` and above, +inf too, are beams without a return.
    ///     max_range: Maximum range of the scanner [m].
    ///     min_range: Smallest valid range of the scanner [m]. Readings below it, -inf too, count as any reading from 0 to
    ///         `min_range`. If it is 0, they are left out.
    ///     fit_offset: If True, also fits how far real returns lie behind the true ranges, because the walls of a map are often a
    ///         cell thicker than real ones. The model is then that for true ranges with `fit.offset` added to those below
    ///         `max_range`.
    ///
    /// Returns:
    ///     The model with its log-likelihood, the offset, and the standard error of each parameter.
    ///
    /// Raises:
    ///     ValueError: The shapes cannot be broadcast, `max_range` is not positive and finite, `min_range` is not in
    ///         [0, max_range), a true range is negative or NaN, or no reading can be used.
    ///     TypeError: An array cannot be converted to float32 without loss.
    ///
    /// Examples:
    ///     >>> import mobile_robot_simulator as mrs
    ///     >>> grid = mrs.floor_plan("office", seed=1)
    ///     >>> poses = grid.draw_free_poses(100, radius=0.3, seed=1)
    ///     >>> laser, noise = mrs.LaserScanner(), mrs.BeamModel(sigma_hit=0.05, z_hit=0.9, z_rand=0.1, z_max=0.0)
    ///     >>> readings = laser.scan_batch(grid, poses, noise=noise, seed=1)
    ///     >>> fit = mrs.BeamModel.fit(laser.scan_batch(grid, poses), readings, max_range=30.0)
    ///     >>> round(fit.model.sigma_hit, 2), round(fit.model.z_rand, 2), fit.unidentified
    ///     (0.05, 0.1, ('lambda_short',))
    #[staticmethod]
    #[pyo3(
        text_signature = "(true_ranges, readings, max_range, *, min_range=0.0, fit_offset=False)",
        signature = (true_ranges, readings, max_range, *, min_range = 0.0.into(), fit_offset = false)
    )]
    fn fit(
        py: Python<'_>,
        true_ranges: &Bound<'_, PyAny>,
        readings: &Bound<'_, PyAny>,
        max_range: Argument<f64>,
        min_range: Argument<f64>,
        fit_offset: bool,
    ) -> PyResult<BeamFit> {
        let limits = (min_range.named("min_range")?, max_range.named("max_range")?);
        let (readings, ranges) = (typed::<f32>("readings", readings)?, typed::<f32>("true_ranges", true_ranges)?);
        let [readings, ranges] = broadcast([("readings", readings), ("true_ranges", ranges)])?;
        let (readings, ranges) = (copied(&readings)?, copied(&ranges)?);
        let fit = py.detach(|| {
            if fit_offset {
                crate::BeamModel::fit_with_offset(readings, ranges, limits)
            } else {
                crate::BeamModel::fit(readings, ranges, limits)
            }
        })?;
        Ok(BeamFit(fit))
    }

    /// Returns the standard deviation of the hits for six equal bands of incidence, from 0° to 90°.
    ///
    /// Real readings scatter more on walls that the beam meets at a grazing angle. Each is the one of greatest likelihood,
    /// with everything else as in this model. `range_offset` counts; what else depends on the range does not.
    ///
    /// Args:
    ///     true_ranges: float32 of any shape, true ranges [m], as for `fit`; with the offset added, if one was fitted.
    ///     readings: float32, measured ranges [m].
    ///     incidences: float32, angle between the beam and the normal of its wall [rad], 0 to π/2. Readings with another one,
    ///         such as NaN, are left out. The shapes of the three arrays are broadcast, as by NumPy.
    ///     max_range: Maximum range of the scanner [m].
    ///     min_range: Smallest valid range of the scanner [m].
    ///
    /// Returns:
    ///     (6,) float64 [m]; NaN for a band with fewer than ten hits.
    ///
    /// Raises:
    ///     ValueError: The shapes cannot be broadcast, `max_range` is not positive and finite, `min_range` is not in
    ///         [0, max_range), or a true range is negative or NaN.
    ///     TypeError: An array cannot be converted to float32 without loss.
    ///
    /// Examples:
    ///     >>> import numpy as np
    ///     >>> from mobile_robot_simulator import BeamModel
    ///     >>> true = np.full(100, 5.0, np.float32)
    ///     >>> readings = true + np.float32([0.1, -0.1] * 50)
    ///     >>> model = BeamModel(sigma_hit=0.05, z_hit=1.0)
    ///     >>> model.sigma_by_incidence(true, readings, np.full(100, 0.1, np.float32), max_range=30.0).round(3)
    ///     array([0.1, nan, nan, nan, nan, nan])
    #[pyo3(
        text_signature = "($self, true_ranges, readings, incidences, max_range, *, min_range=0.0)",
        signature = (true_ranges, readings, incidences, max_range, *, min_range = 0.0.into())
    )]
    fn sigma_by_incidence<'py>(
        &self,
        py: Python<'py>,
        true_ranges: &Bound<'py, PyAny>,
        readings: &Bound<'py, PyAny>,
        incidences: &Bound<'py, PyAny>,
        max_range: Argument<f64>,
        min_range: Argument<f64>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let limits = (min_range.named("min_range")?, max_range.named("max_range")?);
        let (readings, ranges) = (typed::<f32>("readings", readings)?, typed::<f32>("true_ranges", true_ranges)?);
        let incidences = typed::<f32>("incidences", incidences)?;
        let [readings, ranges, incidences] =
            broadcast([("readings", readings), ("true_ranges", ranges), ("incidences", incidences)])?;
        let (readings, ranges, incidences) = (copied(&readings)?, copied(&ranges)?, copied(&incidences)?);
        let sigmas = py.detach(|| self.0.sigma_by_incidence(&readings, &ranges, &incidences, limits))?;
        Ok(vector(py, sigmas.to_vec()).into_any())
    }

    fn __repr__(&self) -> String {
        // What is off is left out.
        let is_said = |(name, value): &(&str, f64)| !name.starts_with("range_") || *value != 0.0;
        let numbers = self.numbers().into_iter().filter(is_said).map(|(name, value)| format!("{name}={value:?}"));
        let numbers: Vec<String> = numbers.collect();
        format!("BeamModel({})", numbers.join(", "))
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Recipe<'py>> {
        let keywords = PyDict::new(py);
        for (name, value) in self.numbers() {
            keywords.set_item(name, value)?;
        }
        recipe::<Self>(py, PyTuple::empty(py), keywords)
    }
}

impl BeamModel {
    /// Returns the arguments, by name.
    fn numbers(&self) -> [(&'static str, f64); 11] {
        let options = self.0.options();
        [
            ("sigma_hit", options.sigma_hit),
            ("lambda_short", options.lambda_short),
            ("z_hit", options.z_hit),
            ("z_short", options.z_short),
            ("z_max", options.z_max),
            ("z_rand", options.z_rand),
            ("range_offset", options.range_offset),
            ("range_sigma_base", options.range_sigma_base),
            ("range_sigma_per_metre", options.range_sigma_per_metre),
            ("range_step", options.range_step),
            ("range_step_share", options.range_step_share),
        ]
    }
}

/// Copies readings, because other Python threads may change the array during a fit.
fn copied(array: &PyReadonlyArrayDyn<'_, f32>) -> Result<Vec<f32>, crate::Error> {
    memory::collected("the readings", array.as_array().iter().copied())
}

/// A noise argument: a `BeamModel`.
pub struct NoiseArgument(pub crate::BeamModel);

impl<'py> FromPyObject<'_, 'py> for NoiseArgument {
    type Error = PyErr;

    fn extract(value: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        if let Ok(model) = value.cast::<BeamModel>() {
            return Ok(Self(model.get().0));
        }
        let number = value.extract::<f64>().ok().filter(|sigma| sigma.is_finite() && *sigma > 0.0);
        let hint = number.map_or_else(String::new, |sigma| format!("; try BeamModel(sigma_hit={sigma:?})"));
        Err(PyTypeError::new_err(format!("noise must be a BeamModel, got {}{hint}", type_name(&value))))
    }
}
