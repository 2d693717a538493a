//! Fits of the beam model to measured readings, by expectation maximization.

use std::f64::consts::FRAC_PI_2;

use crate::beam_model::{BeamModel, BeamModelOptions};
use crate::error::{Error, check_number};
use crate::interrupt::Watch;
use crate::memory;
use crate::numeric::normal;

/// Names of what is fitted, in the order of [`BeamFit::standard_errors`].
pub(crate) const PARAMETERS: [&str; 7] = ["sigma_hit", "lambda_short", "z_hit", "z_short", "z_max", "z_rand", "offset"];

/// Place of the offset among [`PARAMETERS`].
const OFFSET: usize = 6;

/// The model of greatest likelihood for some readings; see [`BeamModel::fit`].
#[derive(Debug, Clone, PartialEq)]
pub struct BeamFit {
    /// The model.
    pub model: BeamModel,
    /// What to add to the true ranges of beams with a return \[m\]; `None` if it was not fitted.
    pub offset: Option<f64>,
    /// Log-likelihood that the model reaches: the sum of the logarithms of densities \[1/m\] and probabilities.
    pub log_likelihood: f64,
    /// Number of readings that were used.
    pub count: usize,
    /// Number of iterations, each of which improves the parameters twice and leaps.
    pub iterations: usize,
    /// False if the likelihood was still growing after 5000 iterations.
    pub has_converged: bool,
    /// Standard errors of σ, λ, `z_hit`, `z_short`, `z_max`, `z_rand` and the offset. NaN for one that is at its limit, not
    /// identified or not fitted.
    pub standard_errors: [f64; 7],
    /// Names of the parameters that the readings do not determine: σ and the offset without hits, λ without short readings.
    pub unidentified: Vec<&'static str>,
}

/// Largest number of iterations.
const MAX_ITERATIONS: usize = 5000;

/// Largest factor by which a leap changes a parameter.
const LARGEST_LEAP: f64 = 10.0;

/// Number of iterations with little gain after which a fit ends.
const CALM: usize = 3;

/// Gain in log-likelihood that is given away at the end of a fit. A loss of 0.5 is one standard error.
const LOSS: f64 = 1e-4;

/// Largest number of corrections of the offset.
const MAX_CORRECTIONS: usize = 100;

/// Part of its standard error by which an offset may be wrong.
const OFFSET_TOLERANCE: f64 = 0.01;

/// Number of equal bands of incidence in [`BeamModel::sigma_by_incidence`], from 0° to 90°.
pub const INCIDENCE_BANDS: usize = 6;

/// Number of readings that a part needs, so that its parameter counts as determined.
const FEWEST: f64 = 10.0;

/// Distance from both ends of the interval, in σ, from which on the hit part is not truncated.
const FAR: f64 = 9.0;

/// Limits of σ, relative to the maximum range, and of λ, relative to its inverse.
const SMALLEST: f64 = 1e-6;

/// See [`SMALLEST`].
const LARGEST: f64 = 1e6;

/// A reading below the maximum range.
#[derive(Debug, Clone, Copy)]
struct Reading {
    /// The reading; `None` if all that is known is that it is below the minimum range.
    value: Option<f64>,
    /// True range, as given; the maximum range if there is no return.
    true_range: f64,
    /// The same, moved by the offset if there is a return.
    range: f64,
    is_hit: bool,
}

/// The readings of a fit.
struct Data {
    min_range: f64,
    max_range: f64,
    below_max: Vec<Reading>,
    /// Number of readings of the maximum range, of beams that hit something.
    max_of_hits: f64,
    /// Number of readings of the maximum range, of beams without a return.
    max_of_no_returns: f64,
}

/// Densities \[1/m\] of the parts for a reading, without their weights; probabilities for a reading below the minimum range.
struct Densities {
    hit: f64,
    short: f64,
    random: f64,
    /// Derivative of the logarithm of `hit` by σ, and of `short` by λ.
    slopes: (f64, f64),
    /// How much the truncation of the hit part narrows it: 0 far from both ends.
    narrowed: f64,
    /// Square of the distance from the true range, and the reading itself, with the distance by which the truncation of the
    /// short part shortens it \[m\]. Means, if the reading is not known.
    square: f64,
    length: f64,
}

