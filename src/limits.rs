//! Limits on velocity and acceleration, as a base controller applies them.

use crate::error::{Error, check_number};
use crate::motion::Twist;

/// The most that a robot can do along each axis `[vx, vy, wz]`, forwards as backwards; infinite where there is no limit.
///
/// Applied to each axis by itself and in the order of `ros2_controllers`' `diff_drive_controller`: acceleration, then velocity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    velocity: [f64; 3],
    acceleration: [f64; 3],
    deceleration: [f64; 3],
}

impl Limits {
    /// No limits.
    pub const NONE: Self =
        Self { velocity: [f64::INFINITY; 3], acceleration: [f64::INFINITY; 3], deceleration: [f64::INFINITY; 3] };

    /// Limits on speed \[m/s, rad/s\], on its growth and on its fall \[m/s², rad/s²\].
    ///
    /// # Errors
    /// Limits that are negative or NaN. Zero holds an axis still; a deceleration of zero never lets it stop.
    pub fn new(velocity: [f64; 3], acceleration: [f64; 3], deceleration: [f64; 3]) -> Result<Self, Error> {
        let named = [("velocity", velocity), ("acceleration", acceleration), ("deceleration", deceleration)];
        for (name, limits) in named {
            if let Some(&value) = limits.iter().find(|&&limit| limit.is_nan() || limit < 0.0) {
                return Err(Error::Number { name, value, needed: "at least 0 or inf" });
            }
        }
        Ok(Self { velocity, acceleration, deceleration })
    }

    /// Limits on speed.
    #[must_use]
    pub fn velocity(&self) -> [f64; 3] {
        self.velocity
    }

    /// Limits on the growth of speed.
    #[must_use]
    pub fn acceleration(&self) -> [f64; 3] {
        self.acceleration
    }

    /// Limits on the fall of speed.
    #[must_use]
    pub fn deceleration(&self) -> [f64; 3] {
        self.deceleration
    }

    /// The velocity that a robot which moves at `current` reaches in `dt` seconds when it is told to move at `wanted`.
    ///
    /// An axis that changes its direction slows down to zero first, and speeds up in what is left of the time.
    ///
    /// # Errors
    /// Velocities that are not finite, a negative `dt`.
    pub fn apply(&self, wanted: Twist, current: Twist, dt: f64) -> Result<Twist, Error> {
        check_number("dt", dt, "at least 0", |value| value >= 0.0)?;
        let (wanted, mut reached) = (wanted.to_array(), current.to_array());
        for (axis, reached) in reached.iter_mut().enumerate() {
            check_number("the velocity wanted", wanted[axis], "finite", |_| true)?;
            check_number("the current velocity", *reached, "finite", |_| true)?;
            let sped = speed(wanted[axis], *reached, self.acceleration[axis], self.deceleration[axis], dt);
            *reached = sped.clamp(-self.velocity[axis], self.velocity[axis]);
        }
        Ok(Twist::from(reached))
    }
}

impl Default for Limits {
    fn default() -> Self {
        Self::NONE
    }
}

/// The velocity of one axis after `dt` seconds.
fn speed(wanted: f64, current: f64, acceleration: f64, deceleration: f64, dt: f64) -> f64 {
    if dt == 0.0 {
        return current;
    }
    // Towards `wanted`, so that what is left to do is positive.
    let sign = if wanted < current { -1.0 } else { 1.0 };
    let (goal, start) = (sign * wanted, sign * current);
    let slowed = if start < 0.0 { (start + deceleration * dt).min(goal.min(0.0)) } else { start };
    if slowed < 0.0 || goal <= 0.0 {
        return sign * slowed;
    }
    let left = if start < 0.0 { dt + start / deceleration } else { dt };
    // Nothing is left of no time, even at an infinite rate.
    let gained = if left > 0.0 { acceleration * left } else { 0.0 };
    sign * (slowed + gained).min(goal)
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
    fn speed_grows_and_falls_at_its_own_rates_up_to_the_top() {
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
    fn what_is_unlimited_is_there_at_once_and_what_is_zero_never() {
        assert_eq!(apply([0.0, 3.0, 1.5], [0.0; 3], 1e-3), [0.0, 0.0, 1.5]);
        let free = Limits::NONE.apply([7.0, -3.0, 9.0].into(), [-7.0, 3.0, 0.0].into(), 1e-9).unwrap();
        assert_eq!(free.to_array(), [7.0, -3.0, 9.0]);
        assert_eq!(apply([0.0, 0.0, -2.0], [0.0, 0.0, 2.0], 0.0), [0.0, 0.0, 2.0]);
        // Turning stops within its limit, and turns back at once.
        assert_eq!(apply([0.0, 0.0, -1.0], [0.0, 0.0, 2.0], 0.5), [0.0, 0.0, 0.0]);
        assert_eq!(apply([0.0, 0.0, -1.0], [0.0, 0.0, 2.0], 0.75), [0.0, 0.0, -1.0]);
    }

    #[test]
    fn many_short_steps_end_where_one_long_one_does() {
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
    fn bad_limits_are_refused_by_name() {
        let error = Limits::new([1.0; 3], [-1.0; 3], [1.0; 3]).unwrap_err().to_string();
        assert_eq!(error, "acceleration must be at least 0 or inf, got -1");
        assert!(Limits::new([1.0; 3], [1.0; 3], [f64::NAN; 3]).is_err());
        let error = limits().apply([f64::NAN, 0.0, 0.0].into(), [0.0; 3].into(), 1.0).unwrap_err().to_string();
        assert_eq!(error, "the velocity wanted must be finite, got NaN");
    }
}
