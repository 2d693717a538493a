//! The beam model of a range finder (Thrun, Burgard & Fox, *Probabilistic Robotics*, 2006, sec. 6.3, table 6.1).

use rand::{Rng, RngExt};

use crate::error::{Error, check_finite, check_number};
use crate::memory;
use crate::numeric::{GROUP, normal};
use crate::random::BeamBits;

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
}

impl Default for BeamModelOptions {
    fn default() -> Self {
        Self { sigma_hit: 0.005, lambda_short: 2.0, z_hit: 0.995, z_short: 0.0, z_max: 0.005, z_rand: 0.0 }
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
}

impl BeamModel {
    /// Returns the model with these parameters, its weights scaled to sum to 1.
    ///
    /// # Errors
    /// - [`Error::Number`]: σ or λ is not positive, a weight is negative, or a value is not finite.
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
        Ok(Self { options, part_ends: [hit, short, max] })
    }

    /// Returns the parameters, with weights that sum to 1.
    #[must_use]
    pub fn options(&self) -> BeamModelOptions {
        self.options
    }

    /// Draws the readings \[m\] of the beams of one scan, given their true ranges \[m\].
    ///
    /// `ranges[i]` is the true range of beam `i`, infinite if the beam has no return within `max_range`. Its reading is
    /// written to `readings[i]`. Reading `i` depends only on `ranges[i]`, `max_range`, i and the name `(seed, index)` of the
    /// scan.
    ///
    /// ```
    /// use mobile_robot_simulator::{BeamModel, BeamModelOptions};
    ///
    /// let options = BeamModelOptions { sigma_hit: 0.01, z_hit: 1.0, z_max: 0.0, ..BeamModelOptions::default() };
    /// let mut readings = [0.0; 2];
    /// BeamModel::new(options)?.sample(&[5.0, f64::INFINITY], 30.0, (1, 0), &mut readings);
    /// assert!((readings[0] - 5.0).abs() < 0.1); // within ten standard deviations
    /// assert_eq!(readings[1], 30.0); // no return
    /// # Ok::<(), mobile_robot_simulator::Error>(())
    /// ```
    ///
    /// # Panics
    /// If `ranges` and `readings` have different lengths.
    pub fn sample(&self, ranges: &[f64], max_range: f64, (seed, index): (u64, u64), readings: &mut [f64]) {
        assert_eq!(ranges.len(), readings.len(), "ranges and readings must have the same length");
        let sampler = Sampler::new(self, max_range, BeamBits::new(seed, index));
        let (groups, rest) = ranges.as_chunks::<GROUP>();
        let padded = std::array::from_fn(|lane| rest.get(lane).copied().unwrap_or(f64::INFINITY));
        for (group, (ranges, readings)) in groups.iter().chain([&padded]).zip(readings.chunks_mut(GROUP)).enumerate() {
            readings.copy_from_slice(&sampler.sample(group, ranges)[..readings.len()]);
        }
    }

    /// Draws from the normal distribution around `range`, truncated to `[0, max_range]`, by rejection.
    fn sample_hit(&self, range: f64, max_range: f64, stream: &mut impl Rng) -> f64 {
        let sigma = self.options.sigma_hit;
        if self.is_narrow(max_range) {
            loop {
                let reading = range + sigma * normal::sample(stream);
                if (0.0..=max_range).contains(&reading) {
                    return reading;
                }
            }
        }
        loop {
            // Here σ > max_range, so the density is at least exp(-1/2) of its peak in the interval: few draws are rejected.
            let reading = stream.random::<f64>() * max_range;
            let deviation = (reading - range) / sigma;
            if stream.random::<f64>() < libm::exp(-0.5 * deviation * deviation) {
                return reading;
            }
        }
    }

    /// Returns true if σ is at most `max_range`: at least a third of the normal distribution then lies in `[0, max_range]`.
    fn is_narrow(&self, max_range: f64) -> bool {
        self.options.sigma_hit <= max_range
    }

