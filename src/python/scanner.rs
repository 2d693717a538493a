//! The Python class `LaserScanner`.

use numpy::{IntoPyArray, PyArray1, PyArray2, ndarray::Array2};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyTuple;

use super::arrays::{check_out, fill, rows, rows_or_beam_rows, shape, short_repr, typed, vector};
use super::beam_model::NoiseArgument;
use super::grid::GridArgument;
use super::likelihood_field::ModelArgument;
use super::mount::MountArgument;
use super::number::Argument;
use super::obstacles::{MovingObstaclesArgument, ObstaclesArgument};
use super::pose::{Pose, PoseArgument};
use super::random_stream::SeedArgument;
use super::scanner_options::{chosen_beams, default, keywords, layout, text};
use super::surface_model::SurfacesArgument;
use super::sweep::SweepArguments;
use super::{Recipe, recipe, thread_count, whole_number};
use crate::memory;
use crate::{Courses, Hit, NoReturn, Noise, Preset, Readings, ScannerOptions, Score};

/// A planar laser scanner with evenly spaced beams.
///
/// Beam i points at `angle_min + i * angle_increment` in the scanner's frame. A field of view `fov` is centred on the x axis,
/// with a beam at both ends: `angle_increment = fov / (beam_count - 1)`. A full turn (within 2e-5) has no second end:
/// `angle_increment = fov / beam_count`. A single beam points along the x axis. The defaults are those of a SICK S300.
///
/// Instead of `fov`, the field can be given by `angle_min` and `angle_max`, with the same rules, or by `angle_min` and
/// `angle_increment`. If `angle_max` is less than `angle_min`, or the increment is negative, the beams turn clockwise.
///
/// A scanner may be mounted upside down or tilted. A tilted one measures the distance in space to walls and obstacles, which
/// have any height, and to the floor if z is positive. A tilt of at most 1e-5 rad counts as level or upside down.
///
/// Args:
///     fov: Field of view [rad], above 0 and at most 2π. None means the default, or the field given by the angles.
///     angle_min: Angle of the first beam [rad], -2π to 2π.
///     angle_max: Angle of the last beam [rad], -2π to 2π; in a full turn, the angle at which the turn is complete.
///     angle_increment: Angle from one beam to the next [rad]. All beams together must turn by at most 2π.
///     beam_count: Number of beams and of ranges in a scan, 1 to 1000000. None means the default.
///     min_range: Smallest valid range [m]. It does not change scans; `mark_invalid` and `end_points` use it.
///     max_range: Range of a beam that hits nothing [m], greater than `min_range`.
///     mount: Pose of the scanner in the robot's frame: (x, y, yaw) [m, m, rad], or in space (x, y, z, roll, pitch, yaw) with
///         the angles of URDF, or (x, y, z, qx, qy, qz, qw) with a quaternion.
///
/// Raises:
///     ValueError: A value is outside its range or not finite.
///     TypeError: An argument has the wrong type.
///
/// Examples:
///     >>> import mobile_robot_simulator as mrs
///     >>> mrs.LaserScanner(fov=2.0, beam_count=5).angles
///     array([-1. , -0.5,  0. ,  0.5,  1. ])
///
///     0.5 m above the floor, and looking down by 30°:
///
///     >>> import math
///     >>> import numpy as np
///     >>> free = mrs.OccupancyGrid(np.zeros((1, 1), np.int8), resolution=1.0)
///     >>> down = mrs.LaserScanner(beam_count=1, mount=(0.0, 0.0, 0.5, 0.0, math.radians(30), 0.0))
///     >>> down.scan(free, (0.5, 0.5, 0.0))
///     array([1.], dtype=float32)
#[pyclass(frozen, module = "mobile_robot_simulator")]
pub struct LaserScanner(pub crate::LaserScanner);

