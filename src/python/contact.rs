//! The Python functions `touches`, `clearance` and `advance`, and the class `Contact`.

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use super::arrays::{fill, rows};
use super::grid::GridArgument;
use super::number::Argument;
use super::obstacles::ObstaclesArgument;
use super::pose::{Pose, PoseArgument};
use super::shape::FootprintArgument;
use super::{Recipe, recipe, thread_count, whole_number};
use crate::ContactMode;

/// Where and when a robot touched a wall or an obstacle. `advance` returns it.
///
/// Args:
///     point: Point of contact (x, y) in the map frame [m], on the surface of the wall or obstacle.
///     normal: Unit vector (x, y) in the map frame that points from the wall or obstacle to the robot; (0, 0) if the robot's
///         origin is inside.
///     fraction: Time of the contact as a fraction of the step, from 0 to 1.
///     obstacle: Index in `obstacles` of the obstacle that was touched; None for a wall of the grid.
///
/// Raises:
///     ValueError: A number is not finite, the normal is longer than 1, the fraction is not in 0..1, or the index is
///         negative.
///
/// Examples:
///     >>> from mobile_robot_simulator import Contact
///     >>> Contact(point=(2.0, 0.5), normal=(-1.0, 0.0), fraction=0.5)
///     Contact(point=(2.0, 0.5), normal=(-1.0, 0.0), fraction=0.5, obstacle=None)
#[pyclass(frozen, eq, module = "mobile_robot_simulator")]
#[derive(PartialEq)]
pub struct Contact(crate::Contact);

#[pymethods]
impl Contact {
    #[new]
    #[pyo3(signature = (*, point, normal, fraction, obstacle = None))]
    fn new(
        point: Argument<[f64; 2]>,
        normal: Argument<[f64; 2]>,
        fraction: Argument<f64>,
        obstacle: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let (point, normal, fraction) = (point.named("point")?, normal.named("normal")?, fraction.named("fraction")?);
        let obstacle = obstacle.map(|index| whole_number("obstacle", index, "at least 0")).transpose()?;
        let contact = crate::Contact { point: point.into(), normal: normal.into(), fraction, obstacle };
        Ok(Self(contact.checked()?))
    }

    /// Point of contact (x, y) in the map frame [m], on the surface of the wall or obstacle.
    #[getter]
    fn point(&self) -> (f64, f64) {
        self.0.point.into()
    }

    /// Unit vector (x, y) in the map frame that points from the wall or obstacle to the robot.
    ///
    /// It is (0, 0) if the robot's origin is inside the wall or obstacle.
    #[getter]
    fn normal(&self) -> (f64, f64) {
        self.0.normal.into()
    }

    /// Time of the contact as a fraction of the step, from 0 to 1.
    #[getter]
    fn fraction(&self) -> f64 {
        self.0.fraction
    }

    /// Index in `obstacles` of the obstacle that was touched; None for a wall of the grid.
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

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Recipe<'py>> {
        let keywords = PyDict::new(py);
        keywords.set_item("point", self.point())?;
        keywords.set_item("normal", self.normal())?;
        keywords.set_item("fraction", self.fraction())?;
        keywords.set_item("obstacle", self.obstacle())?;
        recipe::<Self>(py, PyTuple::empty(py), keywords)
    }
}

