//! How a robot on wheels steers, from one command until the next.

use super::super::{Limits, Twist, seconds};
use super::{Drive, Steering, WheelMotion};
use crate::error::Error;

/// The steering angle of a robot from a time on: it turns to its goal, and stays there. It does not end with the command.
///
/// A drive that does not steer keeps the angle 0. The drive is an argument, because a robot keeps two of these profiles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SteeringProfile {
    /// Start time \[ns\].
    pub start_ns: i64,
    /// The angle from then on. Its rate is a limit beside that of the drive.
    pub steering: Steering,
}

impl SteeringProfile {
    /// Returns the steering of a robot that steers straight ahead.
    pub fn straight(start_ns: i64) -> Self {
        Self { start_ns, steering: Steering::STRAIGHT }
    }

    /// Returns the steering of a robot that begins to steer to a goal \[rad\] at a time \[ns\], at most at a rate \[rad/s\].
    ///
    /// # Errors
    /// [`Error::Number`]: a number is not finite, or the rate is not positive. It can be infinite.
    pub fn towards(&self, goal: f64, rate: f64, time_ns: i64, drive: &Drive) -> Result<Self, Error> {
        if (goal, rate) == (self.steering.goal, self.steering.rate) {
            return Ok(*self);
        }
        Ok(Self { start_ns: time_ns, steering: Steering { angle: self.angle_at(time_ns, drive)?, goal, rate } })
    }

    /// Returns the steering angle at a time \[rad\].
    ///
    /// # Errors
    /// [`Error::Number`]: a number is not finite.
    pub fn angle_at(&self, time_ns: i64, drive: &Drive) -> Result<f64, Error> {
        Ok(self.steering.of(drive)?.at(self.elapsed(time_ns)))
    }

    /// Returns the rate of change of the steering angle at a time \[rad/s\].
    ///
    /// # Errors
    /// [`Error::Number`]: a number is not finite.
    pub fn rate_at(&self, time_ns: i64, drive: &Drive) -> Result<f64, Error> {
        Ok(self.steering.of(drive)?.rate_at(self.elapsed(time_ns)))
    }

    /// Returns the motion of the wheels from a time \[ns\] on, at which they have one velocity and are commanded to have another.
    ///
    /// # Errors
    /// [`Error::Number`]: a number is not finite.
    pub fn moving(
        &self,
        velocity: Twist,
        command: Twist,
        limits: Option<Limits>,
        time_ns: i64,
        drive: &Drive,
    ) -> Result<WheelMotion, Error> {
        let steering = Steering { angle: self.angle_at(time_ns, drive)?, ..self.steering };
        WheelMotion::new(*drive, &limits.unwrap_or(Limits::NONE), velocity, command, steering)
    }

    fn elapsed(&self, time_ns: i64) -> f64 {
        seconds(time_ns - self.start_ns)
    }
}
