//! The Python class `Shape`.

use glam::DVec2;
use numpy::{IntoPyArray, PyArray2, ndarray::Array2};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::PyTuple;

use super::arrays::{points, type_name};
use super::material::{Material, MaterialArgument};
use super::number::Argument;

/// Outline of a robot or an obstacle in its own frame: a disc around the origin, or a simple polygon.
///
/// Create one with `Shape.disc`, `Shape.rectangle` or `Shape.polygon`. Lengths are in metres. A pose places the origin of
/// the shape in the map; the origin may lie outside a polygon.
///
/// Examples:
///     >>> from mobile_robot_simulator import Shape
///     >>> Shape.rectangle(0.6, 0.4).area
///     0.24
#[pyclass(frozen, eq, module = "mobile_robot_simulator", from_py_object)]
#[derive(Clone, PartialEq)]
pub struct Shape(pub crate::Shape);

#[pymethods]
impl Shape {
    /// Returns a disc around the origin.
    ///
    /// Args:
    ///     radius: Radius [m], at most 1e6.
    ///
    /// Raises:
    ///     ValueError: The radius is not positive, or is larger than 1e6.
    ///
    /// Examples:
    ///     >>> from mobile_robot_simulator import Shape
    ///     >>> Shape.disc(0.3)
    ///     Shape.disc(0.3)
    #[staticmethod]
    fn disc(radius: Argument<f64>) -> PyResult<Self> {
        Ok(Self(crate::Shape::disc(radius.named("radius")?)?))
    }

    /// Returns a rectangle with its centre at the origin.
    ///
    /// Args:
    ///     length: Side along x, the forward direction [m], at most 1e6.
    ///     width: Side along y [m], at most 1e6.
    ///
    /// Raises:
    ///     ValueError: A side is not positive, or is larger than 1e6.
    ///
    /// Examples:
    ///     >>> from mobile_robot_simulator import Shape
    ///     >>> Shape.rectangle(2.0, 1.0).points.tolist()
    ///     [[-1.0, -0.5], [1.0, -0.5], [1.0, 0.5], [-1.0, 0.5]]
    #[staticmethod]
    fn rectangle(length: Argument<f64>, width: Argument<f64>) -> PyResult<Self> {
        Ok(Self(crate::Shape::rectangle(length.named("length")?, width.named("width")?)?))
    }

    /// Returns a polygon with the given corners, convex or not.
    ///
    /// An edge joins the last corner to the first.
    ///
    /// Args:
    ///     points: Corners (x, y) [m], 3 to 1000 of them, clockwise or counter-clockwise: an (N, 2) array or a sequence of
    ///         pairs. Coordinates lie between -1e6 and 1e6.
    ///
    /// Raises:
    ///     ValueError: The array has another shape, there are fewer than 3 or more than 1000 corners, a coordinate is not
    ///         finite or beyond 1e6, two consecutive corners are equal, or two edges meet anywhere but at a shared corner.
    ///     TypeError: `points` does not consist of pairs of numbers.
    ///
    /// Examples:
    ///     >>> from mobile_robot_simulator import Shape
    ///     >>> Shape.polygon([(0.0, 0.0), (2.0, 0.0), (2.0, 1.0)]).area
    ///     1.0
    #[staticmethod]
    fn polygon(points: &Bound<'_, PyAny>) -> PyResult<Self> {
        Ok(Self(crate::Shape::polygon(&self::points("points", points)?)?))
    }

    /// Returns the same shape of another material. Beams pass glass, and mirrors reflect them.
    ///
    /// Args:
    ///     material: A `Material`, or the name of one: "wall", "glass", "mirror" or "dark".
    ///
    /// Raises:
    ///     ValueError: There is no material with this name.
    ///     TypeError: `material` is neither a `Material` nor a name.
    ///
    /// Examples:
    ///     >>> from mobile_robot_simulator import Shape
    ///     >>> Shape.rectangle(2.0, 0.1).with_material("mirror").material.kind
    ///     'mirror'
    fn with_material(&self, material: MaterialArgument) -> PyResult<Self> {
        Ok(Self(self.0.clone().with_material(material.0)?))
    }

    /// What the shape is made of.
    #[getter]
    fn material(&self) -> Material {
        Material(self.0.material())
    }

    /// Radius of a disc [m]; None for a polygon.
    #[getter]
    fn radius(&self) -> Option<f64> {
        self.0.radius()
    }

    /// Corners of a polygon, counter-clockwise: (N, 2) float64 [m]. For a disc, an empty (0, 2) array.
    #[getter]
    fn points<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        let corners: Vec<[f64; 2]> = self.0.corners().iter().map(DVec2::to_array).collect();
        Array2::from(corners).into_pyarray(py)
    }

    /// Distance from the origin to the farthest point [m]: the radius of the circle that the shape needs to turn in place.
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
        let outline = match self.0.radius() {
            Some(radius) => format!("Shape.disc({radius:?})"),
            None => format!("Shape.polygon([{}])", corners.join(", ")),
        };
        let material = self.material();
        if material.0 == crate::Material::WALL { outline } else { format!("{outline}.with_material({})", material.shown()) }
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
        let class = py.get_type::<Self>();
        if self.0.material() != crate::Material::WALL {
            let plain = self.0.clone().with_material(crate::Material::WALL)?;
            let arguments = (Self(plain).into_pyobject(py)?, self.material().into_pyobject(py)?);
            return Ok((class.getattr("with_material")?, arguments.into_pyobject(py)?));
        }
        match self.0.radius() {
            Some(radius) => Ok((class.getattr("disc")?, PyTuple::new(py, [radius])?)),
            None => Ok((class.getattr("polygon")?, PyTuple::new(py, [self.points(py)])?)),
        }
    }
}

/// A footprint argument: a `Shape`.
pub struct FootprintArgument<'py>(Bound<'py, Shape>);

impl FootprintArgument<'_> {
    /// Returns the shape.
    pub fn get(&self) -> &crate::Shape {
        &self.0.get().0
    }
}

impl<'py> FromPyObject<'_, 'py> for FootprintArgument<'py> {
    type Error = PyErr;

    fn extract(value: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        value.cast::<Shape>().map(|shape| Self(shape.to_owned())).map_err(|_| {
            let hint = "; make one with Shape.disc, Shape.rectangle or Shape.polygon";
            PyTypeError::new_err(format!("footprint must be a Shape, got {}{hint}", type_name(&value)))
        })
    }
}
