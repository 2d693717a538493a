//! Scorer: the log-likelihood of a scan under a beam model, from the true ranges as they are cast.

use crate::beam_model::{BeamModel, BeamModelOptions, HitPart};
use crate::numeric::exponential::exp;
use crate::numeric::{GROUP, Group, normal};

/// Computes log-likelihoods of scans under one beam model.
///
/// The likelihood of a scan is the product of [`BeamModel::likelihood`] over its beams. It is computed for a group of beams
/// at a time, with a relative error of each factor below 1e-9; if readings are rounded, one by one. The product is kept as a significand and a power of two for
/// each place in a group, so its logarithm is taken only once, and it cannot underflow.
#[derive(Debug, Clone)]
pub(crate) struct Scorer {
    model: BeamModel,
    limits: (f64, f64),
    /// `1 / σ`.
    per_sigma: f64,
    /// Peak of the hit density, with its weight.
    hit_peak: f64,
    /// The same times σ.
    weight_of_peak: f64,
    /// Density of the random part, with its weight.
    random: f64,
    /// Distance from both ends of the interval from which on all of the hit part is in the interval, up to rounding \[m\].
    far: f64,
    lambda_short: f64,
    has_short: bool,
    temper: f64,
}

/// Readings of a group of beams.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ReadingColumns {
    /// The reading, 0 if it has no density.
    reading: Group,
    /// `z_short · λ · exp(-λ · reading)`.
    short: Group,
    /// 1 for a reading with a density, else 0.
    has_density: Group,
    /// Probability of a reading without a density, if the beam has a return and if it has none; else 0.
    of_return: Group,
    of_none: Group,
    /// One bit for each reading below `min_range`.
    below: u32,
}

const _: () = assert!(GROUP == 32, "a bit for each beam of a group");

/// Number of beams of which the hit parts are truncated together, if one of them has to be.
const LANES: usize = 8;

/// `λ · range` from which on `1 - exp(-λ · range)` is computed without noticeable cancellation.
const SHORT: f64 = 1e-4;

impl Scorer {
    /// Returns the scorer for readings of a scanner with the limits `(min_range, max_range)` \[m\]. Log-likelihoods are
    /// multiplied by `temper`.
    pub fn new(model: BeamModel, (min_range, max_range): (f64, f64), temper: f64) -> Self {
        // Readings are float32, so the limits must be rounded the same way to compare equal.
        let limits = (f64::from(min_range as f32), f64::from(max_range as f32));
        let BeamModelOptions { sigma_hit, lambda_short, z_hit, z_short, z_rand, .. } = model.options();
        Self {
            model,
            limits,
            per_sigma: 1.0 / sigma_hit,
            hit_peak: z_hit * normal::density(0.0) / sigma_hit,
            weight_of_peak: z_hit * normal::density(0.0),
            random: z_rand / limits.1,
            far: normal::FAR * sigma_hit,
            lambda_short,
            has_short: z_short > 0.0,
            temper,
        }
    }

    /// Returns a group of readings; places past the last one are left out of every product.
    pub fn columns(&self, readings: &[f32]) -> ReadingColumns {
        let BeamModelOptions { lambda_short, z_hit, z_short, z_max, .. } = self.model.options();
        let zero = [0.0; GROUP];
        let mut columns = ReadingColumns {
            reading: zero,
            short: zero,
            has_density: zero,
            of_return: [1.0; GROUP],
            of_none: [1.0; GROUP],
            below: 0,
        };
        for (slot, &reading) in readings.iter().enumerate() {
            let reading = f64::from(reading);
            let set = |column: &mut Group, value: f64| column[slot] = value;
            if reading >= self.limits.1 {
                set(&mut columns.of_return, z_max);
                set(&mut columns.of_none, z_max + z_hit);
            } else if reading < self.limits.0.max(0.0) {
                columns.below |= 1 << slot;
            } else if !reading.is_nan() {
                set(&mut columns.reading, reading);
                set(&mut columns.short, z_short * lambda_short * libm::exp(-lambda_short * reading));
                set(&mut columns.has_density, 1.0);
                set(&mut columns.of_return, 0.0);
                set(&mut columns.of_none, 0.0);
            }
        }
        columns
    }

    /// Returns a true range as an array of scans has it, a float32, so that a score is that of the likelihoods of such an array.
    #[inline(always)]
    pub fn as_stored(&self, range: f64) -> f64 {
        let range = f64::from(range as f32);
        if range < self.limits.1 { range } else { f64::INFINITY }
    }

