//! Sine and cosine of a group of angles: vectorised, and the same bytes as `libm::sincos`.

use super::elementary::{COS, ROUND, SIN};
use super::{GROUP, Group};

/// π/2 as the sum of a number of 33 bits and the rest (fdlibm, `e_rem_pio2.c`).
const HALF_PI: [f64; 2] = [1.570_796_326_734_125_6, 6.077_100_506_506_192e-11];

/// Angles from here on are left to `libm`.
const MAX_ANGLE: f64 = 2e4;

/// If a reduced angle is smaller than this share of the angle, `libm` reduces it more exactly.
const CANCELLED: f64 = 1.0 / 32_768.0;

/// An angle this near to the border between two quarters, in quarters, may be in either of them in `libm`.
const BORDER: f64 = 1e-4;

/// The last angle that a whole group had: groups of a robot that does not turn have the same one.
#[derive(Debug, Clone, Copy)]
pub struct Last {
    angle: f64,
    sin: f64,
    cos: f64,
}

impl Last {
    fn new(angle: f64) -> Self {
        let (sin, cos) = libm::sincos(angle);
        Self { angle, sin, cos }
    }
}

impl Default for Last {
    fn default() -> Self {
        Self { angle: 0.0, sin: 0.0, cos: 1.0 }
    }
}

/// Writes the sine of each angle \[rad\]: the same bytes as `libm::sin`.
#[inline(always)]
pub fn sin(angles: &Group, sin: &mut Group) {
    /// Up to here, an angle is not reduced.
    const SMALL: f64 = 0.785;
    if angles.iter().fold(true, |small, angle| small & (angle.abs() < SMALL)) {
        for slot in 0..GROUP {
            sin[slot] = of_small(angles[slot]);
        }
        return;
    }
    sincos(angles, sin, &mut [0.0; GROUP], &mut Last::default());
}

/// Returns the sine of an angle in [-π/4, π/4].
#[inline(always)]
fn of_small(x: f64) -> f64 {
    let z = x * x;
    let sin = x + z * x * (SIN[0] + z * sin_rest(z));
    if x == 0.0 { x } else { sin }
}

/// Returns the polynomial of `k_sin.c` without its first coefficient, over x⁵.
#[inline(always)]
fn sin_rest(z: f64) -> f64 {
    SIN[1] + z * (SIN[2] + z * SIN[3]) + z * (z * z) * (SIN[4] + z * SIN[5])
}

/// Writes the sine and the cosine of each angle \[rad\]: the same bytes as `libm::sincos`.
///
/// Almost all angles take the steps of fdlibm in its order: the reduction to [-π/4, π/4] in one round, then the polynomials of
/// `k_sin.c` and `k_cos.c`. The others go to `libm`: angles near a multiple of π/2 or near the border of a quarter, and large
/// ones.
///
/// `last` is what groups of equal angles leave for the next group.
#[inline(always)]
pub fn sincos(angles: &Group, sin: &mut Group, cos: &mut Group, last: &mut Last) {
    if angles.iter().fold(true, |same, angle| same & (*angle == angles[0])) {
        if last.angle.to_bits() != angles[0].to_bits() {
            *last = Last::new(angles[0]);
        }
        (*sin, *cos) = ([last.sin; GROUP], [last.cos; GROUP]);
        return;
    }
    let mut are_usual = true;
    for slot in 0..GROUP {
        let (is_usual, of_slot) = usual(angles[slot]);
        (sin[slot], cos[slot]) = of_slot;
        are_usual &= is_usual;
    }
    if !are_usual {
        correct(angles, sin, cos);
    }
}

/// Replaces the results for angles that [`usual`] does not cover.
#[cold]
#[inline(never)]
fn correct(angles: &Group, sin: &mut Group, cos: &mut Group) {
    for slot in 0..GROUP {
        if !usual(angles[slot]).0 {
            (sin[slot], cos[slot]) = libm::sincos(angles[slot]);
        }
    }
}

