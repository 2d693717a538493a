//! The Python class `SurfaceModel`.

use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use super::arrays::type_name;
use super::number::Argument;
use super::{Recipe, recipe};
use crate::SurfaceOptions;

/// How the surface that a beam meets changes its reading: by angle, light and place, and by the width of the beam.
///
/// It changes the hit part of a `BeamModel`, and which beams have a return: give both to `scan_batch` or a `Fleet`, as `noise` and
/// `surfaces`.
/// By default all is off.
///
/// The incidence is the angle between the beam and the normal of the surface, 0 for a beam perpendicular to it. It is exact at
/// an obstacle. At a blocking cell, the normal is that of the wall around it (`OccupancyGrid.wall_directions`), or of the side
/// of the cell where the direction of the wall is unknown.
///
/// Args:
///     incidence_sigma: Exponent p, 0 to 4: the standard deviation of a hit is multiplied by `cos(incidence)**-p`. 0.5 is the
///         noise of a receiver that counts photons from a matt surface; 1 is the form of Soudarissanane et al. 2009.
///     incidence_limit: Incidence from which on nothing grows any further [rad], at least 0 and below π/2.
///     incidence_bias: Distance by which hits at a grazing incidence lie behind those at a perpendicular one [m]:
///         `incidence_bias * (1 - cos(incidence))` is added.
///     correlation: Part of the variance of a hit that is fixed for each beam and cell, 0 to 1. The rest is drawn for each
///         scan. So a robot that stands sees a constant part of the error. It depends on the seed, not on the index of the scan.
///     reference_range: Distance R at which a surface of reflectivity 1, met at a right angle, returns every second beam [m]. The
///         chance of no return at a distance r is `q**4 / (1 + q**4)`, with `q = r**2 / (R**2 * reflectivity * cos(incidence))`.
///         A beam without a return reads as one that meets nothing: the maximum range. 0 is off: all beams return.
///     beam_divergence: Angle over which a beam is spread [rad], 0 to 0.2. A beam that meets an edge reads one of the two surfaces, or
///         a range between them. 0 is off: a beam has no width.
///     edge_depth: Smallest difference between the ranges of the two surfaces at an edge [m]. A beam at a smaller step has the
///         range of its middle.
///     mixing_length: Two surfaces at an edge whose ranges differ by at most this much can be mixed [m]. If the near one has a share s
///         of the beam, the beam reads the near one with the probability `s**2`, the far one with `(1 - s)**2`, else a range
///         between them. If they are farther apart, these are s, 1 - s and 0.
///
/// Raises:
///     ValueError: A number is out of its range or not finite.
///
/// Examples:
///     Readings of a wall that the beam meets at 60°: cos(60°) = 0.5.
///
///     >>> import math
///     >>> import numpy as np
///     >>> import mobile_robot_simulator as mrs
///     >>> cells = np.zeros((100, 100), np.int8)
///     >>> cells[:, 80] = 100
///     >>> grid = mrs.OccupancyGrid(cells, resolution=0.05)
///     >>> laser, poses = mrs.LaserScanner(beam_count=1), np.tile([3.0, 1.0, math.radians(60)], (10_000, 1))
///     >>> noise = mrs.BeamModel(sigma_hit=0.01, z_hit=1.0, z_max=0.0)
///     >>> surfaces = mrs.SurfaceModel(incidence_sigma=1.0)
///     >>> laser.scan_batch(grid, poses, noise=noise, surfaces=surfaces, seed=1).std().round(3)
///     np.float32(0.02)
#[pyclass(frozen, module = "mobile_robot_simulator", from_py_object)]
#[derive(Clone, Copy)]
pub struct SurfaceModel(pub crate::SurfaceModel);

fn default() -> SurfaceOptions {
    SurfaceOptions::default()
}

