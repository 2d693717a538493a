//! The beam model of a range finder: Thrun, Burgard & Fox, *Probabilistic Robotics* (2006), ch. 6.3, table 6.1.

pub(crate) mod normal;

use rand::{Rng, RngExt};

use crate::error::{Error, check_number};
use crate::random::BeamBits;
use crate::raycast::GROUP;

/// Parameters of a [`BeamModel`], with the defaults of a SICK S300.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BeamModelOptions {
    /// Standard deviation of a measured range \[m\].
    pub sigma_hit: f64,
    /// Rate of unexpected objects \[1/m\].
    pub lambda_short: f64,
    /// Weight of correct ranges with local noise.
    pub z_hit: f64,
    /// Weight of unexpected objects.
    pub z_short: f64,
    /// Weight of failures: readings of the maximum range.
    pub z_max: f64,
    /// Weight of unexplained readings, uniform up to the maximum range.
    pub z_rand: f64,
}

impl Default for BeamModelOptions {
    fn default() -> Self {
        Self { sigma_hit: 0.005, lambda_short: 2.0, z_hit: 0.995, z_short: 0.0, z_max: 0.005, z_rand: 0.0 }
    }
}

/// What a range finder reads, given the true range: a mixture of hit, short, max and random readings, properly normalised.
///
/// The hit part is truncated to `[0, max_range]` and the short part to `[0, true range]`; the weights sum to 1. A beam that
/// hits nothing has nothing to blur: its hit part is the point mass at `max_range`. Short and random readings still befall it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BeamModel {
    options: BeamModelOptions,
    /// Upper ends of the intervals of [0, 1) that the hit, short and max parts are chosen by.
    shares: [f64; 3],
}

