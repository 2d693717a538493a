//! The velocity of a robot's wheels over time, from one command until the next.

use super::{Drive, DriveKind, Limits, MAX_WHEELS, SteeringProfile, Twist, WheelMotion, integrate};
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
///
/// The drive of the robot is an argument, so that a profile is small. With one, the wheels do what [`WheelMotion`] says. The velocities are then those that [`Drive::command`] returns.
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
    /// How the drive steers; `None` for a robot that moves in any direction, as its velocity says.
    pub steering: Option<SteeringProfile>,
}

/// How wheels steer, and what they are.
type Wheels<'a> = (&'a SteeringProfile, &'a Drive);

impl Profile {
    /// Returns the profile of a constant velocity from a time \[ns\] until another one, whatever the wheels can do.
    pub fn constant(velocity: Twist, start_ns: i64, until_ns: i64) -> Self {
        Self { start_ns, velocity: Twist::default(), command: velocity, until_ns, limits: None, steering: None }
    }

    /// Returns true if the velocity does not change until the command ends.
    pub fn is_constant(&self, drive: Option<&Drive>) -> bool {
        let steers = self.steering.is_some() && drive.is_some_and(|drive| drive.kind() == DriveKind::Ackermann);
        self.limits.is_none() && !steers
    }

    /// Returns the velocity at a time \[ns\] of a robot whose wheels do not slip.
    ///
    /// # Errors
    /// [`Error::Number`]: a velocity is not finite.
    pub fn velocity_at(&self, time_ns: i64, drive: Option<&Drive>) -> Result<Twist, Error> {
        match self.motion_at(time_ns, drive)? {
            Some((motion, elapsed)) => Ok(motion.velocity(elapsed)),
            None => self.ramp_velocity_at(time_ns, drive),
        }
    }

    /// Returns the velocity at a time \[ns\] from which another profile goes on.
    ///
    /// # Errors
    /// [`Error::Number`]: a velocity is not finite.
    pub fn ramp_velocity_at(&self, time_ns: i64, drive: Option<&Drive>) -> Result<Twist, Error> {
        if let Some((motion, elapsed)) = self.motion_at(time_ns, drive)? {
            return Ok(motion.ramp_velocity(elapsed));
        }
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
    pub fn move_from(&self, pose: Pose, time_ns: i64, grip: f64, drive: Option<&Drive>) -> Result<Pose, Error> {
        let (held, after) = (self.held(time_ns), self.seconds_after_end(time_ns));
        if let Some(wheels) = self.wheels(drive) {
            let pose = self.driving(wheels)?.integrate(pose, held, grip)?;
            return if after == 0.0 { Ok(pose) } else { self.released(wheels)?.integrate(pose, after, grip) };
        }
        let Some(limits) = &self.limits else {
            return integrate(pose, self.command.scaled(grip), held).checked();
        };
        let pose = limits.integrate(pose, self.command, self.velocity, held, grip)?;
        if after == 0.0 {
            return Ok(pose);
        }
        let velocity = limits.apply(self.command, self.velocity, held)?;
        limits.integrate(pose, Twist::default(), velocity, after, grip)
    }

    /// Returns the angle by which each wheel of a robot has turned from the start to a time \[ns\], in radians.
    ///
    /// A profile without a drive must have no limits. The wheels are then those of `drive`, and the steering angle is constant.
    ///
    /// # Errors
    /// [`Error::Number`]: a number is not finite.
    pub fn rolled(&self, time_ns: i64, drive: &Drive, angle: f64) -> Result<[f64; MAX_WHEELS], Error> {
        let (held, after) = (self.held(time_ns), self.seconds_after_end(time_ns));
        let Some(wheels) = self.wheels(Some(drive)) else {
            return Ok(drive.wheels(self.command, angle).map(|rate| rate * held));
        };
        let mut rolled = self.driving(wheels)?.rolled(held)?;
        if after != 0.0 {
            let released = self.released(wheels)?.rolled(after)?;
            rolled.iter_mut().zip(released).for_each(|(sum, part)| *sum += part);
        }
        Ok(rolled)
    }

    /// Returns the motion of the wheels at a time \[ns\] and the time since it began \[s\]; `None` without a drive.
    fn motion_at(&self, time_ns: i64, drive: Option<&Drive>) -> Result<Option<(WheelMotion, f64)>, Error> {
        let Some(wheels) = self.wheels(drive) else { return Ok(None) };
        Ok(Some(if time_ns < self.until_ns {
            (self.driving(wheels)?, self.held(time_ns))
        } else {
            (self.released(wheels)?, self.seconds_after_end(time_ns))
        }))
    }

    /// Returns how the wheels steer, and the drive; `None` if the robot moves as its velocity says.
    fn wheels<'a>(&'a self, drive: Option<&'a Drive>) -> Option<Wheels<'a>> {
        self.steering.as_ref().zip(drive)
    }

    /// Returns the motion of the wheels while the command is held.
    fn driving(&self, (steering, drive): Wheels<'_>) -> Result<WheelMotion, Error> {
        steering.moving(self.velocity, self.command, self.limits, self.start_ns, drive)
    }

    /// Returns the motion of the wheels after the end of the command.
    fn released(&self, (steering, drive): Wheels<'_>) -> Result<WheelMotion, Error> {
        let velocity = self.driving((steering, drive))?.ramp_velocity(self.held(self.until_ns));
        steering.moving(velocity, Twist::default(), self.limits, self.until_ns, drive)
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
