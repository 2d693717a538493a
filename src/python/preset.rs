//! The Python function `laser_presets`.

use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::Preset;

/// Returns the parameters of laser scanners that are sold, as their makers or their users published them.
///
/// `docs/reference/sensors.md` gives the source of each number. A parameter without a source is missing.
///
/// Returns:
///     Parameters of the laser node by name, for each preset by name.
///
/// Examples:
///     >>> import mobile_robot_simulator as mrs
///     >>> sensor = mrs.laser_presets().get("hokuyo_utm30lx")
///     >>> sensor.get("laser_beam_count")
///     1081
#[pyfunction]
pub fn laser_presets(py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
    let presets = PyDict::new(py);
    for preset in Preset::ALL {
        let parameters = PyDict::new(py);
        parameters.set_item("laser_fov", preset.fov)?;
        parameters.set_item("laser_beam_count", preset.beam_count)?;
        parameters.set_item("laser_frequency", preset.frequency)?;
        let optional = [
            ("laser_min_range", preset.min_range),
            ("laser_max_range", preset.max_range),
            ("sigma_hit", preset.sigma_hit),
            ("range_sigma_base", preset.range_sigma.map(|(base, _)| base)),
            ("range_sigma_per_metre", preset.range_sigma.map(|(_, per_metre)| per_metre)),
            ("range_step_share", preset.range_step_share),
        ];
        for (name, number) in optional {
            if let Some(number) = number {
                parameters.set_item(name, number)?;
            }
        }
        presets.set_item(preset.name, parameters)?;
    }
    Ok(presets)
}
