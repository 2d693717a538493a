//! `touches`, `clearance`, `advance` and `Contact` for Python.

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use super::grid::OccupancyGrid;
use super::obstacles::ObstaclesArgument;
use super::pose::{Pose, PoseArgument};
use super::shape::Shape;
use crate::ContactMode;

/// Where and when a robot met a wall or an obstacle.
#[pyclass(frozen, eq, module = "mobile_robot_simulator")]
#[derive(PartialEq)]
pub struct Contact(crate::Contact);

#[pymethods]
impl Contact {
    /// Where, (x, y) in the map frame [m]: on what was met.
    #[getter]
    fn point(&self) -> (f64, f64) {
        self.0.point.into()
    }

    /// Unit vector (x, y) of the map frame from what was met to the robot; (0, 0) if the robot's origin is inside of it.
    #[getter]
    fn normal(&self) -> (f64, f64) {
        self.0.normal.into()
    }

    /// Share of the step that was over, 0 to 1.
    #[getter]
    fn fraction(&self) -> f64 {
        self.0.fraction
    }

    /// Index of the obstacle that was met; None for a wall of the grid.
    #[getter]
    fn obstacle(&self) -> Option<usize> {
        self.0.obstacle
    }

    fn __repr__(&self) -> String {
        let crate::Contact { point, normal, fraction, obstacle } = self.0;
        let obstacle = obstacle.map_or_else(|| "None".to_owned(), |index| index.to_string());
        format!(
            "Contact(point=({:?}, {:?}), normal=({:?}, {:?}), fraction={fraction:?}, obstacle={obstacle})",
            point.x, point.y, normal.x, normal.y
        )
    }
}

/// Whether a footprint at a pose shares a point with a blocking cell or an obstacle, all of them with their edges.
///
/// footprint: Shape in the robot's frame. pose: (x, y, yaw) of the robot in the map frame.
/// obstacles: sequence of (Shape, pose), poses in the map frame.
/// raises: ValueError if a pose is not finite.
#[pyfunction]
#[pyo3(signature = (grid, footprint, pose, *, obstacles = ObstaclesArgument::none()))]
pub fn touches(
    py: Python<'_>,
    grid: &Bound<'_, OccupancyGrid>,
    footprint: &Bound<'_, Shape>,
    pose: PoseArgument,
    obstacles: ObstaclesArgument,
) -> PyResult<bool> {
    let (grid, footprint) = (grid.get().core(), &footprint.get().0);
    Ok(py.detach(|| crate::touches((&*grid, &obstacles.0), footprint, pose.0))?)
}

/// Distance [m] from a footprint at a pose to the nearest blocking cell or obstacle, exactly.
///
/// footprint: Shape in the robot's frame. pose: (x, y, yaw) of the robot in the map frame. limit: metres; cost grows with
/// its square where the map is empty. obstacles: sequence of (Shape, pose), poses in the map frame.
/// returns: 0 if they share a point, ``limit`` if there is nothing within it.
/// raises: ValueError if a pose is not finite or the limit not positive.
#[pyfunction]
#[pyo3(signature = (grid, footprint, pose, *, limit, obstacles = ObstaclesArgument::none()))]
pub fn clearance(
    py: Python<'_>,
    grid: &Bound<'_, OccupancyGrid>,
    footprint: &Bound<'_, Shape>,
    pose: PoseArgument,
    limit: f64,
    obstacles: ObstaclesArgument,
) -> PyResult<f64> {
    let (grid, footprint) = (grid.get().core(), &footprint.get().0);
    Ok(py.detach(|| crate::clearance((&*grid, &obstacles.0), footprint, pose.0, limit))?)
}

/// Where a robot comes to under a constant twist in ``dt`` seconds, and the first contact on its way, if any.
///
/// footprint: Shape in the robot's frame. pose: (x, y, yaw) of the robot in the map frame. twist: (vx, vy, wz) in the robot's
/// frame [m/s, rad/s]. obstacles: sequence of (Shape, pose), poses in the map frame, that stand still meanwhile.
/// mode: "stop", the robot stops within 1e-6 m of what it meets, never in it; "slide", it goes on for the rest of the step with
/// what is left of its velocity, its linear part losing what would drive a point of contact into what it met; "report", it goes on
/// through everything.
/// returns: (Pose, Contact or None). The way is the exact arc; without contact the pose is that of ``pose.integrate(twist, dt)``.
/// A robot that overlaps something at the start is in contact from the start, and moves as the largest smaller copy of itself,
/// scaled about its origin, that does not: it may go away, along or out, but no deeper. One whose origin is inside goes free.
/// raises: ValueError for numbers that are not finite, a negative dt or one that leads farther than 100000 times the robot's
/// size, another mode.
/// method: conservative advancement (Mirtich 1996, sec. 2.3), with bounds of second order.
#[pyfunction]
#[pyo3(signature = (grid, footprint, pose, twist, dt, *, mode = "stop", obstacles = ObstaclesArgument::none()))]
#[allow(clippy::too_many_arguments, reason = "what a step is made of")]
pub fn advance(
    py: Python<'_>,
    grid: &Bound<'_, OccupancyGrid>,
    footprint: &Bound<'_, Shape>,
    pose: PoseArgument,
    twist: [f64; 3],
    dt: f64,
    mode: &str,
    obstacles: ObstaclesArgument,
) -> PyResult<(Pose, Option<Contact>)> {
    let mode = match mode {
        "stop" => ContactMode::Stop,
        "slide" => ContactMode::Slide,
        "report" => ContactMode::Report,
        other => return Err(PyValueError::new_err(format!("mode must be 'stop', 'slide' or 'report', got '{other}'"))),
    };
    let (grid, footprint) = (grid.get().core(), &footprint.get().0);
    let step = py.detach(|| crate::advance((&*grid, &obstacles.0), footprint, pose.0, twist.into(), dt, mode))?;
    Ok((Pose(step.0), step.1.map(Contact)))
}