/// Sums over all readings, weighted by the probability that a reading is of a part.
#[derive(Default)]
struct Sums {
    hit: f64,
    short: f64,
    max: f64,
    random: f64,
    /// Hits below the maximum range.
    measured: f64,
    squares: f64,
    freedom: f64,
    lengths: f64,
    log_likelihood: f64,
}

impl BeamModel {
    /// Returns the model of greatest likelihood for readings, given the true range at the same position in `ranges`.
    ///
    /// It has one σ for all true ranges, no offset and no steps.
    ///
    /// A reading of `max_range` or more, infinite too, and a true range of `max_range` or more mean no return. A reading below
    /// `min_range`, minus infinity too, counts as any reading from 0 to `min_range`. Readings that are NaN are left out, and so
    /// are those below 0 if `min_range` is 0, and those with a true range of 0. If the lengths differ, the extra elements of the
    /// longer are ignored.
    ///
    /// Source: the algorithm of table 6.2 of the book (expectation maximization), with the truncation of the hit and the short
    /// part taken into account: their parameters satisfy `σ² = Σ w·(z - z*)² / Σ w·(1 - k)` and
    /// `λ = Σ w / Σ w·(z + z* / (exp(λz*) - 1))`, where `w` is the probability that a reading is of the part, and
    /// `k = (a·φ(a) + b·φ(b)) / (Φ(b) - Φ(-a))` with `a = z* / σ` and `b = (max_range - z*) / σ`. Leaps in the direction of two
    /// improvements make it faster (Varadhan & Roland, *Simple and globally convergent methods for accelerating the convergence
    /// of any EM algorithm*, 2008). The standard errors are those of the observed information, the sum of the outer products of
    /// the scores.
    ///
    /// ```
    /// use mobile_robot_simulator::{BeamModel, BeamModelOptions};
    ///
    /// let options = BeamModelOptions { sigma_hit: 0.1, z_hit: 0.8, z_rand: 0.2, z_max: 0.0, ..BeamModelOptions::default() };
    /// let mut readings = [0.0; 10_000];
    /// BeamModel::new(options)?.sample(&[5.0; 10_000], 30.0, (1, 0), &mut readings);
    /// let fit = BeamModel::fit(readings.map(|reading| reading as f32), [5.0; 10_000], (0.0, 30.0))?;
    /// assert!((fit.model.options().sigma_hit - 0.1).abs() < 0.005);
    /// assert_eq!(fit.unidentified, ["lambda_short"]);
    /// # Ok::<(), mobile_robot_simulator::Error>(())
    /// ```
    ///
    /// # Errors
    /// - [`Error::Number`]: `max_range` is not positive and finite, `min_range` is negative or not below `max_range`, or a true
    ///   range is negative or NaN.
    /// - [`Error::Count`]: no reading can be used.
    /// - [`Error::Memory`]: there is not enough memory.
    /// - [`Error::Interrupted`]: the call was interrupted.
    pub fn fit(
        readings: impl IntoIterator<Item = f32>,
        ranges: impl IntoIterator<Item = f32>,
        limits: (f64, f64),
    ) -> Result<BeamFit, Error> {
        let data = Data::new(readings, ranges, limits)?;
        let best = data.best(&Watch::new())?;
        data.result(best, None)
    }

