//! Poses in the plane: compose, invert, transform.

use std::f64::consts::{PI, TAU};
use std::ops::Mul;

use glam::DVec2;

use crate::error::{Error, check_number};

/// Position \[m\] and heading \[rad\] of one frame in another.
///
/// Named target first, so that neighbours match: `map_from_laser = map_from_base * base_from_laser`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Pose {
    /// Position in metres.
    pub position: DVec2,
    /// Heading in radians, counter-clockwise from x.
    pub yaw: f64,
}

impl Pose {
    /// The pose at `(x, y)` that looks along `yaw`.
    #[must_use]
    pub const fn new(x: f64, y: f64, yaw: f64) -> Self {
        Self { position: DVec2::new(x, y), yaw }
    }

    /// The pose, if all of it is finite.
    ///
    /// # Errors
    /// [`Error::Number`] names the coordinate that is not finite.
    pub fn checked(self) -> Result<Self, Error> {
        check_number("x", self.position.x, "finite", |_| true)?;
        check_number("y", self.position.y, "finite", |_| true)?;
        check_number("yaw", self.yaw, "finite", |_| true)?;
        Ok(self)
    }

    /// The pose of the parent frame in this one.
    #[must_use]
    pub fn inverse(self) -> Self {
        Self { position: rotate(-self.position, -self.yaw), yaw: -self.yaw }
    }

    /// A point of this frame, in the parent frame.
    #[must_use]
    pub fn transform_point(self, point: DVec2) -> DVec2 {
        self.position + rotate(point, self.yaw)
    }

    /// The same pose with its yaw in (-π, π].
    #[must_use]
    pub fn wrapped(self) -> Self {
        Self { yaw: wrap_angle(self.yaw), ..self }
    }

    /// The numbers `[x, y, yaw]`.
    #[must_use]
    pub fn to_array(self) -> [f64; 3] {
        [self.position.x, self.position.y, self.yaw]
    }

    /// The rotation about z as the quaternion parts `(z, w)`; `x` and `y` are zero.
    #[must_use]
    pub fn to_quaternion(self) -> (f64, f64) {
        libm::sincos(0.5 * self.yaw)
    }
}

impl From<[f64; 3]> for Pose {
    fn from([x, y, yaw]: [f64; 3]) -> Self {
        Self::new(x, y, yaw)
    }
}

impl Mul for Pose {
    type Output = Self;

    #[allow(clippy::suspicious_arithmetic_impl, reason = "headings add up when frames are composed")]
    fn mul(self, inner: Self) -> Self {
        Self { position: self.transform_point(inner.position), yaw: self.yaw + inner.yaw }
    }
}

/// `vector` turned counter-clockwise by `angle`.
pub(crate) fn rotate(vector: DVec2, angle: f64) -> DVec2 {
    let (sin, cos) = libm::sincos(angle);
    DVec2::new(cos, sin).rotate(vector)
}

/// The same direction in (-π, π].
#[must_use]
pub fn wrap_angle(angle: f64) -> f64 {
    let wrapped = libm::remainder(angle, TAU);
    if wrapped <= -PI { PI } else { wrapped }
}

/// The heading of a rotation given as a quaternion, of any length but zero.
///
/// Roll and pitch are passed over, as robots of the plane do.
///
/// # Errors
/// A quaternion of length zero, or one that is not finite.
pub fn yaw_from_quaternion(x: f64, y: f64, z: f64, w: f64) -> Result<f64, Error> {
    let length = libm::sqrt(x * x + y * y + z * z + w * w);
    check_number("the length of a quaternion", length, "positive and finite", |value| value > 0.0)?;
    Ok(libm::atan2(2.0 * (w * z + x * y), w * w + x * x - y * y - z * z))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    fn assert_close(left: Pose, right: Pose) {
        assert!((left.position - right.position).length() < 1e-12, "{left:?} {right:?}");
        assert!(wrap_angle(left.yaw - right.yaw).abs() < 1e-12, "{left:?} {right:?}");
    }

    #[test]
    fn composition_moves_along_the_heading() {
        assert_close(Pose::new(1.0, 2.0, FRAC_PI_2) * Pose::new(3.0, 0.0, 0.5), Pose::new(1.0, 5.0, FRAC_PI_2 + 0.5));
    }

    #[test]
    fn a_pose_times_its_inverse_is_nothing() {
        let pose = Pose::new(-3.0, 0.7, 2.5);
        assert_close(pose * pose.inverse(), Pose::default());
        assert_close(pose.inverse() * pose, Pose::default());
    }

    #[test]
    fn angles_wrap_into_the_half_open_turn() {
        assert_eq!(wrap_angle(PI), PI);
        assert_eq!(wrap_angle(-PI), PI);
        assert!((wrap_angle(7.0) - (7.0 - TAU)).abs() < 1e-15);
    }

    #[test]
    fn quaternions_go_there_and_back() {
        for yaw in [-3.0, -1.0, 0.0, 0.3, 3.1] {
            let (z, w) = Pose::new(0.0, 0.0, yaw).to_quaternion();
            for length in [1.0, 2.0] {
                let found = yaw_from_quaternion(0.0, 0.0, length * z, length * w).expect("a rotation");
                assert!((found - yaw).abs() < 1e-15);
            }
        }
    }

    #[test]
    fn a_quaternion_without_a_length_is_no_rotation() {
        let error = |w| yaw_from_quaternion(0.0, 0.0, 0.0, w).unwrap_err().to_string();
        assert_eq!(error(0.0), "the length of a quaternion must be positive and finite, got 0");
        assert_eq!(error(f64::NAN), "the length of a quaternion must be positive and finite, got NaN");
    }

    #[test]
    fn a_pose_that_is_not_finite_is_refused_by_name() {
        let error = Pose::new(0.0, f64::NAN, 0.0).checked().unwrap_err();
        assert_eq!(error.to_string(), "y must be finite, got NaN");
    }
}
