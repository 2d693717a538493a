//! The standard normal distribution: random numbers with the same bytes on every machine, density and probability.

use std::f32::consts::FRAC_PI_4;
use std::f64::consts::{FRAC_1_SQRT_2, PI};

use rand::Rng;

use super::elementary::{ln32, sin_cos32};

/// Returns two independent standard normal numbers, to the precision of a float32.
///
/// They are made from two words of random bits and the two upper bits of a third word, `quadrant`. As coordinates they are a
/// point at a random angle, at a distance whose square is exponentially distributed (Box & Muller 1958).
///
/// Limits: no number is beyond ±6.67, although about one in 4 · 10¹⁰ should be, and one pair in 2²⁵ is (0, 0).
#[inline(always)]
#[must_use]
pub fn pair([first, second]: [u32; 2], quadrant: u32) -> (f32, f32) {
    /// Returns the middle of one of 2³² equal parts of (-1, 1). After rounding it may be exactly -1 or 1.
    #[inline(always)]
    fn middle(bits: u32) -> f32 {
        (bits as i32 as f32 + 0.5) * (1.0 / (1u32 << 31) as f32)
    }
    let distance = (-2.0 * ln32(middle(first >> 1))).sqrt();
    // An angle of at most 45° to an axis. The bits of `quadrant` choose the axis and its direction.
    let (sin, cos) = sin_cos32(middle(second) * FRAC_PI_4);
    let (across, along) = (sin * distance, cos * distance);
    let along = f32::from_bits(along.to_bits() ^ (quadrant & 1 << 31));
    if quadrant & 1 << 30 == 0 { (along, across) } else { (across, along) }
}

/// Draws a standard normal number.
pub fn sample(stream: &mut impl Rng) -> f64 {
    let [first, second] = [stream.next_u64(), stream.next_u64()];
    pair([first, second].map(|bits| (bits >> 32) as u32), first as u32).0.into()
}

/// Returns the probability of the interval from -`below` to `above`, Φ(above) - Φ(-below), without cancellation.
pub fn mass_around_mean(below: f64, above: f64) -> f64 {
    0.5 * (libm::erf(below * FRAC_1_SQRT_2) + libm::erf(above * FRAC_1_SQRT_2))
}

/// Returns the probability of the interval from `low` to `high`, Φ(high) - Φ(low), with a small relative error in both tails.
pub fn mass_between(low: f64, high: f64) -> f64 {
    if low > 0.0 {
        0.5 * (libm::erfc(low * FRAC_1_SQRT_2) - libm::erfc(high * FRAC_1_SQRT_2))
    } else if high < 0.0 {
        mass_between(-high, -low)
    } else {
        mass_around_mean(-low, high)
    }
}

/// From here on, [`mass_below`] is 1, with an error of 6e-10.
pub const FAR: f64 = 6.1;

/// Returns Φ(x) for x from 0 to [`FAR`], with an error below 2e-10.
///
/// It is the polynomial of degree 22 through the values at the zeros of a Chebyshev polynomial. It has no branches, so that the
/// compiler can vectorise a loop over it.
#[inline(always)]
pub fn mass_below(x: f64) -> f64 {
    let t = x * (2.0 / FAR) - 1.0;
    MASS_BELOW.iter().rev().fold(0.0, |sum, coefficient| sum * t + coefficient)
}

/// Coefficients of [`mass_below`], for t from -1 to 1.
const MASS_BELOW: [f64; 23] = [
    9.988_557_931_689_773e-1,
    1.161_977_145_470_005_3e-2,
    -5.404_647_402_187_563e-2,
    1.495_738_809_639_974e-1,
    -2.640_577_430_287_438e-1,
    2.825_610_953_629_814_6e-1,
    -1.105_746_372_690_968_2e-1,
    -1.658_944_662_337_088e-1,
    3.031_651_424_507_819e-1,
    -1.638_422_608_290_805_8e-1,
    -9.849_480_434_341_477e-2,
    2.101_141_855_611_567e-1,
    -9.287_024_069_102_631e-2,
    -7.686_177_680_109_783e-2,
    1.070_503_208_497_639e-1,
    -1.277_085_310_564_803e-2,
    -4.971_727_248_033_72e-2,
    2.336_337_653_550_427e-2,
    1.168_046_990_220_360_6e-2,
    -9.268_113_296_809_885e-3,
    -8.850_777_105_587_174e-4,
    1.405_160_230_437_525e-3,
    -1.054_771_374_379_939_2e-4,
];

