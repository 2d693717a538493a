//! Limits on velocity, acceleration and deceleration, as a base controller applies them.

use super::ramp::Ramp;
use super::{Twist, traced};
use crate::error::{Error, check_finite, check_number};
use crate::pose::Pose;

/// Limits on the speed of each axis `[vx, vy, wz]` and on its rate of change. Infinity means no limit.
///
/// The limits are the same in both directions of an axis, and each axis is limited independently. Order, as in the
/// `diff_drive_controller` of `ros2_controllers`: acceleration first, then velocity.
///
/// ```
/// use mobile_robot_simulator::{Limits, Twist};
///
/// // At most 1 m/s; 0.5 m/s² to speed up, 2 m/s² to slow down; no sideways motion.
/// let limits = Limits::new([1.0, 0.0, 1.0], [0.5, 0.0, 1.0], [2.0, 0.0, 1.0])?;
/// let (still, fast) = (Twist::from([0.0; 3]), Twist::from([3.0, 0.0, 0.0]));
/// assert_eq!(limits.apply(fast, still, 0.5)?.to_array(), [0.25, 0.0, 0.0]);
/// assert_eq!(limits.apply(fast, still, 60.0)?.to_array(), [1.0, 0.0, 0.0]);
/// assert_eq!(limits.apply(still, Twist::from([1.0, 0.0, 0.0]), 0.25)?.to_array(), [0.5, 0.0, 0.0]);
/// # Ok::<(), mobile_robot_simulator::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    pub(super) velocity: [f64; 3],
    pub(super) acceleration: [f64; 3],
    pub(super) deceleration: [f64; 3],
}

impl Limits {
    /// No limits.
    pub const NONE: Self =
        Self { velocity: [f64::INFINITY; 3], acceleration: [f64::INFINITY; 3], deceleration: [f64::INFINITY; 3] };

    /// Returns limits for the axes `[vx, vy, wz]`: on speed \[m/s, rad/s\], its increase and its decrease \[m/s², rad/s²\].
    ///
    /// A velocity limit of 0 holds an axis still. An acceleration limit of 0 never lets it speed up, a deceleration limit of
    /// 0 never lets it slow down.
    ///
    /// # Errors
    /// [`Error::Number`] if a limit is negative or NaN.
    pub fn new(velocity: [f64; 3], acceleration: [f64; 3], deceleration: [f64; 3]) -> Result<Self, Error> {
        let named = [("velocity", velocity), ("acceleration", acceleration), ("deceleration", deceleration)];
        for (name, limits) in named {
            if let Some(&value) = limits.iter().find(|&&limit| limit.is_nan() || limit < 0.0) {
                return Err(Error::Number { name, value, needed: "at least 0 or inf" });
            }
        }
        Ok(Self { velocity, acceleration, deceleration })
    }

    /// Returns the limits on the speed of `[vx, vy, wz]` \[m/s, m/s, rad/s\].
    #[must_use]
    pub fn velocity(&self) -> [f64; 3] {
        self.velocity
    }

    /// Returns the limits on the increase of speed \[m/s², m/s², rad/s²\].
    #[must_use]
    pub fn acceleration(&self) -> [f64; 3] {
        self.acceleration
    }

    /// Returns the limits on the decrease of speed \[m/s², m/s², rad/s²\].
    #[must_use]
    pub fn deceleration(&self) -> [f64; 3] {
        self.deceleration
    }

    /// Returns the velocity after `dt` seconds of a robot that moves at `current` and is commanded to move at `wanted`.
    ///
    /// An axis that changes its direction first slows down to 0 at the deceleration limit, then uses the remaining time to
    /// speed up at the acceleration limit. A speed above the velocity limit drops to the limit
    /// immediately.
    ///
    /// # Errors
    /// [`Error::Number`] if a velocity is not finite, or `dt` is negative or not finite.
    pub fn apply(&self, wanted: Twist, current: Twist, dt: f64) -> Result<Twist, Error> {
        let ramp = self.ramp(wanted, current, dt)?;
        Ok(if dt > 0.0 { ramp.velocity(dt) } else { self.clamped(current) })
    }