/// Returns true if the result is that of `libm`, and the sine and cosine.
#[inline(always)]
fn usual(angle: f64) -> (bool, (f64, f64)) {
    let shifted = angle * std::f64::consts::FRAC_2_PI + ROUND;
    let quarters = shifted - ROUND;
    let quarter = shifted.to_bits();
    let r = angle - quarters * HALF_PI[0];
    let w = quarters * HALF_PI[1];
    let x = r - w;
    let rest = (r - x) - w;
    let beside = (angle * std::f64::consts::FRAC_2_PI - quarters).abs();
    // The last comparison is false for 0, whose sign counts.
    let is_usual = (angle.abs() < MAX_ANGLE) & (beside < 0.5 - BORDER) & (x.abs() > angle.abs() * CANCELLED);

    let z = x * x;
    let square = z * z;
    let cube = z * x;
    let by_z = sin_rest(z);
    let without_rest = x + cube * (SIN[0] + z * by_z);
    let with_rest = x - ((z * (0.5 * rest - cube * by_z) - rest) - cube * SIN[0]);
    let sin = if quarters == 0.0 { without_rest } else { with_rest };

    let by_z = z * (COS[0] + z * (COS[1] + z * COS[2])) + square * square * (COS[3] + z * (COS[4] + z * COS[5]));
    let half = 0.5 * z;
    let main = 1.0 - half;
    let cos = main + (((1.0 - main) - half) + (z * by_z - x * rest));

    let (along, across) = if quarter & 1 == 0 { (cos, sin) } else { (sin, cos) };
    let cos = if quarter.wrapping_add(1) & 2 == 0 { along } else { -along };
    let sin = if quarter & 2 == 0 { across } else { -across };
    (is_usual, (sin, cos))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random;
    use rand::RngExt;
    use std::f64::consts::FRAC_PI_4;

    fn assert_same_as_libm(angles: &Group) -> usize {
        let (mut sin, mut cos) = ([0.0; GROUP], [0.0; GROUP]);
        sincos(angles, &mut sin, &mut cos, &mut Last::default());
        let mut alone = [0.0; GROUP];
        super::super::sincos::sin(angles, &mut alone);
        for slot in 0..GROUP {
            let (expected_sin, expected_cos) = libm::sincos(angles[slot]);
            let bits = [sin[slot], cos[slot]].map(f64::to_bits);
            assert!(
                alone[slot].is_nan() || alone[slot].to_bits() == libm::sin(angles[slot]).to_bits(),
                "{:e}",
                angles[slot]
            );
            let is_nan = sin[slot].is_nan() && cos[slot].is_nan() && !angles[slot].is_finite();
            assert!(is_nan || bits == [expected_sin, expected_cos].map(f64::to_bits), "{:e}", angles[slot]);
        }
        angles.iter().filter(|angle| usual(**angle).0).count()
    }

    #[test]
    fn every_angle_gives_the_bytes_of_libm() {
        let mut stream = random::stream(5, 0);
        let mut usual = 0;
        for scale in [1e-300, 1e-9, 0.1, 1.0, 7.0, 100.0, 1e4, 2e6, 1e300] {
            for _ in 0..20_000 {
                let angles = std::array::from_fn(|_| (stream.random::<f64>() - 0.5) * scale);
                usual += assert_same_as_libm(&angles);
            }
        }
        assert!(usual > 4_000_000, "only {usual} were computed in groups");
    }

    #[test]
    fn angles_near_the_borders_give_the_bytes_of_libm() {
        let mut stream = random::stream(6, 0);
        for eighth in -40..40 {
            for exponent in 0..56 {
                for _ in 0..8 {
                    let off = libm::exp2(-f64::from(exponent));
                    let center = f64::from(eighth) * FRAC_PI_4;
                    let angles = std::array::from_fn(|_| center + (stream.random::<f64>() - 0.5) * off);
                    assert_same_as_libm(&angles);
                }
            }
        }
    }

    #[test]
    fn special_numbers_give_what_libm_gives() {
        let special =
            [0.0, -0.0, f64::NAN, f64::INFINITY, f64::NEG_INFINITY, f64::MIN_POSITIVE, 5e-324, f64::MAX, MAX_ANGLE];
        for first in special {
            let mut angles = [first; GROUP];
            assert_same_as_libm(&angles);
            angles[GROUP - 1] = 0.5;
            assert_same_as_libm(&angles);
        }
    }
}
