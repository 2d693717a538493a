//! `Shape` for Python.

use glam::DVec2;
use numpy::{IntoPyArray, PyArray2, ndarray::Array2};
use pyo3::prelude::*;
use pyo3::types::PyTuple;

use super::arrays::points;

/// The shape of a robot or of an obstacle, in its own frame: a disc around the origin, or a simple polygon anywhere about it.
///
/// Made by ``Shape.disc``, ``Shape.rectangle`` and ``Shape.polygon``. Lengths in metres; a pose says where the origin is.
#[pyclass(frozen, eq, module = "mobile_robot_simulator", from_py_object)]
#[derive(Clone, PartialEq)]
pub struct Shape(pub crate::Shape);

#[pymethods]
impl Shape {
    /// The disc of a radius [m] around the origin.
    ///
    /// raises: ValueError for a radius that is not positive, or more than 1e6.
    #[staticmethod]
    fn disc(radius: f64) -> PyResult<Self> {
        Ok(Self(crate::Shape::disc(radius)?))
    }

    /// The rectangle around the origin, ``length`` [m] along x (forward) and ``width`` [m] along y.
    ///
    /// raises: ValueError for a side that is not positive, or more than 1e6.
    #[staticmethod]
    fn rectangle(length: f64, width: f64) -> PyResult<Self> {
        Ok(Self(crate::Shape::rectangle(length, width)?))
    }

    /// The polygon with these corners, either way round, convex or not; the last is joined to the first.
    ///
    /// points: (N, 2) array or sequence of (x, y) [m], 3 to 1000 of them.
    /// raises: ValueError for another shape or number, coordinates that are not finite or beyond 1e6, a corner repeated at once,
    /// edges that meet elsewhere than at the corner they share; TypeError for what is no numbers.
    #[staticmethod]
    fn polygon(points: &Bound<'_, PyAny>) -> PyResult<Self> {
        Ok(Self(crate::Shape::polygon(&self::points("points", points)?)?))
    }

    /// Radius of a disc [m], None of a polygon.
    #[getter]
    fn radius(&self) -> Option<f64> {
        self.0.radius()
    }

    /// Corners counter-clockwise, (N, 2) float64 [m]; (0, 2) of a disc.
    #[getter]
    fn points<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        let corners: Vec<[f64; 2]> = self.0.corners().iter().map(DVec2::to_array).collect();
        Array2::from(corners).into_pyarray(py)
    }

    /// Distance from the origin to the farthest point [m]: the radius within which the shape turns.
    #[getter]
    fn reach(&self) -> f64 {
        self.0.reach()
    }

    /// Area [m²].
    #[getter]
    fn area(&self) -> f64 {
        self.0.area()
    }

    fn __repr__(&self) -> String {
        let corners = self.0.corners().iter().map(|corner| format!("({:?}, {:?})", corner.x, corner.y));
        let corners: Vec<String> = corners.collect();
        match self.0.radius() {
            Some(radius) => format!("Shape.disc({radius:?})"),
            None => format!("Shape.polygon([{}])", corners.join(", ")),
        }
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
        let class = py.get_type::<Self>();
        match self.0.radius() {
            Some(radius) => Ok((class.getattr("disc")?, PyTuple::new(py, [radius])?)),
            None => Ok((class.getattr("polygon")?, PyTuple::new(py, [self.points(py)])?)),
        }
    }
}
