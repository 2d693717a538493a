//! The Python function `cast_rays`.

use pyo3::prelude::*;

use super::arrays::{fill, rows};
use super::grid::GridArgument;
use super::number::Argument;
use super::obstacles::ObstaclesArgument;
use super::thread_count;
use crate::raycast;

/// Returns the range of each ray: the distance at which it enters the first blocking cell or obstacle.
///
/// The rays are independent; for the beams of a scanner, use `LaserScanner.scan_batch`. Ranges are exact: the grid traversal
/// follows Amanatides & Woo (1987), section 2. More than 5,000 rays are read in place, without a copy, so no other thread
/// may write to them during the call.
///
/// Args:
///     grid: Map to cast the rays in.
///     rays: (N, 3), one row (x, y, direction) per ray in the map frame [m, m, rad]. Rays may start outside the grid.
///         Anything that NumPy can convert to float64 without loss.
///     max_range: Range of a ray that hits nothing [m].
///     obstacles: Pairs (Shape, pose) that also stop rays, with poses in the map frame.
///     threads: Number of threads, 1 to 1024; None means one per core. The result does not depend on it.
///     out: (N,) float32 in C order, an array for the result. None means a new array.
///
/// Returns:
///     (N,) float32 [m], which is `out` if it was given. A ray that starts inside a blocking cell or an obstacle has range
///         0. A ray that hits nothing within `max_range` has exactly `max_range`.
///
/// Raises:
///     ValueError: A shape is wrong, a number is not finite, `max_range` is not positive, `threads` is out of range, or
///         `out` is read-only, in use or not in C order.
///     TypeError: An argument has the wrong type or dtype.
///     OSError: The threads could not be started.
///
/// Examples:
///     The only wall covers x from 2 m to 3 m:
///
///     >>> import numpy as np
///     >>> import mobile_robot_simulator as mrs
///     >>> grid = mrs.OccupancyGrid(np.array([[0, 0, 100]], np.int8), resolution=1.0)
///     >>> rays = np.array([[0.5, 0.5, 0.0], [0.5, 0.5, np.pi]])
///     >>> mrs.cast_rays(grid, rays, max_range=9.0)
///     array([1.5, 9. ], dtype=float32)
#[pyfunction]
#[pyo3(
    text_signature = "(grid, rays, max_range, *, obstacles=(), threads=None, out=None)",
    signature = (grid, rays, max_range, *, obstacles = ObstaclesArgument::none(), threads = None, out = None)
)]
pub fn cast_rays<'py>(
    py: Python<'py>,
    grid: GridArgument<'py>,
    rays: &Bound<'py, PyAny>,
    max_range: Argument<f64>,
    obstacles: ObstaclesArgument,
    threads: Option<&Bound<'py, PyAny>>,
    out: Option<Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyAny>> {
    let (grid, rays, threads) = (grid.get().core(), rows("rays", rays, out.as_ref())?, thread_count(threads)?);
    let (rays, max_range): (&[[f64; 3]], f64) = (&rays, max_range.named("max_range")?);
    fill(py, out, &[rays.len()], |ranges| raycast::cast_rays(obstacles.on(&grid), rays, max_range, threads, ranges))
}