/// Returns the density φ(x).
pub fn density(x: f64) -> f64 {
    libm::exp(-0.5 * x * x) / libm::sqrt(2.0 * PI)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random;
    use rand::RngExt;

    const COUNT: usize = 1_000_000;

    fn pairs() -> Vec<[f64; 2]> {
        let mut stream = random::stream(11, 0);
        let mut draw = || <[f32; 2]>::from(pair([stream.random(), stream.random()], stream.random())).map(f64::from);
        (0..COUNT).map(|_| draw()).collect()
    }

    /// The test of Kolmogorov and Smirnov, at a level of about 1e-5.
    #[test]
    fn both_numbers_are_normal() {
        for which in 0..2 {
            let mut numbers: Vec<f64> = pairs().iter().map(|pair| pair[which]).collect();
            numbers.sort_by(f64::total_cmp);
            let cdf = |x: f64| 0.5 * libm::erfc(-x * FRAC_1_SQRT_2);
            let off = numbers.iter().enumerate().map(|(index, &x)| (cdf(x) - index as f64 / COUNT as f64).abs());
            let off = off.fold(0.0, f64::max);
            assert!(off < 2.5 / (COUNT as f64).sqrt(), "number {which} is off by {off}");
            // In a normal distribution, 1 number in 15,787 is beyond ±4.
            let beyond = |limit: f64| numbers.iter().filter(|x| x.abs() > limit).count() as f64;
            assert!((beyond(4.0) - COUNT as f64 / 15_787.0).abs() < 40.0, "{} are beyond 4", beyond(4.0));
        }
    }

    #[test]
    fn the_two_numbers_are_independent() {
        let mut quadrants = [0.0; 8];
        let (mut products, mut squares) = (0.0, 0.0);
        for [x, y] in pairs() {
            quadrants[usize::from(x < 0.0) + 2 * usize::from(y < 0.0) + 4 * usize::from(x.abs() < y.abs())] += 1.0;
            products += x * y;
            squares += (x * x - 1.0) * (y * y - 1.0);
        }
        let count = COUNT as f64;
        assert!(
            quadrants.iter().all(|eighth| (eighth - count / 8.0).abs() < 4.5 * (count * 7.0 / 64.0).sqrt()),
            "{quadrants:?}"
        );
        assert!(products.abs() < 4.5 * count.sqrt() && squares.abs() < 4.5 * 2.0 * count.sqrt(), "{products} {squares}");
    }

    #[test]
    fn extreme_bits_give_small_numbers() {
        for bits in [0, 1, u32::MAX / 2, u32::MAX - 1, u32::MAX, 1 << 31] {
            for other in [0, u32::MAX, 1 << 31, 1 << 30] {
                let (x, y) = pair([bits, other], other);
                assert!(x.abs() < 6.7 && y.abs() < 6.7, "{x} {y} of {bits} {other}");
            }
        }
    }

    #[test]
    fn the_bytes_do_not_change() {
        let bits = <[f32; 2]>::from(pair([0x1234_5678, 0x9abc_def0], 1 << 30)).map(f32::to_bits);
        assert_eq!(bits, [3_215_676_459, 1_072_647_996]);
    }

    #[test]
    fn the_mass_between_is_the_same_in_both_tails() {
        assert!((mass_between(-1.0, 1.0) - 0.682_689_492_137_085_9).abs() < 1e-15);
        assert!((mass_between(0.0, 1.0) - 0.5 * mass_between(-1.0, 1.0)).abs() < 1e-16);
        // Φ(-10) - Φ(-11) = 7.6198530241605e-24 - 1.9106595744987e-28
        for mass in [mass_between(-11.0, -10.0), mass_between(10.0, 11.0)] {
            assert!((mass / 7.619_661_958_203e-24 - 1.0).abs() < 1e-12, "{mass:e}");
        }
    }

    #[test]
    fn the_mass_below_agrees_with_libm() {
        for step in 0..=100_000 {
            let x = FAR * f64::from(step) / 100_000.0;
            let off = mass_below(x) - mass_around_mean(f64::INFINITY, x);
            assert!(off.abs() < 2e-10, "mass_below({x}) is off by {off:e}");
        }
        assert!(1.0 - mass_around_mean(f64::INFINITY, FAR) < 6e-10);
    }
}
