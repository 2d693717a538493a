//! `BeamModel` for Python.

use numpy::PyArrayMethods;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use super::arrays::{shape, typed, vector};
use crate::BeamModelOptions;

/// Noise of a range finder: the beam model of Probabilistic Robotics (Thrun, Burgard & Fox 2006), table 6.1.
///
/// sigma_hit: standard deviation of a range [m]. lambda_short: rate of unexpected objects [1/m].
/// z_hit, z_short, z_max, z_rand: weights of correct ranges, unexpected objects, failures (readings of the maximum) and
/// unexplained readings; scaled to sum to 1. The hit part is truncated to [0, max_range], the short part to [0, true range].
/// A beam that hits nothing reads max_range where others read a correct range; short and random readings can still befall it.
///
/// raises: ValueError for a sigma or lambda that is not positive, a negative weight, or no positive weight.
#[pyclass(frozen, module = "mobile_robot_simulator", from_py_object)]
#[derive(Clone, Copy)]
pub struct BeamModel(pub crate::BeamModel);

fn default() -> BeamModelOptions {
    BeamModelOptions::default()
}

#[pymethods]
impl BeamModel {
    #[new]
    #[pyo3(signature = (
        *,
        sigma_hit = default().sigma_hit,
        lambda_short = default().lambda_short,
        z_hit = default().z_hit,
        z_short = default().z_short,
        z_max = default().z_max,
        z_rand = default().z_rand,
    ))]
    fn new(sigma_hit: f64, lambda_short: f64, z_hit: f64, z_short: f64, z_max: f64, z_rand: f64) -> PyResult<Self> {
        let options = BeamModelOptions { sigma_hit, lambda_short, z_hit, z_short, z_max, z_rand };
        Ok(Self(crate::BeamModel::new(options)?))
    }

    /// Standard deviation of a measured range [m].
    #[getter]
    fn sigma_hit(&self) -> f64 {
        self.0.options().sigma_hit
    }

    /// Rate of unexpected objects [1/m].
    #[getter]
    fn lambda_short(&self) -> f64 {
        self.0.options().lambda_short
    }

    /// Weight of correct ranges with local noise.
    #[getter]
    fn z_hit(&self) -> f64 {
        self.0.options().z_hit
    }

    /// Weight of unexpected objects.
    #[getter]
    fn z_short(&self) -> f64 {
        self.0.options().z_short
    }

    /// Weight of failures.
    #[getter]
    fn z_max(&self) -> f64 {
        self.0.options().z_max
    }

    /// Weight of unexplained readings.
    #[getter]
    fn z_rand(&self) -> f64 {
        self.0.options().z_rand
    }

    /// Likelihood of readings given true ranges.
    ///
    /// readings, true_ranges: float32 arrays of one shape [m]; a true range of max_range means a beam that hits nothing.
    /// returns: (size,) float64: the density [1/m] of readings in [0, max_range), the probability of those of max_range, else 0.
    /// raises: ValueError for shapes that differ or a max_range that is not positive; TypeError for dtypes.
    fn likelihood<'py>(
        &self,
        py: Python<'py>,
        readings: &Bound<'py, PyAny>,
        true_ranges: &Bound<'py, PyAny>,
        max_range: f64,
    ) -> PyResult<Bound<'py, PyAny>> {
        let (readings, ranges) = (typed::<f32>("readings", readings)?, typed::<f32>("true_ranges", true_ranges)?);
        let (readings, ranges) = (readings.as_array(), ranges.as_array());
        if readings.shape() != ranges.shape() {
            let (needed, got) = (shape(readings.shape()), shape(ranges.shape()));
            return Err(PyValueError::new_err(format!("true_ranges must have the shape of readings {needed}, got {got}")));
        }
        let likelihoods = self.0.likelihoods(readings.iter().copied(), ranges.iter().copied(), max_range)?;
        Ok(vector(py, likelihoods).reshape(readings.shape().to_vec())?.into_any())
    }

    fn __repr__(&self) -> String {
        let BeamModelOptions { sigma_hit, lambda_short, z_hit, z_short, z_max, z_rand } = self.0.options();
        format!(
            "BeamModel(sigma_hit={sigma_hit:?}, lambda_short={lambda_short:?}, \
             z_hit={z_hit:?}, z_short={z_short:?}, z_max={z_max:?}, z_rand={z_rand:?})"
        )
    }

    #[allow(clippy::type_complexity, reason = "what pickle asks for")]
    fn __getnewargs_ex__<'py>(&self, py: Python<'py>) -> PyResult<((), Bound<'py, pyo3::types::PyDict>)> {
        let keywords = pyo3::types::PyDict::new(py);
        let BeamModelOptions { sigma_hit, lambda_short, z_hit, z_short, z_max, z_rand } = self.0.options();
        let names = ["sigma_hit", "lambda_short", "z_hit", "z_short", "z_max", "z_rand"];
        for (name, value) in names.into_iter().zip([sigma_hit, lambda_short, z_hit, z_short, z_max, z_rand]) {
            keywords.set_item(name, value)?;
        }
        Ok(((), keywords))
    }
}
