//! The Python class `FleetStep`.

use numpy::PyReadwriteArrayDyn;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use crate::python::arrays::{check_array, length, writable, zeros};
use crate::python::{Recipe, recipe};
use crate::{Report, Thing};

/// What `Fleet.step` returns: one row for each robot. Pass it as `out=` to a later step to use its arrays again.
///
/// `Fleet.step` makes one. With arrays of your own, for example in shared memory, a step writes its results there.
///
/// Args:
///     poses: (N, 3) float64 in C order.
///     velocities: (N, 3) float64 in C order.
///     contacts: (N,) bool.
///     contact_points: (N, 2) float64 in C order.
///     contact_obstacles: (N,) int64.
///     contact_robots: (N,) int64.
///     odometry: (N, 3) float64 in C order.
///     ranges: (N, beam_count) float32 in C order; None for steps without scans.
///     clearances: (N,) float64; None for a fleet without `clearance_limit`.
///
/// Raises:
///     ValueError: An array has another shape, or is not in C order.
///     TypeError: An argument is no array, or has another dtype.
///
/// Examples:
///     >>> import numpy as np
///     >>> import mobile_robot_simulator as mrs
///     >>> grid = mrs.OccupancyGrid(np.zeros((9, 9), np.int8), resolution=1.0)
///     >>> fleet, commands = mrs.Fleet(grid, [(1.0, 1.0, 0.0)]), [(0.5, 0.0, 0.0)]
///     >>> step = fleet.step(commands, 1.0)
///     >>> fleet.step(commands, 1.0, out=step) is step
///     True
///     >>> step.poses
///     array([[2., 1., 0.]])
#[pyclass(frozen, module = "mobile_robot_simulator")]
pub struct FleetStep {
    poses: Py<PyAny>,
    velocities: Py<PyAny>,
    contacts: Py<PyAny>,
    contact_points: Py<PyAny>,
    contact_obstacles: Py<PyAny>,
    contact_robots: Py<PyAny>,
    odometry: Py<PyAny>,
    ranges: Option<Py<PyAny>>,
    clearances: Option<Py<PyAny>>,
}