    /// Multiplies the likelihoods of a group of readings, whose beams have these true ranges, into a product.
    #[inline(always)]
    pub fn multiply(&self, columns: &ReadingColumns, ranges: &Group, product: &mut Product) {
        if self.model.rounds() {
            return self.multiply_rounded(columns, ranges, product);
        }
        let mut hit = [0.0; GROUP];
        if self.model.has_one_hit_part() {
            for slot in 0..GROUP {
                let deviation = (columns.reading[slot] - ranges[slot]) * self.per_sigma;
                // For a beam without a return, this is exp(-∞) = 0.
                hit[slot] = self.hit_peak * exp(-0.5 * deviation * deviation);
            }
            self.truncate(ranges, &mut hit);
        } else {
            self.hits_by_range(columns, ranges, &mut hit);
        }
        let mut likelihoods = [0.0; GROUP];
        for slot in 0..GROUP {
            let has_return = ranges[slot] < f64::INFINITY;
            let fixed = if has_return { columns.of_return[slot] } else { columns.of_none[slot] };
            likelihoods[slot] = (self.random + hit[slot]) * columns.has_density[slot] + fixed;
        }
        let mut has_odd = columns.below != 0;
        if self.has_short {
            for slot in 0..GROUP {
                let (range, reading) = (ranges[slot], columns.reading[slot]);
                // For a beam without a return, the exponent is that of the maximum range.
                let exponent = self.lambda_short * if range < f64::INFINITY { range } else { self.limits.1 };
                let short = columns.short[slot] / (1.0 - exp(-exponent));
                let is_odd = exponent < SHORT;
                likelihoods[slot] += if (reading <= range) & !is_odd { short } else { 0.0 };
                has_odd |= is_odd;
            }
        }
        if has_odd {
            self.correct(columns, ranges, &mut likelihoods);
        }
        product.multiply(&likelihoods);
    }

    /// Computes the hit parts of a group of beams, if they depend on the true range.
    #[inline(always)]
    fn hits_by_range(&self, columns: &ReadingColumns, ranges: &Group, hit: &mut Group) {
        let (max_range, mut is_truncated) = (self.limits.1, false);
        for slot in 0..GROUP {
            let has_return = ranges[slot] < f64::INFINITY;
            let HitPart { center, sigma } = self.model.hit_part(if has_return { ranges[slot] } else { 0.0 }, max_range);
            let deviation = (columns.reading[slot] - center) / sigma;
            let density = self.weight_of_peak / sigma * exp(-0.5 * deviation * deviation);
            hit[slot] = if has_return { density } else { 0.0 };
            is_truncated |= (center < normal::FAR * sigma) | (center > max_range - normal::FAR * sigma);
        }
        if is_truncated {
            for (hit, range) in hit.iter_mut().zip(ranges).filter(|(_, range)| **range < f64::INFINITY) {
                *hit /= self.model.hit_part(*range, max_range).mass(max_range);
            }
        }
    }

    /// Multiplies the likelihoods of rounded readings into a product, one by one.
    #[inline(never)]
    fn multiply_rounded(&self, columns: &ReadingColumns, ranges: &Group, product: &mut Product) {
        let mut likelihoods = [0.0; GROUP];
        for slot in 0..GROUP {
            let hit = (ranges[slot] < f64::INFINITY).then_some(ranges[slot]);
            let fixed = if hit.is_some() { columns.of_return[slot] } else { columns.of_none[slot] };
            let is_fixed = columns.has_density[slot] == 0.0 && columns.below & 1 << slot == 0;
            let reading = if columns.below & 1 << slot == 0 { columns.reading[slot] } else { f64::NEG_INFINITY };
            likelihoods[slot] = if is_fixed { fixed } else { self.model.likelihood(reading, hit, self.limits) };
        }
        product.multiply(&likelihoods);
    }

    /// Divides the hit parts of a group of beams by their masses between 0 and the maximum range, before they were truncated.
    #[inline(always)]
    fn truncate(&self, ranges: &Group, hit: &mut Group) {
        let max_range = self.limits.1;
        let is_truncated = |range: f64| ((range < self.far) | (range > max_range - self.far)) & (range < f64::INFINITY);
        for (hit, ranges) in hit.as_chunks_mut::<LANES>().0.iter_mut().zip(ranges.as_chunks::<LANES>().0) {
            // No early end, so that the compiler vectorises it.
            if !ranges.iter().fold(false, |any, &range| any | is_truncated(range)) {
                continue;
            }
            if max_range < 2.0 * self.far {
                for (hit, &range) in hit.iter_mut().zip(ranges).filter(|(_, range)| is_truncated(**range)) {
                    *hit /= normal::mass_around_mean(range * self.per_sigma, (max_range - range) * self.per_sigma);
                }
                continue;
            }
            // The other end is far. Parts that are not truncated stay as they are, whatever their neighbours.
            for lane in 0..LANES {
                let nearest = ranges[lane].min((max_range - ranges[lane]).abs());
                let mass = normal::mass_below((nearest * self.per_sigma).min(normal::FAR));
                hit[lane] = if is_truncated(ranges[lane]) { hit[lane] / mass } else { hit[lane] };
            }
        }
    }