#[pymethods]
impl SurfaceModel {
    #[new]
    // The text repeats the core's defaults for `help()`; a test compares the two.
    #[pyo3(
        text_signature = "(*, incidence_sigma=0.0, incidence_limit=1.5, incidence_bias=0.0, correlation=0.0, \
                          reference_range=0.0, beam_divergence=0.0, edge_depth=0.1, mixing_length=0.75)",
        signature = (
            *,
            incidence_sigma = default().incidence_sigma.into(),
            incidence_limit = default().incidence_limit.into(),
            incidence_bias = default().incidence_bias.into(),
            correlation = default().correlation.into(),
            reference_range = default().reference_range.into(),
            beam_divergence = default().beam_divergence.into(),
            edge_depth = default().edge_depth.into(),
            mixing_length = default().mixing_length.into(),
        )
    )]
    #[allow(clippy::too_many_arguments, reason = "they are keyword arguments in Python")]
    fn new(
        incidence_sigma: Argument<f64>,
        incidence_limit: Argument<f64>,
        incidence_bias: Argument<f64>,
        correlation: Argument<f64>,
        reference_range: Argument<f64>,
        beam_divergence: Argument<f64>,
        edge_depth: Argument<f64>,
        mixing_length: Argument<f64>,
    ) -> PyResult<Self> {
        let options = SurfaceOptions {
            incidence_sigma: incidence_sigma.named("incidence_sigma")?,
            incidence_limit: incidence_limit.named("incidence_limit")?,
            incidence_bias: incidence_bias.named("incidence_bias")?,
            correlation: correlation.named("correlation")?,
            reference_range: reference_range.named("reference_range")?,
            beam_divergence: beam_divergence.named("beam_divergence")?,
            edge_depth: edge_depth.named("edge_depth")?,
            mixing_length: mixing_length.named("mixing_length")?,
        };
        Ok(Self(crate::SurfaceModel::new(options)?))
    }

    /// Exponent of the standard deviation of a hit by incidence.
    #[getter]
    fn incidence_sigma(&self) -> f64 {
        self.0.options().incidence_sigma
    }

    /// Incidence from which on nothing grows any further [rad].
    #[getter]
    fn incidence_limit(&self) -> f64 {
        self.0.options().incidence_limit
    }

    /// Distance by which hits at a grazing incidence lie behind those at a perpendicular one [m].
    #[getter]
    fn incidence_bias(&self) -> f64 {
        self.0.options().incidence_bias
    }

    /// Part of the variance of a hit that is fixed for each beam and cell.
    #[getter]
    fn correlation(&self) -> f64 {
        self.0.options().correlation
    }

    /// Distance at which a surface of reflectivity 1, met at a right angle, returns every second beam [m]; 0 is off.
    #[getter]
    fn reference_range(&self) -> f64 {
        self.0.options().reference_range
    }

    /// Angle over which a beam is spread [rad]; 0 is off.
    #[getter]
    fn beam_divergence(&self) -> f64 {
        self.0.options().beam_divergence
    }

    /// Smallest difference between the ranges of the two surfaces at an edge [m].
    #[getter]
    fn edge_depth(&self) -> f64 {
        self.0.options().edge_depth
    }

    /// Largest difference of two ranges that become one reading between them [m].
    #[getter]
    fn mixing_length(&self) -> f64 {
        self.0.options().mixing_length
    }

    fn __repr__(&self) -> String {
        let numbers = self.numbers().map(|(name, value)| format!("{name}={value:?}"));
        format!("SurfaceModel({})", numbers.join(", "))
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Recipe<'py>> {
        let keywords = PyDict::new(py);
        for (name, value) in self.numbers() {
            keywords.set_item(name, value)?;
        }
        recipe::<Self>(py, PyTuple::empty(py), keywords)
    }
}

impl SurfaceModel {
    /// Returns the names and values of the arguments.
    fn numbers(&self) -> [(&'static str, f64); 8] {
        let options = self.0.options();
        [
            ("incidence_sigma", options.incidence_sigma),
            ("incidence_limit", options.incidence_limit),
            ("incidence_bias", options.incidence_bias),
            ("correlation", options.correlation),
            ("reference_range", options.reference_range),
            ("beam_divergence", options.beam_divergence),
            ("edge_depth", options.edge_depth),
            ("mixing_length", options.mixing_length),
        ]
    }
}

/// A surfaces argument: a `SurfaceModel`.
pub struct SurfacesArgument(pub crate::SurfaceModel);

impl<'py> FromPyObject<'_, 'py> for SurfacesArgument {
    type Error = PyErr;

    fn extract(value: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        match value.cast::<SurfaceModel>() {
            Ok(model) => Ok(Self(model.get().0)),
            Err(_) => Err(PyTypeError::new_err(format!("surfaces must be a SurfaceModel, got {}", type_name(&value)))),
        }
    }
}
