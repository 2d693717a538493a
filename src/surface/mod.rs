//! Surfaces: what they are made of, and how what a beam meets changes its reading.

mod footprint;
mod material;

use std::f64::consts::FRAC_PI_2;

use crate::beam_model::HitPart;
use crate::error::{Error, check_finite, check_number};
use crate::numeric::elementary::{exp32, ln32};
pub(crate) use footprint::Footprint;
pub use material::{Material, MaterialKind, Materials};

/// Parameters of a [`SurfaceModel`]. By default all is off.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfaceOptions {
    /// Exponent p: σ of a hit is multiplied by `cos(α)^-p` at an incidence α. 0 is off.
    pub incidence_sigma: f64,
    /// Incidence \[rad\] from which on σ and the bias grow no further, 0 to below π/2.
    pub incidence_limit: f64,
    /// Distance by which hits at a grazing incidence lie behind those at a perpendicular one \[m\]: `1 - cos(α)` times this is
    /// added.
    pub incidence_bias: f64,
    /// ρ: part of the variance of a hit that is fixed for each beam and cell, 0 to 1. The rest is drawn for each scan.
    pub correlation: f64,
    /// R \[m\]: distance at which a surface of reflectivity 1, met at a right angle, returns every second beam. 0 is off: all
    /// beams return.
    pub reference_range: f64,
    /// δ \[rad\]: angle over which a beam is spread, 0 to 0.2. 0 is off: a beam has no width.
    pub beam_divergence: f64,
    /// Smallest difference between the ranges of the two surfaces at an edge \[m\]. A beam at a smaller step has the range of its
    /// middle.
    pub edge_depth: f64,
    /// L \[m\]: two returns whose ranges differ by at most this much become one, somewhere between them. 0 is off.
    pub mixing_length: f64,
}

impl Default for SurfaceOptions {
    fn default() -> Self {
        Self {
            incidence_sigma: 0.0,
            incidence_limit: 1.5,
            incidence_bias: 0.0,
            correlation: 0.0,
            reference_range: 0.0,
            beam_divergence: 0.0,
            edge_depth: 0.1,
            mixing_length: 0.75,
        }
    }
}

/// How the surface that a beam meets, and the angle at which it does, change the hit part of a
/// [`BeamModel`](crate::BeamModel).
///
/// The incidence α is the angle between the beam and the normal of the surface, 0 if the beam is perpendicular to it. At an
/// obstacle it is exact. At a blocking cell the normal is that of the [wall](crate::OccupancyGrid::wall_directions) around it,
/// or of the side of the cell where the direction of the wall is unknown.
///
/// ```text
/// σ        becomes σ · cos(α)^-p                          p = incidence_sigma
/// center   becomes center + bias · (1 - cos(α))           bias = incidence_bias
/// normal   √ρ · (fixed number) + √(1 - ρ) · (number of this scan)    ρ = correlation
/// ```
///
/// with α at most `incidence_limit`. p = ½ is the noise of a receiver that counts photons: σ falls with the square root of their
/// number, which is proportional to cos(α) for a matt surface (Lambert). p = 1 is the form of Soudarissanane et al. 2009.
///
/// The fixed number belongs to the seed, the beam and the cell or obstacle that it meets, not to the scan. So a robot that stands
/// sees a constant part of the error, as with a real scanner, and only the rest flickers. The variance is the same for each ρ.
///
/// A beam whose light is too weak has no return. The light that comes back from a matt surface is in proportion to
/// `reflectivity · cos(α) / r²` at the distance r, if the beam is smaller than the surface (the range equation of lidars).
///
/// ```text
/// q                  = r² / (R² · reflectivity · cos(α))      R = reference_range
/// chance of no return = q⁴ / (1 + q⁴)
/// ```
///
/// q is how many times too weak the light is. So the log-odds of a return are 4 times the logarithm of the light. The reflectivity
/// is that of the [`Material`]; on a path through glass and mirrors it is that of the last surface, times the light that is left
/// on the way there and back. A beam without a return reads as one that meets nothing.
///
/// A beam is as wide as its `beam_divergence` δ. If it meets an edge, its light falls on two surfaces and it reads one of them, or
/// a *mixed pixel* between them (Hebert & Krotkov 1992; Tuley, Vandapel & Hebert 2005). It meets an edge if the ranges at its two
/// ends and in its middle differ by more than `edge_depth`, and the three points are not along a straight wall. Then
///
/// ```text
/// u₁, u₂, w       uniform in [0, 1)
/// rᵢ              range in the direction (uᵢ - ½) · δ beside the beam
/// range           r₁ + w · (r₂ - r₁)  if |r₂ - r₁| <= L, else r₁     L = mixing_length
/// ```
///
/// Let the near surface have a share s of the beam. If the surfaces are at most L apart, the beam reads the near one with the
/// probability s², the far one with (1 - s)², and a range between them, uniform, with 2s(1 - s). If they are farther apart, these
/// are s, 1 - s and 0. A part of the beam that meets nothing is a surface without a return. For a scanner with pulses of the
/// length τ, L is cτ / 2, from which on it can tell two returns apart.
///
/// ```
/// use mobile_robot_simulator::{SurfaceModel, SurfaceOptions};
///
/// let model = SurfaceModel::new(SurfaceOptions { incidence_sigma: 0.5, ..SurfaceOptions::default() })?;
/// assert_eq!(model.options().incidence_bias, 0.0);
/// # Ok::<(), mobile_robot_simulator::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfaceModel {
    options: SurfaceOptions,
    /// Cosine of the limit of the incidence.
    least_cos: f64,
    /// √(1 - ρ) and √ρ.
    weights: [f32; 2],
}

