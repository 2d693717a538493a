//! The Python class `LikelihoodField`.

use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use super::arrays::type_name;
use super::beam_model::BeamModel;
use super::number::Argument;
use super::{Recipe, recipe};
use crate::LikelihoodFieldOptions;

/// A model of readings that looks only at where they end: the likelihood field of Probabilistic Robotics, table 6.3.
///
/// With d for the distance from the end of a reading to the nearest wall, the likelihood of the reading is
///
///     z_hit * exp(-d**2 / (2 * sigma_hit**2)) / (sigma_hit * sqrt(2 * pi)) + z_rand / max_range
///
/// d is the distance between the centre of the cell in which the reading ends and the centre of the nearest blocking cell,
/// or `max_distance` if that is smaller. Only readings from `min_range` to below `max_range` count. Of a tilted scanner, readings
/// within three times `sigma_hit` of the floor do not count.
///
/// `laser.log_likelihood` takes it as `noise`. It is faster than a `BeamModel`, since no beam is cast, and smoother, since a
/// pose that is a little wrong scores a little less. It is not a density of readings: it does not see what lies between
/// the scanner and the end of a beam, so it cannot tell a pose behind a wall from one in front of it, and nothing can be
/// sampled from it. Source: Thrun, Burgard & Fox 2005. The defaults are those of AMCL.
///
/// Args:
///     sigma_hit: Standard deviation of the distance from the end of a reading to the nearest wall [m].
///     z_hit: Weight of readings that end at a wall. The two weights are scaled to sum to 1.
///     z_rand: Weight of readings that end anywhere.
///     max_distance: Largest distance to a wall [m], at most 255 cells. Longer ones count as this one.
///
/// Raises:
///     ValueError: `sigma_hit` or `max_distance` is not positive, a weight is negative, both are 0, or a number is not finite.
///     TypeError: An argument is not a number.
///
/// Examples:
///     >>> import mobile_robot_simulator as mrs
///     >>> grid, laser = mrs.floor_plan("office", seed=1), mrs.LaserScanner(beam_count=61)
///     >>> poses = grid.draw_free_poses(10_000, radius=0.3, seed=1)
///     >>> scan = laser.scan(grid, poses[7])
///     >>> laser.log_likelihood(grid, poses, scan, noise=mrs.LikelihoodField()).argmax()
///     np.int64(7)
#[pyclass(frozen, module = "mobile_robot_simulator")]
pub struct LikelihoodField(crate::LikelihoodField);

fn default() -> LikelihoodFieldOptions {
    LikelihoodFieldOptions::default()
}

#[pymethods]
impl LikelihoodField {
    #[new]
    // The text repeats the core's defaults for `help()`; a test compares the two.
    #[pyo3(
        text_signature = "(*, sigma_hit=0.2, z_hit=0.95, z_rand=0.05, max_distance=2.0)",
        signature = (
            *,
            sigma_hit = default().sigma_hit.into(),
            z_hit = default().z_hit.into(),
            z_rand = default().z_rand.into(),
            max_distance = default().max_distance.into(),
        )
    )]
    fn new(
        sigma_hit: Argument<f64>,
        z_hit: Argument<f64>,
        z_rand: Argument<f64>,
        max_distance: Argument<f64>,
    ) -> PyResult<Self> {
        let options = LikelihoodFieldOptions {
            sigma_hit: sigma_hit.named("sigma_hit")?,
            z_hit: z_hit.named("z_hit")?,
            z_rand: z_rand.named("z_rand")?,
            max_distance: max_distance.named("max_distance")?,
        };
        Ok(Self(crate::LikelihoodField::new(options)?))
    }

    /// Standard deviation of the distance from the end of a reading to the nearest wall [m].
    #[getter]
    fn sigma_hit(&self) -> f64 {
        self.0.options().sigma_hit
    }

    /// Weight of readings that end at a wall, after scaling.
    #[getter]
    fn z_hit(&self) -> f64 {
        self.0.options().z_hit
    }

    /// Weight of readings that end anywhere, after scaling.
    #[getter]
    fn z_rand(&self) -> f64 {
        self.0.options().z_rand
    }

    /// Largest distance to a wall [m].
    #[getter]
    fn max_distance(&self) -> f64 {
        self.0.options().max_distance
    }

    fn __repr__(&self) -> String {
        let LikelihoodFieldOptions { sigma_hit, z_hit, z_rand, max_distance } = self.0.options();
        format!(
            "LikelihoodField(sigma_hit={sigma_hit:?}, z_hit={z_hit:?}, z_rand={z_rand:?}, max_distance={max_distance:?})"
        )
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Recipe<'py>> {
        let keywords = PyDict::new(py);
        let LikelihoodFieldOptions { sigma_hit, z_hit, z_rand, max_distance } = self.0.options();
        let names = ["sigma_hit", "z_hit", "z_rand", "max_distance"];
        for (name, value) in names.into_iter().zip([sigma_hit, z_hit, z_rand, max_distance]) {
            keywords.set_item(name, value)?;
        }
        recipe::<Self>(py, PyTuple::empty(py), keywords)
    }
}

/// A model of readings: a `BeamModel` or a `LikelihoodField`.
pub enum ModelArgument {
    Beams(crate::BeamModel),
    Field(crate::LikelihoodField),
}

impl<'py> FromPyObject<'_, 'py> for ModelArgument {
    type Error = PyErr;

    fn extract(value: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        if let Ok(model) = value.cast::<BeamModel>() {
            return Ok(Self::Beams(model.get().0));
        }
        if let Ok(model) = value.cast::<LikelihoodField>() {
            return Ok(Self::Field(model.get().0));
        }
        let needed = "noise must be a BeamModel or a LikelihoodField";
        Err(PyTypeError::new_err(format!("{needed}, got {}", type_name(&value))))
    }
}
