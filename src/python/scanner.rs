//! `LaserScanner` for Python.

use numpy::{IntoPyArray, PyArray1, PyArray2, ndarray::Array2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use super::arrays::{fill, rows, typed, vector};
use super::beam_model::BeamModel;
use super::grid::OccupancyGrid;
use super::obstacles::ObstaclesArgument;
use super::pose::{Pose, PoseArgument};
use super::{stream_number, thread_count, whole_number};
use crate::{NoReturn, Noise, ScannerOptions};

/// A planar laser scanner whose beams spread evenly over its field of view.
///
/// fov: field of view [rad], at most 2π. beam_count: number of beams, which is the number of ranges.
/// min_range: returns nearer than this are too close to be valid [m]; only messages mark them. max_range: range of a beam
/// without a return [m]. mount: pose of the scanner on the robot.
///
/// Beam i points at angle_min + i * angle_increment, with angle_increment = fov / (beam_count - 1), or fov / beam_count for a
/// full turn (to within 1e-6), so that no beam is repeated. A single beam looks along the middle.
///
/// raises: ValueError for a value out of its range.
#[pyclass(frozen, module = "mobile_robot_simulator")]
pub struct LaserScanner(crate::LaserScanner);

fn default() -> ScannerOptions {
    ScannerOptions::default()
}

#[pymethods]
impl LaserScanner {
    #[new]
    #[pyo3(signature = (
        *,
        fov = default().fov,
        beam_count = None,
        min_range = default().min_range,
        max_range = default().max_range,
        mount = PoseArgument(default().mount),
    ))]
    fn new(
        fov: f64,
        beam_count: Option<&Bound<'_, PyAny>>,
        min_range: f64,
        max_range: f64,
        mount: PoseArgument,
    ) -> PyResult<Self> {
        let beam_count = beam_count.map(|value| whole_number("beam_count", value, "in 1..1000000")).transpose()?;
        let beam_count = beam_count.unwrap_or(default().beam_count);
        let options = ScannerOptions { fov, beam_count, min_range, max_range, mount: mount.0 };
        Ok(Self(crate::LaserScanner::new(options)?))
    }

    /// Field of view [rad].
    #[getter]
    fn fov(&self) -> f64 {
        self.0.options().fov
    }

    /// Number of beams, which is the number of ranges.
    #[getter]
    fn beam_count(&self) -> usize {
        self.0.options().beam_count
    }

    /// Returns nearer than this are too close to be valid [m].
    #[getter]
    fn min_range(&self) -> f64 {
        self.0.options().min_range
    }

    /// Range of a beam without a return [m].
    #[getter]
    fn max_range(&self) -> f64 {
        self.0.options().max_range
    }

    /// Pose of the scanner on the robot.
    #[getter]
    fn mount(&self) -> Pose {
        Pose(self.0.options().mount)
    }

    /// Angle of the first beam in the scanner's frame [rad].
    #[getter]
    fn angle_min(&self) -> f64 {
        self.0.angle_min()
    }

    /// Angle of the last beam [rad].
    #[getter]
    fn angle_max(&self) -> f64 {
        self.0.angle_max()
    }

    /// Angle from one beam to the next [rad].
    #[getter]
    fn angle_increment(&self) -> f64 {
        self.0.angle_increment()
    }

    /// Angles of the beams in the scanner's frame, (beam_count,) float64 [rad].
    #[getter]
    fn angles<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        vector(py, (0..self.beam_count()).map(|beam| self.0.angle(beam)).collect())
    }

    /// Ranges measured from one pose, without noise.
    ///
    /// pose: (x, y, yaw) of the robot in the map frame. obstacles: sequence of (Shape, pose), poses in the map frame.
    /// returns: (beam_count,) float32 [m], to the nearest of grid and obstacles; max_range means no return.
    /// raises: ValueError if a pose is not finite. Poses off the map are allowed.
    #[pyo3(signature = (grid, pose, *, obstacles = ObstaclesArgument::none()))]
    fn scan<'py>(
        &self,
        py: Python<'py>,
        grid: &Bound<'py, OccupancyGrid>,
        pose: PoseArgument,
        obstacles: ObstaclesArgument,
    ) -> PyResult<Bound<'py, PyAny>> {
        let grid = grid.get().core();
        fill(py, None, &[self.beam_count()], |ranges| self.0.scan((&*grid, &obstacles.0), pose.0, ranges))
    }

    /// Ranges measured from each pose.
    ///
    /// poses: (N, 3) float64, x y [m] and yaw [rad] of the robot in the map frame.
    /// obstacles: sequence of (Shape, pose), poses in the map frame, that all scans see.
    /// noise: BeamModel to sample from, none if None. seed: names the random streams. first_index: index of the first scan in
    /// its stream, so that chunks of a long batch equal the whole. threads: number of threads, all cores if None; the result
    /// does not depend on it. out: (N, beam_count) float32 in C order, to write into. Arrays are read and written where they are:
    /// no other thread may change them meanwhile.
    /// returns: (N, beam_count) float32 [m]; column i points at angle_min + i * angle_increment; max_range means no return.
    /// raises: ValueError for shapes and for poses that are not finite; TypeError for dtypes. Poses off the map are allowed.
    /// method: Amanatides & Woo 1987, sec. 2; noise: Probabilistic Robotics, table 6.1.
    #[pyo3(signature = (grid, poses, *, obstacles = ObstaclesArgument::none(), noise = None, seed = None, first_index = None, threads = None, out = None))]
    #[allow(clippy::too_many_arguments, reason = "the keywords of a batch")]
    fn scan_batch<'py>(
        &self,
        py: Python<'py>,
        grid: &Bound<'py, OccupancyGrid>,
        poses: &Bound<'py, PyAny>,
        obstacles: ObstaclesArgument,
        noise: Option<BeamModel>,
        seed: Option<&Bound<'py, PyAny>>,
        first_index: Option<&Bound<'py, PyAny>>,
        threads: Option<&Bound<'py, PyAny>>,
        out: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let (grid, poses, threads) = (grid.get().core(), rows("poses", poses)?, thread_count(threads)?);
        let (seed, first_index) = (stream_number("seed", seed)?, stream_number("first_index", first_index)?);
        let noise = noise.map(|model| Noise { model: model.0, seed, first_index });
        let poses: &[[f64; 3]] = &poses;
        fill(py, out, &[poses.len(), self.beam_count()], |readings| {
            self.0.scan_batch((&*grid, &obstacles.0), poses, noise, threads, readings)
        })
    }

    /// The same readings with those that are no valid return marked as REP-117 asks of a message.
    ///
    /// readings: float32 of any shape [m]. no_return: what becomes of readings of max_range, "inf" or "max" (they stay).
    /// Readings nearer than min_range become -inf.
    /// returns: a new array.
    #[pyo3(signature = (readings, *, no_return = "inf"))]
    fn mark_invalid<'py>(
        &self,
        py: Python<'py>,
        readings: &Bound<'py, PyAny>,
        no_return: &str,
    ) -> PyResult<Bound<'py, PyAny>> {
        let no_return = match no_return {
            "inf" => NoReturn::Inf,
            "max" => NoReturn::Max,
            other => return Err(PyValueError::new_err(format!("no_return must be 'inf' or 'max', got '{other}'"))),
        };
        let readings = typed::<f32>("readings", readings)?;
        let readings = readings.as_array();
        fill(py, None, readings.shape(), |marked| {
            marked.iter_mut().zip(&readings).for_each(|(marked, reading)| *marked = *reading);
            self.0.mark_invalid(marked, no_return);
            Ok(())
        })
    }

    /// Points of the map frame that the valid returns among the readings of one scan came from.
    ///
    /// pose: (x, y, yaw) of the robot in the map frame. readings: (beam_count,) float32 [m], raw or as in a message.
    /// returns: (M, 2) float64 [m], beams without a valid return left out.
    /// raises: ValueError for a wrong shape; TypeError for another dtype.
    fn end_points<'py>(
        &self,
        py: Python<'py>,
        pose: PoseArgument,
        readings: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let readings = typed::<f32>("readings", readings)?;
        let readings: Vec<f32> = readings.as_array().iter().copied().collect();
        Ok(Array2::from(self.0.end_points(pose.0, &readings)?).into_pyarray(py))
    }

    fn __repr__(&self) -> String {
        let ScannerOptions { fov, beam_count, min_range, max_range, mount } = self.0.options();
        let [x, y, yaw] = mount.to_array();
        format!(
            "LaserScanner(fov={fov:?}, beam_count={beam_count}, min_range={min_range:?}, max_range={max_range:?}, \
             mount=({x:?}, {y:?}, {yaw:?}))"
        )
    }

    #[allow(clippy::type_complexity, reason = "what pickle asks for")]
    fn __getnewargs_ex__<'py>(&self, py: Python<'py>) -> PyResult<((), Bound<'py, pyo3::types::PyDict>)> {
        let keywords = pyo3::types::PyDict::new(py);
        keywords.set_item("fov", self.fov())?;
        keywords.set_item("beam_count", self.beam_count())?;
        keywords.set_item("min_range", self.min_range())?;
        keywords.set_item("max_range", self.max_range())?;
        keywords.set_item("mount", self.mount())?;
        Ok(((), keywords))
    }
}
