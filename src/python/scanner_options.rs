//! The options of the Python class `LaserScanner`: from arguments, as text and as keyword arguments.

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use super::number::Argument;
use super::whole_number;
use crate::memory;
use crate::{BeamLayout, Mount, ScannerOptions};

/// Returns the options of a scanner made without arguments.
pub fn default() -> ScannerOptions {
    ScannerOptions::default()
}

/// Returns the layout that these arguments describe.
pub fn layout(
    fov: Option<Argument<f64>>,
    angle_min: Option<Argument<f64>>,
    angle_max: Option<Argument<f64>>,
    angle_increment: Option<Argument<f64>>,
) -> PyResult<BeamLayout> {
    let arguments = [("fov", fov), ("angle_min", angle_min), ("angle_max", angle_max), ("angle_increment", angle_increment)];
    let given: Vec<_> = arguments.iter().filter(|(_, number)| number.is_some()).map(|(name, _)| *name).collect();
    let text = format!("the beams need fov, or angle_min with angle_max or angle_increment, got {}", given.join(" and "));
    let named = |(name, number): (&str, Option<Argument<f64>>)| number.map(|number| number.named(name)).transpose();
    let [fov, angle_min, angle_max, angle_increment] = arguments.map(named);
    match (fov?, angle_min?, angle_max?, angle_increment?) {
        (None, None, None, None) => Ok(default().layout),
        (Some(fov), None, None, None) => Ok(BeamLayout::Fov(fov)),
        (None, Some(angle_min), Some(angle_max), None) => Ok(BeamLayout::Ends { angle_min, angle_max }),
        (None, Some(angle_min), None, Some(angle_increment)) => Ok(BeamLayout::Steps { angle_min, angle_increment }),
        _ => Err(PyValueError::new_err(text)),
    }
}

/// Returns a mount as three numbers if it is in the plane, else as six.
fn shown(mount: Mount) -> String {
    let numbers =
        if mount == mount.planar().into() { mount.planar().to_array().to_vec() } else { mount.to_array().to_vec() };
    numbers.iter().map(|number| format!("{number:?}")).collect::<Vec<_>>().join(", ")
}

/// Returns the numbers of the beams that an argument selects, of `beam_count`.
pub fn chosen_beams(beam_count: usize, beams: &Bound<'_, PyAny>) -> PyResult<Vec<usize>> {
    if beams.try_iter().is_err() {
        let step = whole_number("beams", beams, "a positive number k for every k-th beam, or a sequence of numbers")?;
        if step == 0 {
            return Err(PyValueError::new_err("beams must be a positive number k for every k-th beam, got 0"));
        }
        return Ok(memory::collected("the beams", (0..beam_count.div_ceil(step)).map(|nth| nth * step))?);
    }
    let mut numbers = Vec::new();
    for beam in beams.try_iter()? {
        memory::push("the beams", &mut numbers, whole_number("a number of beams", &beam?, "the number of a beam")?)?;
    }
    Ok(numbers)
}

/// Returns the call that makes a scanner with these options.
pub fn text(&ScannerOptions { layout, beam_count, min_range, max_range, mount }: &ScannerOptions) -> String {
    let mount = shown(mount);
    let layout = match layout {
        BeamLayout::Fov(fov) => format!("fov={fov:?}"),
        BeamLayout::Ends { angle_min, angle_max } => format!("angle_min={angle_min:?}, angle_max={angle_max:?}"),
        BeamLayout::Steps { angle_min, angle_increment } => {
            format!("angle_min={angle_min:?}, angle_increment={angle_increment:?}")
        }
    };
    format!(
        "LaserScanner({layout}, beam_count={beam_count}, min_range={min_range:?}, max_range={max_range:?}, \
         mount=({mount}))"
    )
}

/// Returns the keyword arguments that make a scanner with these options.
pub fn keywords<'py>(py: Python<'py>, options: &ScannerOptions) -> PyResult<Bound<'py, PyDict>> {
    let &ScannerOptions { layout, beam_count, min_range, max_range, mount } = options;
    let keywords = PyDict::new(py);
    match layout {
        BeamLayout::Fov(fov) => keywords.set_item("fov", fov)?,
        BeamLayout::Ends { angle_min, angle_max } => {
            keywords.set_item("angle_min", angle_min)?;
            keywords.set_item("angle_max", angle_max)?;
        }
        BeamLayout::Steps { angle_min, angle_increment } => {
            keywords.set_item("angle_min", angle_min)?;
            keywords.set_item("angle_increment", angle_increment)?;
        }
    }
    keywords.set_item("beam_count", beam_count)?;
    keywords.set_item("min_range", min_range)?;
    keywords.set_item("max_range", max_range)?;
    keywords.set_item("mount", <(f64, f64, f64, f64, f64, f64)>::from(mount.to_array()))?;
    Ok(keywords)
}
