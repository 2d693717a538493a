//! Sampler: draws readings from a beam model.

use rand::{Rng, RngExt};

use super::{BeamModel, HitPart};
use crate::numeric::{GROUP, Group, normal};
use crate::random::BeamBits;

impl BeamModel {
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
}

impl HitPart {
    /// Draws from the normal distribution, truncated to `[0, max_range]`, by rejection.
    fn sample(self, max_range: f64, stream: &mut impl Rng) -> f64 {
        let Self { center, sigma } = self;
        if sigma <= max_range {
            // At least a third of the normal distribution is in the interval.
            loop {
                let reading = center + sigma * normal::sample(stream);
                if (0.0..=max_range).contains(&reading) {
                    return reading;
                }
            }
        }
        loop {
            // Here σ > max_range, so the density is at least exp(-1/2) of its peak in the interval: few draws are rejected.
            let reading = stream.random::<f64>() * max_range;
            let deviation = (reading - center) / sigma;
            if stream.random::<f64>() < libm::exp(-0.5 * deviation * deviation) {
                return reading;
            }
        }
    }
}

/// What the beams of a group meet.
pub(crate) struct HitColumns<'a> {
    /// Cosines of the incidences.
    pub cosines: &'a Group,
    /// Random bits that each beam has at its place, in every scan; `None` if there are none.
    pub fixed: Option<[u64; GROUP]>,
    /// Weights of the normal number of this scan and of that of the place; the sum of their squares is 1.
    pub weights: [f32; 2],
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
    /// Largest rounded reading \[m\].
    last: f64,
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
        let hit_choices_end = if model.options.sigma_hit <= max_range { hit_end as u32 } else { 0 };
        let last = model.rounding.map_or(max_range, |rounding| rounding.last(max_range));
        Self { model, max_range, bits, hit_choices_end, max_choices: [short_end.ceil() as u32, max_end as u32], last }
    }

    /// Returns the random bits of the scan.
    #[must_use]
    pub fn bits(&self) -> BeamBits {
        self.bits
    }

    /// Returns the readings \[m\] of a group of beams, given their true ranges \[m\]: infinite for a beam without a return.
    ///
    /// Group `g` holds the beams from `g · GROUP` on.
    #[inline(always)]
    #[must_use]
    pub fn sample(&self, group: usize, ranges: &Group) -> Group {
        if self.model.has_one_hit_part {
            let sigma = self.model.options.sigma_hit;
            self.draw(group, ranges, |lane| HitPart { center: ranges[lane], sigma }, |_, normal| normal)
        } else {
            let part = |lane: usize| self.model.hit_part(ranges[lane], self.max_range);
            self.round(self.draw(group, ranges, part, |_, normal| normal))
        }
    }

    /// The same for beams that meet surfaces, of which `change` changes the hit part by the cosine of the incidence.
    #[inline(always)]
    #[must_use]
    pub fn sample_hits(
        &self,
        group: usize,
        ranges: &Group,
        hits: &HitColumns<'_>,
        change: impl Fn(HitPart, f64, f64) -> HitPart,
    ) -> Group {
        let (mut centers, mut sigmas) = ([0.0; GROUP], [0.0; GROUP]);
        for lane in 0..GROUP {
            let range = if ranges[lane] < f64::INFINITY { ranges[lane] } else { 0.0 };
            let part = change(self.model.hit_part(range, self.max_range), hits.cosines[lane], self.max_range);
            (centers[lane], sigmas[lane]) = (part.center, part.sigma);
        }
        let part = |lane: usize| HitPart { center: centers[lane], sigma: sigmas[lane] };
        let Some(bits) = &hits.fixed else {
            return self.round(self.draw(group, ranges, part, |_, normal| normal));
        };
        let mut fixed = [0.0; GROUP];
        for lane in 0..GROUP {
            let (low, high) = (bits[lane] as u32, (bits[lane] >> 32) as u32);
            fixed[lane] = normal::pair([high, low << 2], low).0;
        }
        let [own, of_place] = hits.weights;
        self.round(self.draw(group, ranges, part, |lane, normal| own * normal + of_place * fixed[lane]))
    }

    /// Returns the readings before they are rounded.
    #[inline(always)]
    fn draw(
        &self,
        group: usize,
        ranges: &Group,
        hit_part: impl Fn(usize) -> HitPart,
        blend: impl Fn(usize, f32) -> f32,
    ) -> Group {
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
        let (pairs, mut normals) = (normals.as_flattened(), [0.0; GROUP]);
        for lane in 0..GROUP {
            normals[lane] = blend(lane, pairs[lane]);
        }
        let (mut readings, mut all_decided) = ([0.0; GROUP], true);
        for lane in 0..GROUP {
            let (reading, is_decided) = self.reading_from_bits(ranges[lane], hit_part(lane), low[lane], normals[lane]);
            readings[lane] = reading;
            all_decided &= is_decided;
        }
        if !all_decided {
            let is_undecided =
                |lane: usize| !self.reading_from_bits(ranges[lane], hit_part(lane), low[lane], normals[lane]).1;
            let mut undecided: u32 = (0..GROUP).map(|lane| u32::from(is_undecided(lane)) << lane).sum();
            while undecided != 0 {
                let lane = undecided.trailing_zeros() as usize;
                undecided &= undecided - 1;
                readings[lane] = self.reading_from_stream(first + lane as u64, ranges[lane], hit_part(lane));
            }
        }
        readings
    }

    /// Returns the readings as the scanner rounds them.
    #[inline(always)]
    fn round(&self, readings: Group) -> Group {
        let Some(rounding) = &self.model.rounding else { return readings };
        let (max_range, last) = (self.max_range, self.last);
        readings.map(|reading| if reading < max_range { rounding.round(reading, last) } else { reading })
    }

    /// Returns the reading that the random bits give without the beam's stream, and whether they decide it. If not, the
    /// reading is meaningless.
    #[inline(always)]
    fn reading_from_bits(&self, range: f64, hit_part: HitPart, low: u32, normal: f32) -> (f64, bool) {
        let reading = hit_part.center + hit_part.sigma * f64::from(normal);
        let (no_return, choice) = (range == f64::INFINITY, choice(low));
        let is_max = (choice >= self.max_choices[0]) & (choice < self.max_choices[1]);
        let fits = (reading >= 0.0) & (reading <= self.max_range);
        let is_decided = (choice < self.hit_choices_end) & (fits | no_return) | is_max;
        (if no_return | is_max { self.max_range } else { reading }, is_decided)
    }

    /// Returns a reading drawn from the beam's own stream, for any part of the model.
    #[cold]
    fn reading_from_stream(&self, beam: u64, range: f64, hit_part: HitPart) -> f64 {
        let Self { model, max_range, .. } = *self;
        let (bits, mut stream) = (self.bits.of(beam), self.bits.stream(beam));
        let is_hit = range < f64::INFINITY;
        // The 24 bits of the choice are the leading digits of a number in [0, 1); the stream gives the others.
        let part = (f64::from(choice(bits as u32)) + stream.random::<f64>()) / f64::from(1u32 << CHOICE_BITS);
        let part = part.min(1.0 - f64::EPSILON);
        let [hit_end, short_end, max_end] = model.part_ends;
        if part < hit_end {
            if is_hit { hit_part.sample(max_range, &mut stream) } else { max_range }
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
