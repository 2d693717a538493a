//! Rounding: the steps in which a scanner reports its readings.

/// Readings are rounded to the nearest multiple of a step that grows with the distance.
///
/// With `step` and `share` of [`BeamModelOptions`](crate::BeamModelOptions), and n = 1 / `share`, rounded up:
///
/// ```text
///   reading         0 ...... n · step ...... 2n · step ...... 4n · step ......
///   its step           step           2 · step         4 · step
/// ```
///
/// Each limit is a multiple of the steps on both sides. So only one interval of readings is rounded to each multiple.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rounding {
    /// Step of the shortest readings \[m\]; 1 m if steps shrink without an end.
    base: f64,
    /// 1 over the distance at which the step becomes larger than `base` \[1/m\]; 0 if it never does.
    per_limit: f64,
    /// Smallest ratio of a reading to that distance that counts.
    least_ratio: f64,
}

/// Number that is added to another, and subtracted again, to round it to a whole number, ties to even.
const WHOLE: f64 = 1.5 * (1_u64 << 52) as f64;

/// Count of steps from which on a reading is not rounded: too large for [`WHOLE`].
const LARGEST_COUNT: f64 = (1_u64 << 51) as f64;

/// Smallest ratio of a step to 1 m if no smallest step is given: below any distance that a scanner resolves.
const LEAST_RATIO: f64 = 1.0 / (1_u64 << 60) as f64;

/// Part of a distance that is less than float64 numbers of readings may be off, and more than they are.
const SLIGHTLY: f64 = 1e-9;

/// Part of a distance that a float32 resolves.
const SINGLE: f64 = f32::EPSILON as f64;

impl Rounding {
    /// Returns the rounding with a smallest step \[m\] and a share of the distance; `None` if both are 0.
    pub fn new(step: f64, share: f64) -> Option<Self> {
        if step == 0.0 && share == 0.0 {
            return None;
        }
        let (base, least_ratio) = if step > 0.0 { (step, 1.0) } else { (1.0, LEAST_RATIO) };
        let per_limit = if share > 0.0 { 1.0 / ((1.0 / share - SLIGHTLY).ceil() * base) } else { 0.0 };
        Some(Self { base, per_limit, least_ratio })
    }

    /// Returns the step at a reading \[m\].
    #[inline(always)]
    fn step(&self, reading: f64) -> f64 {
        const POWER: u64 = 0x7ff0_0000_0000_0000;
        let ratio = reading * self.per_limit;
        let ratio = if ratio > self.least_ratio { ratio } else { self.least_ratio };
        // The largest power of two that is at most the ratio.
        self.base * f64::from_bits(ratio.to_bits() & POWER)
    }

    /// Returns the multiple that a reading from 0 to below `max_range` \[m\] is rounded to, at most [`last`](Self::last).
    #[inline(always)]
    pub fn round(&self, reading: f64, last: f64) -> f64 {
        let step = self.step(reading);
        let count = reading / step;
        let rounded = ((count + WHOLE) - WHOLE) * step;
        let rounded = if count < LARGEST_COUNT { rounded } else { reading };
        if rounded < last { rounded } else { last }
    }

    /// Returns the largest multiple that a float32 tells from the maximum range \[m\].
    pub fn last(&self, max_range: f64) -> f64 {
        let end = max_range * (1.0 - SINGLE);
        let step = self.step(end);
        ((end / step).ceil() - 1.0) * step
    }

    /// Returns the interval of the readings that are rounded to the multiple nearest to `reading` \[m\].
    pub fn interval(&self, reading: f64, max_range: f64) -> (f64, f64) {
        let last = self.last(max_range);
        let multiple = self.round(reading, last);
        let low = multiple - 0.5 * self.step(multiple * (1.0 - SLIGHTLY));
        let high = multiple + 0.5 * self.step(multiple * (1.0 + SLIGHTLY));
        (low.max(0.0), if multiple == last { max_range } else { high })
    }