#[pymethods]
impl FleetStep {
    #[new]
    #[pyo3(signature = (
        *,
        poses,
        velocities,
        contacts,
        contact_points,
        contact_obstacles,
        contact_robots,
        odometry,
        ranges = None,
        clearances = None,
    ))]
    #[allow(clippy::too_many_arguments, reason = "they are keyword arguments in Python")]
    fn of_arrays(
        poses: &Bound<'_, PyAny>,
        velocities: &Bound<'_, PyAny>,
        contacts: &Bound<'_, PyAny>,
        contact_points: &Bound<'_, PyAny>,
        contact_obstacles: &Bound<'_, PyAny>,
        contact_robots: &Bound<'_, PyAny>,
        odometry: &Bound<'_, PyAny>,
        ranges: Option<&Bound<'_, PyAny>>,
        clearances: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let count = length(poses, 0);
        check_array::<f64>("poses", poses, &[count, 3])?;
        check_array::<f64>("velocities", velocities, &[count, 3])?;
        check_array::<bool>("contacts", contacts, &[count])?;
        check_array::<f64>("contact_points", contact_points, &[count, 2])?;
        check_array::<i64>("contact_obstacles", contact_obstacles, &[count])?;
        check_array::<i64>("contact_robots", contact_robots, &[count])?;
        check_array::<f64>("odometry", odometry, &[count, 3])?;
        if let Some(ranges) = ranges {
            check_array::<f32>("ranges", ranges, &[count, length(ranges, 1)])?;
        }
        if let Some(clearances) = clearances {
            check_array::<f64>("clearances", clearances, &[count])?;
        }
        let own = |array: &Bound<'_, PyAny>| array.clone().unbind();
        Ok(Self {
            poses: own(poses),
            velocities: own(velocities),
            contacts: own(contacts),
            contact_points: own(contact_points),
            contact_obstacles: own(contact_obstacles),
            contact_robots: own(contact_robots),
            odometry: own(odometry),
            ranges: ranges.map(own),
            clearances: clearances.map(own),
        })
    }

    /// Pose of each robot: (N, 3) float64, rows (x, y, yaw) in the map frame [m, m, rad], with yaws in (-π, π].
    #[getter]
    fn poses(&self, py: Python<'_>) -> Py<PyAny> {
        self.poses.clone_ref(py)
    }

    /// Velocity of each robot: (N, 3) float64, rows (vx, vy, wz) in its own frame [m/s, m/s, rad/s].
    #[getter]
    fn velocities(&self, py: Python<'_>) -> Py<PyAny> {
        self.velocities.clone_ref(py)
    }

    /// Whether each robot touched something during the step: (N,) bool.
    #[getter]
    fn contacts(&self, py: Python<'_>) -> Py<PyAny> {
        self.contacts.clone_ref(py)
    }

    /// Points that the robots touched first in the step: (N, 2) float64, rows (x, y) in the map frame [m]; NaN for none.
    #[getter]
    fn contact_points(&self, py: Python<'_>) -> Py<PyAny> {
        self.contact_points.clone_ref(py)
    }

    /// Index of the obstacle that each robot touched first in the step: (N,) int64, -1 for none.
    #[getter]
    fn contact_obstacles(&self, py: Python<'_>) -> Py<PyAny> {
        self.contact_obstacles.clone_ref(py)
    }

    /// Index of the other robot that each robot touched first in the step: (N,) int64, -1 for none.
    ///
    /// A contact with neither an obstacle nor a robot is one with a wall.
    #[getter]
    fn contact_robots(&self, py: Python<'_>) -> Py<PyAny> {
        self.contact_robots.clone_ref(py)
    }

    /// Pose that the odometry of each robot reports after the step: (N, 3) float64, rows (x, y, yaw) [m, m, rad].
    ///
    /// It is in the robot's odometry frame, which is that of its first pose. Without noise and slip, it is where the robot is.
    #[getter]
    fn odometry(&self, py: Python<'_>) -> Py<PyAny> {
        self.odometry.clone_ref(py)
    }

    /// Distance of each footprint to the nearest wall, obstacle or robot after the step: (N,) float64 [m].
    ///
    /// It is `clearance_limit` of the fleet if there is nothing nearer. None without that limit, or without a footprint.
    #[getter]
    fn clearances(&self, py: Python<'_>) -> Option<Py<PyAny>> {
        self.clearances.as_ref().map(|clearances| clearances.clone_ref(py))
    }

    /// Scan of each robot after the step: (N, beam_count) float32 [m]; None without a scanner or with `scan=False`.
    #[getter]
    fn ranges(&self, py: Python<'_>) -> Option<Py<PyAny>> {
        self.ranges.as_ref().map(|ranges| ranges.clone_ref(py))
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Recipe<'py>> {
        let keywords = PyDict::new(py);
        keywords.set_item("poses", &self.poses)?;
        keywords.set_item("velocities", &self.velocities)?;
        keywords.set_item("contacts", &self.contacts)?;
        keywords.set_item("contact_points", &self.contact_points)?;
        keywords.set_item("contact_obstacles", &self.contact_obstacles)?;
        keywords.set_item("contact_robots", &self.contact_robots)?;
        keywords.set_item("odometry", &self.odometry)?;
        keywords.set_item("ranges", &self.ranges)?;
        keywords.set_item("clearances", &self.clearances)?;
        recipe::<Self>(py, PyTuple::empty(py), keywords)
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let ranges = match &self.ranges {
            Some(ranges) => format!(", ranges of shape {}", ranges.getattr(py, "shape")?),
            None => String::new(),
        };
        Ok(format!("FleetStep({} robots{ranges})", self.poses.bind(py).len()?))
    }
}

impl FleetStep {
    /// Returns a step with new arrays.
    pub fn new(py: Python<'_>, count: usize, beam_count: Option<usize>, has_clearances: bool) -> PyResult<Self> {
        Ok(Self {
            poses: zeros::<f64>(py, &[count, 3])?.unbind(),
            velocities: zeros::<f64>(py, &[count, 3])?.unbind(),
            contacts: zeros::<bool>(py, &[count])?.unbind(),
            contact_points: zeros::<f64>(py, &[count, 2])?.unbind(),
            contact_obstacles: zeros::<i64>(py, &[count])?.unbind(),
            contact_robots: zeros::<i64>(py, &[count])?.unbind(),
            odometry: zeros::<f64>(py, &[count, 3])?.unbind(),
            clearances: has_clearances.then(|| zeros::<f64>(py, &[count])).transpose()?.map(Bound::unbind),
            ranges: beam_count.map(|beams| zeros::<f32>(py, &[count, beams])).transpose()?.map(Bound::unbind),
        })
    }

