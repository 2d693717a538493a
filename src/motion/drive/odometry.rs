//! Odometry from the angles of the wheels, as a base computes it from its encoders.

use std::f64::consts::TAU;

use super::super::Twist;
use super::{Drive, MAX_WHEELS};
use crate::error::{Error, check_finite, check_number};

impl Drive {
    /// Returns the motion that a robot with this drive computes from the angles of its wheels \[rad\] before and after it: the
    /// distances forward and to the left \[m\] and the turn \[rad\] of an arc.
    ///
    /// Each wheel has an encoder with `ticks` counts per turn; 0 for one that is exact. An encoder shows whole counts, so its
    /// error is less than one count and does not grow. `steering` is the mean steering angle on the way \[rad\], as for
    /// [`twist`](Self::twist).
    ///
    /// # Errors
    /// - [`Error::Length`]: there is not one angle for each wheel.
    /// - [`Error::Number`]: a number or the result is not finite, `ticks` is negative, or there is a steering angle for a drive
    ///   that does not steer. [`Error::Degrees`]: it is beyond [`MAX_STEERING`](super::MAX_STEERING).
    pub fn odometry(&self, before: &[f64], after: &[f64], steering: Option<f64>, ticks: f64) -> Result<Twist, Error> {
        let count = self.wheel_count();
        for (name, angles) in [("before", before), ("after", after)] {
            if angles.len() != count {
                return Err(Error::Length { name, value: angles.len(), needed: count });
            }
            angles.iter().try_for_each(|&angle| check_finite(name, angle).map(|_| ()))?;
        }
        check_number("ticks", ticks, "at least 0", |value| value >= 0.0)?;
        self.checked_steering("steering_angle", steering.unwrap_or(0.0))?;
        let mut turned = [0.0; MAX_WHEELS];
        for (turned, (before, after)) in turned.iter_mut().zip(before.iter().zip(after)) {
            *turned = if ticks == 0.0 {
                after - before
            } else {
                (libm::floor(after * ticks / TAU) - libm::floor(before * ticks / TAU)) * (TAU / ticks)
            };
        }
        let motion = self.twist(&turned[..count], steering);
        motion.to_array().iter().try_for_each(|&number| check_finite("the resulting motion", number).map(|_| ()))?;
        Ok(motion)
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::integrate;
    use super::*;
    use crate::pose::Pose;

    #[test]
    fn whole_counts_are_never_off_by_more_than_one() {
        let drive = Drive::differential(0.5, 0.1).unwrap();
        let (mut pose, mut angle) = (Pose::default(), 0.0);
        for nth in 1..=1000 {
            let next = 0.037 * f64::from(nth);
            pose = integrate(pose, drive.odometry(&[angle; 2], &[next; 2], None, 360.0).unwrap(), 1.0);
            angle = next;
            let exact = 0.1 * next;
            assert!(pose.position.x <= exact + 1e-12 && pose.position.x > exact - 0.1 * TAU / 360.0 - 1e-12, "{nth}");
        }
        // 37 rad are 2119.9 counts of a degree.
        assert!((pose.position.x - 0.1 * 2119.0 * TAU / 360.0).abs() < 1e-12);
    }

    #[test]
    fn exact_encoders_give_the_arc() {
        let drive = Drive::omni(0.4, 0.3, 0.1).unwrap();
        let twist = Twist::from([0.6, -0.2, 0.9]);
        let after = drive.wheels(twist, 0.0).map(|rate| 2.0 * rate + 1.0);
        let start = Pose::new(1.0, 2.0, 0.5);
        let found = integrate(start, drive.odometry(&[1.0; 4], &after, None, 0.0).unwrap(), 1.0);
        let exact = integrate(start, twist, 2.0);
        assert!((found.position - exact.position).length() < 1e-14 && (found.yaw - exact.yaw).abs() < 1e-14);
    }

    #[test]
    fn a_wrong_calibration_scales_what_the_robot_believes() {
        let drive = Drive::differential(0.5, 0.1).unwrap();
        let believed = drive.with_multipliers([1.02, 0.98], 1.1).unwrap();
        // Straight ahead, it believes to turn by the difference of 4 % of 1 m over a track of 0.55 m.
        let arc = believed.odometry(&[0.0; 2], &[10.0; 2], None, 0.0).unwrap().to_array();
        assert!((arc[0] - 1.0).abs() < 1e-15 && (arc[2] + 0.04 / 0.55).abs() < 1e-15, "{arc:?}");
    }

    #[test]
    fn bad_angles_are_refused() {
        let drive = Drive::differential(0.5, 0.1).unwrap();
        let text = |before: &[f64], ticks| drive.odometry(before, &[0.0; 2], None, ticks).unwrap_err().to_string();
        assert_eq!(text(&[0.0], 0.0), "before must have 2 elements, got 1");
        assert_eq!(text(&[0.0, f64::NAN], 0.0), "before must be finite, got NaN");
        assert_eq!(text(&[0.0; 2], -1.0), "ticks must be at least 0, got -1");
    }
}
