//! The Python class `Fleet`.

mod arguments;
mod commands;
mod state;
mod step;

use std::sync::Arc;

use numpy::IntoPyArray;
use numpy::ndarray::Array2;
use pyo3::exceptions::{PyRuntimeError, PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;

pub use state::FleetState;
pub use step::FleetStep;

use super::arrays::{elements, fill, pairs, rows, type_name, vector, whole_numbers, writable, zeros};
use super::beam_model::BeamModel;
use super::contact::contact_mode;
use super::drive::Drive;
use super::grid::OccupancyGrid;
use super::limits::Limits;
use super::motion_noise::MotionNoise;
use super::number::Argument;
use super::scanner::LaserScanner;
use super::shape::{FootprintArgument, Shape};
use super::surface_model::SurfaceModel;
use super::{recipe, thread_count, whole_number};
use crate::{ContactMode, FleetObstacle, FleetOptions, Reset, Rollout};
use arguments::{grids_of, indices, obstacles_of, one_or_each, replacements};
use commands::Commands;

/// Many robots that are stepped together, each alone in a world of its own, or several in one.
///
/// Each robot moves, touches and measures as a robot of a `Simulation`, byte by byte, however many threads work. Robots that
/// share a world see and touch each other; a robot does not depend on robots in other worlds. A command holds for a step, so it is like `velocity_timeout: 0`. Contact is looked for in time
/// steps of 20 ms. Poses are in the map frame, with yaws in (-π, π].
///
/// A robot has a seed. The noise of its scan i is that of `LaserScanner.scan_batch` with this seed and `first_index=i`; the
/// first scan after `reset` with a seed has index 0. Only one thread may use a fleet at a time.
///
/// Args:
///     grids: The map of all robots, or a sequence of maps.
///     poses: (N, 3), the first pose (x, y, yaw) of each robot [m, m, rad]. None means that they are drawn from free space.
///     seeds: (N,) integers from 0 to 2**64 - 1, one for each robot. None means 0, 1, 2 and so on.
///     grid_of: (N,) integers, the index of each robot's map. None means the first map for all if there is only one, or map i
///         for robot i.
///     footprint: Outline of the robots; None if they touch nothing.
///     contact: What a contact does to the motion, as in `advance`: "stop", "slide" or "report".
///     limits: Limits on the velocity and its change: for all robots, or a sequence with one for each. None means no limits.
///     drive: The wheels: for all robots, or a sequence with one of the same kind for each. None means robots that move in any
///         direction.
///     slip: Share of the commanded motion that slipping wheels lose, in 0..1: a number, or (N,) numbers. None means 0.
///     scanner: The scanner on each robot; None for no scans.
///     noise: Noise of the ranges: for all robots, or a sequence with one for each. None means true ranges.
///     surfaces: How what a beam meets changes the noise of its reading: a `SurfaceModel` for all robots, or a sequence with one for
///         each. None means not at all. It needs `noise`, and a scanner that is not tilted.
///     odometry_noise: Noise of the odometry between two steps: for all robots, or a sequence with one for each. None means
///         exact odometry.
///     world_of: (N,) integers. Robots with the same number share a world. None means a world for each robot, with its index as
///         its number.
///     obstacles: Tuples (Shape, trajectory) for an obstacle in each world, or (Shape, trajectory, world) for one world. A
///         trajectory is a pose, or (K, 4) waypoints (time, x, y, yaw) [s, m, m, rad], interpolated linearly: the obstacle stands
///         at the first one before its time, and at the last one after its time. The time is that of the world.
///     clearance: Least free distance around the footprint of a robot at a pose that is drawn [m]. Obstacles and other robots do
///         not count.
///     clearance_limit: Distance up to which the clearance of each robot is measured after each step [m]; None to not measure it.
///
/// Raises:
///     ValueError: There is no robot, a shape or an index is wrong, a number is not finite or out of range, an obstacle is in
///         a world without a robot, or a map has no free place for a robot.
///     TypeError: An argument has the wrong type or dtype.
///
/// Examples:
///     Three robots on an office floor drive ahead for 0.1 s:
///
///     >>> import numpy as np
///     >>> import mobile_robot_simulator as mrs
///     >>> fleet = mrs.Fleet(
///     ...     mrs.floor_plan("office", seed=1),
///     ...     seeds=[1, 2, 3],
///     ...     footprint=mrs.Shape.disc(0.2),
///     ...     scanner=mrs.LaserScanner(beam_count=200),
///     ...     noise=mrs.BeamModel(),
///     ...     clearance=0.1,
///     ... )
///     >>> step = fleet.step(np.tile([0.5, 0.0, 0.0], (3, 1)), 0.1)
///     >>> step.ranges.shape, step.contacts.tolist()
///     ((3, 200), [False, False, False])
#[pyclass(module = "mobile_robot_simulator")]
pub struct Fleet {
    core: crate::Fleet,
    grids: Vec<Py<OccupancyGrid>>,
    world_of: Vec<u64>,
}

#[pymethods]
impl Fleet {
    #[new]
    #[pyo3(
        signature = (
            grids,
            poses = None,
            *,
            seeds = None,
            grid_of = None,
            footprint = None,
            contact = "stop",
            limits = None,
            drive = None,
            slip = None,
            scanner = None,
            noise = None,
            surfaces = None,
            odometry_noise = None,
            world_of = None,
            obstacles = None,
            clearance = 0.0.into(),
            clearance_limit = None,
        ),
        text_signature = "(grids, poses=None, *, seeds=None, grid_of=None, footprint=None, contact='stop', limits=None, \
                          drive=None, slip=None, scanner=None, noise=None, surfaces=None, odometry_noise=None, world_of=None, obstacles=(), \
                          clearance=0.0, clearance_limit=None)"
    )]
    #[allow(clippy::too_many_arguments, reason = "they are keyword arguments in Python")]
    fn new(
        py: Python<'_>,
        grids: &Bound<'_, PyAny>,
        poses: Option<&Bound<'_, PyAny>>,
        seeds: Option<&Bound<'_, PyAny>>,
        grid_of: Option<&Bound<'_, PyAny>>,
        footprint: Option<FootprintArgument<'_>>,
        contact: &str,
        limits: Option<&Bound<'_, PyAny>>,
        drive: Option<&Bound<'_, PyAny>>,
        slip: Option<&Bound<'_, PyAny>>,
        scanner: Option<&Bound<'_, PyAny>>,
        noise: Option<&Bound<'_, PyAny>>,
        surfaces: Option<&Bound<'_, PyAny>>,
        odometry_noise: Option<&Bound<'_, PyAny>>,
        world_of: Option<&Bound<'_, PyAny>>,
        obstacles: Option<&Bound<'_, PyAny>>,
        clearance: Argument<f64>,
        clearance_limit: Option<Argument<f64>>,
    ) -> PyResult<Self> {
        let grids = grids_of(grids)?;
        let poses = poses.map(|poses| rows("poses", poses, None)).transpose()?;
        let count = poses.as_ref().map(|poses| poses.len());
        let seeds = seeds.map(|seeds| whole_numbers("seeds", seeds, count)).transpose()?;
        let seeds = match (seeds, count) {
            (Some(seeds), _) => seeds,
            (None, Some(count)) => (0..count as u64).collect(),
            (None, None) => return Err(PyValueError::new_err("a fleet needs poses or seeds, got neither")),
        };
        let count = seeds.len();
        let grid_of = match grid_of {
            Some(grid_of) => indices("grid_of", grid_of, count)?,
            None if grids.len() == 1 => vec![0; count],
            None if grids.len() == count || count == 0 => (0..count).collect(),
            None => {
                let text = format!("grid_of must be given for {count} robots on {} maps, got None", grids.len());
                return Err(PyValueError::new_err(text));
            }
        };
        let scanner = scanner
            .map(|scanner| {
                scanner
                    .cast::<LaserScanner>()
                    .map(|scanner| scanner.get().0.clone())
                    .map_err(|_| PyTypeError::new_err(format!("scanner must be a LaserScanner, got {}", type_name(scanner))))
            })
            .transpose()?;
        if noise.is_some() && scanner.is_none() {
            return Err(PyValueError::new_err("noise needs a scanner, got scanner=None"));
        }
        if surfaces.is_some() && noise.is_none() {
            return Err(PyValueError::new_err("surfaces need noise, a BeamModel, got None"));
        }
        let slip = match slip {
            None => Vec::new(),
            Some(slip) => match slip.extract::<Argument<f64>>()?.named("slip") {
                Ok(slip) => vec![slip],
                Err(_) => elements("slip", slip, Some(count))?,
            },
        };
        let limits = one_or_each("limits", "Limits", limits, |value| Some(value.cast::<Limits>().ok()?.get().0))?;
        let drives = one_or_each("drive", "Drive", drive, |value| Some(value.cast::<Drive>().ok()?.get().0))?;
        let noise = one_or_each("noise", "BeamModel", noise, |value| Some(value.cast::<BeamModel>().ok()?.get().0))?;
        let surfaces =
            one_or_each("surfaces", "SurfaceModel", surfaces, |value| Some(value.cast::<SurfaceModel>().ok()?.get().0))?;
        let odometry_noise = one_or_each("odometry_noise", "MotionNoise", odometry_noise, |value| {
            Some(value.cast::<MotionNoise>().ok()?.get().0)
        })?;
        let options = FleetOptions {
            footprint: footprint.map(|footprint| footprint.get().clone()),
            contact: contact_mode("contact", contact)?,
            limits,
            drives,
            slip,
            scanner,
            noise,
            surfaces,
            odometry_noise,
            clearance: clearance.named("clearance")?,
            clearance_limit: clearance_limit.map(|limit| limit.named("clearance_limit")).transpose()?,
        };
        let world_of = match world_of {
            Some(world_of) => whole_numbers("world_of", world_of, Some(count))?,
            None => (0..count as u64).collect(),
        };
        let obstacles = obstacles.map_or_else(|| Ok(Vec::new()), obstacles_of)?;
        let cores = grids.iter().map(|grid| grid.get().core()).collect();
        let poses: &[[f64; 3]] = poses.as_deref().unwrap_or(&[]);
        let core = py.detach(|| crate::Fleet::new(cores, options, poses, &seeds, &grid_of, &world_of, obstacles))?;
        Ok(Self { core, grids, world_of })
    }

    /// Moves all robots for a duration, each at its command, and takes a scan of each at the end.
    ///
    /// If there is an error, or the call is interrupted, no robot has moved; the arrays of `out` may have changed.
    ///
    /// Args:
    ///     commands: (N, 3), the velocity (vx, vy, wz) in the frame of each robot [m/s, m/s, rad/s], each at most 1000. With a
    ///         drive, the wheels do what they can of it: see `Drive.command`. For Ackermann drives also (N, 2), the speed and
    ///         the steering angle of each robot [m/s, rad], limited to what the drive can do. Anything that NumPy can convert to float64 without loss.
    ///     duration: Duration of the step [s], at most 1e6. It is rounded to nanoseconds.
    ///     scan: Whether to take scans, if there is a scanner. They have the noise of the next index of each robot.
    ///     threads: Number of threads, 1 to 1024; None means one per core. The result does not depend on it.
    ///     out: Result of an earlier step, whose arrays are used again. None means new arrays.
    ///
    /// Returns:
    ///     Poses, velocities, contacts and ranges of all robots; `out` if it was given.
    ///
    /// Raises:
    ///     ValueError: A shape is wrong, a command is not finite or too large, the duration is not positive, `threads` is out
    ///         of range, or an array of `out` cannot be used.
    ///     TypeError: An argument has the wrong type or dtype.
    ///     RuntimeError: Another thread uses the fleet.
    ///     OSError: The threads could not be started.
    ///
    /// Examples:
    ///     The only wall covers x from 2 m to 3 m. A robot of radius 0.2 m drives against it at 1 m/s:
    ///
    ///     >>> import numpy as np
    ///     >>> import mobile_robot_simulator as mrs
    ///     >>> grid = mrs.OccupancyGrid(np.array([[0, 0, 100]], np.int8), resolution=1.0)
    ///     >>> fleet = mrs.Fleet(grid, [(0.5, 0.5, 0.0)], footprint=mrs.Shape.disc(0.2))
    ///     >>> step = fleet.step([(1.0, 0.0, 0.0)], 2.0)
    ///     >>> step.poses.round(3), step.contacts, step.contact_points
    ///     (array([[1.8, 0.5, 0. ]]), array([ True]), array([[2. , 0.5]]))
    #[pyo3(signature = (commands, duration, *, scan = true, threads = None, out = None))]
    fn step<'py>(
        slf: &Bound<'py, Self>,
        commands: &Bound<'py, PyAny>,
        duration: Argument<f64>,
        scan: bool,
        threads: Option<&Bound<'py, PyAny>>,
        out: Option<Bound<'py, FleetStep>>,
    ) -> PyResult<Bound<'py, FleetStep>> {
        let py = slf.py();
        let (threads, duration) = (thread_count(threads)?, duration.named("duration")?);
        let mut fleet = borrowed(slf)?;
        fleet.refresh(py)?;
        let count = fleet.core.len();
        let commands = Commands::of_robots(commands, &fleet.core)?;
        let beam_count = fleet.beam_count().filter(|_| scan);
        let options = fleet.core.options();
        let has_clearances = options.clearance_limit.is_some() && options.footprint.is_some();
        let out = match out {
            Some(out) => out,
            None => Bound::new(py, FleetStep::new(py, count, beam_count, has_clearances)?)?,
        };
        let mut arrays = out.get().open(py, count, beam_count, has_clearances)?;
        let mut rows = arrays.rows()?;
        let core = &mut fleet.core;
        let commands = commands.of_core();
        py.detach(|| {
            core.step(commands, duration, threads, rows.ranges.take())?;
            rows.write(core.reports());
            Ok::<(), crate::Error>(())
        })?;
        drop(arrays);
        Ok(out)
    }

    /// Takes a scan of each chosen robot where it stands, with the noise of its next index.
    ///
    /// Args:
    ///     mask: (N,) bool, which robots to scan. None means all.
    ///     threads: Number of threads, 1 to 1024; None means one per core. The result does not depend on it.
    ///     out: (M, beam_count) float32, an array for the result. None means a new array.
    ///
    /// Returns:
    ///     (M, beam_count) float32, the ranges of the M chosen robots [m], in their order.
    ///
    /// Raises:
    ///     ValueError: A shape is wrong, the fleet has no scanner, or `out` cannot be used.
    ///     TypeError: An argument has the wrong type or dtype.
    ///     RuntimeError: Another thread uses the fleet.
    ///     OSError: The threads could not be started.
    ///
    /// Examples:
    ///     The only wall covers x from 2 m to 3 m:
    ///
    ///     >>> import numpy as np
    ///     >>> import mobile_robot_simulator as mrs
    ///     >>> grid = mrs.OccupancyGrid(np.array([[0, 0, 100]], np.int8), resolution=1.0)
    ///     >>> fleet = mrs.Fleet(grid, [(0.5, 0.5, 0.0), (1.5, 0.5, 0.0)], scanner=mrs.LaserScanner(beam_count=1))
    ///     >>> fleet.scan()
    ///     array([[1.5],
    ///            [0.5]], dtype=float32)
    ///     >>> fleet.scan([False, True])
    ///     array([[0.5]], dtype=float32)
    #[pyo3(signature = (mask = None, *, threads = None, out = None))]
    fn scan<'py>(
        slf: &Bound<'py, Self>,
        mask: Option<&Bound<'py, PyAny>>,
        threads: Option<&Bound<'py, PyAny>>,
        out: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let threads = thread_count(threads)?;
        let mut fleet = borrowed(slf)?;
        fleet.refresh(slf.py())?;
        let mask = fleet.mask(mask)?;
        let Some(beams) = fleet.beam_count() else {
            return Err(PyValueError::new_err("the fleet must have a scanner to scan, got scanner=None"));
        };
        let chosen = mask.iter().filter(|&&is_chosen| is_chosen).count();
        let core = &mut fleet.core;
        fill(slf.py(), out, &[chosen, beams], |readings| core.scan(&mask, threads, readings))
    }

    /// Puts robots at poses, where they stand still.
    ///
    /// The time of a world begins at 0 again, unless other robots stay in it.
    /// Poses that are not given are drawn from the free space of the robot's map, with the robot's seed: as by
    /// `OccupancyGrid.draw_free_poses` with the radius `footprint.reach + clearance`. If there is an error, nothing has changed.
    ///
    /// Args:
    ///     mask: (N,) bool, which robots to reset. None means all. Rows of the other robots are ignored below.
    ///     poses: (N, 3), poses (x, y, yaw) in the map frame [m, m, rad].
    ///     seeds: (N,) integers, new seeds: the noise and the poses to draw start again. None means that they go on, so that
    ///         each reset draws another pose.
    ///     grids: (N,) integers, indices of the maps from now on. None means that the maps stay.
    ///
    /// Raises:
    ///     ValueError: A shape or an index is wrong, a pose is not finite, or a map has no free place for a robot.
    ///     TypeError: An argument has the wrong type or dtype.
    ///     RuntimeError: Another thread uses the fleet.
    ///
    /// Examples:
    ///     >>> import numpy as np
    ///     >>> import mobile_robot_simulator as mrs
    ///     >>> grid = mrs.OccupancyGrid(np.zeros((9, 9), np.int8), resolution=1.0)
    ///     >>> fleet = mrs.Fleet(grid, seeds=[1, 2, 3])
    ///     >>> first = fleet.poses
    ///     >>> fleet.reset([True, False, False])  # another random pose for robot 0
    ///     >>> (fleet.poses == first).all(axis=1)
    ///     array([False,  True,  True])
    ///     >>> fleet.reset(seeds=[1, 2, 3])
    ///     >>> (fleet.poses == first).all()
    ///     np.True_
    #[pyo3(signature = (mask = None, *, poses = None, seeds = None, grids = None))]
    fn reset(
        slf: &Bound<'_, Self>,
        mask: Option<&Bound<'_, PyAny>>,
        poses: Option<&Bound<'_, PyAny>>,
        seeds: Option<&Bound<'_, PyAny>>,
        grids: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        let mut fleet = borrowed(slf)?;
        fleet.refresh(slf.py())?;
        let (mask, count) = (fleet.mask(mask)?, fleet.core.len());
        let poses = poses.map(|poses| rows("poses", poses, None)).transpose()?;
        let seeds = seeds.map(|seeds| whole_numbers("seeds", seeds, Some(count))).transpose()?;
        let grids = grids.map(|grids| indices("grids", grids, count)).transpose()?;
        let reset = Reset { poses: poses.as_deref(), seeds: seeds.as_deref(), grids: grids.as_deref() };
        let core = &mut fleet.core;
        Ok(slf.py().detach(|| core.reset(&mask, reset))?)
    }

    /// Replaces obstacles, for example by those of the next episode of a robot. They keep their indices and worlds.
    ///
    /// Args:
    ///     obstacles: Tuples (index, Shape, trajectory), with the index of an obstacle that was given for one world. A trajectory
    ///         is that of the constructor: a pose, waypoints, or None if the obstacle is not there.
    ///
    /// Raises:
    ///     ValueError: There is no such obstacle, it is in each world, or a trajectory is invalid. Nothing changes.
    ///     TypeError: An argument has the wrong type.
    ///     RuntimeError: Another thread uses the fleet.
    ///
    /// Examples:
    ///     Two robots in worlds of their own; an obstacle is put before the second one:
    ///
    ///     >>> import numpy as np
    ///     >>> import mobile_robot_simulator as mrs
    ///     >>> grid, disc = mrs.OccupancyGrid(np.zeros((9, 9), np.int8), resolution=1.0), mrs.Shape.disc(0.5)
    ///     >>> obstacles = [(disc, None, 0), (disc, None, 1)]
    ///     >>> fleet = mrs.Fleet(grid, [(1.0, 4.0, 0.0)] * 2, footprint=disc, obstacles=obstacles)
    ///     >>> fleet.replace_obstacles([(1, disc, (3.0, 4.0, 0.0))])
    ///     >>> fleet.step([(1.0, 0.0, 0.0)] * 2, 2.0).poses[:, 0].round(3)
    ///     array([3., 2.])
    fn replace_obstacles(slf: &Bound<'_, Self>, obstacles: &Bound<'_, PyAny>) -> PyResult<()> {
        let changes = replacements(obstacles)?;
        Ok(borrowed(slf)?.core.replace_obstacles(changes)?)
    }

    /// Returns the state of robots, for `restore`: motion, contact, random streams and map.
    ///
    /// Args:
    ///     mask: (N,) bool, which robots to save. None means all.
    ///
    /// Raises:
    ///     ValueError: The mask has the wrong shape.
    ///     TypeError: The mask is not bool.
    ///     RuntimeError: Another thread uses the fleet.
    ///
    /// Examples:
    ///     >>> import numpy as np
    ///     >>> import mobile_robot_simulator as mrs
    ///     >>> grid = mrs.OccupancyGrid(np.zeros((9, 9), np.int8), resolution=1.0)
    ///     >>> fleet = mrs.Fleet(grid, [(1.0, 1.0, 0.0), (1.0, 2.0, 0.0)])
    ///     >>> state = fleet.save()
    ///     >>> step = fleet.step([(1.0, 0.0, 0.0)] * 2, 1.0)
    ///     >>> fleet.restore(state)
    ///     >>> fleet.poses
    ///     array([[1., 1., 0.],
    ///            [1., 2., 0.]])
    #[pyo3(signature = (mask = None))]
    fn save(slf: &Bound<'_, Self>, mask: Option<&Bound<'_, PyAny>>) -> PyResult<FleetState> {
        let fleet = borrowed(slf)?;
        Ok(FleetState(fleet.core.save(&fleet.mask(mask)?)?))
    }

    /// Puts robots into saved states.
    ///
    /// Args:
    ///     state: What `save` returned, of this fleet or of another one with the same maps.
    ///     mask: (N,) bool, which robots to put into the states, in their order; one state can go to any number of robots. None
    ///         means those that were saved.
    ///
    /// Raises:
    ///     ValueError: The mask has the wrong shape, there is neither one state nor one for each robot, a robot or a map does
    ///         not exist, or a robot has another drive than the one saved. Nothing changes.
    ///     TypeError: An argument has the wrong type.
    ///     RuntimeError: Another thread uses the fleet.
    ///
    /// Examples:
    ///     A planner puts all robots of a second fleet where the only robot of the first one is:
    ///
    ///     >>> import numpy as np
    ///     >>> import mobile_robot_simulator as mrs
    ///     >>> grid = mrs.OccupancyGrid(np.zeros((9, 9), np.int8), resolution=1.0)
    ///     >>> robot, imagined = mrs.Fleet(grid, [(1.0, 2.0, 0.0)]), mrs.Fleet(grid, np.zeros((3, 3)))
    ///     >>> imagined.restore(robot.save(), [True, True, False])
    ///     >>> imagined.poses
    ///     array([[1., 2., 0.],
    ///            [1., 2., 0.],
    ///            [0., 0., 0.]])
    #[pyo3(signature = (state, mask = None))]
    fn restore(slf: &Bound<'_, Self>, state: &Bound<'_, PyAny>, mask: Option<&Bound<'_, PyAny>>) -> PyResult<()> {
        let mut fleet = borrowed(slf)?;
        let mask = mask.map(|mask| fleet.mask(Some(mask))).transpose()?;
        let state = state
            .cast::<FleetState>()
            .map_err(|_| PyTypeError::new_err(format!("state must be a FleetState, got {}", type_name(state))))?;
        Ok(fleet.core.restore(&state.get().0, mask.as_deref())?)
    }

    /// Returns the goals of robots as seen from them.
    ///
    /// Args:
    ///     goals: (N, 2), the goal (x, y) of each robot in the map frame [m].
    ///     mask: (N,) bool, which robots to look at. None means all. Goals of the other robots are ignored.
    ///     out: (M, 2) float64, an array for the result. None means a new array.
    ///
    /// Returns:
    ///     (M, 2) float64, which is `out` if it was given: for each of the M chosen robots the distance [m], and the bearing in
    ///     (-π, π] [rad], 0 straight ahead and positive to the left.
    ///
    /// Raises:
    ///     ValueError: A shape is wrong, a goal is not finite, or `out` cannot be used.
    ///     TypeError: An argument has the wrong type or dtype.
    ///     RuntimeError: Another thread uses the fleet.
    ///
    /// Examples:
    ///     >>> import numpy as np
    ///     >>> import mobile_robot_simulator as mrs
    ///     >>> grid = mrs.OccupancyGrid(np.zeros((9, 9), np.int8), resolution=1.0)
    ///     >>> mrs.Fleet(grid, [(1.0, 1.0, 0.0)]).relative([(1.0, 3.0)]).round(4)
    ///     array([[2.    , 1.5708]])
    #[pyo3(signature = (goals, mask = None, *, out = None))]
    fn relative<'py>(
        slf: &Bound<'py, Self>,
        goals: &Bound<'py, PyAny>,
        mask: Option<&Bound<'py, PyAny>>,
        out: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let fleet = borrowed(slf)?;
        let count = fleet.core.len();
        let goals = pairs("goals", goals, Some(count))?;
        let mask = mask.map(|mask| fleet.mask(Some(mask))).transpose()?;
        let chosen = mask.as_ref().map_or(count, |mask| mask.iter().filter(|&&is_chosen| is_chosen).count());
        let core = &fleet.core;
        fill(slf.py(), out, &[chosen, 2], |seen: &mut [f64]| core.relative(mask.as_deref(), &goals, seen.as_chunks_mut().0))
    }

    /// Returns what would happen to one robot under many sequences of commands, for planners such as MPPI. The fleet stays as it is.
    ///
    /// Each sequence begins with the present state of the robot. It moves as by `step(..., scan=False)` with one command after
    /// another. The other robots of its world go on at their last commands.
    ///
    /// Args:
    ///     commands: (K, T, 3), T commands (vx, vy, wz) for each of K rollouts [m/s, m/s, rad/s], each at most 1000. For an
    ///         Ackermann drive also (K, T, 2), speeds and steering angles [m/s, rad]. Anything that NumPy can convert to
    ///         float64 without loss. An array in C order is read in place, so no other thread may write to it during the call.
    ///     duration: Duration of a command [s], at most 1e6.
    ///     robot: Index of the robot.
    ///     threads: Number of threads, 1 to 1024; None means one per core. The result does not depend on it.
    ///
    /// Returns:
    ///     The poses (K, T, 3) float64 in the map frame after each command [m, m, rad], and (K, T) bool, whether the robot
    ///     touched something at each command.
    ///
    /// Raises:
    ///     ValueError: A shape is wrong, a command is not finite or too large, the duration is not positive, or there is no such
    ///         robot.
    ///     TypeError: An argument has the wrong type or dtype.
    ///     RuntimeError: Another thread uses the fleet.
    ///     OSError: The threads could not be started.
    ///
    /// Examples:
    ///     The only wall covers x from 2 m to 3 m. Which of two sequences of two commands touches it?
    ///
    ///     >>> import numpy as np
    ///     >>> import mobile_robot_simulator as mrs
    ///     >>> grid = mrs.OccupancyGrid(np.array([[0, 0, 100]], np.int8), resolution=1.0)
    ///     >>> fleet = mrs.Fleet(grid, [(0.5, 0.5, 0.0)], footprint=mrs.Shape.disc(0.2))
    ///     >>> slow, fast = (0.5, 0.0, 0.0), (1.0, 0.0, 0.0)
    ///     >>> poses, contacts = fleet.rollout([[slow, slow], [fast, fast]], 1.0)
    ///     >>> poses[:, :, 0].round(3), contacts
    ///     (array([[1. , 1.5],
    ///            [1.5, 1.8]]), array([[False, False],
    ///            [False,  True]]))
    #[pyo3(signature = (commands, duration, *, robot = None, threads = None), text_signature = "($self, commands, duration, *, robot=0, threads=None)")]
    fn rollout<'py>(
        slf: &Bound<'py, Self>,
        commands: &Bound<'py, PyAny>,
        duration: Argument<f64>,
        robot: Option<&Bound<'py, PyAny>>,
        threads: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
        let (py, threads, duration) = (slf.py(), thread_count(threads)?, duration.named("duration")?);
        let robot = robot.map_or(Ok(0), |robot| whole_number("robot", robot, "at least 0"))?;
        let mut fleet = borrowed(slf)?;
        fleet.refresh(py)?;
        let (commands, [count, steps]) = Commands::of_rollouts(commands, &fleet.core)?;
        let (poses, contacts) = (zeros::<f64>(py, &[count, steps, 3])?, zeros::<bool>(py, &[count, steps])?);
        {
            let mut poses = writable::<f64>(&poses, &[count, steps, 3])?;
            let mut contacts = writable::<bool>(&contacts, &[count, steps])?;
            let (poses, contacts) = (poses.as_slice_mut()?.as_chunks_mut().0, contacts.as_slice_mut()?);
            let core = &fleet.core;
            let commands = commands.of_core();
            py.detach(|| {
                let length = steps.max(1);
                let pairs = poses.chunks_mut(length).zip(contacts.chunks_mut(length));
                let mut rollouts: Vec<_> = pairs.map(|(poses, contacts)| Rollout { poses, contacts }).collect();
                core.rollout(robot, commands, duration, threads, &mut rollouts)
            })?;
        }
        Ok((poses, contacts))
    }

    /// Poses of the robots now: (N, 3) float64, rows (x, y, yaw) in the map frame [m, m, rad], a new array.
    #[getter]
    fn poses<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        let fleet = borrowed(slf)?;
        let core = &fleet.core;
        fill(slf.py(), None, &[core.len(), 3], |numbers: &mut [f64]| {
            numbers.as_chunks_mut().0.iter_mut().zip(core.poses()).for_each(|(row, pose)| *row = pose.to_array());
            Ok(())
        })
    }

    /// Velocities of the robots now: (N, 3) float64, rows (vx, vy, wz) in their own frames [m/s, m/s, rad/s], a new array.
    #[getter]
    fn velocities<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        let fleet = borrowed(slf)?;
        let core = &fleet.core;
        fill(slf.py(), None, &[core.len(), 3], |numbers: &mut [f64]| {
            numbers.as_chunks_mut().0.iter_mut().zip(core.velocities()).for_each(|(row, twist)| *row = twist.to_array());
            Ok(())
        })
    }

    /// Returns what the joints of the robots do now.
    ///
    /// The joints are the wheels in the order of `Drive`, then the steering of the left and of the right front wheel.
    ///
    /// Returns:
    ///     Positions (N, J) float64 [rad], those of wheels since the last reset, and rates (N, J) float64 [rad/s]. J is 2 for a
    ///     differential, 4 for an omni and 6 for an Ackermann drive, and 0 without a drive.
    ///
    /// Raises:
    ///     ValueError: A rate is too large for a number.
    ///     RuntimeError: Another thread uses the fleet.
    ///
    /// Examples:
    ///     >>> import numpy as np
    ///     >>> import mobile_robot_simulator as mrs
    ///     >>> grid = mrs.OccupancyGrid(np.zeros((9, 9), np.int8), resolution=1.0)
    ///     >>> drive = mrs.Drive.differential(track=0.5, wheel_radius=0.1)
    ///     >>> fleet = mrs.Fleet(grid, [(1.0, 1.0, 0.0)], drive=drive)
    ///     >>> step = fleet.step([(1.0, 0.0, 1.0)], 2.0)
    ///     >>> fleet.joints()
    ///     (array([[15., 25.]]), array([[ 7.5, 12.5]]))
    fn joints<'py>(slf: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
        let (fleet, py) = (borrowed(slf)?, slf.py());
        let dimensions = [fleet.core.len(), fleet.core.joint_count()];
        let (positions, rates) = (zeros::<f64>(py, &dimensions)?, zeros::<f64>(py, &dimensions)?);
        {
            let mut positions = writable::<f64>(&positions, &dimensions)?;
            let mut rates = writable::<f64>(&rates, &dimensions)?;
            fleet.core.joints(positions.as_slice_mut()?, rates.as_slice_mut()?)?;
        }
        Ok((positions, rates))
    }

    /// Steering angle of each robot now: (N,) float64 [rad], a new array; 0 for robots that do not steer.
    #[getter]
    fn steering<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        let fleet = borrowed(slf)?;
        let core = &fleet.core;
        fill(slf.py(), None, &[core.len()], |angles: &mut [f64]| core.steering(angles))
    }

    /// Time of the world of each robot: (N,) float64 [s], a new array.
    #[getter]
    fn times<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        let fleet = borrowed(slf)?;
        let core = &fleet.core;
        fill(slf.py(), None, &[core.len()], |numbers: &mut [f64]| {
            numbers.iter_mut().zip(core.times()).for_each(|(number, time)| *number = time);
            Ok(())
        })
    }

    /// Seed of each robot: (N,) uint64, a new array.
    #[getter]
    fn seeds<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        let fleet = borrowed(slf)?;
        let core = &fleet.core;
        fill(slf.py(), None, &[core.len()], |numbers: &mut [u64]| {
            numbers.iter_mut().zip(core.seeds()).for_each(|(number, seed)| *number = seed);
            Ok(())
        })
    }

    /// Index of the map of each robot: (N,) int64, a new array.
    #[getter]
    fn grid_of<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        let fleet = borrowed(slf)?;
        let core = &fleet.core;
        fill(slf.py(), None, &[core.len()], |numbers: &mut [i64]| {
            numbers.iter_mut().zip(core.grid_of()).for_each(|(number, grid)| *number = grid as i64);
            Ok(())
        })
    }

    /// The maps.
    #[getter]
    fn grids(slf: &Bound<'_, Self>) -> PyResult<Vec<Py<OccupancyGrid>>> {
        let fleet = borrowed(slf)?;
        Ok(fleet.grids.iter().map(|grid| grid.clone_ref(slf.py())).collect())
    }

    /// The scanner on each robot; None without one.
    #[getter]
    fn scanner(slf: &Bound<'_, Self>) -> PyResult<Option<LaserScanner>> {
        Ok(borrowed(slf)?.core.options().scanner.clone().map(LaserScanner))
    }

    /// Outline of the robots; None if they touch nothing.
    #[getter]
    fn footprint(slf: &Bound<'_, Self>) -> PyResult<Option<Shape>> {
        Ok(borrowed(slf)?.core.options().footprint.clone().map(Shape))
    }

    /// What a contact does to the motion: "stop", "slide" or "report".
    #[getter]
    fn contact(slf: &Bound<'_, Self>) -> PyResult<&'static str> {
        Ok(match borrowed(slf)?.core.options().contact {
            ContactMode::Stop => "stop",
            ContactMode::Slide => "slide",
            ContactMode::Report => "report",
        })
    }

    /// Limits on the velocity and its change: one for all robots, or one for each; None for no limits.
    #[getter]
    fn limits(slf: &Bound<'_, Self>) -> PyResult<Option<Vec<Limits>>> {
        let limits = borrowed(slf)?.core.options().limits.iter().copied().map(Limits).collect::<Vec<_>>();
        Ok(Some(limits).filter(|limits| !limits.is_empty()))
    }

    /// The wheels: one drive for all robots, or one for each; None for robots that move in any direction.
    #[getter]
    fn drive(slf: &Bound<'_, Self>) -> PyResult<Option<Vec<Drive>>> {
        let drives = borrowed(slf)?.core.options().drives.iter().copied().map(Drive).collect::<Vec<_>>();
        Ok(Some(drives).filter(|drives| !drives.is_empty()))
    }

    /// Share of the commanded motion that slipping wheels lose, for each robot; None for none.
    #[getter]
    fn slip(slf: &Bound<'_, Self>) -> PyResult<Option<Vec<f64>>> {
        let fleet = borrowed(slf)?;
        let slip = &fleet.core.options().slip;
        let is_one = slip.len() == 1;
        let slip = if is_one { vec![slip[0]; fleet.core.len()] } else { slip.clone() };
        Ok(Some(slip).filter(|slip| !slip.is_empty()))
    }

    /// Noise of the ranges: one for all robots, or one for each; None for true ranges.
    #[getter]
    fn noise(slf: &Bound<'_, Self>) -> PyResult<Option<Vec<BeamModel>>> {
        let noise = borrowed(slf)?.core.options().noise.iter().copied().map(BeamModel).collect::<Vec<_>>();
        Ok(Some(noise).filter(|noise| !noise.is_empty()))
    }

    /// How what a beam meets changes its reading: one for all robots, or one for each; None for not at all.
    #[getter]
    fn surfaces(slf: &Bound<'_, Self>) -> PyResult<Option<Vec<SurfaceModel>>> {
        let surfaces = borrowed(slf)?.core.options().surfaces.iter().copied().map(SurfaceModel).collect::<Vec<_>>();
        Ok(Some(surfaces).filter(|surfaces| !surfaces.is_empty()))
    }

    /// Noise of the odometry: one for all robots, or one for each; None for exact odometry.
    #[getter]
    fn odometry_noise(slf: &Bound<'_, Self>) -> PyResult<Option<Vec<MotionNoise>>> {
        let noise = borrowed(slf)?.core.options().odometry_noise.iter().copied().map(MotionNoise).collect::<Vec<_>>();
        Ok(Some(noise).filter(|noise| !noise.is_empty()))
    }

    /// Number of the world of each robot: (N,) uint64, a new array.
    #[getter]
    fn world_of<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        let world_of = borrowed(slf)?.world_of.clone();
        Ok(vector(slf.py(), world_of).into_any())
    }

    /// The obstacles: a list of (Shape, waypoints, world).
    ///
    /// The waypoints are (K, 4) float64, or None if the obstacle is not there; the world is its number, or None for all.
    #[getter]
    fn obstacles<'py>(slf: &Bound<'py, Self>) -> PyResult<Vec<ObstacleTuple<'py>>> {
        let fleet = borrowed(slf)?;
        let read = |obstacle: &FleetObstacle| {
            let rows = obstacle.trajectory.as_ref().map(|trajectory| {
                let rows: Vec<[f64; 4]> = trajectory.waypoints().collect();
                Array2::from(rows).into_pyarray(slf.py()).into_any()
            });
            (Shape(obstacle.shape.clone()), rows, obstacle.world)
        };
        Ok(fleet.core.obstacles().iter().map(read).collect())
    }

    /// Distance up to which the clearance of the robots is measured after each step [m]; None to not measure it.
    #[getter]
    fn clearance_limit(slf: &Bound<'_, Self>) -> PyResult<Option<f64>> {
        Ok(borrowed(slf)?.core.options().clearance_limit)
    }

    /// Least free distance around the footprint of a robot at a pose that is drawn [m].
    #[getter]
    fn clearance(slf: &Bound<'_, Self>) -> PyResult<f64> {
        Ok(borrowed(slf)?.core.options().clearance)
    }

    fn __len__(slf: &Bound<'_, Self>) -> PyResult<usize> {
        Ok(borrowed(slf)?.core.len())
    }

    fn __setstate__(slf: &Bound<'_, Self>, state: &Bound<'_, PyAny>) -> PyResult<()> {
        Self::restore(slf, state, None)
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>, FleetState)> {
        let (py, state) = (slf.py(), Self::save(slf, None)?);
        let keywords = PyDict::new(py);
        keywords.set_item("grid_of", Self::grid_of(slf)?)?;
        keywords.set_item("footprint", Self::footprint(slf)?)?;
        keywords.set_item("contact", Self::contact(slf)?)?;
        keywords.set_item("limits", Self::limits(slf)?)?;
        keywords.set_item("drive", Self::drive(slf)?)?;
        keywords.set_item("slip", Self::slip(slf)?)?;
        keywords.set_item("scanner", Self::scanner(slf)?)?;
        keywords.set_item("noise", Self::noise(slf)?)?;
        keywords.set_item("surfaces", Self::surfaces(slf)?)?;
        keywords.set_item("odometry_noise", Self::odometry_noise(slf)?)?;
        keywords.set_item("world_of", Self::world_of(slf)?)?;
        keywords.set_item("obstacles", Self::obstacles(slf)?)?;
        keywords.set_item("clearance", Self::clearance(slf)?)?;
        keywords.set_item("clearance_limit", Self::clearance_limit(slf)?)?;
        let positional = (Self::grids(slf)?, Self::poses(slf)?).into_pyobject(py)?;
        let (make, arguments) = recipe::<Self>(py, positional, keywords)?;
        Ok((make, arguments.into_pyobject(py)?.into_any(), state))
    }

    fn __repr__(slf: &Bound<'_, Self>) -> PyResult<String> {
        let fleet = borrowed(slf)?;
        Ok(format!("Fleet({} robots, {} maps)", fleet.core.len(), fleet.grids.len()))
    }
}

impl Fleet {
    /// Takes over changes of the cells of the maps.
    fn refresh(&mut self, py: Python<'_>) -> PyResult<()> {
        let cores: Vec<Arc<crate::OccupancyGrid>> = self.grids.iter().map(|grid| grid.bind(py).get().core()).collect();
        Ok(self.core.use_grids(cores)?)
    }

    fn beam_count(&self) -> Option<usize> {
        self.core.options().scanner.as_ref().map(|scanner| scanner.options().beam_count)
    }

    fn mask(&self, mask: Option<&Bound<'_, PyAny>>) -> PyResult<Vec<bool>> {
        let count = self.core.len();
        mask.map_or_else(|| Ok(vec![true; count]), |mask| elements("mask", mask, Some(count)))
    }
}

/// An obstacle with its waypoints and the number of its world.
type ObstacleTuple<'py> = (Shape, Option<Bound<'py, PyAny>>, Option<u64>);

/// Returns the fleet for one call.
fn borrowed<'py>(fleet: &Bound<'py, Fleet>) -> PyResult<PyRefMut<'py, Fleet>> {
    fleet
        .try_borrow_mut()
        .map_err(|_| PyRuntimeError::new_err("a fleet must be used by one thread at a time, got a call during another one"))
}
