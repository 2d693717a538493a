//! The Python class `Material`, and arguments that name materials.

use numpy::PyUntypedArrayMethods;
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use super::arrays::{shape, short_repr, type_name, typed};
use super::number::Argument;
use super::{Recipe, recipe};
use crate::{MaterialKind, Materials, memory};

/// What a wall or an obstacle is made of.
///
/// An opaque surface returns a beam. A mirror reflects it, and the range is the length of the whole path. Glass lets it pass,
/// and returns some beams that meet it nearly at a right angle. Four materials have names: "wall", "glass", "mirror" and "dark".
/// A name can be given wherever a `Material` is expected.
///
/// Args:
///     kind: "opaque", "glass" or "mirror".
///     reflectivity: Share of the light that it returns, 0 to 1. A mirror reflects this share; glass lets the rest pass. None means
///         1 for opaque surfaces, 0.08 for glass and 0.9 for mirrors, as for the materials that have names.
///     return_chance: Probability that glass returns a beam within `return_angle`. Without noise, a beam takes the likelier way.
///     return_angle: Largest angle between a beam and the normal of glass at which it may return [rad], 0 to π/2.
///
/// Raises:
///     ValueError: The kind is unknown, or a number is out of range.
///     TypeError: An argument has the wrong type.
///
/// Examples:
///     >>> import mobile_robot_simulator as mrs
///     >>> mrs.Material("glass", reflectivity=0.2)
///     Material('glass', reflectivity=0.2, return_chance=0.9, return_angle=0.1)
///     >>> mrs.Material.named("mirror").reflectivity
///     0.9
#[pyclass(frozen, eq, hash, module = "mobile_robot_simulator")]
#[derive(Clone, Copy, PartialEq)]
pub struct Material(pub crate::Material);

impl std::hash::Hash for Material {
    fn hash<H: std::hash::Hasher>(&self, state: &mut H) {
        let crate::Material { kind, reflectivity, return_chance, return_angle } = self.0;
        kind_name(kind).hash(state);
        // Adding 0 makes -0 equal to 0 in all bits, as it is in comparisons.
        [reflectivity, return_chance, return_angle].map(|number| (number + 0.0).to_bits()).hash(state);
    }
}

fn default() -> crate::Material {
    crate::Material::default()
}

fn kind_name(kind: MaterialKind) -> &'static str {
    match kind {
        MaterialKind::Opaque => "opaque",
        MaterialKind::Glass => "glass",
        MaterialKind::Mirror => "mirror",
    }
}

impl Material {
    /// Returns the expression for the material in Python: its name, if it has one.
    pub fn shown(&self) -> String {
        let named = crate::Material::NAMED.iter().find(|(_, material)| *material == self.0);
        named.map_or_else(|| self.__repr__(), |(name, _)| format!("'{name}'"))
    }
}

