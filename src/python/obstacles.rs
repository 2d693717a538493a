//! Conversion of obstacle arguments.

use std::sync::Arc;

use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyList, PyTuple};

use super::arrays::{Rows, rows, short_repr, type_name};
use super::pose::{PoseArgument, refused};
use super::shape::Shape;
use super::whole_number;
use crate::fork::Lock;
use crate::{Course, Error, MovingObstacle, OccupancyGrid, Pose, Twist, World, memory};

/// What the memory is for, in errors.
const NAME: &str = "the obstacles";

/// Obstacles that are converted once, for many calls: shapes at poses in the map frame.
///
/// Every function that takes `obstacles` takes them in place of pairs (Shape, pose), with the same result. An obstacle is
/// known by its index.
///
/// Args:
///     placed: Pairs (Shape, pose), with poses in the map frame.
///
/// Raises:
///     TypeError: An item is not such a pair.
///     ValueError: A pose is not finite.
///
/// Examples:
///     >>> import mobile_robot_simulator as mrs
///     >>> disc = mrs.Shape.disc(1.0)
///     >>> obstacles = mrs.Obstacles([(disc, (3.0, 0.0, 0.0)), (disc, (7.0, 0.0, 0.0))])
///     >>> len(obstacles)
///     2
#[pyclass(frozen, module = "mobile_robot_simulator")]
pub struct Obstacles {
    /// Shared with those that leave out an obstacle.
    all: Arc<Lock<All>>,
    left_out: Option<usize>,
}

/// All obstacles of a set.
struct All {
    /// A call keeps the set that it started with.
    core: Arc<crate::Obstacles>,
    /// What Python gets back.
    placed: Vec<(Py<Shape>, Pose)>,
}

#[pymethods]
impl Obstacles {
    #[new]
    #[pyo3(text_signature = "(placed=())", signature = (placed = None))]
    fn new(placed: Option<&Bound<'_, PyAny>>) -> PyResult<Self> {
        let placed = placed.map_or_else(|| Ok(Vec::new()), |placed| pairs(placed, "placed"))?;
        let core = Arc::new(set_of(&placed)?);
        let placed = memory::collected(NAME, placed.into_iter().map(|(shape, pose)| (shape.unbind(), pose)))?;
        Ok(Self { all: Arc::new(Lock::new(All { core, placed })), left_out: None })
    }

    /// Places a shape at a pose, as the obstacle with this index: in place of the one that has it, or as the next one.
    ///
    /// Args:
    ///     index: Index of the obstacle, at most their number.
    ///     shape: The shape.
    ///     pose: Pose (x, y, yaw) in the map frame [m, m, rad].
    ///
    /// Raises:
    ///     ValueError: The index is larger than the number of obstacles, or the pose is not finite. Nothing changes.
    ///
    /// Examples:
    ///     >>> import mobile_robot_simulator as mrs
    ///     >>> obstacles = mrs.Obstacles([(mrs.Shape.disc(1.0), (3.0, 0.0, 0.0))])
    ///     >>> obstacles.place(0, mrs.Shape.disc(0.5), (4.0, 0.0, 0.0))
    ///     >>> obstacles.placed
    ///     [(Shape.disc(0.5), Pose(4.0, 0.0, 0.0))]
    fn place(&self, index: &Bound<'_, PyAny>, shape: &Bound<'_, Shape>, pose: PoseArgument) -> PyResult<()> {
        let index: usize = whole_number("index", index, "at least 0")?;
        let mut all = self.all.lock();
        if Arc::get_mut(&mut all.core).is_none() {
            all.core = Arc::new(all.core.try_clone()?);
        }
        if index == all.placed.len() {
            all.placed.try_reserve(1).map_err(|_| memory::missing::<(Py<Shape>, Pose)>(NAME, index + 1))?;
        }
        Arc::get_mut(&mut all.core).expect("the only reference").place(index, &shape.get().0, pose.0)?;
        let placed = (shape.clone().unbind(), pose.0);
        match all.placed.get_mut(index) {
            Some(old) => *old = placed,
            None => all.placed.push(placed),
        }
        Ok(())
    }