    /// Does the same, and also fits an offset: how far real returns lie behind the true ranges. The walls of a map are often a
    /// cell thicker than real ones.
    ///
    /// The model and the log-likelihood are those for true ranges with the offset added to those below the maximum range; the
    /// sums are kept between 0 and the maximum range. The offset is the mean distance of the hits from the true range, each
    /// reading weighted by the probability that it is one. Hits that the ends of the interval may have truncated do not count.
    ///
    /// ```
    /// use mobile_robot_simulator::{BeamModel, BeamModelOptions};
    ///
    /// let options = BeamModelOptions { sigma_hit: 0.1, z_hit: 1.0, z_max: 0.0, ..BeamModelOptions::default() };
    /// let mut readings = [0.0; 10_000];
    /// BeamModel::new(options)?.sample(&[5.04; 10_000], 30.0, (1, 0), &mut readings);
    /// let fit = BeamModel::fit_with_offset(readings.map(|reading| reading as f32), [5.0; 10_000], (0.0, 30.0))?;
    /// assert!((fit.offset.unwrap_or_default() - 0.04).abs() < 0.005);
    /// # Ok::<(), mobile_robot_simulator::Error>(())
    /// ```
    ///
    /// # Errors
    /// Those of [`fit`](Self::fit).
    pub fn fit_with_offset(
        readings: impl IntoIterator<Item = f32>,
        ranges: impl IntoIterator<Item = f32>,
        limits: (f64, f64),
    ) -> Result<BeamFit, Error> {
        let watch = Watch::new();
        let mut data = Data::new(readings, ranges, limits)?;
        let mut best = data.best(&watch)?;
        let (mut offset, mut error) = (0.0, f64::NAN);
        for _ in 0..MAX_CORRECTIONS {
            let (residual, hits) = data.mean_residual(&best.options);
            if hits < FEWEST {
                break;
            }
            error = best.options.sigma_hit / hits.sqrt();
            if residual.abs() < OFFSET_TOLERANCE * error {
                break;
            }
            offset += residual;
            data.shift(offset);
            best = data.climb(best.options, &watch)?;
        }
        let mut fit = data.result(best, Some(offset))?;
        fit.standard_errors[OFFSET] = error;
        if error.is_nan() {
            fit.unidentified.push(PARAMETERS[OFFSET]);
        }
        Ok(fit)
    }

    /// Returns the σ of greatest likelihood \[m\] for each of [`INCIDENCE_BANDS`] equal bands of incidence, with everything else as in
    /// this model except what depends on the true range, other than the offset. NaN for a band with fewer than ten hits.
    ///
    /// `incidences` are the angles between the beams and the normals of their walls \[rad\], from 0 to π/2. Readings with
    /// another incidence, such as NaN for a beam without a return, are left out.
    ///
    /// # Errors
    /// Those of [`fit`](Self::fit), except that there may be no readings.
    pub fn sigma_by_incidence(
        &self,
        readings: &[f32],
        ranges: &[f32],
        incidences: &[f32],
        limits: (f64, f64),
    ) -> Result<[f64; INCIDENCE_BANDS], Error> {
        let watch = Watch::new();
        let mut sigmas = [f64::NAN; INCIDENCE_BANDS];
        for (band, sigma) in sigmas.iter_mut().enumerate() {
            let is_inside = |&incidence: &f32| band_of(incidence) == Some(band);
            let inside = readings.iter().zip(ranges).zip(incidences).filter(|(_, incidence)| is_inside(incidence));
            let (readings, ranges) =
                (inside.clone().map(|((&reading, _), _)| reading), inside.map(|((_, &range), _)| range));
            let mut data = match Data::new(readings, ranges, limits) {
                // A band without readings.
                Err(Error::Count { .. }) => continue,
                data => data?,
            };
            if self.options().range_offset != 0.0 {
                data.shift(self.options().range_offset);
            }
            let start = BeamModelOptions { sigma_hit: data.spread(), ..self.options() };
            let only_sigma = |next: BeamModelOptions| BeamModelOptions { sigma_hit: next.sigma_hit, ..self.options() };
            let best = data.climb_by(start, &watch, only_sigma)?;
            if best.sums.measured >= FEWEST {
                *sigma = best.options.sigma_hit;
            }
        }
        Ok(sigmas)
    }
}

/// Returns the band of an incidence; `None` if it is not from 0 to π/2.
fn band_of(incidence: f32) -> Option<usize> {
    let bands = f64::from(incidence) / FRAC_PI_2 * INCIDENCE_BANDS as f64;
    // π/2 as a float32 is a little larger than π/2.
    (bands >= 0.0 && bands < INCIDENCE_BANDS as f64 + 1e-6).then_some((bands as usize).min(INCIDENCE_BANDS - 1))
}

/// Where a climb ended.
struct Peak {
    options: BeamModelOptions,
    sums: Sums,
    iterations: usize,
}