    /// Replaces the likelihoods of readings below the minimum range, and of short beams.
    #[inline(never)]
    fn correct(&self, columns: &ReadingColumns, ranges: &Group, likelihoods: &mut Group) {
        for slot in 0..GROUP {
            let (range, reading) = (ranges[slot], columns.reading[slot]);
            let hit = (range < f64::INFINITY).then_some(range);
            let is_short = self.has_short && self.lambda_short * range.min(self.limits.1) < SHORT;
            if columns.below & 1 << slot != 0 {
                likelihoods[slot] = self.model.likelihood(f64::NEG_INFINITY, hit, self.limits);
            } else if is_short && columns.has_density[slot] > 0.0 {
                likelihoods[slot] = self.model.likelihood(reading, hit, self.limits);
            }
        }
    }

    /// Returns the log-likelihood of the factors of a product.
    pub fn log_likelihood(&self, product: &Product) -> f64 {
        product.ln() * self.temper
    }
}

/// A product of likelihoods: 32 products of every 32nd factor, each as `significand · 2^power`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Product {
    significands: Group,
    powers: [i64; GROUP],
    is_zero: bool,
}

impl Product {
    /// The product of no factors.
    pub const ONE: Self = Self { significands: [1.0; GROUP], powers: [0; GROUP], is_zero: false };

    /// Multiplies factors into the product. A factor below 2⁻¹⁰²² counts as 0.
    #[inline(always)]
    fn multiply(&mut self, factors: &Group) {
        const FRACTION: u64 = (1 << 52) - 1;
        // Loops without branches and with one result each, so that the compiler vectorises them.
        let mut zeros = 0;
        let mut products = [0.0; GROUP];
        for slot in 0..GROUP {
            let is_normal = factors[slot] >= f64::MIN_POSITIVE;
            zeros += u64::from(!is_normal);
            products[slot] = self.significands[slot] * if is_normal { factors[slot] } else { 1.0 };
        }
        self.is_zero |= zeros > 0;
        for (power, product) in self.powers.iter_mut().zip(&products) {
            *power += (product.to_bits() >> 52) as i64 - 1023;
        }
        for (significand, product) in self.significands.iter_mut().zip(&products) {
            *significand = f64::from_bits(product.to_bits() & FRACTION | 1023 << 52);
        }
    }

