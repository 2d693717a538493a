//! The beam model of a range finder (Thrun, Burgard & Fox, *Probabilistic Robotics*, 2006, sec. 6.3, table 6.1).

mod rounding;
mod sampler;

use rounding::Rounding;
pub(crate) use sampler::HitColumns;
pub use sampler::Sampler;

use crate::error::{Error, check_finite, check_number};
use crate::memory;
use crate::numeric::normal;

/// Parameters of a [`BeamModel`], with the defaults of a SICK S300.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BeamModelOptions {
    /// σ: standard deviation of the hit part \[m\].
    pub sigma_hit: f64,
    /// λ: decay rate of the short part \[1/m\].
    pub lambda_short: f64,
    /// Weight of the hit part: the true range with Gaussian noise.
    pub z_hit: f64,
    /// Weight of the short part: readings of unexpected objects in front of the true range.
    pub z_short: f64,
    /// Weight of the max part: failed measurements that read the maximum range.
    pub z_max: f64,
    /// Weight of the random part: unexplained readings, uniform in \[0, maximum range).
    pub z_rand: f64,
    /// Distance by which hits lie behind the true range `z*` \[m\]. The sum is kept from 0 to the maximum range.
    pub range_offset: f64,
    /// σ of a hit is at least `range_sigma_base + range_sigma_per_metre · z*` \[m\].
    pub range_sigma_base: f64,
    /// Growth of that σ with the true range \[m/m\].
    pub range_sigma_per_metre: f64,
    /// Smallest step between readings \[m\]; 0 for none.
    pub range_step: f64,
    /// Largest share of a reading that its step may be, if that is more than `range_step`; 0 for none.
    pub range_step_share: f64,
}

impl Default for BeamModelOptions {
    fn default() -> Self {
        Self {
            sigma_hit: 0.005,
            lambda_short: 2.0,
            z_hit: 0.995,
            z_short: 0.0,
            z_max: 0.005,
            z_rand: 0.0,
            range_offset: 0.0,
            range_sigma_base: 0.0,
            range_sigma_per_metre: 0.0,
            range_step: 0.0,
            range_step_share: 0.0,
        }
    }
}

/// Distribution of the reading `z` of a beam, given its true range `z*`: a mixture of hit, short, max and random readings.
///
/// | part | weight | distribution of the reading `z` |
/// |---|---|---|
/// | hit | `z_hit` | normal(`z*`, σ), truncated to \[0, `max_range`\] |
/// | short | `z_short` | exponential with rate λ, truncated to \[0, `z*`\] |
/// | max | `z_max` | always `max_range` |
/// | random | `z_rand` | uniform in \[0, `max_range`) |
///
/// The weights sum to 1 and each part is normalised over its interval. A beam without a return has `z* = max_range`: its hit
/// part always reads `max_range`, without noise; the other parts stay as they are.
///
/// Three options, all off by default, make the model that of a real scanner:
///
/// - The hit part is normal(`z* + range_offset`, σ), with
///   `σ = max(sigma_hit, range_sigma_base + range_sigma_per_metre · z*)`. This is the form of libpointmatcher's
///   `SimpleSensorNoiseDataPointsFilter`, with the constants of Pomerleau et al., *Noise characterization of depth sensors
///   for surface inspections* (2012).
/// - Readings below `max_range` are rounded to the nearest multiple of a step: `range_step`, doubled as often as it is at most
///   `1 / n` of the reading, where `n` is `1 / range_step_share`, rounded up. Without `range_step`, steps are powers of two of
///   1 m. A reading that would become `max_range` becomes the largest multiple below.
///
/// ```
/// use mobile_robot_simulator::{BeamModel, BeamModelOptions};
///
/// // One reading in four is a failure, the others are uniform; the weights are scaled to sum to 1.
/// let options = BeamModelOptions { z_hit: 0.0, z_short: 0.0, z_max: 1.0, z_rand: 3.0, ..BeamModelOptions::default() };
/// let model = BeamModel::new(options)?;
/// assert_eq!(model.options().z_rand, 0.75);
/// assert_eq!(model.likelihood(2.0, Some(5.0), (0.0, 10.0)), 0.075); // density: 0.75 / 10 m
/// assert_eq!(model.likelihood(10.0, Some(5.0), (0.0, 10.0)), 0.25); // probability of max_range
/// # Ok::<(), mobile_robot_simulator::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BeamModel {
    options: BeamModelOptions,
    /// A number in [0, 1) chooses the part of a reading: hit below the first of these, then short, then max, else random.
    part_ends: [f64; 3],
    /// True if the hit part is normal(z*, `sigma_hit`) for every true range, and readings are not rounded.
    has_one_hit_part: bool,
    rounding: Option<Rounding>,
}