impl SurfaceModel {
    /// Returns the model with these parameters.
    ///
    /// # Errors
    /// [`Error::Number`]: `incidence_sigma` is negative or more than 4, `incidence_limit` is not from 0 to below π/2,
    /// `correlation` is not from 0 to 1, `beam_divergence` is not from 0 to 0.2, `reference_range`, `edge_depth` or `mixing_length`
    /// is negative, or a number is not finite.
    pub fn new(options: SurfaceOptions) -> Result<Self, Error> {
        check_number("incidence_sigma", options.incidence_sigma, "in 0..4", |value| (0.0..=4.0).contains(&value))?;
        check_number("incidence_limit", options.incidence_limit, "at least 0 and below π/2", |value| {
            // Nearer to π/2, the cosine is too small to be of use.
            (0.0..FRAC_PI_2 - 1e-6).contains(&value)
        })?;
        check_finite("incidence_bias", options.incidence_bias)?;
        check_number("correlation", options.correlation, "in 0..1", |value| (0.0..=1.0).contains(&value))?;
        check_number("reference_range", options.reference_range, "at least 0", |value| value >= 0.0)?;
        // A wider beam is one in degrees.
        check_number("beam_divergence", options.beam_divergence, "in 0..0.2 rad", |value| (0.0..=0.2).contains(&value))?;
        check_number("edge_depth", options.edge_depth, "at least 0", |value| value >= 0.0)?;
        check_number("mixing_length", options.mixing_length, "at least 0", |value| value >= 0.0)?;
        let weights = [(1.0 - options.correlation).sqrt() as f32, options.correlation.sqrt() as f32];
        Ok(Self { options, least_cos: libm::cos(options.incidence_limit), weights })
    }

    /// Returns the parameters.
    #[must_use]
    pub fn options(&self) -> SurfaceOptions {
        self.options
    }

    /// Returns true if the model changes nothing.
    pub(crate) fn is_off(&self) -> bool {
        let is_still = self.options.correlation == 0.0 && !self.changes_by_incidence();
        is_still && !self.loses_beams() && self.footprint().is_none()
    }

    /// Returns true if hits depend on the incidence.
    pub(crate) fn changes_by_incidence(&self) -> bool {
        self.options.incidence_sigma != 0.0 || self.options.incidence_bias != 0.0
    }

    /// Returns the footprint of the beams; `None` if they have no width.
    pub(crate) fn footprint(&self) -> Option<Footprint> {
        let SurfaceOptions { beam_divergence: divergence, edge_depth, mixing_length, .. } = self.options;
        (divergence > 0.0).then_some(Footprint { divergence, edge_depth, mixing_length })
    }

    /// Returns true if beams may have no return.
    pub(crate) fn loses_beams(&self) -> bool {
        self.options.reference_range > 0.0
    }

    /// Returns true if a beam has no return from a surface at this range \[m\], with this cosine of its incidence, that returns
    /// this share of the light at a right angle. `draw` is a random number in \[0, 1).
    #[inline(always)]
    pub(crate) fn loses(&self, range: f64, cos: f64, share: f64, draw: f64) -> bool {
        let cos = if cos > self.least_cos { cos } else { self.least_cos };
        let ratio = self.options.reference_range / range;
        // 1 / q: q⁴ / (1 + q⁴) = 1 / (1 + light⁴). At a range of 0, inside something, it is infinite.
        let light = ratio * ratio * share * cos;
        draw * (1.0 + (light * light) * (light * light)) < 1.0
    }