    /// Returns the natural logarithm.
    fn ln(&self) -> f64 {
        if self.is_zero {
            return f64::NEG_INFINITY;
        }
        // Each significand is in [1, 2), so the product of all is below 2³². Halves are multiplied, which takes five steps.
        let mut significands = self.significands;
        let mut count = GROUP;
        while count > 1 {
            count /= 2;
            let (low, high) = significands[..2 * count].split_at_mut(count);
            low.iter_mut().zip(high).for_each(|(low, high)| *low *= *high);
        }
        let significand = significands[0];
        let power: i64 = self.powers.iter().sum();
        power as f64 * std::f64::consts::LN_2 + libm::log(significand)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random;
    use rand::RngExt;

    fn model(sigma_hit: f64, lambda_short: f64, weights: [f64; 4]) -> BeamModel {
        let [z_hit, z_short, z_max, z_rand] = weights;
        BeamModel::new(BeamModelOptions {
            sigma_hit,
            lambda_short,
            z_hit,
            z_short,
            z_max,
            z_rand,
            ..BeamModelOptions::default()
        })
        .unwrap()
    }

    fn changed(change: impl Fn(&mut BeamModelOptions)) -> BeamModel {
        let mut options = model(0.05, 2.0, [0.8, 0.1, 0.05, 0.05]).options();
        change(&mut options);
        BeamModel::new(options).unwrap()
    }

    /// Compares the score of each group with the sum of the logarithms of its likelihoods.
    fn assert_scores(model: BeamModel, limits: (f64, f64), readings: &[f32], ranges: &[f64]) {
        let scorer = Scorer::new(model, limits, 1.0);
        let limits = (f64::from(limits.0 as f32), f64::from(limits.1 as f32));
        for (readings, ranges) in readings.chunks(GROUP).zip(ranges.as_chunks().0) {
            let mut product = Product::ONE;
            scorer.multiply(&scorer.columns(readings), ranges, &mut product);
            let score = scorer.log_likelihood(&product);
            let likelihood = |(&reading, &range): (&f32, &f64)| {
                model.likelihood(reading.into(), (range < f64::INFINITY).then_some(range), limits)
            };
            let likelihoods: Vec<f64> = readings.iter().zip(ranges).map(likelihood).collect();
            let expected: f64 = likelihoods.iter().copied().map(libm::log).sum();
            // A reading this unlikely may count as impossible.
            let may_be_zero = likelihoods.iter().any(|&likelihood| likelihood < 1e-300);
            let is_close =
                (score - expected).abs() < 1e-8 * (1.0 + expected.abs()) || (may_be_zero && score == f64::NEG_INFINITY);
            assert!(score == expected || is_close, "{score} {expected} {model:?} {readings:?} {ranges:?}");
        }
    }

    #[test]
    fn scores_are_those_of_the_likelihood() {
        let mut stream = random::stream(12, 0);
        let models = [
            model(0.005, 2.0, [0.995, 0.0, 0.005, 0.0]),
            model(0.05, 2.0, [0.8, 0.1, 0.05, 0.05]),
            model(0.2, 0.1, [0.95, 0.1, 0.05, 0.05]),
            model(3.0, 5.0, [0.5, 0.3, 0.1, 0.1]),
            model(200.0, 1e-6, [0.5, 0.3, 0.1, 0.1]),
            model(0.3, 1.0, [0.0, 0.5, 0.0, 0.5]),
            changed(|options| options.range_offset = 0.03),
            changed(|options| (options.range_offset, options.range_sigma_per_metre) = (-0.03, 0.02)),
            changed(|options| (options.range_sigma_base, options.range_sigma_per_metre) = (0.001, 40.0)),
            changed(|options| options.range_step = 0.03),
            changed(|options| (options.range_step_share, options.range_sigma_per_metre) = (0.01, 0.01)),
        ];
        for model in models {
            for max_range in [10.0, 0.7] {
                for scale in [1.0, 0.01] {
                    for _ in 0..400 {
                        let ranges: [f64; 96] = std::array::from_fn(|_| match stream.random_range(0..12) {
                            0 => f64::INFINITY,
                            1 => 0.0,
                            2 => max_range * (1.0 - 1e-3 * stream.random::<f64>()),
                            3 => stream.random::<f64>() * 1e-3,
                            _ => stream.random::<f64>() * max_range,
                        });
                        let readings: [f32; 96] = std::array::from_fn(|index| match stream.random_range(0..14) {
                            0 => f32::INFINITY,
                            1 => f32::NEG_INFINITY,
                            2 => f32::NAN,
                            3 => 0.0,
                            4 => max_range as f32,
                            5 => stream.random::<f32>() * max_range as f32,
                            _ => (ranges[index] + scale * (stream.random::<f64>() - 0.5)) as f32,
                        });
                        assert_scores(model, (0.05, max_range), &readings, &ranges);
                        assert_scores(model, (0.0, max_range), &readings[..70], &ranges);
                    }
                }
            }
        }
    }

    #[test]
    fn a_long_product_neither_overflows_nor_underflows() {
        for (sigma, error) in [(1e-4, 0.0), (0.1, 3.0)] {
            let model = model(sigma, 2.0, [0.9, 0.0, 0.0, 0.1]);
            let scorer = Scorer::new(model, (0.0, 10.0), 0.5);
            let columns = scorer.columns(&[5.0; GROUP]);
            let mut product = Product::ONE;
            for _ in 0..30_000 {
                scorer.multiply(&columns, &[5.0 + error; GROUP], &mut product);
            }
            let expected = 0.5 * 960_000.0 * libm::log(model.likelihood(5.0, Some(5.0 + error), (0.0, 10.0)));
            assert!((scorer.log_likelihood(&product) / expected - 1.0).abs() < 1e-9);
        }
    }

    #[test]
    fn an_impossible_reading_makes_the_product_zero() {
        let scorer = Scorer::new(model(0.01, 2.0, [1.0, 0.0, 0.0, 0.0]), (0.0, 10.0), 1.0);
        let mut product = Product::ONE;
        scorer.multiply(&scorer.columns(&[5.0]), &[6.0; GROUP], &mut product);
        assert_eq!(scorer.log_likelihood(&product), f64::NEG_INFINITY);
        // Without readings, nothing is unlikely.
        let mut product = Product::ONE;
        scorer.multiply(&scorer.columns(&[]), &[0.0; GROUP], &mut product);
        assert_eq!(scorer.log_likelihood(&product), 0.0);
    }
}
