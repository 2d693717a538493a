//! Poses in the plane: composition, inversion, transformation of points, angles and quaternions.

use std::f64::consts::{PI, TAU};
use std::ops::Mul;

use glam::DVec2;

use crate::error::{Error, check_finite, check_number};

/// Position \[m\] and yaw \[rad\] of a child frame in its parent frame.
///
/// A variable that holds a pose is named after its parent frame, then its child frame. In a product the frames that meet are
/// then equal: `map_from_laser = map_from_base * base_from_laser`.
///
/// ```
/// use mobile_robot_simulator::Pose;
/// use std::f64::consts::FRAC_PI_2;
///
/// // The robot is at (1, 2) and faces +y; its laser sits 0.5 m ahead of its centre.
/// let map_from_base = Pose::new(1.0, 2.0, FRAC_PI_2);
/// let base_from_laser = Pose::new(0.5, 0.0, 0.0);
/// let map_from_laser = map_from_base * base_from_laser;
/// assert_eq!(map_from_laser.to_array(), [1.0, 2.5, FRAC_PI_2]);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Pose {
    /// Position in the parent frame \[m\].
    pub position: DVec2,
    /// Heading in the parent frame \[rad\], counter-clockwise from its x axis. Not necessarily wrapped.
    pub yaw: f64,
}

impl Pose {
    /// Returns the pose at `(x, y)` \[m\] with heading `yaw` \[rad\].
    #[must_use]
    pub const fn new(x: f64, y: f64, yaw: f64) -> Self {
        Self { position: DVec2::new(x, y), yaw }
    }

    /// Returns the pose unchanged if x, y and yaw are finite.
    ///
    /// # Errors
    /// [`Error::Number`], which names the first coordinate that is not finite.
    pub fn checked(self) -> Result<Self, Error> {
        check_finite("x", self.position.x)?;
        check_finite("y", self.position.y)?;
        check_finite("yaw", self.yaw)?;
        Ok(self)
    }

    /// Returns the inverse: the pose of the parent frame in the child frame.
    ///
    /// ```
    /// use mobile_robot_simulator::Pose;
    ///
    /// assert_eq!(Pose::new(1.0, 2.0, 0.0).inverse(), Pose::new(-1.0, -2.0, 0.0));
    /// ```
    #[must_use]
    pub fn inverse(self) -> Self {
        Self { position: rotate(-self.position, -self.yaw), yaw: -self.yaw }
    }

    /// Returns the coordinates in the parent frame \[m\] of a point given in the child frame \[m\].
    #[must_use]
    pub fn transform_point(self, point: DVec2) -> DVec2 {
        self.position + rotate(point, self.yaw)
    }

    /// Returns the same pose with its yaw wrapped to (-π, π], see [`wrap_angle`].
    #[must_use]
    pub fn wrapped(self) -> Self {
        Self { yaw: wrap_angle(self.yaw), ..self }
    }

    /// Returns `[x, y, yaw]` in metres and radians.
    #[must_use]
    pub fn to_array(self) -> [f64; 3] {
        [self.position.x, self.position.y, self.yaw]
    }

    /// Returns the components `(z, w)` of the unit quaternion that rotates by `yaw` about z. Its x and y components are 0.
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

    /// Returns the composition `a_from_c = a_from_b * b_from_c`. Yaws add up and are not wrapped.
    #[allow(clippy::suspicious_arithmetic_impl, reason = "yaw angles add up when frames are composed")]
    fn mul(self, b_from_c: Self) -> Self {
        Self { position: self.transform_point(b_from_c.position), yaw: self.yaw + b_from_c.yaw }
    }
}

/// Returns `vector` rotated counter-clockwise by `angle` \[rad\].
pub(crate) fn rotate(vector: DVec2, angle: f64) -> DVec2 {
    let (sin, cos) = libm::sincos(angle);
    DVec2::new(cos, sin).rotate(vector)
}

/// Returns the angle in (-π, π] that has the same direction as `angle` \[rad\].
///
/// ```
/// use mobile_robot_simulator::wrap_angle;
/// use std::f64::consts::PI;
///
/// assert_eq!(wrap_angle(-PI), PI);
/// assert_eq!(wrap_angle(0.5), 0.5);
/// ```
#[must_use]
pub fn wrap_angle(angle: f64) -> f64 {
    if angle > -PI && angle <= PI {
        return angle;
    }
    let wrapped = libm::remainder(angle, TAU);
    if wrapped <= -PI { PI } else { wrapped }
}

/// Returns the yaw in \[-π, π\] \[rad\] of the rotation given by the quaternion `(x, y, z, w)`.
///
/// The quaternion may have any positive length. Roll and pitch are ignored.
///
/// # Errors
/// [`Error::Number`] if the quaternion has length 0 or is not finite.
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
    fn a_pose_times_its_inverse_is_the_identity() {
        let pose = Pose::new(-3.0, 0.7, 2.5);
        assert_close(pose * pose.inverse(), Pose::default());
        assert_close(pose.inverse() * pose, Pose::default());
    }

    #[test]
    fn angles_wrap_to_the_half_open_interval() {
        assert_eq!(wrap_angle(PI), PI);
        assert_eq!(wrap_angle(-PI), PI);
        assert!((wrap_angle(7.0) - (7.0 - TAU)).abs() < 1e-15);
    }

    #[test]
    fn yaw_survives_the_round_trip_through_a_quaternion() {
        for yaw in [-3.0, -1.0, 0.0, 0.3, 3.1] {
            let (z, w) = Pose::new(0.0, 0.0, yaw).to_quaternion();
            for length in [1.0, 2.0] {
                let found = yaw_from_quaternion(0.0, 0.0, length * z, length * w).expect("a quaternion of positive length");
                assert!((found - yaw).abs() < 1e-15);
            }
        }
    }

    #[test]
    fn a_quaternion_of_length_zero_or_nan_is_an_error() {
        let error = |w| yaw_from_quaternion(0.0, 0.0, 0.0, w).unwrap_err().to_string();
        assert_eq!(error(0.0), "the length of a quaternion must be positive and finite, got 0");
        assert_eq!(error(f64::NAN), "the length of a quaternion must be positive and finite, got NaN");
    }

    #[test]
    fn the_error_names_the_coordinate_that_is_not_finite() {
        let error = Pose::new(0.0, f64::NAN, 0.0).checked().unwrap_err();
        assert_eq!(error.to_string(), "y must be finite, got NaN");
    }
}