#[pymethods]
impl LaserScanner {
    #[new]
    // The text repeats the core's defaults for `help()`; a test compares the two.
    #[pyo3(
        text_signature = "(*, fov=4.71, angle_min=None, angle_max=None, angle_increment=None, beam_count=541, \
                          min_range=0.05, max_range=30.0, mount=(0.0, 0.0, 0.0))",
        signature = (
            *args,
            fov = None,
            angle_min = None,
            angle_max = None,
            angle_increment = None,
            beam_count = None,
            min_range = default().min_range.into(),
            max_range = default().max_range.into(),
            mount = MountArgument(default().mount),
        )
    )]
    #[allow(clippy::too_many_arguments, reason = "they are keyword arguments in Python")]
    fn new(
        args: &Bound<'_, PyTuple>,
        fov: Option<Argument<f64>>,
        angle_min: Option<Argument<f64>>,
        angle_max: Option<Argument<f64>>,
        angle_increment: Option<Argument<f64>>,
        beam_count: Option<&Bound<'_, PyAny>>,
        min_range: Argument<f64>,
        max_range: Argument<f64>,
        mount: MountArgument,
    ) -> PyResult<Self> {
        if !args.is_empty() {
            let text = "LaserScanner takes its arguments by name, such as fov=4.71 (radians) and beam_count=541, got ";
            return Err(PyTypeError::new_err(format!("{text}{}", short_repr(args))));
        }
        let beam_count = beam_count.map(|value| whole_number("beam_count", value, "in 1..1000000")).transpose()?;
        let beam_count = beam_count.unwrap_or(default().beam_count);
        let layout = layout(fov, angle_min, angle_max, angle_increment)?;
        let (min_range, max_range) = (min_range.named("min_range")?, max_range.named("max_range")?);
        let options = ScannerOptions { layout, beam_count, min_range, max_range, mount: mount.0 };
        Ok(Self(crate::LaserScanner::new(options)?))
    }

    /// Returns a scanner that is sold, with the field, the beams and the ranges of its data sheet.
    ///
    /// What is not known of it has the default. `laser_presets` lists all presets, and `BeamModel.preset` gives the noise.
    ///
    /// Args:
    ///     name: Name of the preset, such as hokuyo_utm30lx.
    ///     mount: Pose of the scanner in the robot's frame, as in the constructor.
    ///
    /// Raises:
    ///     ValueError: There is no such preset.
    ///
    /// Examples:
    ///     >>> import mobile_robot_simulator as mrs
    ///     >>> laser = mrs.LaserScanner.preset("hokuyo_utm30lx")
    ///     >>> laser.beam_count, laser.max_range
    ///     (1081, 30.0)
    #[staticmethod]
    #[pyo3(text_signature = "(name, *, mount=(0.0, 0.0, 0.0))", signature = (name, *, mount = MountArgument(default().mount)))]
    fn preset(name: &str, mount: MountArgument) -> PyResult<Self> {
        let options = ScannerOptions { mount: mount.0, ..Preset::named(name)?.scanner_options() };
        Ok(Self(crate::LaserScanner::new(options)?))
    }

    /// Field of view [rad]: the one given, or the angle between the ends of the field.
    #[getter]
    fn fov(&self) -> f64 {
        self.0.fov()
    }

    /// Number of beams and of ranges in a scan.
    #[getter]
    fn beam_count(&self) -> usize {
        self.0.options().beam_count
    }

    /// Smallest valid range [m].
    #[getter]
    fn min_range(&self) -> f64 {
        self.0.options().min_range
    }

    /// Range of a beam that hits nothing [m].
    #[getter]
    fn max_range(&self) -> f64 {
        self.0.options().max_range
    }

    /// Pose of the scanner in the robot's frame, seen from above.
    #[getter]
    fn mount(&self) -> Pose {
        Pose(self.0.options().mount.planar())
    }

    /// Pose (x, y, z, roll, pitch, yaw) of the scanner in the robot's frame, in space [m, m, m, rad, rad, rad].
    #[getter]
    fn mount_in_space(&self) -> (f64, f64, f64, f64, f64, f64) {
        self.0.options().mount.to_array().into()
    }

    /// Rotation of the scanner in the robot's frame, as a unit quaternion (x, y, z, w).
    #[getter]
    fn mount_quaternion(&self) -> (f64, f64, f64, f64) {
        self.0.options().mount.to_quaternion().into()
    }

    /// Angle of the first beam in the scanner's frame [rad].
    #[getter]
    fn angle_min(&self) -> f64 {
        self.0.angle_min()
    }

    /// Angle of the last beam in the scanner's frame [rad].
    #[getter]
    fn angle_max(&self) -> f64 {
        self.0.angle_max()
    }

    /// Angle from one beam to the next [rad]: negative if they turn clockwise.
    #[getter]
    fn angle_increment(&self) -> f64 {
        self.0.angle_increment()
    }

    /// Angles of the beams in the scanner's frame, (beam_count,) float64 [rad].
    #[getter]
    fn angles<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let angles = (0..self.beam_count()).map(|beam| self.0.angle(beam));
        Ok(vector(py, memory::collected("the angles", angles)?))
    }

    /// Returns the true ranges of one scan, without noise.
    ///
    /// Ranges are exact: the grid traversal follows Amanatides & Woo (1987), section 2.
    ///
    /// Args:
    ///     grid: Map to scan.
    ///     pose: Pose (x, y, yaw) of the robot in the map frame [m, m, rad]. It may lie outside the grid.
    ///     obstacles: Pairs (Shape, pose) that beams also hit, with poses in the map frame.
    ///
    /// Returns:
    ///     (beam_count,) float32 [m], the distance at which each beam enters the first blocking cell or obstacle. A beam
    ///         that starts inside one has range 0. A beam that hits nothing within `max_range` has exactly `max_range`.
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
    ///     >>> mrs.LaserScanner(beam_count=1).scan(grid, (0.5, 0.5, 0.0))
    ///     array([1.5], dtype=float32)
    #[pyo3(
        text_signature = "($self, grid, pose, *, obstacles=())",
        signature = (grid, pose, *, obstacles = ObstaclesArgument::none())
    )]
    fn scan<'py>(
        &self,
        py: Python<'py>,
        grid: GridArgument<'py>,
        pose: PoseArgument,
        obstacles: ObstaclesArgument,
    ) -> PyResult<Bound<'py, PyAny>> {
        let grid = grid.get().core();
        fill(py, None, &[self.beam_count()], |ranges| self.0.scan(obstacles.on(&grid), pose.0, ranges))
    }

    /// Returns one scan from each pose of a batch, with or without noise.
    ///
    /// True ranges are those of `scan`. Scan i draws its noise from the random stream (seed, first_index + i), so a long
    /// batch may be split into chunks: the readings are the same bytes for any split, number of threads and machine.
    ///
    /// With `scan_duration`, the scans take time, as those of a head that turns. Beam j is then taken
    /// `j * time_increment(scan_duration)` seconds after beam 0, from where its robot is at that time, past obstacles where
    /// they are at that time: the range of `scan` from there, to the last bit.
    ///
    /// Args:
    ///     grid: Map to scan.
    ///     poses: (N, 3), one row (x, y, yaw) per scan: the robot in the map frame [m, m, rad], at the time of beam 0. Poses
    ///         may lie outside the grid. Anything that NumPy can convert to float64 without loss, such as a list of poses.
    ///         Or (N, beam_count, 3): the robot at the time of each beam.
    ///     twists: (N, 3), one row (vx, vy, wz) per scan: the constant velocity in the robot's frame at which it moves while
    ///         the scan is taken [m/s, m/s, rad/s]. None means that robots stand.
    ///     scan_duration: Time in which the head turns through the field of the beams [s]. None means that all beams are taken
    ///         in one instant.
    ///     obstacles: Pairs (Shape, pose) that the beams of all scans also hit, with poses in the map frame. An obstacle may
    ///         move during each scan: (Shape, pose, twist) from its pose at the time of beam 0 on, or (Shape, poses) with a
    ///         (beam_count, 3) array of its poses at the time of each beam.
    ///     noise: Beam model to draw the readings from. None means no noise.
    ///     surfaces: How what a beam meets changes the noise of its reading, such as by the angle of incidence. None means not at
    ///         all. It needs `noise`, and a scanner that is not tilted.
    ///     seed: Seed of the noise, 0 to 2**64 - 1, or a `RandomStream`, which counts the scans of all calls. Noise needs one.
    ///     first_index: Index of the first scan in the random stream, 0 to 2**64 - 1. None means 0, or that of the
    ///         `RandomStream`.
    ///     threads: Number of threads, 1 to 1024; None means one per core. The result does not depend on it.
    ///     out: (N, beam_count) float32 in C order, an array for the result. None means a new array.
    ///
    /// Returns:
    ///     (N, beam_count) float32 [m], which is `out` if it was given. Row i is the scan from `poses[i]`, column j the beam
    ///         at `angle_min + j * angle_increment`. Exactly `max_range` means no return.
    ///
    /// Raises:
    ///     ValueError: A shape is wrong, a number is not finite, an integer is out of range, `scan_duration` is negative or
    ///         missing where something moves, noise has no seed, surfaces have no noise or a tilted scanner, or `out` is read-only, in use or not in C order.
    ///     TypeError: An argument has the wrong type or dtype.
    ///     OSError: The threads could not be started.
    ///
    /// Examples:
    ///     The only wall covers x from 2 m to 3 m:
    ///
    ///     >>> import numpy as np
    ///     >>> import mobile_robot_simulator as mrs
    ///     >>> grid = mrs.OccupancyGrid(np.array([[0, 0, 100]], np.int8), resolution=1.0)
    ///     >>> poses = np.array([[0.5, 0.5, 0.0], [1.5, 0.5, 0.0]])
    ///     >>> mrs.LaserScanner(beam_count=1).scan_batch(grid, poses)
    ///     array([[1.5],
    ///            [0.5]], dtype=float32)
    ///
    ///     Three beams, nearly all ahead, of a robot that drives towards the wall at 1 m/s:
    ///
    ///     >>> ahead = mrs.LaserScanner(fov=1e-9, beam_count=3)
    ///     >>> ahead.scan_batch(grid, poses[:1], twists=[(1.0, 0.0, 0.0)], scan_duration=0.5)
    ///     array([[1.5 , 1.25, 1.  ]], dtype=float32)
    #[pyo3(
        text_signature = "($self, grid, poses, *, twists=None, scan_duration=None, obstacles=(), noise=None, \
                          surfaces=None, seed=None, first_index=None, threads=None, out=None)",
        signature = (
            grid,
            poses,
            *,
            twists = None,
            scan_duration = None,
            obstacles = MovingObstaclesArgument::none(),
            noise = None,
            surfaces = None,
            seed = None,
            first_index = None,
            threads = None,
            out = None,
        )
    )]
    #[allow(clippy::too_many_arguments, reason = "they are keyword arguments in Python")]
    fn scan_batch<'py>(
        &self,
        py: Python<'py>,
        grid: GridArgument<'py>,
        poses: &Bound<'py, PyAny>,
        twists: Option<&Bound<'py, PyAny>>,
        scan_duration: Option<Argument<f64>>,
        obstacles: MovingObstaclesArgument<'py>,
        noise: Option<NoiseArgument>,
        surfaces: Option<SurfacesArgument>,
        seed: Option<&Bound<'py, PyAny>>,
        first_index: Option<&Bound<'py, PyAny>>,
        threads: Option<&Bound<'py, PyAny>>,
        out: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let (grid, threads) = (grid.get().core(), thread_count(threads)?);
        let sweep = SweepArguments::new(self.beam_count(), poses, twists, scan_duration, out.as_ref())?;
        let seed = SeedArgument::new(seed, "first_index", first_index)?;
        if noise.is_some() && seed.is_none() {
            return Err(PyValueError::new_err(
                "noise needs a seed: give seed=RandomStream(7), which counts the scans of all calls, or seed=7 with \
                 first_index= the number of scans before, because calls with the same seed and index draw the same noise",
            ));
        }
        if surfaces.is_some() && noise.is_none() {
            return Err(PyValueError::new_err("surfaces need noise, a BeamModel, got None"));
        }
        let size = [sweep.scans, self.beam_count()];
        check_out::<f32>(out.as_ref(), &size)?;
        let surface = surfaces.map(|model| model.0);
        let noise = noise
            .map(|model| {
                seed.take(sweep.scans).map(|(seed, first_index)| Noise { model: model.0, surface, seed, first_index })
            })
            .transpose()?;
        if let Some(poses) = sweep.instant() {
            let obstacles = obstacles.standing()?;
            return fill(py, out, &size, |readings| self.0.scan_batch(obstacles.on(&grid), poses, noise, threads, readings));
        }
        let obstacles = sweep.obstacles(&obstacles)?;
        let sweeps = sweep.sweeps(&obstacles);
        fill(py, out, &size, |readings| self.0.sweep_batch(&grid, sweeps, noise, threads, readings))
    }

    /// Returns how much light comes back to each beam, without noise.
    ///
    /// The intensity is `reflectivity * cos(incidence) / range**2` of the surface at which the range ends, times the share of the
    /// light that mirrors and glass leave on the way there and back. So a white wall at a right angle and a distance of 1 m has 1.
    /// The normal of a cell is that of the side through which the beam enters it.
    ///
    /// Args:
    ///     grid: Map to scan.
    ///     poses: As in `scan_batch`.
    ///     twists: As in `scan_batch`.
    ///     scan_duration: As in `scan_batch`.
    ///     obstacles: As in `scan_batch`.
    ///     seed: The seed of the noise, which also says which panes of glass return a beam. None means that beams take the
    ///         likelier way, as in scans without noise.
    ///     first_index: The index of the first scan in the random stream, as in `scan_batch`.
    ///     threads: Number of threads, 1 to 1024; None means one per core. The result does not depend on it.
    ///     out: (N, beam_count) float32 in C order, an array for the result. None means a new array.
    ///
    /// Returns:
    ///     (N, beam_count) float32, which is `out` if it was given; 0 for a beam without a return, or inside something.
    ///
    /// Raises:
    ///     ValueError: The scanner is tilted, or as in `scan_batch`.
    ///     TypeError: An argument has the wrong type or dtype.
    ///
    /// Examples:
    ///     A wall at a distance of 2 m, at a right angle:
    ///
    ///     >>> import numpy as np
    ///     >>> import mobile_robot_simulator as mrs
    ///     >>> grid = mrs.OccupancyGrid(np.array([[0, 0, 0, 100]], np.int8), resolution=1.0)
    ///     >>> mrs.LaserScanner(beam_count=1).intensities(grid, [(1.0, 0.5, 0.0)])
    ///     array([[0.25]], dtype=float32)
    #[pyo3(
        text_signature = "($self, grid, poses, *, twists=None, scan_duration=None, obstacles=(), seed=None, first_index=None, \
                          threads=None, out=None)",
        signature = (
            grid,
            poses,
            *,
            twists = None,
            scan_duration = None,
            obstacles = MovingObstaclesArgument::none(),
            seed = None,
            first_index = None,
            threads = None,
            out = None,
        )
    )]
    #[allow(clippy::too_many_arguments, reason = "they are keyword arguments in Python")]
    fn intensities<'py>(
        &self,
        py: Python<'py>,
        grid: GridArgument<'py>,
        poses: &Bound<'py, PyAny>,
        twists: Option<&Bound<'py, PyAny>>,
        scan_duration: Option<Argument<f64>>,
        obstacles: MovingObstaclesArgument<'py>,
        seed: Option<&Bound<'py, PyAny>>,
        first_index: Option<&Bound<'py, PyAny>>,
        threads: Option<&Bound<'py, PyAny>>,
        out: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let (grid, threads) = (grid.get().core(), thread_count(threads)?);
        let sweep = SweepArguments::new(self.beam_count(), poses, twists, scan_duration, out.as_ref())?;
        let stream = SeedArgument::new(seed, "first_index", first_index)?;
        let size = [sweep.scans, self.beam_count()];
        check_out::<f32>(out.as_ref(), &size)?;
        let stream = seed.map(|_| stream.take(sweep.scans)).transpose()?;
        if let Some(poses) = sweep.instant() {
            let obstacles = obstacles.standing()?;
            return fill(py, out, &size, |intensities| {
                self.0.intensities(obstacles.on(&grid), poses, stream, threads, intensities)
            });
        }
        let obstacles = sweep.obstacles(&obstacles)?;
        let sweeps = sweep.sweeps(&obstacles);
        fill(py, out, &size, |intensities| self.0.intensities_of_sweeps(&grid, sweeps, stream, threads, intensities))
    }

    /// Returns the log-likelihood of a scan, given each pose from which it may have been taken.
    ///
    /// With a `BeamModel`, it is `temper * sum(log(noise.likelihood(ranges, true_ranges, max_range, min_range=min_range)))`, with
    /// the true ranges of `scan` from each pose, to within 1e-9 for each beam. No array of true ranges is made. Readings may have
    /// the marks of `mark_invalid`.
    ///
    /// The beam model takes the errors of all beams as independent. They are not: what the map or the pose gets wrong, many
    /// beams get wrong in the same way. So the likelihood of all beams is far too sure. Two things help: few `beams`, and a
    /// `temper` below 1, such as 10 divided by the number of beams, which makes the scan count like ten independent beams.
    ///
    /// Args:
    ///     grid: Map.
    ///     poses: (N, 3), one row (x, y, yaw) per pose of the robot in the map frame [m, m, rad]; at the time of beam 0 if the
    ///         scan takes time. Anything that NumPy can convert to float64 without loss.
    ///     ranges: (beam_count,) float32, the readings of one scan [m]; or (N, beam_count), a scan for each pose. NaN does not
    ///         count.
    ///     noise: Beam model of the readings; or a `LikelihoodField`, which casts no beams, and takes no obstacles and no
    ///         `scan_duration`.
    ///     beams: Beams that count: a number k for every k-th beam from beam 0 on, or a sequence of their numbers. None means
    ///         all.
    ///     temper: Factor of the log-likelihood, above 0.
    ///     twists: (N, 3), the velocity (vx, vy, wz) of the robot while the scan is taken [m/s, m/s, rad/s], as for `scan_batch`.
    ///     scan_duration: Time in which the head turns through the field of the beams [s]. None means that all beams are taken
    ///         in one instant.
    ///     obstacles: Obstacles, as for `scan_batch`.
    ///     threads: Number of threads, 1 to 1024; None means one per core. The result does not depend on it.
    ///     out: (N,) float64, an array for the result. None means a new array.
    ///
    /// Returns:
    ///     (N,) float64, which is `out` if it was given. -inf if a reading is impossible from a pose.
    ///
    /// Raises:
    ///     ValueError: A shape is wrong, a number is not finite, a beam does not exist, `temper` is not positive, or a
    ///         `LikelihoodField` was given obstacles, `scan_duration` or a `max_distance` of more than 255 cells.
    ///     TypeError: An argument has the wrong type or dtype.
    ///     OSError: The threads could not be started.
    ///
    /// Examples:
    ///     Which of 10,000 poses is right?
    ///
    ///     >>> import mobile_robot_simulator as mrs
    ///     >>> grid, laser = mrs.floor_plan("office", seed=1), mrs.LaserScanner(beam_count=61)
    ///     >>> noise = mrs.BeamModel(sigma_hit=0.05, z_hit=0.9, z_rand=0.1)
    ///     >>> poses = grid.draw_free_poses(10_000, radius=0.3, seed=1)
    ///     >>> scan = laser.scan_batch(grid, poses[7:8], noise=noise, seed=1)[0]
    ///     >>> laser.log_likelihood(grid, poses, scan, noise=noise).argmax()
    ///     np.int64(7)
    #[pyo3(
        text_signature = "($self, grid, poses, ranges, *, noise, beams=None, temper=1.0, twists=None, scan_duration=None, \
                          obstacles=(), threads=None, out=None)",
        signature = (
            grid,
            poses,
            ranges,
            *,
            noise,
            beams = None,
            temper = 1.0.into(),
            twists = None,
            scan_duration = None,
            obstacles = MovingObstaclesArgument::none(),
            threads = None,
            out = None,
        )
    )]
    #[allow(clippy::too_many_arguments, reason = "they are keyword arguments in Python")]
    fn log_likelihood<'py>(
        &self,
        py: Python<'py>,
        grid: GridArgument<'py>,
        poses: &Bound<'py, PyAny>,
        ranges: &Bound<'py, PyAny>,
        noise: ModelArgument,
        beams: Option<&Bound<'py, PyAny>>,
        temper: Argument<f64>,
        twists: Option<&Bound<'py, PyAny>>,
        scan_duration: Option<Argument<f64>>,
        obstacles: MovingObstaclesArgument<'py>,
        threads: Option<&Bound<'py, PyAny>>,
        out: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let (grid, threads, temper) = (grid.get().core(), thread_count(threads)?, temper.named("temper")?);
        let sweep = SweepArguments::new(self.beam_count(), poses, twists, scan_duration, out.as_ref())?;
        let beams = beams.map(|numbers| chosen_beams(self.beam_count(), numbers)).transpose()?;
        let readings = typed::<f32>("ranges", ranges)?;
        let readings = readings.as_array();
        let is_one = match *readings.shape() {
            [beams] if beams == self.beam_count() => true,
            [scans, beams] if beams == self.beam_count() && scans == sweep.scans => false,
            ref other => {
                let (scans, beams, got) = (sweep.scans, self.beam_count(), shape(other));
                let text =
                    format!("ranges must have shape ({beams},), or ({scans}, {beams}) with a scan for each pose, got {got}");
                return Err(PyValueError::new_err(text));
            }
        };
        let readings = memory::collected("the readings", readings.iter().copied())?;
        let readings = if is_one { Readings::One(&readings) } else { Readings::Each(&readings) };
        let (beams, scans) = (beams.as_deref(), sweep.scans);
        let model = match &noise {
            ModelArgument::Beams(model) => model,
            ModelArgument::Field(model) => {
                let Some(poses) = sweep.instant().filter(|_| obstacles.is_empty()) else {
                    let text = "a LikelihoodField needs scans without obstacles and without scan_duration";
                    return Err(PyValueError::new_err(text));
                };
                let score = Score { model, readings, beams, temper };
                return fill(py, out, &[scans], |scores| {
                    model.log_likelihoods(&self.0, &grid, poses, score, threads, scores)
                });
            }
        };
        let score = Score { model, readings, beams, temper };
        if let Some(poses) = sweep.instant() {
            let obstacles = obstacles.standing()?;
            return fill(py, out, &[scans], |scores| {
                self.0.log_likelihoods(obstacles.on(&grid), poses, score, threads, scores)
            });
        }
        let obstacles = sweep.obstacles(&obstacles)?;
        let sweeps = sweep.sweeps(&obstacles);
        fill(py, out, &[scans], |scores| self.0.log_likelihoods_of_sweeps(&grid, sweeps, score, threads, scores))
    }

    /// Returns the time from one beam to the next of a scan that takes time [s]; 0 with a single beam.
    ///
    /// It is the `time_increment` of a `LaserScan` message.
    ///
    /// Args:
    ///     scan_duration: Time in which the head turns through the field of the beams [s]. A head that turns at a rate f
    ///         takes `fov / (2 * pi * f)`. In a full turn, the last beam is taken one time increment before its end.
    ///
    /// Raises:
    ///     ValueError: `scan_duration` is negative or not finite.
    ///
    /// Examples:
    ///     >>> import mobile_robot_simulator as mrs
    ///     >>> mrs.LaserScanner(fov=3.0, beam_count=101).time_increment(0.05)
    ///     0.0005
    fn time_increment(&self, scan_duration: Argument<f64>) -> PyResult<f64> {
        let scan_duration = scan_duration.named("scan_duration")?;
        crate::error::check_number("scan_duration", scan_duration, "at least 0", |value| value >= 0.0)?;
        Ok(self.0.time_increment(scan_duration))
    }

    /// Returns where each robot of a batch is at the time of each beam of its scan.
    ///
    /// These are the poses from which `scan_batch` takes the beams of a scan that takes time: those of `Pose.integrate`. Who
    /// knows them can undo the distortion of the scan.
    ///
    /// Args:
    ///     poses: (N, 3), one row (x, y, yaw) per robot at the time of beam 0, in any frame [m, m, rad].
    ///     twists: (N, 3), one row (vx, vy, wz) per robot: its constant velocity in its own frame [m/s, m/s, rad/s].
    ///     scan_duration: Time in which the head turns through the field of the beams [s].
    ///
    /// Returns:
    ///     (N, beam_count, 3) float64, rows (x, y, yaw) in the frame of `poses` [m, m, rad]. Yaws are not wrapped.
    ///
    /// Raises:
    ///     ValueError: A shape is wrong, a number is not finite, or `scan_duration` is negative.
    ///     TypeError: An array cannot be converted to float64 without loss.
    ///
    /// Examples:
    ///     >>> import mobile_robot_simulator as mrs
    ///     >>> laser = mrs.LaserScanner(fov=1.0, beam_count=3)
    ///     >>> laser.beam_poses([(0.0, 0.0, 0.0)], [(1.0, 0.0, 0.0)], 0.5)
    ///     array([[[0.  , 0.  , 0.  ],
    ///             [0.25, 0.  , 0.  ],
    ///             [0.5 , 0.  , 0.  ]]])
    fn beam_poses<'py>(
        &self,
        py: Python<'py>,
        poses: &Bound<'py, PyAny>,
        twists: &Bound<'py, PyAny>,
        scan_duration: Argument<f64>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let scan_duration = scan_duration.named("scan_duration")?;
        let (poses, twists) = (rows("poses", poses, None)?, rows("twists", twists, None)?);
        let courses = Courses::Arcs { poses: &poses, twists: &twists };
        fill(py, None, &[poses.len(), self.beam_count(), 3], |numbers: &mut [f64]| {
            self.0.beam_poses(courses, scan_duration, numbers.as_chunks_mut().0)
        })
    }

    /// Returns what each beam of a batch of scans meets, and at which angle.
    ///
    /// It is the surface whose distance is the range of `scan_batch` without noise. The normal of a blocking cell is that of the
    /// side through which the beam enters it, so a slanting wall has the normals of its steps. A beam takes some hundred
    /// nanoseconds, longer than a range.
    ///
    /// Args:
    ///     grid: Map.
    ///     poses: (N, 3), one row (x, y, yaw) per scan: the robot in the map frame [m, m, rad]. Or (N, beam_count, 3): the robot at
    ///         the time of each beam, such as `beam_poses` returns.
    ///     obstacles: Pairs (Shape, pose) that the beams also hit, with poses in the map frame.
    ///     threads: Number of threads, 1 to 1024; None means one per core. The result does not depend on it.
    ///
    /// Returns:
    ///     Two arrays (N, beam_count): the surfaces, int32, which are -1 without a return, 0 for a wall and k + 1 for obstacle k;
    ///         and the angles between the beams and the normals of the surfaces, float32, 0 to π/2 [rad], NaN if there is no
    ///         surface or the laser is inside of it.
    ///
    /// Raises:
    ///     ValueError: The scanner is tilted, a shape is wrong, a pose is not finite, or `threads` is out of range.
    ///     TypeError: An argument has the wrong type or dtype.
    ///     OSError: The threads could not be started.
    ///
    /// Examples:
    ///     The only wall covers x from 2 m to 3 m:
    ///
    ///     >>> import numpy as np
    ///     >>> import mobile_robot_simulator as mrs
    ///     >>> grid = mrs.OccupancyGrid(np.array([[0, 0, 100]], np.int8), resolution=1.0)
    ///     >>> mrs.LaserScanner(beam_count=1).hits(grid, [(0.5, 0.5, 0.25), (0.5, 0.5, 3.0)])
    ///     (array([[ 0],
    ///            [-1]], dtype=int32), array([[0.25],
    ///            [ nan]], dtype=float32))
    #[pyo3(
        text_signature = "($self, grid, poses, *, obstacles=(), threads=None)",
        signature = (grid, poses, *, obstacles = ObstaclesArgument::none(), threads = None)
    )]
    fn hits<'py>(
        &self,
        py: Python<'py>,
        grid: GridArgument<'py>,
        poses: &Bound<'py, PyAny>,
        obstacles: ObstaclesArgument,
        threads: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
        let (grid, threads, beams) = (grid.get().core(), thread_count(threads)?, self.beam_count());
        let (poses, has_beams) = rows_or_beam_rows("poses", poses, beams, None)?;
        let scans = if has_beams { poses.len() / beams } else { poses.len() };
        let mut hits = memory::filled("the hits", Hit::default(), scans * beams)?;
        let rows: &[[f64; 3]] = &poses;
        py.detach(|| self.0.hits(obstacles.on(&grid), rows, threads, &mut hits))?;
        let surfaces = fill(py, None, &[scans, beams], |surfaces| {
            surfaces.iter_mut().zip(&hits).for_each(|(surface, hit): (&mut i32, _)| *surface = hit.surface);
            Ok(())
        })?;
        let incidences = fill(py, None, &[scans, beams], |incidences| {
            incidences.iter_mut().zip(&hits).for_each(|(incidence, hit): (&mut f32, _)| *incidence = hit.incidence);
            Ok(())
        })?;
        Ok((surfaces, incidences))
    }

    /// Returns a copy of readings in which invalid ones are marked as in a `LaserScan` message (REP-117).
    ///
    /// Readings below `min_range` become -inf. Readings of `max_range` and above are beams without a return; `no_return` says
    /// what they become. NaN stays NaN.
    ///
    /// Args:
    ///     readings: float32 of any shape [m].
    ///     no_return: Mark of a beam without a return: "inf" for +inf, "max" for `max_range`, or "below_max" for 0.1 m less
    ///         than `max_range` (but at least `min_range`).
    ///
    /// Returns:
    ///     float32 of the same shape [m], a new array.
    ///
    /// Raises:
    ///     ValueError: `no_return` is none of these.
    ///     TypeError: The array is not float32.
    ///
    /// Examples:
    ///     >>> import numpy as np
    ///     >>> import mobile_robot_simulator as mrs
    ///     >>> laser = mrs.LaserScanner(min_range=0.05, max_range=30.0)
    ///     >>> laser.mark_invalid(np.array([0.01, 2.0, 30.0], np.float32)).tolist()
    ///     [-inf, 2.0, inf]
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
            "below_max" => NoReturn::BelowMax,
            other => {
                let message = format!("no_return must be 'inf', 'max' or 'below_max', got '{other}'");
                return Err(PyValueError::new_err(message));
            }
        };
        let readings = typed::<f32>("readings", readings)?;
        let readings = readings.as_array();
        fill(py, None, readings.shape(), |marked| {
            match readings.as_slice() {
                Some(readings) => marked.copy_from_slice(readings),
                None => marked.iter_mut().zip(&readings).for_each(|(marked, reading)| *marked = *reading),
            }
            self.0.mark_invalid(marked, no_return);
            Ok(())
        })
    }

    /// Returns readings rounded to multiples of a power of two, so that they compress well.
    ///
    /// The readings become multiples of the largest power of two that is at most `step`, which float32 holds exactly: with a step
    /// of 0.001, multiples of 1/1024 m. So a reading changes by at most half of `step`. Readings of `max_range` and above,
    /// infinities and NaN stay as they are. A reading below `max_range` stays below it: where its nearest multiple would not, it
    /// becomes the largest multiple that is, and changes by less than `step`.
    ///
    /// Args:
    ///     readings: float32 of any shape [m].
    ///     step: Largest step between two readings [m], 1e-6 to 1.
    ///     out: Array to write the result to, float32 of the same shape, C-contiguous. It may be `readings` itself.
    ///
    /// Returns:
    ///     float32 of the same shape [m]: `out`, or a new array.
    ///
    /// Raises:
    ///     ValueError: `step` is out of range, or `out` has the wrong shape or order, is read-only, or shares memory with
    ///         `readings` without being the same array.
    ///     TypeError: The array or `out` is not float32.
    ///
    /// Examples:
    ///     >>> import numpy as np
    ///     >>> import mobile_robot_simulator as mrs
    ///     >>> laser = mrs.LaserScanner(max_range=8.1)
    ///     >>> laser.quantize(np.array([1.1, 8.05, 8.1], np.float32), 0.3).tolist()
    ///     [1.0, 8.0, 8.100000381469727]
    #[pyo3(signature = (readings, step, *, out = None))]
    fn quantize<'py>(
        &self,
        py: Python<'py>,
        readings: &Bound<'py, PyAny>,
        step: Argument<f64>,
        out: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let step = step.named("step")?;
        let given = typed::<f32>("readings", readings)?;
        if out.as_ref().is_some_and(|out| out.is(readings)) {
            let dimensions = given.as_array().shape().to_vec();
            drop(given);
            return fill(py, out, &dimensions, |rounded| self.0.quantize(rounded, step).map(drop));
        }
        let readings = given.as_array();
        fill(py, out, readings.shape(), |rounded| {
            rounded.iter_mut().zip(&readings).for_each(|(rounded, reading)| *rounded = *reading);
            self.0.quantize(rounded, step).map(drop)
        })
    }

    /// Returns the points in the map frame, seen from above, where the valid beams of one scan ended.
    ///
    /// A reading is valid if it is at least `min_range` and below `max_range`.
    ///
    /// Args:
    ///     pose: Pose (x, y, yaw) of the robot in the map frame [m, m, rad].
    ///     readings: (beam_count,) float32 [m], with or without the marks of `mark_invalid`. The mark "below_max" counts as a
    ///         return.
    ///
    /// Returns:
    ///     (M, 2) float64, one row (x, y) per valid reading [m], in the order of the beams.
    ///
    /// Raises:
    ///     ValueError: There is not exactly one reading per beam, or the pose is not finite.
    ///     TypeError: The array is not float32.
    ///
    /// Examples:
    ///     >>> import numpy as np
    ///     >>> import mobile_robot_simulator as mrs
    ///     >>> mrs.LaserScanner(beam_count=1).end_points((1.0, 2.0, 0.0), np.array([3.0], np.float32))
    ///     array([[4., 2.]])
    fn end_points<'py>(
        &self,
        py: Python<'py>,
        pose: PoseArgument,
        readings: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let readings = typed::<f32>("readings", readings)?;
        let readings = memory::collected("the readings", readings.as_array().iter().copied())?;
        Ok(Array2::from(self.0.end_points(pose.0, &readings)?).into_pyarray(py))
    }

    fn __repr__(&self) -> String {
        text(&self.0.options())
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Recipe<'py>> {
        recipe::<Self>(py, PyTuple::empty(py), keywords(py, &self.0.options())?)
    }
}