/// A normal distribution of hits, before it is truncated.
#[derive(Debug, Clone, Copy)]
pub(crate) struct HitPart {
    /// Mean \[m\].
    pub center: f64,
    /// Standard deviation \[m\].
    pub sigma: f64,
}

impl BeamModel {
    /// Returns the model with these parameters, its weights scaled to sum to 1.
    ///
    /// # Errors
    /// - [`Error::Number`]: σ or λ is not positive, a weight or another number but `range_offset` is negative,
    ///   `range_step_share` is more than ½, or a value is not finite.
    /// - [`Error::Weights`]: no weight is positive.
    pub fn new(options: BeamModelOptions) -> Result<Self, Error> {
        check_number("sigma_hit", options.sigma_hit, "positive", |value| value > 0.0)?;
        check_number("lambda_short", options.lambda_short, "positive", |value| value > 0.0)?;
        let BeamModelOptions { z_hit, z_short, z_max, z_rand, .. } = options;
        for (name, weight) in [("z_hit", z_hit), ("z_short", z_short), ("z_max", z_max), ("z_rand", z_rand)] {
            check_number(name, weight, "at least 0", |value| value >= 0.0)?;
        }
        let sum = z_hit + z_short + z_max + z_rand;
        if sum <= 0.0 {
            return Err(Error::Weights([z_hit, z_short, z_max, z_rand]));
        }
        check_finite("the sum of the weights", sum)?;
        check_finite("range_offset", options.range_offset)?;
        check_number("range_sigma_base", options.range_sigma_base, "at least 0", |value| value >= 0.0)?;
        check_number("range_sigma_per_metre", options.range_sigma_per_metre, "at least 0", |value| value >= 0.0)?;
        check_number("range_step", options.range_step, "at least 0", |value| value >= 0.0)?;
        check_number("range_step_share", options.range_step_share, "in 0..0.5", |value| (0.0..=0.5).contains(&value))?;
        // Weights that sum to 1 up to rounding stay unchanged, so that a model made from `options()` equals the original.
        let sum = if (sum - 1.0).abs() < 1e-14 { 1.0 } else { sum };
        let options = BeamModelOptions {
            z_hit: z_hit / sum,
            z_short: z_short / sum,
            z_max: z_max / sum,
            z_rand: z_rand / sum,
            ..options
        };
        // If all later weights are 0, the part ends at exactly 1: rounding must not leave a gap for them.
        let end_of_part = |later: &[f64], end: f64| if later.iter().all(|&weight| weight == 0.0) { 1.0 } else { end };
        let hit = end_of_part(&[z_short, z_max, z_rand], options.z_hit);
        let short = end_of_part(&[z_max, z_rand], options.z_hit + options.z_short);
        let max = end_of_part(&[z_rand], options.z_hit + options.z_short + options.z_max);
        let rounding = Rounding::new(options.range_step, options.range_step_share);
        let has_one_sigma = options.range_sigma_base <= options.sigma_hit && options.range_sigma_per_metre == 0.0;
        let has_one_hit_part = has_one_sigma && options.range_offset == 0.0 && rounding.is_none();
        Ok(Self { options, part_ends: [hit, short, max], has_one_hit_part, rounding })
    }