    /// Draws from the exponential distribution truncated to `[0, range]`, by its inverse distribution function.
    fn sample_short(&self, range: f64, stream: &mut impl Rng) -> f64 {
        let uniform = stream.random::<f64>();
        let exponent = self.options.lambda_short * range;
        if exponent < 1e-9 {
            // The limit for λ·z* → 0, the uniform distribution; its relative error is below 1e-9.
            return uniform * range;
        }
        (-libm::log1p(uniform * libm::expm1(-exponent)) / self.options.lambda_short).min(range)
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
    /// hit     z_hit · φ((z - z*) / σ) / σ / (Φ((max_range - z*) / σ) - Φ(-z* / σ))    no return: 0
    /// short   z_short · λ · exp(-λz) / (1 - exp(-λz*))    if 0 < z* and z <= z*, else 0; no return: z* = max_range
    /// random  z_rand / max_range
    /// ```
    ///
    /// So the integral of the density from `min_range` to `max_range` and the probabilities together are 1.
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
        let range = hit.unwrap_or(max_range);
        if range == 0.0 && reading == 0.0 && options.z_short > 0.0 {
            return options.z_short;
        }
        let mut density = options.z_rand / max_range;
        if let Some(range) = hit {
            let deviation = (reading - range) / options.sigma_hit;
            density += options.z_hit * normal::density(deviation) / (options.sigma_hit * self.hit_mass(range, max_range));
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
        let range = hit.unwrap_or(max_range);
        let hit = hit.map_or(0.0, |range| {
            let below = normal::mass_around_mean(range / options.sigma_hit, (limit - range) / options.sigma_hit);
            below / self.hit_mass(range, max_range)
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

    /// Returns the mass of the untruncated hit part in `[0, max_range]`.
    fn hit_mass(&self, range: f64, max_range: f64) -> f64 {
        normal::mass_around_mean(range / self.options.sigma_hit, (max_range - range) / self.options.sigma_hit)
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

/// Draws the readings of one scan from a beam model.
///
/// Each beam has 64 random bits:
///
/// ```text
///  63            32 31      30 29      24 23                        0
/// +----------------+----------+----------+---------------------------+
/// |     normal     | quadrant |  unused  | choice: part of the model |
/// +----------------+----------+----------+---------------------------+
/// ```
///
/// Beams `i` and `i + GROUP / 2` of a group share one pair of normal numbers: it is made of the 32 `normal` bits of both
/// beams and the 2 `quadrant` bits of beam `i`. These bits decide nearly every reading. The others (a short or random
/// reading, a hit that has to be drawn again, a choice on the boundary between two parts) are drawn from a separate stream
/// for the beam.
#[derive(Debug, Clone, Copy)]
pub struct Sampler<'a> {
    model: &'a BeamModel,
    max_range: f64,
    bits: BeamBits,
    /// Choices below this are hits, regardless of the remaining bits.
    hit_choices_end: u32,
    /// Choices from the first (inclusive) to the second (exclusive) are max readings, regardless of the remaining bits.
    max_choices: [u32; 2],
}

// `sample` marks the undecided beams of a group in a u32, and draws normal numbers in pairs.
const _: () = assert!(GROUP <= 32 && GROUP.is_multiple_of(2));

/// Number of bits that choose a part of the model.
const CHOICE_BITS: u32 = 24;

impl<'a> Sampler<'a> {
    /// Returns the sampler for the scan with these random bits.
    #[must_use]
    pub fn new(model: &'a BeamModel, max_range: f64, bits: BeamBits) -> Self {
        let [hit_end, short_end, max_end] = model.part_ends.map(|end| end * f64::from(1u32 << CHOICE_BITS));
        let hit_choices_end = if model.is_narrow(max_range) { hit_end as u32 } else { 0 };
        Self { model, max_range, bits, hit_choices_end, max_choices: [short_end.ceil() as u32, max_end as u32] }
    }

    /// Returns the readings \[m\] of a group of beams, given their true ranges \[m\]: infinite for a beam without a return.
    ///
    /// Group `g` holds the beams from `g · GROUP` on.
    #[inline(always)]
    #[must_use]
    pub fn sample(&self, group: usize, ranges: &[f64; GROUP]) -> [f64; GROUP] {
        const HALF: usize = GROUP / 2;
        let first = (group * GROUP) as u64;
        let (mut low, mut high, mut normals) = ([0; GROUP], [0; GROUP], [[0.0; HALF]; 2]);
        for lane in 0..GROUP {
            let bits = self.bits.of(first + lane as u64);
            (low[lane], high[lane]) = (bits as u32, (bits >> 32) as u32);
        }
        for lane in 0..HALF {
            (normals[0][lane], normals[1][lane]) = normal::pair([high[lane], high[lane + HALF]], low[lane]);
        }
        let normals = normals.as_flattened();
        let (mut readings, mut all_decided) = ([0.0; GROUP], true);
        for lane in 0..GROUP {
            let (reading, is_decided) = self.reading_from_bits(ranges[lane], low[lane], normals[lane]);
            readings[lane] = reading;
            all_decided &= is_decided;
        }
        if !all_decided {
            let is_undecided = |lane: usize| !self.reading_from_bits(ranges[lane], low[lane], normals[lane]).1;
            let mut undecided: u32 = (0..GROUP).map(|lane| u32::from(is_undecided(lane)) << lane).sum();
            while undecided != 0 {
                let lane = undecided.trailing_zeros() as usize;
                undecided &= undecided - 1;
                readings[lane] = self.reading_from_stream(first + lane as u64, ranges[lane]);
            }
        }
        readings
    }

    /// Returns the reading that the random bits give without the beam's stream, and whether they decide it. If not, the
    /// reading is meaningless.
    #[inline(always)]
    fn reading_from_bits(&self, range: f64, low: u32, normal: f32) -> (f64, bool) {
        let reading = range + self.model.options.sigma_hit * f64::from(normal);
        let (no_return, choice) = (range == f64::INFINITY, choice(low));
        let is_max = (choice >= self.max_choices[0]) & (choice < self.max_choices[1]);
        let fits = (reading >= 0.0) & (reading <= self.max_range);
        let is_decided = (choice < self.hit_choices_end) & (fits | no_return) | is_max;
        (if no_return | is_max { self.max_range } else { reading }, is_decided)
    }

    /// Returns a reading drawn from the beam's own stream, for any part of the model.
    #[cold]
    fn reading_from_stream(&self, beam: u64, range: f64) -> f64 {
        let Self { model, max_range, .. } = *self;
        let (bits, mut stream) = (self.bits.of(beam), self.bits.stream(beam));
        let is_hit = range < f64::INFINITY;
        // The 24 bits of the choice are the leading digits of a number in [0, 1); the stream gives the others.
        let part = (f64::from(choice(bits as u32)) + stream.random::<f64>()) / f64::from(1u32 << CHOICE_BITS);
        let part = part.min(1.0 - f64::EPSILON);
        let [hit_end, short_end, max_end] = model.part_ends;
        if part < hit_end {
            if is_hit { model.sample_hit(range, max_range, &mut stream) } else { max_range }
        } else if part < short_end {
            model.sample_short(if is_hit { range } else { max_range }, &mut stream)
        } else if part < max_end {
            max_range
        } else {
            stream.random::<f64>() * max_range
        }
    }
}

/// Returns the bits that choose a part of the model.
#[inline(always)]
fn choice(bits: u32) -> u32 {
    bits & ((1 << CHOICE_BITS) - 1)
}