    /// Returns the end of the readings that are rounded to less than `limit` \[m\].
    pub fn end_below(&self, limit: f64, max_range: f64) -> f64 {
        let step = self.step(limit);
        let first = (limit / step * (1.0 - SINGLE)).ceil() * step;
        if first > self.last(max_range) { max_range } else { self.interval(first, max_range).0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random;
    use rand::RngExt;

    const MAX_RANGE: f64 = 30.0;

    fn roundings() -> [Rounding; 5] {
        [(0.001, 0.0), (0.03, 0.0), (0.001, 0.01), (0.0005, 0.3), (0.0, 0.01)]
            .map(|(step, share)| Rounding::new(step, share).unwrap())
    }

    #[test]
    fn steps_double_with_the_distance() {
        let rounding = Rounding::new(0.001, 0.01).unwrap();
        let steps = [0.0, 0.0999, 0.1001, 0.1999, 0.2001, 12.0].map(|reading| rounding.step(reading));
        assert_eq!(steps, [0.001, 0.001, 0.001, 0.001, 0.002, 0.064]);
        // A share alone gives powers of two, and no more than the share of a reading.
        let rounding = Rounding::new(0.0, 0.01).unwrap();
        assert_eq!(
            [1.0, 1.6, 3.0, 8.0].map(|reading| rounding.step(reading)),
            [1.0 / 128.0, 1.0 / 64.0, 1.0 / 64.0, 0.0625]
        );
        assert_eq!(Rounding::new(0.0, 0.0), None);
    }

    #[test]
    fn a_reading_becomes_the_nearest_multiple() {
        let last = |rounding: Rounding| rounding.last(MAX_RANGE);
        let [millimetres, coarse, grows, ..] = roundings();
        assert_eq!(millimetres.round(1.2344, last(millimetres)), 1.234);
        assert_eq!(coarse.round(0.046, last(coarse)), 0.06);
        // The step at 12 m is 64 mm.
        assert_eq!(grows.round(12.02, last(grows)), 12.032);
        // Nothing becomes the maximum range.
        assert_eq!(coarse.round(29.999, last(coarse)), 29.97);
        assert_eq!(Rounding::new(50.0, 0.0).unwrap().round(29.0, 0.0), 0.0);
    }

    /// Readings inside the interval of a multiple become the multiple, those outside do not.
    #[test]
    fn an_interval_holds_what_is_rounded_to_its_multiple() {
        let mut stream = random::stream(5, 0);
        for rounding in roundings() {
            let last = rounding.last(MAX_RANGE);
            for _ in 0..20_000 {
                let reading = MAX_RANGE * stream.random::<f64>().powi(3);
                let multiple = rounding.round(reading, last);
                let (low, high) = rounding.interval(f64::from(multiple as f32), MAX_RANGE);
                assert!((low..=high).contains(&reading), "{reading} {low} {high} {rounding:?}");
                let inside = |share: f64| rounding.round(low + share * (high - low), last);
                assert_eq!([inside(0.001), inside(0.999)], [multiple; 2], "{rounding:?}");
                assert!(low == 0.0 || inside(-0.001) < multiple, "{rounding:?}");
                assert!(high == MAX_RANGE || inside(1.001) > multiple, "{rounding:?}");
            }
        }
    }

    #[test]
    fn readings_below_a_limit_end_where_the_next_multiple_begins() {
        let [millimetres, coarse, grows, ..] = roundings();
        // As a float32, the limit 0.05 is a little more than 0.05, but so is the reading.
        assert!((millimetres.end_below(f64::from(0.05_f32), MAX_RANGE) - 0.0495).abs() < 1e-12);
        assert!((coarse.end_below(0.05, MAX_RANGE) - 0.045).abs() < 1e-12);
        assert!((grows.end_below(12.01, MAX_RANGE) - 12.0).abs() < 1e-12);
        assert_eq!(coarse.end_below(29.99, MAX_RANGE), MAX_RANGE);
    }
}