    /// Returns the same obstacles as if the one with this index were not there.
    ///
    /// The others keep their indices. What is placed later is placed in both.
    ///
    /// Args:
    ///     index: Index of the obstacle; None leaves out none. There may be none with it yet.
    ///
    /// Raises:
    ///     ValueError: The index is negative.
    ///
    /// Examples:
    ///     >>> import numpy as np
    ///     >>> import mobile_robot_simulator as mrs
    ///     >>> disc = mrs.Shape.disc(1.0)
    ///     >>> robots = mrs.Obstacles([(disc, (0.0, 0.0, 0.0)), (disc, (4.0, 0.0, 0.0))])
    ///     >>> grid = mrs.OccupancyGrid(np.zeros((1, 1), np.int8), resolution=1.0)
    ///     >>> mrs.clearance(grid, disc, (0.0, 0.0, 0.0), limit=9.0, obstacles=robots.without(0))
    ///     2.0
    #[pyo3(signature = (index))]
    fn without(&self, index: Option<&Bound<'_, PyAny>>) -> PyResult<Self> {
        let left_out = index.map(|index| whole_number("index", index, "at least 0")).transpose()?;
        Ok(Self { all: Arc::clone(&self.all), left_out })
    }

    /// All obstacles: a list of pairs (Shape, Pose), with the one that is left out.
    #[getter]
    fn placed<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        let copy = |(shape, pose): &(Py<Shape>, Pose)| (shape.clone_ref(py), super::pose::Pose(*pose));
        let placed = memory::collected(NAME, self.all.lock().placed.iter().map(copy))?;
        PyList::new(py, placed)
    }

    /// Index of the obstacle that is left out; None for none.
    #[getter]
    fn left_out(&self) -> Option<usize> {
        self.left_out
    }

    fn __len__(&self) -> usize {
        self.all.lock().placed.len()
    }

    fn __repr__(&self) -> String {
        let left_out = self.left_out.map(|index| format!(", without number {index}")).unwrap_or_default();
        format!("Obstacles({} placed{left_out})", self.__len__())
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
        let (class, placed) = (py.get_type::<Self>(), PyTuple::new(py, [self.placed(py)?])?);
        match self.left_out {
            None => Ok((class.into_any(), placed)),
            Some(index) => Ok((class.call1(placed)?.getattr("without")?, PyTuple::new(py, [index])?)),
        }
    }
}

/// An obstacle argument: [`Obstacles`], or an iterable of `(Shape, pose)` pairs with poses in the map frame.
pub struct ObstaclesArgument {
    /// `None` for none.
    obstacles: Option<Arc<crate::Obstacles>>,
    except: Option<usize>,
}

impl ObstaclesArgument {
    /// The default of every `obstacles` argument.
    pub fn none() -> Self {
        Self { obstacles: None, except: None }
    }

    /// Returns the obstacles on a grid.
    pub fn on<'a>(&'a self, grid: &'a OccupancyGrid) -> World<'a> {
        World { grid, obstacles: self.obstacles.as_deref().unwrap_or(crate::Obstacles::NONE), except: self.except }
    }

    /// Returns the obstacles of an argument that is a set of them, `None` if it is something else.
    fn of_set(value: &Bound<'_, PyAny>) -> Option<Self> {
        let set = value.cast::<Obstacles>().ok()?.get();
        Some(Self { obstacles: Some(Arc::clone(&set.all.lock().core)), except: set.left_out })
    }
}

/// Returns the pairs of an iterable of `(Shape, pose)`; `name` is that of the argument.
fn pairs<'py>(value: &Bound<'py, PyAny>, name: &str) -> PyResult<Vec<(Bound<'py, Shape>, Pose)>> {
    items(value, name, "(Shape, pose)", |item, refuse| {
        if let Some(placed) = placed(item) {
            return Ok(placed);
        }
        let (shape, pose) = parts(item, refuse)?;
        Ok((shape, pose.extract::<PoseArgument>()?.0))
    })
}

