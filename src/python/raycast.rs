//! `cast_rays` for Python.

use pyo3::prelude::*;

use super::arrays::{fill, rows};
use super::grid::OccupancyGrid;
use super::obstacles::ObstaclesArgument;
use super::thread_count;
use crate::raycast;

/// Ranges of unrelated rays.
///
/// rays: (N, 3) float64, x y [m] and direction [rad] in the map frame. max_range: metres.
/// obstacles: sequence of (Shape, pose), poses in the map frame, that stop rays as well.
/// threads: number of threads, all cores if None. out: (N,) float32 to write into. Arrays are read and written where they are:
/// no other thread may change them meanwhile.
/// returns: (N,) float32 [m], the distance to the boundary at which the ray enters the first blocking cell or obstacle, 0 for
/// one that starts inside; max_range means no return. Rays may start off the map.
/// raises: ValueError for shapes and for numbers that are not finite; TypeError for dtypes.
/// method: Amanatides & Woo 1987, sec. 2.
#[pyfunction]
#[pyo3(signature = (grid, rays, max_range, *, obstacles = ObstaclesArgument::none(), threads = None, out = None))]
pub fn cast_rays<'py>(
    py: Python<'py>,
    grid: &Bound<'py, OccupancyGrid>,
    rays: &Bound<'py, PyAny>,
    max_range: f64,
    obstacles: ObstaclesArgument,
    threads: Option<&Bound<'py, PyAny>>,
    out: Option<Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyAny>> {
    let (grid, rays, threads) = (grid.get().core(), rows("rays", rays)?, thread_count(threads)?);
    let rays: &[[f64; 3]] = &rays;
    fill(py, out, &[rays.len()], |ranges| raycast::cast_rays((&*grid, &obstacles.0), rays, max_range, threads, ranges))
}