/// Returns True if a footprint shares a point with a blocking cell or an obstacle.
///
/// Edges belong to footprints, cells and obstacles, so a shared edge or corner is a contact.
///
/// Args:
///     grid: Map that the robot moves in. Outside the grid is free.
///     footprint: Outline of the robot in its own frame.
///     pose: Pose (x, y, yaw) of the robot in the map frame [m, m, rad].
///     obstacles: Pairs (Shape, pose), with poses in the map frame.
///
/// Raises:
///     ValueError: A pose is not finite.
///
/// Examples:
///     The only wall covers x from 2 m to 3 m:
///
///     >>> import numpy as np
///     >>> import mobile_robot_simulator as mrs
///     >>> grid = mrs.OccupancyGrid(np.array([[0, 0, 100]], np.int8), resolution=1.0)
///     >>> robot = mrs.Shape.disc(0.5)
///     >>> mrs.touches(grid, robot, (1.4, 0.5, 0.0)), mrs.touches(grid, robot, (1.6, 0.5, 0.0))
///     (False, True)
#[pyfunction]
#[pyo3(
    text_signature = "(grid, footprint, pose, *, obstacles=())",
    signature = (grid, footprint, pose, *, obstacles = ObstaclesArgument::none())
)]
pub fn touches(
    py: Python<'_>,
    grid: GridArgument<'_>,
    footprint: FootprintArgument<'_>,
    pose: PoseArgument,
    obstacles: ObstaclesArgument,
) -> PyResult<bool> {
    let (grid, footprint) = (grid.get().core(), footprint.get());
    Ok(py.detach(|| crate::touches(obstacles.on(&grid), footprint, pose.0))?)
}

/// Returns True if a quick look shows that a robot touches nothing for some time. False means that it may touch something.
///
/// The cost grows with the number of obstacles and with the cells that the robot could reach.
///
/// Args:
///     grid: Map that the robot moves in. Outside the grid is free.
///     footprint: Outline of the robot in its own frame.
///     pose: Pose (x, y, yaw) of the robot in the map frame at the start [m, m, rad].
///     velocity: Velocity (vx, vy, wz) in the robot's frame at the start [m/s, m/s, rad/s].
///     command: Velocity (vx, vy, wz) that it approaches. Each component stays between the two, or between zero and one of
///         them.
///     dt: The time [s].
///     obstacles: Pairs (Shape, pose), with poses in the map frame. They stand still.
///
/// Raises:
///     ValueError: The pose is not finite.
///
/// Examples:
///     The only wall covers x from 2 m to 3 m:
///
///     >>> import numpy as np
///     >>> import mobile_robot_simulator as mrs
///     >>> from mobile_robot_simulator._core import stays_clear
///     >>> grid = mrs.OccupancyGrid(np.array([[0, 0, 100]], np.int8), resolution=1.0)
///     >>> robot, pose, standing = mrs.Shape.disc(0.5), (0.5, 0.5, 0.0), (0.0, 0.0, 0.0)
///     >>> [stays_clear(grid, robot, pose, standing, (1.0, 0.0, 0.0), dt) for dt in (0.2, 2.0)]
///     [True, False]
#[pyfunction]
#[pyo3(
    text_signature = "(grid, footprint, pose, velocity, command, dt, *, obstacles=())",
    signature = (grid, footprint, pose, velocity, command, dt, *, obstacles = ObstaclesArgument::none())
)]
#[allow(clippy::too_many_arguments, reason = "they are keyword arguments in Python")]
pub fn stays_clear(
    grid: GridArgument<'_>,
    footprint: FootprintArgument<'_>,
    pose: PoseArgument,
    velocity: Argument<[f64; 3]>,
    command: Argument<[f64; 3]>,
    dt: Argument<f64>,
    obstacles: ObstaclesArgument,
) -> PyResult<bool> {
    let twists = [velocity.named("velocity")?.into(), command.named("command")?.into()];
    let grid = grid.get().core();
    let world = obstacles.on(&grid);
    Ok(crate::stays_clear(world, footprint.get(), pose.0, twists, dt.named("dt")?)?)
}