#[pymethods]
impl Material {
    #[new]
    // The text repeats the core's defaults for `help()`; a test compares the two.
    #[pyo3(
        text_signature = "(kind='opaque', *, reflectivity=None, return_chance=0.9, return_angle=0.1)",
        signature = (
            kind = "opaque",
            *,
            reflectivity = None,
            return_chance = default().return_chance.into(),
            return_angle = default().return_angle.into(),
        )
    )]
    fn new(
        kind: &str,
        reflectivity: Option<Argument<f64>>,
        return_chance: Argument<f64>,
        return_angle: Argument<f64>,
    ) -> PyResult<Self> {
        let kind = match kind {
            "opaque" => MaterialKind::Opaque,
            "glass" => MaterialKind::Glass,
            "mirror" => MaterialKind::Mirror,
            other => {
                let given: String = other.chars().take(60).collect();
                return Err(PyValueError::new_err(format!("kind must be 'opaque', 'glass' or 'mirror', got {given:?}")));
            }
        };
        let usual = crate::Material::of_kind(kind);
        let material = crate::Material {
            kind,
            reflectivity: reflectivity.map_or(Ok(usual.reflectivity), |given| given.named("reflectivity"))?,
            return_chance: return_chance.named("return_chance")?,
            return_angle: return_angle.named("return_angle")?,
        };
        Ok(Self(material.checked()?))
    }

    /// Returns the material with a name.
    ///
    /// Args:
    ///     name: "wall", "glass", "mirror" or "dark".
    ///
    /// Raises:
    ///     ValueError: There is no such material.
    ///
    /// Examples:
    ///     >>> import mobile_robot_simulator as mrs
    ///     >>> mrs.Material.named("dark").reflectivity
    ///     0.024
    #[staticmethod]
    fn named(name: &str) -> PyResult<Self> {
        Ok(Self(crate::Material::named(name)?))
    }

    /// The kind: "opaque", "glass" or "mirror".
    #[getter]
    fn kind(&self) -> &'static str {
        kind_name(self.0.kind)
    }

    /// Share of the light that it returns, 0 to 1.
    #[getter]
    fn reflectivity(&self) -> f64 {
        self.0.reflectivity
    }

    /// Probability that glass returns a beam within `return_angle`.
    #[getter]
    fn return_chance(&self) -> f64 {
        self.0.return_chance
    }

    /// Largest angle between a beam and the normal of glass at which it may return [rad].
    #[getter]
    fn return_angle(&self) -> f64 {
        self.0.return_angle
    }

    fn __repr__(&self) -> String {
        let crate::Material { kind, reflectivity, return_chance, return_angle } = self.0;
        format!(
            "Material('{}', reflectivity={reflectivity:?}, return_chance={return_chance:?}, return_angle={return_angle:?})",
            kind_name(kind)
        )
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Recipe<'py>> {
        let keywords = PyDict::new(py);
        keywords.set_item("reflectivity", self.0.reflectivity)?;
        keywords.set_item("return_chance", self.0.return_chance)?;
        keywords.set_item("return_angle", self.0.return_angle)?;
        recipe::<Self>(py, PyTuple::new(py, [self.kind()])?, keywords)
    }
}

/// A material argument: a `Material`, or the name of one.
pub struct MaterialArgument(pub crate::Material);

impl<'py> FromPyObject<'_, 'py> for MaterialArgument {
    type Error = PyErr;

    fn extract(value: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        if let Ok(material) = value.cast::<Material>() {
            return Ok(Self(material.get().0));
        }
        if let Ok(name) = value.extract::<String>() {
            return Ok(Self(crate::Material::named(&name)?));
        }
        let text = "a material must be a Material or the name of one, got ";
        Err(PyTypeError::new_err(format!("{text}{}: {}", type_name(&value), short_repr(&value))))
    }
}

/// Returns the layer of materials with these numbers of the cells; without a table, the numbers are those of the named materials.
pub fn layer(numbers: &Bound<'_, PyAny>, table: Option<&Bound<'_, PyAny>>) -> PyResult<Materials> {
    let numbers = typed::<u8>("materials", numbers)?;
    let [_, width] = *numbers.shape() else {
        return Err(PyValueError::new_err(format!("materials must have shape (H, W), got {}", shape(numbers.shape()))));
    };
    let table = match table {
        Some(table) => read_table(table)?,
        None => crate::Material::NAMED.map(|(_, material)| material).to_vec(),
    };
    let numbers = memory::collected("the materials", numbers.as_array().iter().copied())?;
    Ok(Materials::new(numbers, width, table)?)
}

/// Returns the materials of a table, at most one more than a table can have.
fn read_table(table: &Bound<'_, PyAny>) -> PyResult<Vec<crate::Material>> {
    let materials = table.try_iter().map_err(|_| {
        PyTypeError::new_err(format!("a table of materials must be a sequence of materials, got {}", type_name(table)))
    })?;
    materials.take(Materials::MAX + 1).map(|material| Ok(material?.extract::<MaterialArgument>()?.0)).collect()
}