fn set_of(placed: &[(Bound<'_, Shape>, Pose)]) -> Result<crate::Obstacles, Error> {
    crate::Obstacles::new(placed.iter().map(|(shape, pose)| (&shape.get().0, *pose)))
}

/// Returns what `read` makes of each item of an iterable; `needed` describes the items in an error.
fn items<'py, T>(
    value: &Bound<'py, PyAny>,
    name: &str,
    needed: &str,
    read: impl Fn(&Bound<'py, PyAny>, &dyn Fn(&Bound<'py, PyAny>) -> PyErr) -> PyResult<T>,
) -> PyResult<Vec<T>> {
    let refuse = |got: &Bound<'py, PyAny>| {
        let got = type_name(got);
        PyTypeError::new_err(format!("{name} must be a sequence of {needed}, got {got}"))
    };
    let mut items = Vec::new();
    for item in value.try_iter().map_err(|_| refuse(value))? {
        memory::push(NAME, &mut items, read(&item?, &refuse)?)?;
    }
    Ok(items)
}

/// Returns the shape and the pose of an item that is a tuple of the two, as nearly all are; `None` for anything else.
fn placed<'py>(item: &Bound<'py, PyAny>) -> Option<(Bound<'py, Shape>, Pose)> {
    let pair = item.cast_exact::<PyTuple>().ok()?;
    if pair.len() != 2 {
        return None;
    }
    let (shape, pose) = (pair.get_item(0).ok()?, pair.get_item(1).ok()?);
    Some((shape.cast_into::<Shape>().ok()?, pose.cast::<super::pose::Pose>().ok()?.get().0))
}

/// Returns the shape and the rest of an item.
fn parts<'py>(
    item: &Bound<'py, PyAny>,
    refuse: &dyn Fn(&Bound<'py, PyAny>) -> PyErr,
) -> PyResult<(Bound<'py, Shape>, Bound<'py, PyAny>)> {
    let (shape, pose) = item.extract::<(Bound<'py, PyAny>, Bound<'py, PyAny>)>().map_err(|_| refuse(item))?;
    Ok((shape.cast_into::<Shape>().map_err(|error| refuse(&error.into_inner()))?, pose))
}

impl<'py> FromPyObject<'_, 'py> for ObstaclesArgument {
    type Error = PyErr;

    fn extract(value: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        match Self::of_set(&value) {
            Some(argument) => Ok(argument),
            None => Ok(Self { obstacles: Some(Arc::new(set_of(&pairs(&value, "obstacles")?)?)), except: None }),
        }
    }
}

/// An obstacle argument of scans that can take time: [`Obstacles`], or an iterable of `(Shape, pose)`, `(Shape, pose, twist)` or
/// `(Shape, poses)`.
pub enum MovingObstaclesArgument<'py> {
    Set(ObstaclesArgument),
    Items(Vec<(Bound<'py, Shape>, Motion<'py>)>),
}

/// How an obstacle moves while a scan is taken.
pub enum Motion<'py> {
    Stands(Pose),
    Arc(Pose, Twist),
    /// A pose for each beam.
    Poses(Rows<'py>),
}