impl Data {
    fn new(
        readings: impl IntoIterator<Item = f32>,
        ranges: impl IntoIterator<Item = f32>,
        (min_range, max_range): (f64, f64),
    ) -> Result<Self, Error> {
        check_number("max_range", max_range, "positive", |value| value > 0.0)?;
        check_number("min_range", min_range, "at least 0 and below max_range", |min| (0.0..max_range).contains(&min))?;
        // Readings and ranges are float32, so the limits must be rounded the same way to compare equal.
        let (min_range, max_range) = (f64::from(min_range as f32), f64::from(max_range as f32));
        let mut data = Self { min_range, max_range, below_max: Vec::new(), max_of_hits: 0.0, max_of_no_returns: 0.0 };
        for (reading, range) in readings.into_iter().zip(ranges) {
            let (reading, range) = (f64::from(reading), f64::from(range));
            if range.is_nan() || range < 0.0 {
                return Err(Error::Number { name: "true_ranges", value: range, needed: "at least 0" });
            }
            let is_hit = range < max_range;
            if range == 0.0 || reading.is_nan() || (reading < 0.0 && min_range == 0.0) {
                continue;
            }
            if reading < max_range {
                let value = (reading >= min_range).then_some(reading);
                let range = range.min(max_range);
                let reading = Reading { value, true_range: range, range, is_hit };
                memory::push("the readings", &mut data.below_max, reading)?;
            } else if is_hit {
                data.max_of_hits += 1.0;
            } else {
                data.max_of_no_returns += 1.0;
            }
        }
        if data.count() == 0.0 {
            return Err(Error::Count { name: "the number of readings to fit", value: 0, needed: "at least 1" });
        }
        Ok(data)
    }

    fn count(&self) -> f64 {
        self.below_max.len() as f64 + self.max_of_hits + self.max_of_no_returns
    }

    /// Returns the spread of the readings around their true ranges: 1.48 times the median distance.
    fn spread(&self) -> f64 {
        let distance = |each: &Reading| each.value.filter(|_| each.is_hit).map(|reading| (reading - each.range).abs());
        let mut distances: Vec<f64> = self.below_max.iter().filter_map(distance).collect();
        distances.sort_by(f64::total_cmp);
        let median = distances.get(distances.len() / 2).copied().unwrap_or(BeamModelOptions::default().sigma_hit);
        self.sigma_within_limits(1.4826 * median)
    }

    fn sigma_within_limits(&self, sigma: f64) -> f64 {
        sigma.clamp(SMALLEST * self.max_range, LARGEST * self.max_range)
    }

    fn lambda_within_limits(&self, lambda: f64) -> f64 {
        lambda.clamp(SMALLEST / self.max_range, LARGEST / self.max_range)
    }

    fn start(&self, sigma_hit: f64) -> BeamModelOptions {
        let sigma_hit = self.sigma_within_limits(sigma_hit);
        let lambda_short = 3.0 / self.max_range;
        let weights = BeamModelOptions { z_hit: 0.7, z_short: 0.1, z_max: 0.1, z_rand: 0.1, ..BeamModelOptions::default() };
        BeamModelOptions { sigma_hit, lambda_short, ..weights }
    }

    /// Returns the higher one of two peaks.
    fn best(&self, watch: &Watch) -> Result<Peak, Error> {
        // Two starts, because readings far from the true range make the first σ too large.
        let spread = self.spread();
        let wide = self.climb(self.start(spread), watch)?;
        let narrow = self.climb(self.start(0.1 * spread), watch)?;
        Ok(if narrow.sums.log_likelihood > wide.sums.log_likelihood { narrow } else { wide })
    }

    /// Improves all parameters until the likelihood hardly grows.
    fn climb(&self, options: BeamModelOptions, watch: &Watch) -> Result<Peak, Error> {
        self.climb_by(options, watch, |next| next)
    }

