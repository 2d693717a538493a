//! The exponential function for a group of numbers, with the same bytes on every machine.

use super::elementary::ROUND;

/// ln 2 as the sum of a number of 32 bits and the rest (fdlibm, `e_exp.c`).
const LN_2: [f64; 2] = [6.931_471_803_691_238e-1, 1.908_214_929_270_587_7e-10];

/// Below this, the result is 0. The exponential of this number is still a normal number.
const LOWEST: f64 = -708.0;

/// Returns exp(x) for x ≤ 0, with a relative error below 1e-12; 0 below -708.
///
/// With `x = k · ln 2 + r` and `|r| <= ln 2 / 2`, it is 2ᵏ times the Taylor polynomial of exp(r) of degree 10, whose first
/// omitted term is smaller than 3e-13. It has no branches, so that the compiler can vectorise a loop over it.
#[inline(always)]
pub fn exp(x: f64) -> f64 {
    let shifted = x * std::f64::consts::LOG2_E + ROUND;
    let power = shifted - ROUND;
    let r = (x - power * LN_2[0]) - power * LN_2[1];
    let sum = TAYLOR.iter().rev().fold(0.0, |sum, coefficient| sum * r + coefficient);
    // The low bits of `shifted` are the integer k.
    let scale = f64::from_bits(shifted.to_bits().wrapping_add(1023) << 52);
    if x >= LOWEST { sum * scale } else { 0.0 }
}

/// 1 / n! for n from 0 to 10.
const TAYLOR: [f64; 11] = [
    1.0,
    1.0,
    1.0 / 2.0,
    1.0 / 6.0,
    1.0 / 24.0,
    1.0 / 120.0,
    1.0 / 720.0,
    1.0 / 5_040.0,
    1.0 / 40_320.0,
    1.0 / 362_880.0,
    1.0 / 3_628_800.0,
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random;
    use rand::RngExt;

    #[test]
    fn it_agrees_with_libm() {
        let mut stream = random::stream(8, 0);
        for scale in [1e-9, 0.5, 1.0, 40.0, 708.0] {
            for _ in 0..100_000 {
                let x = -stream.random::<f64>() * scale;
                let off = exp(x) / libm::exp(x) - 1.0;
                assert!(off.abs() < 1e-12, "exp({x}) has a relative error of {off:e}");
            }
        }
        assert_eq!([exp(0.0), exp(-708.1), exp(f64::NEG_INFINITY)], [1.0, 0.0, 0.0]);
        assert_eq!(exp(f64::NAN), 0.0);
    }
}