impl BeamModel {
    /// The model with these parameters, its weights scaled to sum to 1.
    ///
    /// # Errors
    /// A sigma or lambda that is not positive, a negative weight, no positive weight.
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
        check_number("the sum of the weights", sum, "finite", |_| true)?;
        // Weights that sum to 1 but for rounding stay as they are, so that a copy of a model is the same model.
        let sum = if (sum - 1.0).abs() < 1e-14 { 1.0 } else { sum };
        let options = BeamModelOptions {
            z_hit: z_hit / sum,
            z_short: z_short / sum,
            z_max: z_max / sum,
            z_rand: z_rand / sum,
            ..options
        };
        // A part of weight zero after the last positive one must get nothing of what rounding leaves of 1.
        let tail = |parts: &[f64], end: f64| if parts.iter().all(|&weight| weight == 0.0) { 1.0 } else { end };
        let hit = tail(&[z_short, z_max, z_rand], options.z_hit);
        let short = tail(&[z_max, z_rand], options.z_hit + options.z_short);
        let max = tail(&[z_rand], options.z_hit + options.z_short + options.z_max);
        Ok(Self { options, shares: [hit, short, max] })
    }

    /// The parameters, weights summing to 1.
    #[must_use]
    pub fn options(&self) -> BeamModelOptions {
        self.options
    }

    /// Readings of the beams of the scan named by `seed` and `index`, given their true ranges, infinite for a beam that hits
    /// nothing within `max_range`. Lengths in metres.
    ///
    /// # Panics
    /// If there are not as many readings as ranges.
    pub fn sample(&self, ranges: &[f64], max_range: f64, (seed, index): (u64, u64), readings: &mut [f64]) {
        assert_eq!(ranges.len(), readings.len(), "one reading per range");
        let sampler = Sampler::new(self, max_range, BeamBits::new(seed, index));
        let (groups, rest) = ranges.as_chunks::<GROUP>();
        let padded = std::array::from_fn(|place| rest.get(place).copied().unwrap_or(f64::INFINITY));
        for (group, (ranges, readings)) in groups.iter().chain([&padded]).zip(readings.chunks_mut(GROUP)).enumerate() {
            readings.copy_from_slice(&sampler.sample(group, ranges)[..readings.len()]);
        }
    }

    /// Normal around `range`, truncated to `[0, max_range]`, by rejection.
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
            // The density of a wide one falls to no less than exp(-1/2) of its peak within the interval.
            let reading = stream.random::<f64>() * max_range;
            let deviation = (reading - range) / sigma;
            if stream.random::<f64>() < libm::exp(-0.5 * deviation * deviation) {
                return reading;
            }
        }
    }

    /// Whether the hit part is so narrow that at least a third of the normal lies in `[0, max_range]`.
    fn is_narrow(&self, max_range: f64) -> bool {
        self.options.sigma_hit <= max_range
    }

    /// Exponential, truncated to `[0, range]`, by its inverse distribution function.
    fn sample_short(&self, range: f64, stream: &mut impl Rng) -> f64 {
        let uniform = stream.random::<f64>();
        let exponent = self.options.lambda_short * range;
        if exponent < 1e-9 {
            // The limit for λ·z* → 0, to within a relative 1e-9.
            return uniform * range;
        }
        (-libm::log1p(uniform * libm::expm1(-exponent)) / self.options.lambda_short).min(range)
    }

    /// Density \[1/m\] of a reading in `[0, max_range)` given the true range, or probability mass of a reading of `max_range`.
    ///
    /// `hit` is `None` for a beam that hits nothing. Readings outside of `[0, max_range]` have likelihood 0.
    #[must_use]
    pub fn likelihood(&self, reading: f64, hit: Option<f64>, max_range: f64) -> f64 {
        let options = &self.options;
        if reading == max_range {
            return options.z_max + if hit.is_none() { options.z_hit } else { 0.0 };
        }
        if !(0.0..max_range).contains(&reading) {
            return 0.0;
        }
        let range = hit.unwrap_or(max_range);
        let mut density = options.z_rand / max_range;
        if let Some(range) = hit {
            let deviation = (reading - range) / options.sigma_hit;
            let inside = normal::mass_around_mean(range / options.sigma_hit, (max_range - range) / options.sigma_hit);
            density += options.z_hit * normal::density(deviation) / (options.sigma_hit * inside);
        }
        if reading <= range && range > 0.0 {
            let lambda = options.lambda_short;
            density += options.z_short * lambda * libm::exp(-lambda * reading) / -libm::expm1(-lambda * range);
        }
        density
    }

    /// [`likelihood`](Self::likelihood) of each reading, where a true range of `max_range` is a beam that hits nothing.
    ///
    /// # Errors
    /// A `max_range` that is not positive, a true range that is not a number or negative.
    pub fn likelihoods(
        &self,
        readings: impl IntoIterator<Item = f32>,
        ranges: impl IntoIterator<Item = f32>,
        max_range: f64,
    ) -> Result<Vec<f64>, Error> {
        check_number("max_range", max_range, "positive", |value| value > 0.0)?;
        // Ranges left as float32, and so did the maximum among them.
        let max = f64::from(max_range as f32);
        let each = |(reading, range): (f32, f32)| {
            let range = f64::from(range);
            if range.is_nan() || range < 0.0 {
                return Err(Error::Number { name: "true_ranges", value: range, needed: "at least 0" });
            }
            Ok(self.likelihood(reading.into(), (range < max).then_some(range), max))
        };
        readings.into_iter().zip(ranges).map(each).collect()
    }
}

/// A beam model at work on one scan.
///
/// Each beam has 64 bits: the lowest 24 choose its part of the mixture; the upper half and the two bits below it make two normal
/// numbers with the upper half of the beam half a group away. For nearly all beams that decides; the few others go on with a stream
/// of their own.
#[derive(Debug, Clone, Copy)]
pub struct Sampler<'a> {
    model: &'a BeamModel,
    max_range: f64,
    bits: BeamBits,
    /// Choices below this are hits, whatever more digits they had.
    sure_hits: u32,
    /// Choices within these are failures, whatever more digits they had.
    sure_failures: [u32; 2],
}