    /// Opens the arrays, for a step with so many robots and beams.
    ///
    /// # Errors
    /// An array is missing, has another shape or cannot be written.
    pub fn open<'py>(
        &self,
        py: Python<'py>,
        count: usize,
        beam_count: Option<usize>,
        has_clearances: bool,
    ) -> PyResult<OpenStep<'py>> {
        let missing = |what| PyValueError::new_err(format!("out must have {what}, got the result of a step without"));
        Ok(OpenStep {
            poses: writable(self.poses.bind(py), &[count, 3])?,
            velocities: writable(self.velocities.bind(py), &[count, 3])?,
            contacts: writable(self.contacts.bind(py), &[count])?,
            points: writable(self.contact_points.bind(py), &[count, 2])?,
            ranges: match (beam_count, &self.ranges) {
                (Some(beams), Some(ranges)) => Some(writable(ranges.bind(py), &[count, beams])?),
                (Some(_), None) => return Err(missing("ranges")),
                (None, _) => None,
            },
            obstacles: writable(self.contact_obstacles.bind(py), &[count])?,
            robots: writable(self.contact_robots.bind(py), &[count])?,
            odometry: writable(self.odometry.bind(py), &[count, 3])?,
            clearances: match (has_clearances, &self.clearances) {
                (true, Some(clearances)) => Some(writable(clearances.bind(py), &[count])?),
                (true, None) => return Err(missing("clearances")),
                (false, _) => None,
            },
        })
    }
}

/// The arrays of a step, open for writing.
pub struct OpenStep<'py> {
    poses: PyReadwriteArrayDyn<'py, f64>,
    velocities: PyReadwriteArrayDyn<'py, f64>,
    contacts: PyReadwriteArrayDyn<'py, bool>,
    points: PyReadwriteArrayDyn<'py, f64>,
    obstacles: PyReadwriteArrayDyn<'py, i64>,
    robots: PyReadwriteArrayDyn<'py, i64>,
    odometry: PyReadwriteArrayDyn<'py, f64>,
    ranges: Option<PyReadwriteArrayDyn<'py, f32>>,
    clearances: Option<PyReadwriteArrayDyn<'py, f64>>,
}

impl OpenStep<'_> {
    /// Returns the elements of the arrays. They can be written without the GIL.
    pub fn rows(&mut self) -> PyResult<StepRows<'_>> {
        Ok(StepRows {
            poses: self.poses.as_slice_mut()?.as_chunks_mut().0,
            velocities: self.velocities.as_slice_mut()?.as_chunks_mut().0,
            contacts: self.contacts.as_slice_mut()?,
            points: self.points.as_slice_mut()?.as_chunks_mut().0,
            obstacles: self.obstacles.as_slice_mut()?,
            robots: self.robots.as_slice_mut()?,
            odometry: self.odometry.as_slice_mut()?.as_chunks_mut().0,
            ranges: self.ranges.as_mut().map(|ranges| ranges.as_slice_mut()).transpose()?,
            clearances: self.clearances.as_mut().map(|clearances| clearances.as_slice_mut()).transpose()?,
        })
    }
}

/// Rows for the robots of a step.
pub struct StepRows<'a> {
    poses: &'a mut [[f64; 3]],
    velocities: &'a mut [[f64; 3]],
    contacts: &'a mut [bool],
    points: &'a mut [[f64; 2]],
    obstacles: &'a mut [i64],
    robots: &'a mut [i64],
    odometry: &'a mut [[f64; 3]],
    /// All ranges, one scan after the other.
    pub ranges: Option<&'a mut [f32]>,
    clearances: Option<&'a mut [f64]>,
}

impl StepRows<'_> {
    /// Writes what the robots report.
    pub fn write(&mut self, reports: impl Iterator<Item = Report>) {
        for (robot, Report { pose, velocity, odometry, touch, clearance }) in reports.enumerate() {
            self.poses[robot] = pose.to_array();
            self.velocities[robot] = velocity.to_array();
            self.odometry[robot] = odometry.to_array();
            if let Some(clearances) = &mut self.clearances {
                clearances[robot] = clearance;
            }
            self.contacts[robot] = touch.is_some();
            self.points[robot] = touch.map_or([f64::NAN; 2], |touch| touch.point.to_array());
            (self.obstacles[robot], self.robots[robot]) = match touch.map(|touch| touch.what) {
                None | Some(Thing::Wall) => (-1, -1),
                Some(Thing::Obstacle(index)) => (index as i64, -1),
                Some(Thing::Robot(index)) => (-1, index as i64),
            };
        }
    }
}
