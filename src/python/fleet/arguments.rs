//! Arguments of fleets, converted from Python.

use numpy::PyUntypedArrayMethods;
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyString;

use crate::memory;
use crate::python::arrays::{short_repr, typed, waypoints, whole_numbers};
use crate::python::grid::OccupancyGrid;
use crate::python::pose::PoseArgument;
use crate::python::shape::Shape;
use crate::python::whole_number;
use crate::{FleetObstacle, Trajectory};

/// Returns the grids of an argument that is one or a sequence of them.
pub fn grids_of(grids: &Bound<'_, PyAny>) -> PyResult<Vec<Py<OccupancyGrid>>> {
    one_or_each("grids", "OccupancyGrid", Some(grids), |value| Some(value.cast::<OccupancyGrid>().ok()?.clone().unbind()))
}

/// Returns the values of an argument that is one value or a sequence of them; none for `None`.
pub fn one_or_each<T>(
    name: &str,
    class: &str,
    value: Option<&Bound<'_, PyAny>>,
    read: impl Fn(&Bound<'_, PyAny>) -> Option<T>,
) -> PyResult<Vec<T>> {
    let Some(value) = value else { return Ok(Vec::new()) };
    if let Some(one) = read(value) {
        return Ok(vec![one]);
    }
    let refused = |got: &Bound<'_, PyAny>| {
        let got = short_repr(got);
        PyTypeError::new_err(format!("{name} must be one {class} or a sequence of them, got {got}"))
    };
    if value.is_instance_of::<PyString>() {
        return Err(refused(value));
    }
    let items = value.len().and_then(|_| value.try_iter()).map_err(|_| refused(value))?;
    let mut found = Vec::new();
    for item in items {
        let item = item?;
        memory::push("the arguments of a fleet", &mut found, read(&item).ok_or_else(|| refused(&item))?)?;
    }
    if found.is_empty() {
        return Err(PyValueError::new_err(format!("{name} must have at least one {class}, got none")));
    }
    Ok(found)
}

/// Returns the indices of an array of integers of shape `(count,)`.
pub fn indices(name: &str, value: &Bound<'_, PyAny>, count: usize) -> PyResult<Vec<usize>> {
    let numbers = whole_numbers(name, value, Some(count))?;
    Ok(numbers.into_iter().map(|number| usize::try_from(number).unwrap_or(usize::MAX)).collect())
}

/// Returns the obstacles of an argument: an iterable of `(Shape, trajectory)` or `(Shape, trajectory, world)`.
pub fn obstacles_of(obstacles: &Bound<'_, PyAny>) -> PyResult<Vec<FleetObstacle>> {
    let refused = |got: &Bound<'_, PyAny>| {
        let needed = "obstacles must be (Shape, trajectory) or (Shape, trajectory, world), with a pose or waypoints";
        PyTypeError::new_err(format!("{needed}, got {}", short_repr(got)))
    };
    let mut found = Vec::new();
    for item in obstacles.len().and_then(|_| obstacles.try_iter()).map_err(|_| refused(obstacles))? {
        let item = item?;
        let (shape, trajectory, world) = match item.len().unwrap_or(0) {
            2 => item.extract::<(Bound<'_, PyAny>, Bound<'_, PyAny>)>().map(|(shape, trajectory)| (shape, trajectory, None)),
            3 => item
                .extract::<(Bound<'_, PyAny>, Bound<'_, PyAny>, Bound<'_, PyAny>)>()
                .map(|(shape, trajectory, world)| (shape, trajectory, Some(world))),
            _ => Err(refused(&item)),
        }
        .map_err(|_| refused(&item))?;
        let shape = shape.cast::<Shape>().map_err(|_| refused(&item))?.get().0.clone();
        let trajectory = trajectory_of(&trajectory)?;
        let world = world.filter(|world| !world.is_none());
        let world = world.map(|world| whole_number("the world of an obstacle", &world, "in 0..2**64 - 1")).transpose()?;
        memory::push("the obstacles", &mut found, FleetObstacle { shape, trajectory, world })?;
    }
    Ok(found)
}

/// Returns the trajectory of an argument that is a pose, waypoints or `None`.
fn trajectory_of(trajectory: &Bound<'_, PyAny>) -> PyResult<Option<Trajectory>> {
    if trajectory.is_none() {
        return Ok(None);
    }
    match trajectory.extract::<PoseArgument>() {
        Ok(pose) => Ok(Some(Trajectory::standing(pose.0))),
        Err(_) if typed::<f64>("the pose of an obstacle", trajectory)?.ndim() == 1 => {
            let needed = "the pose of an obstacle must be three finite numbers (x, y, yaw)";
            Err(PyValueError::new_err(format!("{needed}, got {}", short_repr(trajectory))))
        }
        Err(_) => Ok(Some(Trajectory::new(&waypoints("the waypoints of an obstacle", trajectory)?)?)),
    }
}

/// Returns the obstacles of an argument: an iterable of `(index, Shape, trajectory)`.
pub fn replacements(obstacles: &Bound<'_, PyAny>) -> PyResult<Vec<(usize, crate::Shape, Option<Trajectory>)>> {
    let refused = |got: &Bound<'_, PyAny>| {
        let needed = "obstacles must be (index, Shape, trajectory), with a pose, waypoints or None";
        PyTypeError::new_err(format!("{needed}, got {}", short_repr(got)))
    };
    let mut found = Vec::new();
    for item in obstacles.len().and_then(|_| obstacles.try_iter()).map_err(|_| refused(obstacles))? {
        let item = item?;
        let (index, shape, trajectory) =
            item.extract::<(Bound<'_, PyAny>, Bound<'_, PyAny>, Bound<'_, PyAny>)>().map_err(|_| refused(&item))?;
        let index = whole_number("the index of an obstacle", &index, "at least 0")?;
        let shape = shape.cast::<Shape>().map_err(|_| refused(&item))?.get().0.clone();
        memory::push("the obstacles", &mut found, (index, shape, trajectory_of(&trajectory)?))?;
    }
    Ok(found)
}
