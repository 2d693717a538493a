//! The Python function `scan_each`.

use pyo3::prelude::*;
use pyo3::types::PyList;

use super::arrays::vector;
use super::beam_model::NoiseArgument;
use super::grid::GridArgument;
use super::obstacles::ObstaclesArgument;
use super::pose::PoseArgument;
use super::scanner::LaserScanner;
use super::surface_model::SurfacesArgument;
use super::{stream_number, thread_count};
use crate::scanner::{Shot, ShotNoise};
use crate::{memory, scanner};

/// What the memory is for, in errors.
const NAME: &str = "the scans";

/// Scanner, grid, pose, obstacles, noise, surfaces, seed and index of one scan.
type Scan<'py> = (
    Bound<'py, LaserScanner>,
    GridArgument<'py>,
    PoseArgument,
    ObstaclesArgument,
    Option<NoiseArgument>,
    Option<SurfacesArgument>,
    Bound<'py, PyAny>,
    Bound<'py, PyAny>,
);

/// Returns scans in one instant, each of a scanner, of a map and among obstacles of its own: the scans of `scan_batch`.
///
/// Args:
///     scans: Tuples (scanner, grid, pose, obstacles, noise, surfaces, seed, index), one for each scan: a `LaserScanner`, and
///         the arguments of its `scan_batch` for one pose; `index` stands for `first_index`. Surfaces, seed and index have
///         an effect only with noise. Scans of equal scanners in one map are the fastest side by side.
///     threads: Number of threads, 1 to 1024; None means one per core. The result does not depend on it.
///
/// Returns:
///     A list with the readings of each scan, (beam_count,) float32 [m].
///
/// Raises:
///     ValueError: As for `scan_batch`, or a tuple has another length.
///     TypeError: An argument has the wrong type.
///     OSError: The threads could not be started.
///
/// Examples:
///     The only wall covers x from 2 m to 3 m:
///
///     >>> import numpy as np
///     >>> import mobile_robot_simulator as mrs
///     >>> from mobile_robot_simulator._core import scan_each
///     >>> grid = mrs.OccupancyGrid(np.array([[0, 0, 100]], np.int8), resolution=1.0)
///     >>> scanner, pose = mrs.LaserScanner(beam_count=1), (0.5, 0.5, 0.0)
///     >>> scan_each([(scanner, grid, pose, (), None, None, 0, 0)])
///     [array([1.5], dtype=float32)]
#[pyfunction]
#[pyo3(signature = (scans, *, threads = None))]
pub fn scan_each<'py>(
    py: Python<'py>,
    scans: &Bound<'py, PyAny>,
    threads: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyList>> {
    let threads = thread_count(threads)?;
    let mut arguments: Vec<Scan<'py>> = Vec::new();
    for scan in scans.try_iter()? {
        memory::push(NAME, &mut arguments, scan?.extract()?)?;
    }
    let grids = memory::collected(NAME, arguments.iter().map(|scan| scan.1.get().core()))?;
    let mut shots = memory::with_room(NAME, arguments.len())?;
    for ((scanner, _, pose, obstacles, noise, surfaces, seed, index), grid) in arguments.iter().zip(&grids) {
        let (seed, index) = (stream_number("seed", Some(seed))?, stream_number("index", Some(index))?);
        let surface = surfaces.as_ref().map(|model| &model.0);
        let noise = noise.as_ref().map(|model| ShotNoise { model: &model.0, surface, seed, index });
        shots.push(Shot { scanner: &scanner.get().0, world: obstacles.on(grid), map_from_base: pose.0, noise });
    }
    let mut readings = memory::with_room(NAME, shots.len())?;
    for shot in &shots {
        readings.push(memory::filled(NAME, 0.0, shot.scanner.options().beam_count)?);
    }
    let mut rows = memory::collected(NAME, readings.iter_mut().map(Vec::as_mut_slice))?;
    py.detach(|| scanner::scan_each(&shots, threads, &mut rows))?;
    PyList::new(py, readings.into_iter().map(|readings| vector(py, readings)))
}
