//! The Python class `BeamFit`.

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use super::beam_model::BeamModel;
use super::number::Argument;
use super::{Recipe, recipe, whole_number};
use crate::beam_fit::PARAMETERS;

/// The beam model of greatest likelihood for some readings, as returned by `BeamModel.fit`.
///
/// Args:
///     model: The model.
///     log_likelihood: Log-likelihood that the model reaches.
///     count: Number of readings that were used.
///     iterations: Number of iterations.
///     has_converged: False if the likelihood was still growing at the end.
///     standard_errors: Standard error of each parameter by its name. None for one that is at its limit or not identified.
///     unidentified: Names of the parameters that the readings do not determine.
///     offset: What to add to true ranges below the maximum [m]; None if it was not fitted.
///
/// Raises:
///     ValueError: A number is negative or not finite, or a name is not one of a parameter.
///     TypeError: An argument has the wrong type.
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
    #[new]
    #[pyo3(signature = (*, model, log_likelihood, count, iterations, has_converged, standard_errors, unidentified, offset = None))]
    #[allow(clippy::too_many_arguments, reason = "they are keyword arguments in Python")]
    fn new(
        model: BeamModel,
        log_likelihood: Argument<f64>,
        count: &Bound<'_, PyAny>,
        iterations: &Bound<'_, PyAny>,
        has_converged: bool,
        standard_errors: &Bound<'_, PyDict>,
        unidentified: &Bound<'_, PyAny>,
        offset: Option<Argument<f64>>,
    ) -> PyResult<Self> {
        let mut errors = [f64::NAN; PARAMETERS.len()];
        for (name, error) in PARAMETERS.into_iter().zip(&mut errors) {
            let given = standard_errors.get_item(name)?.filter(|given| !given.is_none());
            if let Some(given) = given {
                *error = given.extract::<Argument<f64>>()?.named(name)?;
            }
        }
        // Not extracted as a vector, which would trust a length that the object only claims to have.
        let mut names = Vec::new();
        for given in unidentified.try_iter()? {
            let given: String = given?.extract()?;
            let name = PARAMETERS.into_iter().find(|name| *name == given && !names.contains(name));
            let text = || format!("unidentified must be different names of parameters, got '{given:.40}'");
            names.push(name.ok_or_else(|| PyValueError::new_err(text()))?);
        }
        Ok(Self(crate::BeamFit {
            model: model.0,
            offset: offset.map(|offset| offset.named("offset")).transpose()?,
            log_likelihood: log_likelihood.named("log_likelihood")?,
            count: whole_number("count", count, "at least 0")?,
            iterations: whole_number("iterations", iterations, "at least 0")?,
            has_converged,
            standard_errors: errors,
            unidentified: names,
        }))
    }

    /// The model.
    #[getter]
    fn model(&self) -> BeamModel {
        BeamModel(self.0.model)
    }

    /// What to add to true ranges below the maximum [m]; None if it was not fitted.
    #[getter]
    fn offset(&self) -> Option<f64> {
        self.0.offset
    }

    /// Log-likelihood that the model reaches: the sum of the logarithms of densities [1/m] and probabilities.
    #[getter]
    fn log_likelihood(&self) -> f64 {
        self.0.log_likelihood
    }

    /// Number of readings that were used.
    #[getter]
    fn count(&self) -> usize {
        self.0.count
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
        let fitted = PARAMETERS.len() - usize::from(self.0.offset.is_none());
        for (name, error) in PARAMETERS.into_iter().zip(self.0.standard_errors).take(fitted) {
            errors.set_item(name, (!error.is_nan()).then_some(error))?;
        }
        Ok(errors)
    }

    /// Names of the parameters that the readings do not determine.
    ///
    /// These are `sigma_hit` and `offset` without hits, and `lambda_short` without short readings. The model has some value for them.
    #[getter]
    fn unidentified<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, &self.0.unidentified)
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let model = self.model().into_pyobject(py)?.repr()?;
        let crate::BeamFit { count, log_likelihood, unidentified, offset, .. } = &self.0;
        let names = PyTuple::new(py, unidentified)?.repr()?;
        let offset = offset.map_or_else(String::new, |offset| format!(", offset={offset:.4}"));
        Ok(format!("BeamFit({model}, count={count}, log_likelihood={log_likelihood:.6}, unidentified={names}{offset})"))
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Recipe<'py>> {
        let keywords = PyDict::new(py);
        keywords.set_item("model", self.model())?;
        keywords.set_item("log_likelihood", self.log_likelihood())?;
        keywords.set_item("count", self.count())?;
        keywords.set_item("iterations", self.iterations())?;
        keywords.set_item("has_converged", self.has_converged())?;
        keywords.set_item("standard_errors", self.standard_errors(py)?)?;
        keywords.set_item("unidentified", self.unidentified(py)?)?;
        keywords.set_item("offset", self.offset())?;
        recipe::<Self>(py, PyTuple::empty(py), keywords)
    }
}
