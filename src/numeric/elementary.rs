//! Elementary functions that vectorise and give the same bytes on every machine.

use super::{GROUP, Group};

/// Largest angle for [`direction`]. Up to here a multiple of the first part of [`HALF_PI`] is exact.
const MAX_ANGLE: f64 = 1e5;

/// π/2 as the sum of three parts; the first two have 33 bits each (fdlibm, `e_rem_pio2.c`).
const HALF_PI: [f64; 3] = [1.570_796_326_734_125_6, 6.077_100_506_303_966e-11, 2.022_266_248_795_950_6e-21];

/// Adding this number to a number below 2⁵¹ and subtracting it again rounds to the nearest integer.
pub(super) const ROUND: f64 = 6_755_399_441_055_744.0;

/// Writes the cosine and the sine of each angle to `cos` and `sin`, to within 2 ulp. Returns true if all angles are finite.
///
/// Angles are reduced to [-π/4, π/4] (Cody & Waite 1980), then evaluated with the polynomials of fdlibm (`k_sin.c`,
/// `k_cos.c`). Angles that are too large for the reduction go to `libm`.
#[inline(always)]
pub fn directions(angles: &Group, cos: &mut Group, sin: &mut Group) -> bool {
    let mut are_small = true;
    for slot in 0..GROUP {
        (cos[slot], sin[slot]) = direction(angles[slot]);
        are_small &= angles[slot].abs() <= MAX_ANGLE;
    }
    if are_small {
        return true;
    }
    for slot in 0..GROUP {
        if angles[slot].abs() > MAX_ANGLE {
            (sin[slot], cos[slot]) = libm::sincos(angles[slot]);
        }
    }
    angles.iter().all(|angle| angle.is_finite())
}

/// Returns the cosine and the sine of an angle of at most [`MAX_ANGLE`].
#[inline(always)]
fn direction(angle: f64) -> (f64, f64) {
    let shifted = angle * std::f64::consts::FRAC_2_PI + ROUND;
    let quarters = shifted - ROUND;
    let quarter = shifted.to_bits();
    let near = (angle - quarters * HALF_PI[0]) - quarters * HALF_PI[1];
    let x = near - quarters * HALF_PI[2];
    let z = x * x;
    let sin = x + x * z * polynomial(z, &SIN);
    let cos = 1.0 - (0.5 * z - z * z * polynomial(z, &COS));
    let (along, across) = if quarter & 1 == 0 { (cos, sin) } else { (sin, cos) };
    let cos = if (quarter.wrapping_add(1)) & 2 == 0 { along } else { -along };
    let sin = if quarter & 2 == 0 { across } else { -across };
    (cos, sin)
}

/// Coefficients of (sin x - x) / x³ in powers of x² (fdlibm, `k_sin.c`).
pub(super) const SIN: [f64; 6] = [
    -1.666_666_666_666_663_2e-1,
    8.333_333_333_322_49e-3,
    -1.984_126_982_985_795e-4,
    2.755_731_370_707_006_8e-6,
    -2.505_076_025_340_686_3e-8,
    1.589_690_995_211_55e-10,
];

/// Coefficients of (cos x - 1 + x²/2) / x⁴ in powers of x² (fdlibm, `k_cos.c`).
pub(super) const COS: [f64; 6] = [
    4.166_666_666_666_66e-2,
    -1.388_888_888_887_411e-3,
    2.480_158_728_947_673e-5,
    -2.755_731_435_139_066_3e-7,
    2.087_572_321_298_175e-9,
    -1.135_964_755_778_819_5e-11,
];

/// Evaluates a polynomial by Horner's rule; the constant coefficient comes first.
#[inline(always)]
fn polynomial(x: f64, coefficients: &[f64; 6]) -> f64 {
    let [rest @ .., last] = coefficients;
    rest.iter().rev().fold(*last, |sum, coefficient| sum * x + coefficient)
}

/// Returns the sine and the cosine of an angle in [-π/4, π/4], to within 2⁻²³ (polynomials of Cephes, `sinf.c`).
#[inline(always)]
pub fn sin_cos32(x: f32) -> (f32, f32) {
    let z = x * x;
    let sin = x + x * z * (-0.166_666_55 + z * (0.008_332_161 - z * 0.000_195_152_96));
    let cos = 1.0 - z * (0.5 - z * (0.041_666_646 - z * (0.001_388_731_6 - z * 0.000_024_433_157)));
    (sin, cos)
}

/// Returns the natural logarithm of a positive number that is not subnormal, with a relative error of at most 2⁻²²
/// (polynomial of fdlibm, `e_logf.c`).
#[inline(always)]
pub fn ln32(x: f32) -> f32 {
    /// Bits of 1.
    const ONE: u32 = 0x3f80_0000;
    /// Bits of the smallest number that is at least √½.
    const SQRT_HALF: u32 = 0x3f35_04f4;
    // x = significand · 2^power, with the significand in [√½, √2).
    let shifted = x.to_bits().wrapping_add(ONE - SQRT_HALF);
    let power = (shifted >> 23) as i32 - 127;
    let significand = f32::from_bits((shifted & 0x007f_ffff) + SQRT_HALF);
    let s = (significand - 1.0) / (significand + 1.0);
    let z = s * s;
    let rest = z * ((0.666_666_6 + z * 0.400_009_72) + z * z * (0.284_987_87 + z * 0.242_790_79));
    power as f32 * std::f32::consts::LN_2 + s * (2.0 + rest)
}

