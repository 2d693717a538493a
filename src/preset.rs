//! Presets: laser scanners that are sold, with the numbers that their makers or their users published.

use std::f64::consts::TAU;

use crate::beam_model::{BeamModel, BeamModelOptions};
use crate::beams::BeamLayout;
use crate::error::Error;
use crate::scanner::{LaserScanner, ScannerOptions};

/// A laser scanner that is sold.
///
/// Each number has a source; `docs/reference/sensors.md` names it. A number without a source is `None`, and the scanner or the
/// noise then has the default.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Preset {
    /// Name of the preset.
    pub name: &'static str,
    /// Maker and model.
    pub sensor: &'static str,
    /// Field of view \[rad\].
    pub fov: f64,
    /// Number of beams.
    pub beam_count: usize,
    /// Smallest valid range \[m\].
    pub min_range: Option<f64>,
    /// Largest range \[m\].
    pub max_range: Option<f64>,
    /// Rate of the scans \[Hz\].
    pub frequency: f64,
    /// Smallest standard deviation of a range \[m\].
    pub sigma_hit: Option<f64>,
    /// The standard deviation of a range r is at least the first number \[m\] plus the second times r.
    pub range_sigma: Option<(f64, f64)>,
    /// Largest share of a reading that its step may be.
    pub range_step_share: Option<f64>,
}

/// A preset about which only the geometry and the rate are known.
const GEOMETRY: Preset = Preset {
    name: "",
    sensor: "",
    fov: TAU,
    beam_count: 360,
    min_range: None,
    max_range: None,
    frequency: 10.0,
    sigma_hit: None,
    range_sigma: None,
    range_step_share: None,
};

/// 270°, the field of many scanners \[rad\].
const THREE_QUARTERS: f64 = 0.75 * TAU;

impl Preset {
    /// All presets, sorted by name.
    pub const ALL: &'static [Self] = &[
        Self {
            name: "hokuyo_urg04lx",
            sensor: "Hokuyo URG-04LX",
            // Steps 44 to 725 of 1024 in a turn.
            fov: 681.0 / 1024.0 * TAU,
            beam_count: 682,
            min_range: Some(0.02),
            max_range: Some(5.6),
            frequency: 10.0,
            sigma_hit: Some(0.028),
            range_sigma: Some((0.0001, 0.0013)),
            ..GEOMETRY
        },
        Self {
            name: "hokuyo_utm30lx",
            sensor: "Hokuyo UTM-30LX",
            fov: THREE_QUARTERS,
            beam_count: 1081,
            min_range: Some(0.1),
            max_range: Some(30.0),
            frequency: 40.0,
            sigma_hit: Some(0.018),
            range_sigma: Some((0.0015, 0.0006)),
            ..GEOMETRY
        },
        Self {
            name: "robotis_lds01",
            sensor: "ROBOTIS LDS-01 (Hitachi-LG HLS-LFCD2)",
            beam_count: 360,
            min_range: Some(0.12),
            max_range: Some(3.5),
            frequency: 5.0,
            sigma_hit: Some(0.01 / 3.0),
            range_sigma: Some((0.0, 0.035 / 3.0)),
            ..GEOMETRY
        },
        Self {
            name: "robotis_lds02",
            sensor: "ROBOTIS LDS-02",
            beam_count: 360,
            min_range: Some(0.16),
            max_range: Some(8.0),
            frequency: 5.0,
            sigma_hit: Some(0.01 / 3.0),
            range_sigma: Some((0.0, 0.03 / 3.0)),
            ..GEOMETRY
        },
        Self {
            name: "sick_s300",
            sensor: "SICK S300",
            fov: THREE_QUARTERS,
            beam_count: 541,
            min_range: Some(0.1),
            max_range: Some(30.0),
            frequency: 25.0,
            sigma_hit: Some(0.03),
            ..GEOMETRY
        },
        Self {
            name: "sick_tim561",
            sensor: "SICK TiM561",
            fov: THREE_QUARTERS,
            beam_count: 811,
            min_range: Some(0.05),
            max_range: Some(10.0),
            frequency: 15.0,
            sigma_hit: Some(0.02),
            ..GEOMETRY
        },
        Self {
            name: "sick_tim571",
            sensor: "SICK TiM571",
            fov: THREE_QUARTERS,
            beam_count: 811,
            min_range: Some(0.05),
            max_range: Some(25.0),
            frequency: 15.0,
            ..GEOMETRY
        },
        Self {
            name: "slamtec_rplidar_a1m8",
            sensor: "Slamtec RPLIDAR A1M8",
            beam_count: 360,
            min_range: Some(0.15),
            max_range: Some(12.0),
            frequency: 5.5,
            range_step_share: Some(0.01),
            ..GEOMETRY
        },
        Self {
            name: "slamtec_rplidar_a2m8",
            sensor: "Slamtec RPLIDAR A2M8",
            beam_count: 800,
            max_range: Some(12.0),
            frequency: 10.0,
            ..GEOMETRY
        },
    ];

    /// Returns the preset with this name.
    ///
    /// # Errors
    /// [`Error::Name`]: there is none.
    pub fn named(name: &str) -> Result<&'static Self, Error> {
        let found = Self::ALL.iter().find(|preset| preset.name == name);
        let known = || Self::ALL.iter().map(|preset| preset.name).collect();
        found.ok_or_else(|| Error::unknown("the preset", name, known()))
    }

    /// Returns the options of the scanner, at the origin of the robot's frame.
    #[must_use]
    pub fn scanner_options(&self) -> ScannerOptions {
        let default = ScannerOptions::default();
        ScannerOptions {
            layout: BeamLayout::Fov(self.fov),
            beam_count: self.beam_count,
            min_range: self.min_range.unwrap_or(default.min_range),
            max_range: self.max_range.unwrap_or(default.max_range),
            ..default
        }
    }

    /// Returns the options of the noise of the ranges.
    #[must_use]
    pub fn noise_options(&self) -> BeamModelOptions {
        let default = BeamModelOptions::default();
        let (range_sigma_base, range_sigma_per_metre) =
            self.range_sigma.unwrap_or((default.range_sigma_base, default.range_sigma_per_metre));
        BeamModelOptions {
            sigma_hit: self.sigma_hit.unwrap_or(default.sigma_hit),
            range_sigma_base,
            range_sigma_per_metre,
            range_step_share: self.range_step_share.unwrap_or(default.range_step_share),
            ..default
        }
    }
}