/// Returns the exact distance [m] from a footprint to the nearest blocking cell or obstacle.
///
/// Args:
///     grid: Map that the robot moves in. Outside the grid is free.
///     footprint: Outline of the robot in its own frame.
///     pose: Pose (x, y, yaw) of the robot in the map frame [m, m, rad].
///     limit: Distance up to which to search [m]. In empty space, the cost grows with its square.
///     obstacles: Pairs (Shape, pose), with poses in the map frame.
///
/// Returns:
///     The distance [m]: 0 if the footprint touches something, `limit` if there is nothing within `limit`.
///
/// Raises:
///     ValueError: A pose is not finite, or `limit` is not positive and finite.
///
/// Examples:
///     The only wall covers x from 2 m to 3 m:
///
///     >>> import numpy as np
///     >>> import mobile_robot_simulator as mrs
///     >>> grid = mrs.OccupancyGrid(np.array([[0, 0, 100]], np.int8), resolution=1.0)
///     >>> mrs.clearance(grid, mrs.Shape.disc(0.5), (0.5, 0.5, 0.0), limit=9.0)
///     1.0
#[pyfunction]
#[pyo3(
    text_signature = "(grid, footprint, pose, *, limit, obstacles=())",
    signature = (grid, footprint, pose, *, limit, obstacles = ObstaclesArgument::none())
)]
pub fn clearance(
    py: Python<'_>,
    grid: GridArgument<'_>,
    footprint: FootprintArgument<'_>,
    pose: PoseArgument,
    limit: Argument<f64>,
    obstacles: ObstaclesArgument,
) -> PyResult<f64> {
    let (grid, footprint, limit) = (grid.get().core(), footprint.get(), limit.named("limit")?);
    Ok(py.detach(|| crate::clearance(obstacles.on(&grid), footprint, pose.0, limit))?)
}

/// Returns the clearance of a footprint at each of many poses: `clearance` of each row.
///
/// Args:
///     grid: Map that the robot moves in. Outside the grid is free.
///     footprint: Outline of the robot in its own frame.
///     poses: (N, 3), one row (x, y, yaw) per pose of the robot in the map frame [m, m, rad]. Anything that NumPy can convert
///         to float64 without loss. More than 5,000 poses are read in place, without a copy, so no other thread may write
///         to them during the call.
///     limit: Distance up to which to search [m]. In empty space, the cost grows with its square.
///     obstacles: Pairs (Shape, pose), with poses in the map frame.
///     threads: Number of threads, 1 to 1024; None means one per core. The result does not depend on it.
///
/// Returns:
///     (N,) float64, the distances [m]: 0 where the footprint touches something, `limit` where there is nothing within
///         `limit`.
///
/// Raises:
///     ValueError: A shape is wrong, a pose is not finite, `limit` is not positive and finite, or `threads` is out of range.
///     TypeError: An argument has the wrong type or dtype.
///     OSError: The threads could not be started.
///
/// Examples:
///     The only wall covers x from 2 m to 3 m:
///
///     >>> import numpy as np
///     >>> import mobile_robot_simulator as mrs
///     >>> grid = mrs.OccupancyGrid(np.array([[0, 0, 100]], np.int8), resolution=1.0)
///     >>> mrs.clearance_batch(grid, mrs.Shape.disc(0.5), [(0.5, 0.5, 0.0), (1.0, 0.5, 0.0)], limit=9.0)
///     array([1. , 0.5])
#[pyfunction]
#[pyo3(
    text_signature = "(grid, footprint, poses, *, limit, obstacles=(), threads=None)",
    signature = (grid, footprint, poses, *, limit, obstacles = ObstaclesArgument::none(), threads = None)
)]
pub fn clearance_batch<'py>(
    py: Python<'py>,
    grid: GridArgument<'py>,
    footprint: FootprintArgument<'py>,
    poses: &Bound<'py, PyAny>,
    limit: Argument<f64>,
    obstacles: ObstaclesArgument,
    threads: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyAny>> {
    let (grid, footprint) = (grid.get().core(), footprint.get());
    let (poses, limit, threads) = (rows("poses", poses, None)?, limit.named("limit")?, thread_count(threads)?);
    let poses: &[[f64; 3]] = &poses;
    fill(py, None, &[poses.len()], |distances| {
        crate::clearance_batch(obstacles.on(&grid), footprint, poses, limit, threads, distances)
    })
}

