//! Conversion of obstacle arguments.

use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;

use super::arrays::type_name;
use super::pose::PoseArgument;
use super::shape::Shape;
use crate::{Obstacles, memory};

/// An obstacle argument: an iterable of `(Shape, pose)` pairs, with poses in the map frame.
pub struct ObstaclesArgument(pub Obstacles);

impl ObstaclesArgument {
    /// The default of every `obstacles` argument.
    pub fn none() -> Self {
        Self(Obstacles::default())
    }
}

impl<'py> FromPyObject<'_, 'py> for ObstaclesArgument {
    type Error = PyErr;

    fn extract(value: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        let refuse = |got: &Bound<'py, PyAny>| {
            let got = type_name(got);
            PyTypeError::new_err(format!("obstacles must be a sequence of (Shape, pose), got {got}"))
        };
        let items = value.try_iter().map_err(|_| refuse(&value))?;
        let items = items.map(|item| {
            let item = item?;
            let (shape, pose) = item.extract::<(Bound<'py, PyAny>, Bound<'py, PyAny>)>().map_err(|_| refuse(&item))?;
            let shape = shape.cast_into::<Shape>().map_err(|error| refuse(&error.into_inner()))?;
            Ok::<_, PyErr>((shape, pose.extract::<PoseArgument>()?.0))
        });
        let mut placed = Vec::new();
        for item in items {
            memory::push("the obstacles", &mut placed, item?)?;
        }
        Ok(Self(Obstacles::new(placed.iter().map(|(shape, pose)| (&shape.get().0, *pose)))?))
    }
}