    /// Returns the hit part of a beam that meets a surface with this cosine of its incidence.
    #[inline(always)]
    pub(crate) fn hit_part(&self, part: HitPart, cos: f64, max_range: f64) -> HitPart {
        let SurfaceOptions { incidence_sigma, incidence_bias, .. } = self.options;
        let cos = if cos > self.least_cos { cos } else { self.least_cos };
        let center = part.center + incidence_bias * (1.0 - cos);
        let center = if center > 0.0 { center } else { 0.0 };
        let center = if center < max_range { center } else { max_range };
        // cos^-p = exp(-p · ln(cos)), with an exponent that is at least 0 and, at the largest p and limit, below 56.
        let exponent = -(incidence_sigma as f32) * ln32(cos as f32);
        HitPart { center, sigma: part.sigma * f64::from(exp32(if exponent > 0.0 { exponent } else { 0.0 })) }
    }

    /// Returns the weights of the number of a scan and of the fixed number.
    pub(crate) fn weights(&self) -> [f32; 2] {
        self.weights
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sigma_and_center_follow_the_formulas() {
        let options =
            SurfaceOptions { incidence_sigma: 0.5, incidence_bias: 0.04, incidence_limit: 1.2, ..SurfaceOptions::default() };
        let model = SurfaceModel::new(options).unwrap();
        for incidence in [0.0, 0.4, 1.0, 1.2, 1.4, 1.57] {
            let cos = libm::cos(incidence);
            let found = model.hit_part(HitPart { center: 5.0, sigma: 0.02 }, cos, 30.0);
            let limited = libm::cos(f64::min(incidence, 1.2));
            assert!((found.center - (5.0 + 0.04 * (1.0 - limited))).abs() < 1e-12);
            assert!((found.sigma / (0.02 / limited.sqrt()) - 1.0).abs() < 1e-6, "{incidence} {found:?}");
        }
        assert_eq!(model.hit_part(HitPart { center: 29.999, sigma: 0.02 }, 0.0, 30.0).center, 30.0);
        assert!(!model.is_off() && SurfaceModel::new(SurfaceOptions::default()).unwrap().is_off());
    }

    #[test]
    fn beams_are_lost_by_the_formula() {
        let options = SurfaceOptions { reference_range: 20.0, incidence_limit: 1.2, ..SurfaceOptions::default() };
        let model = SurfaceModel::new(options).unwrap();
        assert!(model.loses_beams() && !model.is_off());
        for (range, incidence, share) in
            [(5.0, 0.0, 1.0), (20.0, 0.0, 1.0), (20.0, 1.1, 1.0), (9.0, 1.5, 0.1), (40.0, 0.5, 0.9)]
        {
            let q = range * range / (400.0 * share * libm::cos(f64::min(incidence, 1.2)));
            let chance = libm::pow(q, 4.0) / (1.0 + libm::pow(q, 4.0));
            let loses = |draw| model.loses(range, libm::cos(incidence), share, draw);
            assert!(loses(0.0) && loses(chance * 0.999_999) && !loses(chance * 1.000_001), "{range} {incidence} {share}");
        }
        // Nothing comes back from a black surface, and all from one that the laser touches.
        assert!(model.loses(1.0, 1.0, 0.0, 0.999) && !model.loses(0.0, 1.0, 1.0, 0.0) && !model.loses(0.0, 1.0, 0.0, 0.5));
        assert!(model.loses(1e30, 1.0, 1.0, 0.999) && !model.loses(1e-100, 1.0, 1.0, 1e-15));
    }

    #[test]
    fn bad_parameters_are_named() {
        let error = |options: SurfaceOptions| SurfaceModel::new(options).unwrap_err().to_string();
        let off = SurfaceOptions::default();
        assert_eq!(error(SurfaceOptions { incidence_sigma: -1.0, ..off }), "incidence_sigma must be in 0..4, got -1");
        let text = error(SurfaceOptions { incidence_limit: FRAC_PI_2, ..off });
        assert!(text.starts_with("incidence_limit must be at least 0 and below π/2, got 1.57"), "{text}");
        assert_eq!(error(SurfaceOptions { incidence_bias: f64::NAN, ..off }), "incidence_bias must be finite, got NaN");
        assert_eq!(error(SurfaceOptions { correlation: 1.5, ..off }), "correlation must be in 0..1, got 1.5");
        assert_eq!(error(SurfaceOptions { reference_range: -1.0, ..off }), "reference_range must be at least 0, got -1");
        let text = error(SurfaceOptions { beam_divergence: 0.5, ..off });
        assert_eq!(text, "beam_divergence must be in 0..0.2 rad, got 0.5");
        assert_eq!(error(SurfaceOptions { edge_depth: -1.0, ..off }), "edge_depth must be at least 0, got -1");
        let text = error(SurfaceOptions { mixing_length: f64::INFINITY, ..off });
        assert_eq!(text, "mixing_length must be at least 0, got inf");
    }
}