impl LaserScanner {
    /// Returns the scanner of the [`Preset`] with this name, at the origin of the robot's frame.
    ///
    /// # Errors
    /// [`Error::Name`]: there is none.
    pub fn preset(name: &str) -> Result<Self, Error> {
        Self::new(Preset::named(name)?.scanner_options())
    }
}

impl BeamModel {
    /// Returns the noise of the [`Preset`] with this name.
    ///
    /// # Errors
    /// [`Error::Name`]: there is none.
    pub fn preset(name: &str) -> Result<Self, Error> {
        Self::new(Preset::named(name)?.noise_options())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_presets_are_valid_and_sorted_by_name() {
        for preset in Preset::ALL {
            let scanner = LaserScanner::preset(preset.name).expect("a valid scanner");
            assert_eq!(scanner.options().beam_count, preset.beam_count);
            BeamModel::preset(preset.name).expect("a valid noise model");
        }
        assert!(Preset::ALL.is_sorted_by(|a, b| a.name < b.name));
    }

    #[test]
    fn beams_are_as_far_apart_as_in_the_data_sheets() {
        let step = |name| LaserScanner::preset(name).expect("a preset").angle_increment().to_degrees();
        for (name, degrees) in [
            ("hokuyo_urg04lx", 360.0 / 1024.0),
            ("hokuyo_utm30lx", 0.25),
            ("robotis_lds01", 1.0),
            ("robotis_lds02", 1.0),
            ("sick_s300", 0.5),
            ("sick_tim561", 1.0 / 3.0),
            ("sick_tim571", 1.0 / 3.0),
            ("slamtec_rplidar_a1m8", 1.0),
            ("slamtec_rplidar_a2m8", 0.45),
        ] {
            assert!((step(name) - degrees).abs() < 1e-9, "{name}: {}", step(name));
        }
    }

    #[test]
    fn unknown_names_are_rejected() {
        let error = LaserScanner::preset("hokuyo").expect_err("no such preset").to_string();
        assert!(error.starts_with("the preset must be one of hokuyo_urg04lx, hokuyo_utm30lx,"), "{error}");
        assert!(error.ends_with("got \"hokuyo\""), "{error}");
    }
}