    /// Returns the pose after `dt` seconds of a robot that starts at `pose`, moves at `current` and is commanded to move at
    /// `wanted`.
    ///
    /// The velocity follows [`apply`](Self::apply) at every moment. `grip` is the share of the motion of the wheels that the
    /// robot makes: 1 without slip. The position is exact up to rounding while the robot turns by less than 10⁶ rad in
    /// changing its turn rate. The yaw is not wrapped.
    ///
    /// ```
    /// use mobile_robot_simulator::{Limits, Pose, Twist};
    ///
    /// // From 1 m/s to a stop at 1 m/s²: half a metre.
    /// let limits = Limits::new([f64::INFINITY; 3], [1.0; 3], [1.0; 3])?;
    /// let end = limits.integrate(Pose::default(), Twist::default(), Twist::from([1.0, 0.0, 0.0]), 5.0, 1.0)?;
    /// assert_eq!(end, Pose::new(0.5, 0.0, 0.0));
    /// # Ok::<(), mobile_robot_simulator::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Number`] if a number or the resulting pose is not finite, or `dt` is negative.
    pub fn integrate(&self, pose: Pose, wanted: Twist, current: Twist, dt: f64, grip: f64) -> Result<Pose, Error> {
        pose.checked()?;
        check_finite("grip", grip)?;
        self.ramp(wanted, current, dt)?.integrate(pose, dt, grip).checked()
    }

    /// Returns the pose of [`integrate`](Self::integrate) after each of several times \[s\], as `[x, y, yaw]`.
    ///
    /// # Errors
    /// - [`Error::Number`]: a number is not finite, or a time is negative.
    /// - [`Error::Row`]: a resulting pose is not finite.
    /// - [`Error::Memory`]: there is not enough memory.
    pub fn trace(
        &self,
        pose: Pose,
        wanted: Twist,
        current: Twist,
        times: &[f64],
        grip: f64,
    ) -> Result<Vec<[f64; 3]>, Error> {
        pose.checked()?;
        check_finite("grip", grip)?;
        let ramp = self.ramp(wanted, current, 0.0)?;
        traced(times, |time| {
            check_number("times", time, "at least 0", |value| value >= 0.0)?;
            Ok(ramp.integrate(pose, time, grip))
        })
    }

    /// Returns the length of the path \[m\] that the robot of [`integrate`](Self::integrate) drives without slip.
    ///
    /// # Errors
    /// [`Error::Number`] if a velocity is not finite, or `dt` is negative or not finite.
    pub fn distance(&self, wanted: Twist, current: Twist, dt: f64) -> Result<f64, Error> {
        Ok(self.ramp(wanted, current, dt)?.distance(dt))
    }

    fn ramp(&self, wanted: Twist, current: Twist, dt: f64) -> Result<Ramp, Error> {
        check_number("dt", dt, "at least 0", |value| value >= 0.0)?;
        for (wanted, current) in wanted.to_array().into_iter().zip(current.to_array()) {
            check_finite("wanted", wanted)?;
            check_finite("current", current)?;
        }
        Ok(Ramp::new(self, current, wanted))
    }

    fn clamped(&self, velocity: Twist) -> Twist {
        let velocity = velocity.to_array();
        Twist::from(std::array::from_fn(|axis| velocity[axis].clamp(-self.velocity[axis], self.velocity[axis])))
    }
}

