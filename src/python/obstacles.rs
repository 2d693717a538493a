//! Conversion of obstacle arguments.

use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyTuple;

use super::arrays::{Rows, rows, short_repr, type_name};
use super::pose::{PoseArgument, refused};
use super::shape::Shape;
use crate::{Course, Error, MovingObstacle, Obstacles, Pose, Twist, memory};

/// An obstacle argument: an iterable of `(Shape, pose)` pairs, with poses in the map frame.
pub struct ObstaclesArgument(pub Obstacles);

impl ObstaclesArgument {
    /// The default of every `obstacles` argument.
    pub fn none() -> Self {
        Self(Obstacles::default())
    }
}

/// Returns what `read` makes of each item of an iterable; `needed` describes the items in an error.
fn items<'py, T>(
    value: &Bound<'py, PyAny>,
    needed: &str,
    read: impl Fn(&Bound<'py, PyAny>, &dyn Fn(&Bound<'py, PyAny>) -> PyErr) -> PyResult<T>,
) -> PyResult<Vec<T>> {
    let refuse = |got: &Bound<'py, PyAny>| {
        let got = type_name(got);
        PyTypeError::new_err(format!("obstacles must be a sequence of {needed}, got {got}"))
    };
    let mut items = Vec::new();
    for item in value.try_iter().map_err(|_| refuse(value))? {
        memory::push("the obstacles", &mut items, read(&item?, &refuse)?)?;
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
        let placed = items(&value, "(Shape, pose)", |item, refuse| {
            if let Some(placed) = placed(item) {
                return Ok(placed);
            }
            let (shape, pose) = parts(item, refuse)?;
            Ok((shape, pose.extract::<PoseArgument>()?.0))
        })?;
        Ok(Self(Obstacles::new(placed.iter().map(|(shape, pose)| (&shape.get().0, *pose)))?))
    }
}

/// An obstacle argument of scans that can take time: an iterable of `(Shape, pose)`, `(Shape, pose, twist)` or
/// `(Shape, poses)`.
pub struct MovingObstaclesArgument<'py>(Vec<(Bound<'py, Shape>, Motion<'py>)>);

/// How an obstacle moves while a scan is taken.
enum Motion<'py> {
    Stands(Pose),
    Arc(Pose, Twist),
    /// A pose for each beam.
    Poses(Rows<'py>),
}

impl MovingObstaclesArgument<'_> {
    /// The default of every `obstacles` argument.
    pub fn none() -> Self {
        Self(Vec::new())
    }

    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Returns the obstacles as they stand.
    ///
    /// # Errors
    /// `ValueError` if one of them moves.
    pub fn standing(&self) -> PyResult<Obstacles> {
        let placed = self.0.iter().map(|(shape, motion)| match motion {
            Motion::Stands(pose) => Ok((shape, *pose)),
            Motion::Arc(..) | Motion::Poses(_) => Err(needs_duration()),
        });
        let placed: Vec<_> = placed.collect::<PyResult<_>>()?;
        Ok(Obstacles::new(placed.iter().map(|(shape, pose)| (&shape.get().0, *pose)))?)
    }

    /// Checks that no obstacle has a twist.
    ///
    /// # Errors
    /// `ValueError` if one has.
    pub fn check_have_poses(&self) -> PyResult<()> {
        let has_twist = self.0.iter().any(|(_, motion)| matches!(motion, Motion::Arc(..)));
        if has_twist { Err(needs_duration()) } else { Ok(()) }
    }

    /// Returns the obstacles and how they move.
    ///
    /// # Errors
    /// [`Error::Memory`]: there is not enough memory.
    pub fn moving(&self) -> Result<Vec<MovingObstacle<'_>>, Error> {
        let obstacles = self.0.iter().map(|(shape, motion)| {
            let course = match motion {
                Motion::Stands(pose) => Course::Arc { start: *pose, twist: Twist::default() },
                Motion::Arc(start, twist) => Course::Arc { start: *start, twist: *twist },
                Motion::Poses(poses) => Course::Poses(poses),
            };
            MovingObstacle { shape: &shape.get().0, course }
        });
        memory::collected("the obstacles", obstacles)
    }
}

fn needs_duration() -> PyErr {
    PyValueError::new_err("obstacles that move need scan_duration, the time in which the beams of a scan are taken [s]")
}

impl<'py> FromPyObject<'_, 'py> for MovingObstaclesArgument<'py> {
    type Error = PyErr;

    fn extract(value: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
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
        Ok(Self(items(&value, needed, read)?))
    }
}