    /// Improves parameters until the likelihood hardly grows. `kept` puts back those that must not change.
    ///
    /// Each iteration improves them twice and then leaps on in the same direction, which counts if the likelihood grows by it.
    ///
    /// The gains of the two improvements tell what further ones would gain, if they shrink like a geometric series (Böhning et al.,
    /// *The distribution of the likelihood ratio for mixtures*, 1994, section 5). It ends when that and the gain of the iteration
    /// have been little for [`CALM`] iterations: directly after a leap, the gains do not show yet that improvements are slow.
    fn climb_by(
        &self,
        options: BeamModelOptions,
        watch: &Watch,
        kept: impl Fn(BeamModelOptions) -> BeamModelOptions,
    ) -> Result<Peak, Error> {
        let place = |options, iterations| {
            let options = kept(options);
            Peak { options, sums: self.sums(&options), iterations }
        };
        let (mut here, mut calm) = (place(options, 0), 0);
        for iterations in 1..=MAX_ITERATIONS {
            watch.check()?;
            let once = place(self.improved(&here.options, &here.sums), iterations);
            let twice = place(self.improved(&once.options, &once.sums), iterations);
            let leap = place(self.leap([&here, &once, &twice].map(|each| each.options)), iterations);
            let [before, first, second, leapt] = [&here, &once, &twice, &leap].map(|each| each.sums.log_likelihood);
            let (gain, rate) = (second - first, (second - first) / (first - before));
            let is_little = leapt.max(second) - before < LOSS && rate < 1.0 && gain * rate / (1.0 - rate) < LOSS;
            calm = if is_little { calm + 1 } else { 0 };
            if gain <= 0.0 || calm == CALM {
                return Ok(twice);
            }
            here = if leapt > second { leap } else { twice };
        }
        Ok(here)
    }

    /// Returns where further improvements lead, given parameters before and after two of them. Weights of 0 stay 0.
    ///
    /// The logarithms of the parameters go from `x` to `x + 2·s·r + s²·v`, where `r` is the first change, `v` the change of the
    /// change, and `s = |r| / |v|`. With `s = 1`, that is the second improvement.
    fn leap(&self, [start, once, twice]: [BeamModelOptions; 3]) -> BeamModelOptions {
        let nothing = libm::log(f64::MIN_POSITIVE);
        let [start, once, twice] = [start, once, twice].map(|options| {
            let BeamModelOptions { sigma_hit, lambda_short, z_hit, z_short, z_max, z_rand, .. } = options;
            [sigma_hit, lambda_short, z_hit, z_short, z_max, z_rand].map(|each| libm::log(each.max(f64::MIN_POSITIVE)))
        });
        let change: [f64; 6] = std::array::from_fn(|index| once[index] - start[index]);
        let bend: [f64; 6] = std::array::from_fn(|index| twice[index] - once[index] - change[index]);
        let length = |vector: [f64; 6]| vector.map(|each| each * each).iter().sum::<f64>().sqrt();
        let stride = (length(change) / length(bend).max(f64::MIN_POSITIVE)).max(1.0);
        let most = libm::log(LARGEST_LEAP);
        let leap = |index: usize| {
            let end = start[index] + stride * (2.0 * change[index] + stride * bend[index]);
            if twice[index] > nothing { libm::exp(end.clamp(twice[index] - most, twice[index] + most)) } else { 0.0 }
        };
        let [sigma_hit, lambda_short, weights @ ..]: [f64; 6] = std::array::from_fn(leap);
        let [z_hit, z_short, z_max, z_rand] = weights.map(|weight| weight / weights.iter().sum::<f64>());
        BeamModelOptions {
            sigma_hit: self.sigma_within_limits(sigma_hit),
            lambda_short: self.lambda_within_limits(lambda_short),
            z_hit,
            z_short,
            z_max,
            z_rand,
            ..BeamModelOptions::default()
        }
    }

    fn result(&self, Peak { options, sums, iterations }: Peak, offset: Option<f64>) -> Result<BeamFit, Error> {
        let mut unidentified = Vec::new();
        if sums.measured < FEWEST {
            unidentified.push(PARAMETERS[0]);
        }
        if sums.short < FEWEST {
            unidentified.push(PARAMETERS[1]);
        }
        Ok(BeamFit {
            model: BeamModel::new(options)?,
            offset,
            log_likelihood: sums.log_likelihood,
            count: self.count() as usize,
            iterations,
            has_converged: iterations < MAX_ITERATIONS,
            standard_errors: self.standard_errors(&options, &unidentified),
            unidentified,
        })
    }

    /// Moves the true ranges of beams with a return. They stay within the interval of readings.
    fn shift(&mut self, offset: f64) {
        let (least, most) = (SMALLEST * self.max_range, self.max_range * (1.0 - SMALLEST));
        for each in self.below_max.iter_mut().filter(|each| each.is_hit) {
            each.range = (each.true_range + offset).clamp(least, most);
        }
    }

