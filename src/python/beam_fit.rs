//! The Python class `BeamFit`.

use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use super::beam_model::BeamModel;
use crate::beam_fit::PARAMETERS;

/// The beam model of greatest likelihood for some readings, as returned by `BeamModel.fit`.
///
/// Examples:
///     >>> import numpy as np
///     >>> from mobile_robot_simulator import BeamModel
///     >>> readings = np.array([4.9, 5.0, 5.1, 8.0], np.float32)
///     >>> BeamModel.fit(np.full(4, 5.0, np.float32), readings, max_range=8.0).unidentified
///     ('sigma_hit', 'lambda_short')
#[pyclass(frozen, module = "mobile_robot_simulator")]
pub struct BeamFit(pub crate::BeamFit);

#[pymethods]
impl BeamFit {
    /// The model.
    #[getter]
    fn model(&self) -> BeamModel {
        BeamModel(self.0.model)
    }

    /// Log-likelihood that the model reaches: the sum of the logarithms of densities [1/m] and probabilities.
    #[getter]
    fn log_likelihood(&self) -> f64 {
        self.0.log_likelihood
    }

    /// Number of readings that were used.
    #[getter]
    fn readings(&self) -> usize {
        self.0.readings
    }

    /// Number of iterations.
    #[getter]
    fn iterations(&self) -> usize {
        self.0.iterations
    }

    /// False if the likelihood was still growing when the number of iterations reached its limit, 5000.
    #[getter]
    fn has_converged(&self) -> bool {
        self.0.has_converged
    }

    /// Standard error of each parameter by its name. None for one that is at its limit or not identified.
    #[getter]
    fn standard_errors<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let errors = PyDict::new(py);
        for (name, error) in PARAMETERS.into_iter().zip(self.0.standard_errors) {
            errors.set_item(name, (!error.is_nan()).then_some(error))?;
        }
        Ok(errors)
    }

    /// Names of the parameters that the readings do not determine.
    ///
    /// These are `sigma_hit` without hits, and `lambda_short` without short readings. The model has some value for them.
    #[getter]
    fn unidentified<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, &self.0.unidentified)
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let model = self.model().into_pyobject(py)?.repr()?;
        let crate::BeamFit { readings, log_likelihood, unidentified, .. } = &self.0;
        let names = PyTuple::new(py, unidentified)?.repr()?;
        Ok(format!("BeamFit({model}, readings={readings}, log_likelihood={log_likelihood:.6}, unidentified={names})"))
    }
}