    /// Returns the distribution of the hits of a beam with this true range \[m\].
    #[inline(always)]
    pub(crate) fn hit_part(&self, range: f64, max_range: f64) -> HitPart {
        let BeamModelOptions { sigma_hit, range_offset, range_sigma_base, range_sigma_per_metre, .. } = self.options;
        let center = range + range_offset;
        let center = if center > 0.0 { center } else { 0.0 };
        let center = if center < max_range || range_offset == 0.0 { center } else { max_range };
        let sigma = range_sigma_base + range_sigma_per_metre * range;
        HitPart { center, sigma: if sigma > sigma_hit { sigma } else { sigma_hit } }
    }

    /// Returns true if the hit part has the true range as its center and one σ for all true ranges, and readings are not rounded.
    pub(crate) fn has_one_hit_part(&self) -> bool {
        self.has_one_hit_part
    }

    /// Returns true if readings are rounded.
    pub(crate) fn rounds(&self) -> bool {
        self.rounding.is_some()
    }

    /// Returns the parameters, with weights that sum to 1.
    #[must_use]
    pub fn options(&self) -> BeamModelOptions {
        self.options
    }

    /// Returns the probability density \[1/m\] of a reading, or its probability where readings have one.
    ///
    /// This is the distribution that [`sample`](Self::sample) draws from, with its readings marked as in messages
    /// ([`mark_invalid`](crate::LaserScanner::mark_invalid)). `hit` is the true range `z*` \[m\], `None` for a beam without a
    /// return. With `z` for the reading:
    ///
    /// | reading | likelihood |
    /// |---|---|
    /// | `z >= max_range`, infinite too | probability of `max_range`: `z_max`, plus `z_hit` for a beam without a return |
    /// | `z < min_range`, minus infinity too | probability of a reading below `min_range` |
    /// | `z = z* = 0` with `z_short > 0` | `z_short`: short readings in front of the laser itself are all 0 |
    /// | any other number | sum of the hit, short and random densities below |
    /// | NaN | 1, so that it does not count in a product |
    ///
    /// ```text
    /// hit     z_hit · φ((z - c) / σ) / σ / (Φ((max_range - c) / σ) - Φ(-c / σ))    c = z* + range_offset; no return: 0
    /// short   z_short · λ · exp(-λz) / (1 - exp(-λz*))    if 0 < z* and z <= z*, else 0; no return: z* = max_range
    /// random  z_rand / max_range
    /// ```
    ///
    /// So the integral of the density from `min_range` to `max_range` and the probabilities together are 1.
    ///
    /// If readings are rounded, the density is the mean over all readings that are rounded to the same multiple as `z`, and the
    /// probability of a reading below `min_range` is that of a multiple below it.
    ///
    /// Source: table 6.1 of the book, with both truncated parts normalised.
    #[must_use]
    pub fn likelihood(&self, reading: f64, hit: Option<f64>, (min_range, max_range): (f64, f64)) -> f64 {
        let options = &self.options;
        if reading.is_nan() {
            return 1.0;
        }
        if reading >= max_range {
            return options.z_max + if hit.is_none() { options.z_hit } else { 0.0 };
        }
        if reading < min_range.max(0.0) {
            return self.mass_below(min_range, hit, max_range);
        }
        if let Some(rounding) = &self.rounding {
            let (low, high) = rounding.interval(reading, max_range);
            return self.mass_between(low, high, hit, max_range) / (high - low);
        }
        let range = hit.unwrap_or(max_range);
        if range == 0.0 && reading == 0.0 && options.z_short > 0.0 {
            return options.z_short;
        }
        let mut density = options.z_rand / max_range;
        if let Some(range) = hit {
            let part = self.hit_part(range, max_range);
            let deviation = (reading - part.center) / part.sigma;
            density += options.z_hit * normal::density(deviation) / (part.sigma * part.mass(max_range));
        }
        if reading <= range && range > 0.0 {
            let lambda = options.lambda_short;
            density += options.z_short * lambda * libm::exp(-lambda * reading) / -libm::expm1(-lambda * range);
        }
        density
    }