    /// Returns the mean distance of the hits behind their true ranges, and the number of hits, without those that the ends of
    /// the interval may have truncated.
    fn mean_residual(&self, options: &BeamModelOptions) -> (f64, f64) {
        let (mut sum, mut hits) = (0.0, 0.0);
        for each in self.below_max.iter().filter(|each| each.is_hit) {
            let far = FAR * options.sigma_hit;
            let Some(reading) = each.value.filter(|_| each.range > far && each.range < self.max_range - far) else {
                continue;
            };
            let Densities { hit, short, random, .. } = self.densities(options, each);
            let hit = options.z_hit * hit;
            let density = (hit + options.z_short * short + options.z_rand * random).max(f64::MIN_POSITIVE);
            sum += hit / density * (reading - each.range);
            hits += hit / density;
        }
        (if hits > 0.0 { sum / hits } else { 0.0 }, hits)
    }

    /// Returns the parameters of greatest likelihood if each reading is of the parts that `sums` says.
    fn improved(&self, options: &BeamModelOptions, sums: &Sums) -> BeamModelOptions {
        let count = self.count();
        let sigma = (sums.squares / sums.freedom).sqrt();
        let lambda = sums.short / sums.lengths;
        BeamModelOptions {
            sigma_hit: if sigma.is_finite() { self.sigma_within_limits(sigma) } else { options.sigma_hit },
            lambda_short: if lambda.is_finite() { self.lambda_within_limits(lambda) } else { options.lambda_short },
            z_hit: sums.hit / count,
            z_short: sums.short / count,
            z_max: sums.max / count,
            z_rand: sums.random / count,
            ..*options
        }
    }

    fn sums(&self, options: &BeamModelOptions) -> Sums {
        let mut sums = Sums::default();
        for each in &self.below_max {
            let densities = self.densities(options, each);
            let (hit, short) = (options.z_hit * densities.hit, options.z_short * densities.short);
            let random = options.z_rand * densities.random;
            let density = (hit + short + random).max(f64::MIN_POSITIVE);
            let (hit, short, random) = (hit / density, short / density, random / density);
            sums.hit += hit;
            sums.short += short;
            sums.random += random;
            sums.squares += hit * densities.square;
            sums.freedom += hit * (1.0 - densities.narrowed);
            sums.lengths += short * densities.length;
            sums.log_likelihood += libm::log(density);
        }
        sums.measured = sums.hit;
        // Readings of the maximum range: failures, or the hit part of beams without a return.
        let no_return = options.z_hit + options.z_max;
        let failures = if no_return > 0.0 { options.z_max / no_return } else { 0.0 };
        sums.hit += self.max_of_no_returns * (1.0 - failures);
        sums.max += self.max_of_hits + self.max_of_no_returns * failures;
        for (count, mass) in [(self.max_of_hits, options.z_max), (self.max_of_no_returns, no_return)] {
            if count > 0.0 {
                sums.log_likelihood += count * libm::log(mass.max(f64::MIN_POSITIVE));
            }
        }
        sums
    }

    fn densities(&self, options: &BeamModelOptions, each: &Reading) -> Densities {
        let BeamModelOptions { sigma_hit: sigma, lambda_short: lambda, .. } = *options;
        let Reading { value: reading, range, is_hit, .. } = *each;
        let random = if reading.is_some() { 1.0 } else { self.min_range } / self.max_range;
        let mut densities =
            Densities { hit: 0.0, short: 0.0, random, slopes: (0.0, 0.0), narrowed: 0.0, square: 0.0, length: 0.0 };
        if is_hit {
            let (below, above) = (range / sigma, (self.max_range - range) / sigma);
            let mut mass = 1.0;
            if below.min(above) < FAR {
                mass = normal::mass_around_mean(below, above);
                densities.narrowed = (below * normal::density(below) + above * normal::density(above)) / mass;
            }
            let square = if let Some(reading) = reading {
                let deviation = (reading - range) / sigma;
                densities.hit = normal::density(deviation) / (sigma * mass);
                deviation * deviation
            } else {
                // The mean of the square of a normal number between -below and end.
                let end = (self.min_range - range) / sigma;
                let inside = normal::mass_around_mean(below, end).max(f64::MIN_POSITIVE);
                densities.hit = inside / mass;
                1.0 - (below * normal::density(below) + end * normal::density(end)) / inside
            };
            densities.square = square * sigma * sigma;
            densities.slopes.0 = (square - 1.0 + densities.narrowed) / sigma;
        }
        if reading.is_none_or(|reading| reading <= range) {
            // Mean of the distance that the truncation of an exponential distribution to a length cuts off.
            let cut = |length: f64| {
                let grown = libm::expm1(lambda * length);
                if grown.is_finite() { length / grown } else { 0.0 }
            };
            let mean = if let Some(reading) = reading {
                densities.short = lambda * libm::exp(-lambda * reading) / -libm::expm1(-lambda * range);
                reading
            } else {
                let length = self.min_range.min(range);
                densities.short = libm::expm1(-lambda * length) / libm::expm1(-lambda * range);
                1.0 / lambda - cut(length)
            };
            densities.length = mean + cut(range);
            densities.slopes.1 = 1.0 / lambda - densities.length;
        }
        densities
    }