/// Returns exp(x) for x from -87 to 87, with a relative error of at most 4e-7 + 1e-7 · |x|.
///
/// With `x = k · ln 2 + r` and `|r| <= ln 2 / 2`, it is 2ᵏ times the Taylor polynomial of exp(r) of degree 6, whose first omitted
/// term is smaller than 1.2e-7.
#[inline(always)]
pub fn exp32(x: f32) -> f32 {
    /// Adding this number to a number below 2²² and subtracting it again rounds to the nearest integer.
    const ROUND: f32 = 12_582_912.0;
    let shifted = x * std::f32::consts::LOG2_E + ROUND;
    let r = x - (shifted - ROUND) * std::f32::consts::LN_2;
    let sum = 1.0 / 6.0 + r * (1.0 / 24.0 + r * (1.0 / 120.0 + r * (1.0 / 720.0)));
    let sum = 1.0 + r * (1.0 + r * (0.5 + r * sum));
    // The low bits of `shifted` are the integer k.
    sum * f32::from_bits(shifted.to_bits().wrapping_add(127) << 23)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random;
    use rand::RngExt;
    use std::f64::consts::FRAC_PI_2;

    #[test]
    fn directions_agree_with_libm() {
        let mut stream = random::stream(3, 0);
        let mut angle = |scale: f64| (stream.random::<f64>() - 0.5) * scale;
        for scale in [1e-300, 1e-9, 1.0, 7.0, 100.0, 2e5, 1e300] {
            for _ in 0..2000 {
                let mut angles = [0.0; GROUP];
                angles.fill_with(|| angle(scale));
                let (mut cos, mut sin) = ([0.0; GROUP], [0.0; GROUP]);
                assert!(directions(&angles, &mut cos, &mut sin));
                for slot in 0..GROUP {
                    let (expected_sin, expected_cos) = libm::sincos(angles[slot]);
                    let off = (cos[slot] - expected_cos).abs().max((sin[slot] - expected_sin).abs());
                    assert!(off < 3e-16, "{} is off by {off}", angles[slot]);
                }
            }
        }
    }

    #[test]
    fn quarter_turns_are_along_the_axes() {
        let angles = std::array::from_fn(|slot| (slot as f64 - 16.0) * FRAC_PI_2);
        let (mut cos, mut sin) = ([0.0; GROUP], [0.0; GROUP]);
        assert!(directions(&angles, &mut cos, &mut sin));
        for slot in 0..GROUP {
            let (expected_sin, expected_cos) = libm::sincos(angles[slot]);
            assert!((cos[slot] - expected_cos).abs() < 1e-17 || cos[slot] == expected_cos, "{slot}");
            assert!((sin[slot] - expected_sin).abs() < 1e-17 || sin[slot] == expected_sin, "{slot}");
        }
    }

    #[test]
    fn angles_that_are_not_finite_are_reported() {
        for angle in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let (mut angles, mut cos, mut sin) = ([1e6; GROUP], [0.0; GROUP], [0.0; GROUP]);
            assert!(directions(&angles, &mut cos, &mut sin));
            angles[GROUP - 1] = angle;
            assert!(!directions(&angles, &mut cos, &mut sin));
            assert!(cos[GROUP - 1].is_nan() && cos[0] == libm::cos(1e6));
        }
    }

    #[test]
    fn float32_functions_agree_with_float64() {
        let mut stream = random::stream(4, 0);
        for _ in 0..100_000 {
            let x = (stream.random::<f32>() - 0.5) * std::f32::consts::FRAC_PI_2;
            let ((sin, cos), (expected_sin, expected_cos)) = (sin_cos32(x), libm::sincos(x.into()));
            let off = (f64::from(sin) - expected_sin).abs().max((f64::from(cos) - expected_cos).abs());
            assert!(off < 1.2e-7, "{x} is off by {off}");
            for x in [stream.random::<f32>(), stream.random::<f32>() * 1e-8, 1.0 - stream.random::<f32>() * 1e-6] {
                let off = f64::from(ln32(x)) / libm::log(x.into()) - 1.0;
                assert!(x == 0.0 || x == 1.0 || off.abs() < 2.4e-7, "{x} has a relative error of {off}");
            }
        }
        assert_eq!(ln32(1.0), 0.0);
        for scale in [1e-6, 0.5, 2.0, 87.0] {
            for _ in 0..100_000 {
                let x = (2.0 * stream.random::<f32>() - 1.0) * scale;
                let off = f64::from(exp32(x)) / libm::exp(x.into()) - 1.0;
                assert!(off.abs() < 4e-7 + 1e-7 * f64::from(x.abs()), "exp({x}) has a relative error of {off:e}");
            }
        }
        assert_eq!(exp32(0.0), 1.0);
    }
}