    /// Returns the probability of a reading below `limit` \[m\], which is at most `max_range`.
    fn mass_below(&self, limit: f64, hit: Option<f64>, max_range: f64) -> f64 {
        if limit <= 0.0 {
            return 0.0;
        }
        let options = &self.options;
        let limit = self.rounding.map_or(limit, |rounding| rounding.end_below(limit, max_range));
        let range = hit.unwrap_or(max_range);
        let hit = hit.map_or(0.0, |range| {
            let HitPart { center, sigma } = self.hit_part(range, max_range);
            let below = normal::mass_around_mean(center / sigma, (limit - center) / sigma);
            below / HitPart { center, sigma }.mass(max_range)
        });
        let exponent = options.lambda_short * range;
        let share = (limit / range).min(1.0);
        // The limit for λ·z* → 0 is that of the uniform distribution. All short readings of a true range of 0 are 0.
        let short = if limit >= range {
            1.0
        } else if exponent < 1e-9 {
            share
        } else {
            libm::expm1(-exponent * share) / libm::expm1(-exponent)
        };
        options.z_hit * hit + options.z_short * short + options.z_rand * (limit / max_range)
    }

    /// Returns the probability of a reading from `low` to `high` \[m\] before it is rounded, without cancellation.
    fn mass_between(&self, low: f64, high: f64, hit: Option<f64>, max_range: f64) -> f64 {
        let options = &self.options;
        let range = hit.unwrap_or(max_range);
        let hit = hit.map_or(0.0, |range| {
            let part = self.hit_part(range, max_range);
            let mass = normal::mass_between((low - part.center) / part.sigma, (high - part.center) / part.sigma);
            mass / part.mass(max_range)
        });
        let exponent = options.lambda_short * range;
        let end = high.min(range);
        let short = if range == 0.0 {
            if low == 0.0 { 1.0 } else { 0.0 }
        } else if low >= range {
            0.0
        } else if exponent < 1e-9 {
            (end - low) / range
        } else {
            let decay = libm::exp(-options.lambda_short * low);
            decay * libm::expm1(-options.lambda_short * (end - low)) / libm::expm1(-exponent)
        };
        options.z_hit * hit + options.z_short * short + options.z_rand * ((high - low) / max_range)
    }

    /// Returns the [`likelihood`](Self::likelihood) of each reading, given the true range at the same position in `ranges`.
    ///
    /// A true range of `max_range` or more means no return. If the lengths differ, the extra elements of the longer are
    /// ignored.
    ///
    /// # Errors
    /// [`Error::Number`] if `max_range` is not positive and finite, `min_range` is negative or not below `max_range`, or a true
    /// range is negative or NaN.
    pub fn likelihoods(
        &self,
        readings: impl IntoIterator<Item = f32>,
        ranges: impl IntoIterator<Item = f32>,
        (min_range, max_range): (f64, f64),
    ) -> Result<Vec<f64>, Error> {
        check_number("max_range", max_range, "positive", |value| value > 0.0)?;
        check_number("min_range", min_range, "at least 0 and below max_range", |min| (0.0..max_range).contains(&min))?;
        // Readings and ranges are float32, so the limits must be rounded the same way to compare equal.
        let limits = (f64::from(min_range as f32), f64::from(max_range as f32));
        let each = |(reading, range): (f32, f32)| {
            let range = f64::from(range);
            if range.is_nan() || range < 0.0 {
                return Err(Error::Number { name: "true_ranges", value: range, needed: "at least 0" });
            }
            Ok(self.likelihood(reading.into(), (range < limits.1).then_some(range), limits))
        };
        let pairs = readings.into_iter().zip(ranges);
        let mut likelihoods = memory::with_room("the likelihoods", pairs.size_hint().0)?;
        for pair in pairs {
            memory::push("the likelihoods", &mut likelihoods, each(pair)?)?;
        }
        Ok(likelihoods)
    }
}

impl HitPart {
    /// Returns the mass of the distribution in `[0, max_range]`.
    pub fn mass(self, max_range: f64) -> f64 {
        normal::mass_around_mean(self.center / self.sigma, (max_range - self.center) / self.sigma)
    }
}