    /// Returns the standard errors in the order of [`PARAMETERS`].
    fn standard_errors(&self, options: &BeamModelOptions, unidentified: &[&str]) -> [f64; 7] {
        // z_rand follows from the other weights, so there are five free parameters.
        let weights = [options.z_hit, options.z_short, options.z_max];
        let is_free = |index: usize| match index {
            0 | 1 => !unidentified.contains(&PARAMETERS[index]),
            _ => weights[index - 2] > 1e-9,
        };
        let free: Vec<usize> = (0..5).filter(|&index| is_free(index)).collect();
        let mut information = [[0.0; 5]; 5];
        let mut add = |scores: [f64; 5], count: f64| {
            for (row, &one) in free.iter().enumerate() {
                for (col, &other) in free.iter().enumerate() {
                    information[row][col] += count * scores[one] * scores[other];
                }
            }
        };
        for each in &self.below_max {
            let Densities { hit, short, random, slopes, .. } = self.densities(options, each);
            let density = (options.z_hit * hit + options.z_short * short + options.z_rand * random).max(f64::MIN_POSITIVE);
            let by_sigma = options.z_hit * hit * slopes.0;
            let by_lambda = options.z_short * short * slopes.1;
            add([by_sigma, by_lambda, hit - random, short - random, -random].map(|slope| slope / density), 1.0);
        }
        let no_return = options.z_hit + options.z_max;
        if self.max_of_hits > 0.0 {
            add([0.0, 0.0, 0.0, 0.0, 1.0 / options.z_max], self.max_of_hits);
        }
        if self.max_of_no_returns > 0.0 {
            add([0.0, 0.0, 1.0 / no_return, 0.0, 1.0 / no_return], self.max_of_no_returns);
        }
        let mut errors = [f64::NAN; 7];
        let Some(covariance) = inverse(information, free.len()) else { return errors };
        let mut of_random = 0.0;
        for (row, &one) in free.iter().enumerate() {
            errors[one] = covariance[row][row].sqrt();
            of_random += free
                .iter()
                .enumerate()
                .filter(|_| one >= 2)
                .filter(|(_, other)| **other >= 2)
                .map(|(col, _)| covariance[row][col])
                .sum::<f64>();
        }
        if options.z_rand > 1e-9 {
            errors[5] = of_random.sqrt();
        }
        errors
    }
}

/// Returns the inverse of the upper left part of a symmetric matrix; `None` if it is singular.
fn inverse(mut matrix: [[f64; 5]; 5], size: usize) -> Option<[[f64; 5]; 5]> {
    let mut inverse = [[0.0; 5]; 5];
    for (index, row) in inverse.iter_mut().enumerate() {
        row[index] = 1.0;
    }
    // Gauss and Jordan's elimination. The matrix has no negative eigenvalues, so the diagonal is a good choice of pivots.
    for pivot in 0..size {
        let scale = matrix[pivot][pivot];
        if !(scale > 0.0 && scale.is_finite()) {
            return None;
        }
        for col in 0..size {
            matrix[pivot][col] /= scale;
            inverse[pivot][col] /= scale;
        }
        for row in (0..size).filter(|&row| row != pivot) {
            let factor = matrix[row][pivot];
            for col in 0..size {
                matrix[row][col] -= factor * matrix[pivot][col];
                inverse[row][col] -= factor * inverse[pivot][col];
            }
        }
    }
    Some(inverse)
}
