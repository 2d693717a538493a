//! The velocity of a robot's wheels over time, from one command until the next.

use super::{Limits, Twist, integrate};
use crate::error::Error;
use crate::pose::Pose;

/// End time of a command that is held until the next one \[ns\].
pub(crate) const FOREVER: i64 = 1 << 62;

/// Nanoseconds in a second.
const NANOSECONDS: f64 = 1e9;

/// The velocity of a robot's wheels while it follows a command, and after the command has ended.
///
/// Without limits, the velocity is that of the command from the start until `until_ns`, then zero. With limits, it approaches
/// the command, and after `until_ns` zero, as fast as they allow.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Profile {
    /// Start time \[ns\].
    pub start_ns: i64,
    /// Velocity of the wheels just before the start. Matters only with limits.
    pub velocity: Twist,
    /// Velocity that is commanded until `until_ns`.
    pub command: Twist,
    /// Time at which the command ends \[ns\].
    pub until_ns: i64,
    /// Limits on the velocity and its change; `None` for no limits.
    pub limits: Option<Limits>,
}

impl Profile {
    /// Returns the profile of wheels that stand still from a time \[ns\] on.
    pub fn standing(time_ns: i64, limits: Option<Limits>) -> Self {
        let still = Twist::default();
        Self { start_ns: time_ns, velocity: still, command: still, until_ns: time_ns, limits }
    }

    /// Returns the velocity of the wheels at a time \[ns\].
    ///
    /// # Errors
    /// [`Error::Number`]: a velocity is not finite.
    pub fn velocity_at(&self, time_ns: i64) -> Result<Twist, Error> {
        let Some(limits) = &self.limits else {
            return Ok(if time_ns < self.until_ns { self.command } else { Twist::default() });
        };
        let velocity = limits.apply(self.command, self.velocity, self.held(time_ns))?;
        let after = self.seconds_after_end(time_ns);
        if after == 0.0 { Ok(velocity) } else { limits.apply(Twist::default(), velocity, after) }
    }

    /// Returns the pose that is reached at a time \[ns\] by a robot that was at `pose` at the start, in any frame. Before the
    /// start, the pose stays that of the start.
    ///
    /// `grip` is the share of the motion of the wheels that the robot makes: 1 without slip.
    ///
    /// # Errors
    /// [`Error::Number`]: a number or the resulting pose is not finite.
    pub fn move_from(&self, pose: Pose, time_ns: i64, grip: f64) -> Result<Pose, Error> {
        let held = self.held(time_ns);
        let Some(limits) = &self.limits else {
            return integrate(pose, self.command.scaled(grip), held).checked();
        };
        let pose = limits.integrate(pose, self.command, self.velocity, held, grip)?;
        let after = self.seconds_after_end(time_ns);
        if after == 0.0 {
            return Ok(pose);
        }
        let velocity = limits.apply(self.command, self.velocity, held)?;
        limits.integrate(pose, Twist::default(), velocity, after, grip)
    }

    /// Returns the time for which the command has been followed \[s\].
    fn held(&self, time_ns: i64) -> f64 {
        seconds(time_ns.min(self.until_ns) - self.start_ns)
    }

    fn seconds_after_end(&self, time_ns: i64) -> f64 {
        seconds(time_ns - self.until_ns)
    }
}

/// Returns a duration in whole nanoseconds, given in seconds.
pub(crate) fn nanoseconds(duration: f64) -> i64 {
    (duration * NANOSECONDS).round_ties_even() as i64
}

/// Returns a duration \[ns\] in seconds; 0 if it is negative.
pub(crate) fn seconds(duration_ns: i64) -> f64 {
    duration_ns.max(0) as f64 / NANOSECONDS
}