/// Returns the pose of a robot after `dt` seconds at a constant twist, and its first contact on the way.
///
/// The robot follows the exact arc of `Pose.integrate`. Contacts are found by conservative advancement (Mirtich 1996,
/// section 2.3) with second-order bounds. `mode` says what a contact does:
///
/// - "stop": The robot stops at most 1e-6 m before the wall or obstacle, never inside it.
/// - "slide": The robot continues for the rest of the step. Its linear velocity loses the part that would push a point of
///   contact into the wall or obstacle.
/// - "report": The robot passes through everything; the contact is only reported.
///
/// A robot that overlaps something at the start has a contact with fraction 0. It then moves with a smaller footprint: the
/// largest copy, scaled about its origin, that overlaps nothing. It can move out or along the wall or obstacle, but not
/// deeper. A robot whose origin is inside a wall or obstacle moves freely.
///
/// Args:
///     grid: Map that the robot moves in. Outside the grid is free.
///     footprint: Outline of the robot in its own frame.
///     pose: Pose (x, y, yaw) of the robot in the map frame at the start [m, m, rad].
///     twist: Velocity (vx, vy, wz) in the robot's frame [m/s, m/s, rad/s].
///     dt: Duration of the step [s].
///     mode: What a contact does: "stop", "slide" or "report".
///     obstacles: Pairs (Shape, pose), with poses in the map frame. They stand still during the step.
///
/// Returns:
///     The pose reached, and the first contact or None. Without a contact, the pose equals `pose.integrate(twist, dt)`.
///
/// Raises:
///     ValueError: An argument or the pose reached is not finite, `dt` is negative or so long that the robot would move
///         more than 100000 times its own size, or the mode is unknown.
///
/// Examples:
///     The only wall covers x from 2 m to 3 m. The robot stops half way, when its edge reaches the wall:
///
///     >>> import numpy as np
///     >>> import mobile_robot_simulator as mrs
///     >>> grid = mrs.OccupancyGrid(np.array([[0, 0, 100]], np.int8), resolution=1.0)
///     >>> pose, contact = mrs.advance(grid, mrs.Shape.disc(0.5), (0.5, 0.5, 0.0), (1.0, 0.0, 0.0), dt=2.0)
///     >>> round(pose.x, 3), round(contact.fraction, 3), contact.obstacle
///     (1.5, 0.5, None)
#[pyfunction]
#[pyo3(
    text_signature = "(grid, footprint, pose, twist, dt, *, mode='stop', obstacles=())",
    signature = (grid, footprint, pose, twist, dt, *, mode = "stop", obstacles = ObstaclesArgument::none())
)]
#[allow(clippy::too_many_arguments, reason = "they are keyword arguments in Python")]
pub fn advance(
    py: Python<'_>,
    grid: GridArgument<'_>,
    footprint: FootprintArgument<'_>,
    pose: PoseArgument,
    twist: Argument<[f64; 3]>,
    dt: Argument<f64>,
    mode: &str,
    obstacles: ObstaclesArgument,
) -> PyResult<(Pose, Option<Contact>)> {
    let mode = contact_mode("mode", mode)?;
    let (grid, footprint) = (grid.get().core(), footprint.get());
    let (twist, dt) = (twist.named("twist")?, dt.named("dt")?);
    let step = py.detach(|| crate::advance(obstacles.on(&grid), footprint, pose.0, twist.into(), dt, mode))?;
    Ok((Pose(step.0), step.1.map(Contact)))
}

/// Returns what a contact does, by its name.
pub fn contact_mode(name: &str, mode: &str) -> PyResult<ContactMode> {
    match mode {
        "stop" => Ok(ContactMode::Stop),
        "slide" => Ok(ContactMode::Slide),
        "report" => Ok(ContactMode::Report),
        other => Err(PyValueError::new_err(format!("{name} must be 'stop', 'slide' or 'report', got '{other}'"))),
    }
}