impl Default for Limits {
    fn default() -> Self {
        Self::NONE
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn limits() -> Limits {
        Limits::new([1.0, 0.0, 2.0], [0.5, 1.0, f64::INFINITY], [2.0, 1.0, 4.0]).unwrap()
    }

    fn apply(wanted: [f64; 3], current: [f64; 3], dt: f64) -> [f64; 3] {
        limits().apply(wanted.into(), current.into(), dt).unwrap().to_array()
    }

    #[test]
    fn speed_increases_and_decreases_at_separate_rates_up_to_the_limit() {
        assert_eq!(apply([1.0, 0.0, 0.0], [0.0; 3], 0.5), [0.25, 0.0, 0.0]);
        assert_eq!(apply([0.0, 0.0, 0.0], [1.0, 0.0, 0.0], 0.25), [0.5, 0.0, 0.0]);
        assert_eq!(apply([-0.5, 0.0, 0.0], [-1.0, 0.0, 0.0], 0.125), [-0.75, 0.0, 0.0]);
        assert_eq!(apply([-5.0, 0.0, 0.0], [0.0; 3], 10.0), [-1.0, 0.0, 0.0]);
        assert_eq!(apply([0.3, 0.0, 0.0], [0.25, 0.0, 0.0], 10.0), [0.3, 0.0, 0.0]);
    }

    #[test]
    fn a_change_of_direction_slows_down_first() {
        // 0.25 s to stop from 0.5 m/s, then 0.75 s at 0.5 m/s².
        assert_eq!(apply([-1.0, 0.0, 0.0], [0.5, 0.0, 0.0], 1.0), [-0.375, 0.0, 0.0]);
        assert_eq!(apply([-1.0, 0.0, 0.0], [0.5, 0.0, 0.0], 0.125), [0.25, 0.0, 0.0]);
        assert_eq!(apply([1.0, 0.0, 0.0], [-0.5, 0.0, 0.0], 1.0), [0.375, 0.0, 0.0]);
    }

    #[test]
    fn an_infinite_limit_acts_at_once_and_a_zero_limit_holds_still() {
        assert_eq!(apply([0.0, 3.0, 1.5], [0.0; 3], 1e-3), [0.0, 0.0, 1.5]);
        let free = Limits::NONE.apply([7.0, -3.0, 9.0].into(), [-7.0, 3.0, 0.0].into(), 1e-9).unwrap();
        assert_eq!(free.to_array(), [7.0, -3.0, 9.0]);
        assert_eq!(apply([0.0, 0.0, -2.0], [0.0, 0.0, 2.0], 0.0), [0.0, 0.0, 2.0]);
        // The turn rate decreases at a finite rate, then increases in the other direction at once.
        assert_eq!(apply([0.0, 0.0, -1.0], [0.0, 0.0, 2.0], 0.25), [0.0, 0.0, 1.0]);
        assert_eq!(apply([0.0, 0.0, -1.0], [0.0, 0.0, 2.0], 0.5), [0.0, 0.0, -1.0]);
        assert_eq!(apply([0.0, 0.0, -1.0], [0.0, 0.0, 2.0], 0.75), [0.0, 0.0, -1.0]);
    }

    #[test]
    fn many_short_steps_equal_one_long_step() {
        for (wanted, current) in [(1.0, -0.9), (-0.6, 0.8), (0.2, 0.9), (0.9, 0.1)] {
            let mut short = [current, 0.0, 0.0];
            for _ in 0..64 {
                short = apply([wanted, 0.0, 0.0], short, 1.0 / 64.0);
            }
            let long = apply([wanted, 0.0, 0.0], [current, 0.0, 0.0], 1.0);
            assert!((short[0] - long[0]).abs() < 1e-12, "{wanted} from {current}: {short:?} {long:?}");
        }
    }

    #[test]
    fn the_error_names_the_bad_limit_or_velocity() {
        let error = Limits::new([1.0; 3], [-1.0; 3], [1.0; 3]).unwrap_err().to_string();
        assert_eq!(error, "acceleration must be at least 0 or inf, got -1");
        assert!(Limits::new([1.0; 3], [1.0; 3], [f64::NAN; 3]).is_err());
        let error = limits().apply([f64::NAN, 0.0, 0.0].into(), [0.0; 3].into(), 1.0).unwrap_err().to_string();
        assert_eq!(error, "wanted must be finite, got NaN");
    }
}
