//! Elementary functions in a form that vectorises, with the same bytes on every machine.

use super::{GROUP, Group};

/// Angles up to here are reduced by multiples of π/2 that leave the first part of it exact.
const LARGEST: f64 = 1e5;

/// π/2 in three parts, the first two with 33 bits each (fdlibm, `e_rem_pio2.c`).
const HALF_PI: [f64; 3] = [1.570_796_326_734_125_6, 6.077_100_506_303_966e-11, 2.022_266_248_795_950_6e-21];

/// Adding this to a number of less than 51 bits and taking it off again rounds to a whole number.
const ROUND: f64 = 6_755_399_441_055_744.0;

/// Puts the cosines and sines of angles where they belong, to within 2 ulp; returns whether all of them are finite.
///
/// The polynomials of fdlibm (`k_sin.c`, `k_cos.c`) after a reduction to [-π/4, π/4] by Cody & Waite (1980); angles too large for
/// it go to `libm`.
#[inline(always)]
pub fn directions(angles: &Group, cos: &mut Group, sin: &mut Group) -> bool {
    let mut are_small = true;
    for place in 0..GROUP {
        (cos[place], sin[place]) = direction(angles[place]);
        are_small &= angles[place].abs() <= LARGEST;
    }
    if are_small {
        return true;
    }
    for place in 0..GROUP {
        if angles[place].abs() > LARGEST {
            (sin[place], cos[place]) = libm::sincos(angles[place]);
        }
    }
    angles.iter().all(|angle| angle.is_finite())
}

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

/// (sin x - x) / x³ in powers of x².
const SIN: [f64; 6] = [
    -1.666_666_666_666_663_2e-1,
    8.333_333_333_322_49e-3,
    -1.984_126_982_985_795e-4,
    2.755_731_370_707_006_8e-6,
    -2.505_076_025_340_686_3e-8,
    1.589_690_995_211_55e-10,
];

/// (cos x - 1 + x²/2) / x⁴ in powers of x².
const COS: [f64; 6] = [
    4.166_666_666_666_66e-2,
    -1.388_888_888_887_411e-3,
    2.480_158_728_947_673e-5,
    -2.755_731_435_139_066_3e-7,
    2.087_572_321_298_175e-9,
    -1.135_964_755_778_819_5e-11,
];

#[inline(always)]
fn polynomial(x: f64, coefficients: &[f64; 6]) -> f64 {
    let [rest @ .., last] = coefficients;
    rest.iter().rev().fold(*last, |sum, coefficient| sum * x + coefficient)
}

/// Sine and cosine of a float32 in [-π/4, π/4], to within 2⁻²³ (the polynomials of Cephes, `sinf.c`).
#[inline(always)]
pub fn sin_cos32(x: f32) -> (f32, f32) {
    let z = x * x;
    let sin = x + x * z * (-0.166_666_55 + z * (0.008_332_161 - z * 0.000_195_152_96));
    let cos = 1.0 - z * (0.5 - z * (0.041_666_646 - z * (0.001_388_731_6 - z * 0.000_024_433_157)));
    (sin, cos)
}

/// Logarithm of a positive float32 that is not subnormal, to within a relative 2⁻²² (fdlibm's polynomial for float32,
/// `e_logf.c`).
#[inline(always)]
pub fn ln32(x: f32) -> f32 {
    /// The bits of 1, and of the least number that is no less than √½.
    const ONE: u32 = 0x3f80_0000;
    const SQRT_HALF: u32 = 0x3f35_04f4;
    // The significand in [√½, √2), and the power of 2 that it comes with.
    let shifted = x.to_bits().wrapping_add(ONE - SQRT_HALF);
    let power = (shifted >> 23) as i32 - 127;
    let significand = f32::from_bits((shifted & 0x007f_ffff) + SQRT_HALF);
    let s = (significand - 1.0) / (significand + 1.0);
    let z = s * s;
    let rest = z * ((0.666_666_6 + z * 0.400_009_72) + z * z * (0.284_987_87 + z * 0.242_790_79));
    power as f32 * std::f32::consts::LN_2 + s * (2.0 + rest)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random;
    use rand::RngExt;
    use std::f64::consts::FRAC_PI_2;

    #[test]
    fn directions_are_those_of_libm() {
        let mut stream = random::stream(3, 0);
        let mut angle = |scale: f64| (stream.random::<f64>() - 0.5) * scale;
        for scale in [1e-300, 1e-9, 1.0, 7.0, 100.0, 2e5, 1e300] {
            for _ in 0..2000 {
                let mut angles = [0.0; GROUP];
                angles.fill_with(|| angle(scale));
                let (mut cos, mut sin) = ([0.0; GROUP], [0.0; GROUP]);
                assert!(directions(&angles, &mut cos, &mut sin));
                for place in 0..GROUP {
                    let (expected_sin, expected_cos) = libm::sincos(angles[place]);
                    let off = (cos[place] - expected_cos).abs().max((sin[place] - expected_sin).abs());
                    assert!(off < 3e-16, "{} is off by {off}", angles[place]);
                }
            }
        }
    }

    #[test]
    fn quarters_of_a_turn_go_along_the_axes() {
        let angles = std::array::from_fn(|place| (place as f64 - 16.0) * FRAC_PI_2);
        let (mut cos, mut sin) = ([0.0; GROUP], [0.0; GROUP]);
        assert!(directions(&angles, &mut cos, &mut sin));
        for place in 0..GROUP {
            let (expected_sin, expected_cos) = libm::sincos(angles[place]);
            assert!((cos[place] - expected_cos).abs() < 1e-17 || cos[place] == expected_cos, "{place}");
            assert!((sin[place] - expected_sin).abs() < 1e-17 || sin[place] == expected_sin, "{place}");
        }
    }

    #[test]
    fn angles_that_are_not_finite_have_no_direction() {
        for angle in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let (mut angles, mut cos, mut sin) = ([1e6; GROUP], [0.0; GROUP], [0.0; GROUP]);
            assert!(directions(&angles, &mut cos, &mut sin));
            angles[GROUP - 1] = angle;
            assert!(!directions(&angles, &mut cos, &mut sin));
            assert!(cos[GROUP - 1].is_nan() && cos[0] == libm::cos(1e6));
        }
    }

    #[test]
    fn float32_functions_are_those_of_float64() {
        let mut stream = random::stream(4, 0);
        for _ in 0..100_000 {
            let x = (stream.random::<f32>() - 0.5) * std::f32::consts::FRAC_PI_2;
            let ((sin, cos), (expected_sin, expected_cos)) = (sin_cos32(x), libm::sincos(x.into()));
            let off = (f64::from(sin) - expected_sin).abs().max((f64::from(cos) - expected_cos).abs());
            assert!(off < 1.2e-7, "{x} is off by {off}");
            for x in [stream.random::<f32>(), stream.random::<f32>() * 1e-8, 1.0 - stream.random::<f32>() * 1e-6] {
                let off = f64::from(ln32(x)) / libm::log(x.into()) - 1.0;
                assert!(x == 0.0 || x == 1.0 || off.abs() < 2.4e-7, "{x} is off by a part of {off}");
            }
        }
        assert_eq!(ln32(1.0), 0.0);
    }
}