impl MovingObstaclesArgument<'_> {
    /// The default of every `obstacles` argument.
    pub fn none() -> Self {
        Self::Items(Vec::new())
    }

    pub fn is_empty(&self) -> bool {
        match self {
            Self::Set(set) => set.obstacles.as_ref().is_none_or(|obstacles| obstacles.is_empty()),
            Self::Items(items) => items.is_empty(),
        }
    }

    /// Returns the obstacles as they stand.
    ///
    /// # Errors
    /// `ValueError` if one of them moves.
    pub fn standing(self) -> PyResult<ObstaclesArgument> {
        let items = match self {
            Self::Set(set) => return Ok(set),
            Self::Items(items) => items,
        };
        let placed = items.iter().map(|(shape, motion)| match motion {
            Motion::Stands(pose) => Ok((shape, *pose)),
            Motion::Arc(..) | Motion::Poses(_) => Err(needs_duration()),
        });
        let placed: Vec<_> = placed.collect::<PyResult<_>>()?;
        let obstacles = crate::Obstacles::new(placed.iter().map(|(shape, pose)| (&shape.get().0, *pose)))?;
        Ok(ObstaclesArgument { obstacles: Some(Arc::new(obstacles)), except: None })
    }

    /// Returns the obstacles and how each of them moves.
    ///
    /// # Errors
    /// - `TypeError` if they are a set, whose obstacles stand.
    /// - `ValueError` if one has a twist, unless `takes_twists`.
    /// - [`Error::Memory`]: there is not enough memory.
    pub fn moving(&self, takes_twists: bool) -> PyResult<Vec<MovingObstacle<'_>>> {
        let Self::Items(items) = self else {
            let text = "obstacles of scans that take time must be a sequence of (Shape, pose), (Shape, pose, twist) or \
                        (Shape, poses), got Obstacles";
            return Err(PyTypeError::new_err(text));
        };
        if !takes_twists && items.iter().any(|(_, motion)| matches!(motion, Motion::Arc(..))) {
            return Err(needs_duration());
        }
        let obstacles = items.iter().map(|(shape, motion)| {
            let course = match motion {
                Motion::Stands(pose) => Course::Arc { start: *pose, twist: Twist::default() },
                Motion::Arc(start, twist) => Course::Arc { start: *start, twist: *twist },
                Motion::Poses(poses) => Course::Poses(poses),
            };
            MovingObstacle { shape: &shape.get().0, course }
        });
        Ok(memory::collected(NAME, obstacles)?)
    }
}

fn needs_duration() -> PyErr {
    PyValueError::new_err("obstacles that move need scan_duration, the time in which the beams of a scan are taken [s]")
}

impl<'py> FromPyObject<'_, 'py> for MovingObstaclesArgument<'py> {
    type Error = PyErr;

    fn extract(value: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        if let Some(set) = ObstaclesArgument::of_set(&value) {
            return Ok(Self::Set(set));
        }
        let needed = "(Shape, pose), (Shape, pose, twist) or (Shape, poses)";
        let read = |item: &Bound<'py, PyAny>, refuse: &dyn Fn(&Bound<'py, PyAny>) -> PyErr| {
            if let Some((shape, pose)) = placed(item) {
                return Ok((shape, Motion::Stands(pose)));
            }
            if item.len().is_ok_and(|count| count == 3) {
                let (shape, pose, twist) =
                    item.extract::<(Bound<'py, PyAny>, Bound<'py, PyAny>, Bound<'py, PyAny>)>().map_err(|_| refuse(item))?;
                let shape = shape.cast_into::<Shape>().map_err(|error| refuse(&error.into_inner()))?;
                let pose = pose.extract::<PoseArgument>()?.0;
                let twist = twist.extract::<[f64; 3]>().map_err(|_| {
                    let text = "the twist of an obstacle must be three numbers (vx, vy, wz), got ";
                    refused(&twist, format!("{text}{}: {}", type_name(&twist), short_repr(&twist)), &[3])
                })?;
                return Ok((shape, Motion::Arc(pose, Twist::from(twist).checked()?)));
            }
            let (shape, pose) = parts(item, refuse)?;
            let motion = match pose.extract::<PoseArgument>() {
                Ok(pose) => Motion::Stands(pose.0),
                Err(_) if pose.getattr("ndim").is_ok_and(|count| count.eq(2).unwrap_or(false)) => {
                    Motion::Poses(rows("the poses of an obstacle", &pose, None)?)
                }
                Err(error) => return Err(error),
            };
            Ok((shape, motion))
        };
        Ok(Self::Items(items(&value, "obstacles", needed, read)?))
    }
}