// A group's beams that need more than their bits are counted by the bits of an u32.
const _: () = assert!(GROUP <= 32 && GROUP.is_multiple_of(2));

/// Bits that choose a part of the mixture.
const SHARE_BITS: u32 = 24;

impl<'a> Sampler<'a> {
    /// The sampler of a scan by its bits.
    #[must_use]
    pub fn new(model: &'a BeamModel, max_range: f64, bits: BeamBits) -> Self {
        let [hit_end, short_end, max_end] = model.shares.map(|share| share * f64::from(1u32 << SHARE_BITS));
        let sure_hits = if model.is_narrow(max_range) { hit_end as u32 } else { 0 };
        Self { model, max_range, bits, sure_hits, sure_failures: [short_end.ceil() as u32, max_end as u32] }
    }

    /// Readings of a group of beams, given their true ranges, infinite for a beam that hits nothing.
    #[inline(always)]
    #[must_use]
    pub fn sample(&self, group: usize, ranges: &[f64; GROUP]) -> [f64; GROUP] {
        const HALF: usize = GROUP / 2;
        let first = (group * GROUP) as u64;
        let (mut low, mut high, mut normals) = ([0; GROUP], [0; GROUP], [[0.0; HALF]; 2]);
        for place in 0..GROUP {
            let bits = self.bits.of(first + place as u64);
            (low[place], high[place]) = (bits as u32, (bits >> 32) as u32);
        }
        for place in 0..HALF {
            (normals[0][place], normals[1][place]) = normal::pair([high[place], high[place + HALF]], low[place]);
        }
        let normals = normals.as_flattened();
        let (mut readings, mut all_sure) = ([0.0; GROUP], true);
        for place in 0..GROUP {
            let (reading, is_sure) = self.guess(ranges[place], low[place], normals[place]);
            readings[place] = reading;
            all_sure &= is_sure;
        }
        if !all_sure {
            let is_unsure = |place: usize| !self.guess(ranges[place], low[place], normals[place]).1;
            let mut unsure: u32 = (0..GROUP).map(|place| u32::from(is_unsure(place)) << place).sum();
            while unsure != 0 {
                let place = unsure.trailing_zeros() as usize;
                unsure &= unsure - 1;
                readings[place] = self.sample_one(first + place as u64, ranges[place]);
            }
        }
        readings
    }

    /// A reading by the bits alone, and whether it is right.
    #[inline(always)]
    fn guess(&self, range: f64, low: u32, normal: f32) -> (f64, bool) {
        let reading = range + self.model.options.sigma_hit * f64::from(normal);
        let (misses, share) = (range == f64::INFINITY, share(low));
        let fails = (share >= self.sure_failures[0]) & (share < self.sure_failures[1]);
        let fits = (reading >= 0.0) & (reading <= self.max_range);
        let is_sure = (share < self.sure_hits) & (fits | misses) | fails;
        (if misses | fails { self.max_range } else { reading }, is_sure)
    }

    /// A reading of a beam, without a shortcut.
    #[cold]
    fn sample_one(&self, beam: u64, range: f64) -> f64 {
        let Self { model, max_range, .. } = *self;
        let (bits, mut stream) = (self.bits.of(beam), self.bits.stream(beam));
        let is_hit = range < f64::INFINITY;
        let share = (f64::from(share(bits as u32)) + stream.random::<f64>()) / f64::from(1u32 << SHARE_BITS);
        let share = share.min(1.0 - f64::EPSILON);
        let [hit_end, short_end, max_end] = model.shares;
        if share < hit_end {
            if is_hit { model.sample_hit(range, max_range, &mut stream) } else { max_range }
        } else if share < short_end {
            model.sample_short(if is_hit { range } else { max_range }, &mut stream)
        } else if share < max_end {
            max_range
        } else {
            stream.random::<f64>() * max_range
        }
    }
}

/// The bits that choose a part of the mixture.
#[inline(always)]
fn share(bits: u32) -> u32 {
    bits & ((1 << SHARE_BITS) - 1)
}
