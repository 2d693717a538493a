//! Drives: how the wheels of a robot move it, and what they cannot do.

mod odometry;
mod quadrature;
mod steering_profile;
mod step;
mod wheel_motion;

pub(crate) use steering_profile::SteeringProfile;
pub use step::{DriveCommands, DriveState};
pub use wheel_motion::{Steering, WheelMotion};

use glam::DVec2;

use super::Twist;
use crate::batch::check_rows;
use crate::error::{Error, check_all_finite, check_finite, check_number};

/// Largest steering angle that a drive may have \[rad\]. A wheel that steers by a quarter turn cannot push the robot forward.
pub const MAX_STEERING: f64 = 1.5;

/// Largest number of wheels of a drive.
pub const MAX_WHEELS: usize = 4;

/// How the wheels of a robot move it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum DriveKind {
    /// Two driven wheels on one axle. The origin of the robot is the middle of the axle.
    Differential,
    /// Four mecanum wheels whose rollers form an X seen from above. The origin of the robot is the middle of the wheels.
    Omni,
    /// Four wheels, of which the front ones steer and the rear ones drive. The origin of the robot is the middle of the rear
    /// axle.
    Ackermann,
}

/// The wheels of a robot: how they move it, and their limits.
///
/// Wheels are listed as `[left, right]` for a differential drive, and as `[front_left, front_right, rear_left, rear_right]` for
/// the others. A wheel turns at a positive rate when it rolls forward. Steering angles are positive to the left. The steering
/// angle of the robot is that of a wheel in the middle of the front axle (the bicycle model); the two front wheels stand at
/// [`steering_angles`](Self::steering_angles), so that all wheels turn about the same point.
///
/// Formulas: with the wheel base `L`, the track `T`, the radius `r` and `k = (L + T) / 2`,
///
/// ```text
/// differential  w = (vx ∓ wz·T/2) / r                                      (left −, right +)
/// omni          w = (vx ∓ vy ∓ k·wz) / r                                   (front_left −−, front_right ++,
///                                                                           rear_left +−, rear_right −+)
/// ackermann     wz = vx · tan(steering) / L, rear wheels as a differential drive
/// ```
///
/// Sources: the kinematics of the `diff_drive_controller`, `mecanum_drive_controller` and `steering_controllers_library` of
/// `ros2_controllers`.
///
/// ```
/// use mobile_robot_simulator::{Drive, Twist};
///
/// // Wheels of 0.1 m radius, 0.5 m apart: 1 m/s is 10 rad/s, and a turn of 1 rad/s adds or takes 2.5 rad/s.
/// let drive = Drive::differential(0.5, 0.1)?;
/// assert_eq!(drive.wheels(Twist::from([1.0, 0.0, 1.0]), 0.0)[..2], [7.5, 12.5]);
/// assert_eq!(drive.twist(&[7.5, 12.5], None).to_array(), [1.0, 0.0, 1.0]);
/// # Ok::<(), mobile_robot_simulator::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drive {
    kind: DriveKind,
    wheelbase: f64,
    track: f64,
    /// Radius of the left and of the right wheels.
    radius: [f64; 2],
    wheel_speed_limit: f64,
    steering_limit: f64,
    steering_rate: f64,
}

fn check_positive(name: &'static str, value: f64) -> Result<f64, Error> {
    check_number(name, value, "positive", |value| value > 0.0)
}

impl Drive {
    /// Returns a differential drive with wheels of this radius \[m\], `track` metres apart.
    ///
    /// # Errors
    /// [`Error::Number`] if a number is not positive.
    pub fn differential(track: f64, wheel_radius: f64) -> Result<Self, Error> {
        Self::new(DriveKind::Differential, 0.0, track, wheel_radius)
    }

    /// Returns a drive of four mecanum wheels: axles `wheelbase` metres apart, wheels of one axle `track` metres apart.
    ///
    /// # Errors
    /// [`Error::Number`] if a number is not positive.
    pub fn omni(wheelbase: f64, track: f64, wheel_radius: f64) -> Result<Self, Error> {
        Self::new(DriveKind::Omni, check_positive("wheelbase", wheelbase)?, track, wheel_radius)
    }

    /// Returns a drive like that of a car: axles `wheelbase` metres apart, wheels of one axle `track` metres apart. The
    /// steering angle of the robot is at most `steering_limit` \[rad\] and changes by at most `steering_rate` \[rad/s\], which
    /// can be infinite.
    ///
    /// # Errors
    /// [`Error::Number`] if a number is not positive or the steering limit is above [`MAX_STEERING`].
    pub fn ackermann(
        wheelbase: f64,
        track: f64,
        wheel_radius: f64,
        steering_limit: f64,
        steering_rate: f64,
    ) -> Result<Self, Error> {
        let needed = "greater than 0 and at most 1.5 rad";
        check_number("steering_limit", steering_limit, needed, |value| value > 0.0 && value <= MAX_STEERING)?;
        check_positive_or_infinite("steering_rate", steering_rate)?;
        let drive = Self::new(DriveKind::Ackermann, check_positive("wheelbase", wheelbase)?, track, wheel_radius)?;
        Ok(Self { steering_limit, steering_rate, ..drive })
    }

    fn new(kind: DriveKind, wheelbase: f64, track: f64, wheel_radius: f64) -> Result<Self, Error> {
        let radius = [check_positive("wheel_radius", wheel_radius)?; 2];
        let track = check_positive("track", track)?;
        let wheel_speed_limit = f64::INFINITY;
        Ok(Self { kind, wheelbase, track, radius, wheel_speed_limit, steering_limit: 0.0, steering_rate: f64::INFINITY })
    }

    /// Returns the drive with a limit on the speed of its wheels \[rad/s\].
    ///
    /// A velocity at which a wheel would turn faster is scaled down, so that the robot stays on its path. The rear wheels of an
    /// Ackermann drive share one motor through a differential gear, so the limit holds for the mean of their speeds.
    ///
    /// # Errors
    /// [`Error::Number`] if the limit is not positive. It may be infinite.
    pub fn with_wheel_speed_limit(self, limit: f64) -> Result<Self, Error> {
        Ok(Self { wheel_speed_limit: check_positive_or_infinite("wheel_speed_limit", limit)?, ..self })
    }

    /// Returns the drive with these radii of the `[left, right]` wheels \[m\].
    ///
    /// # Errors
    /// [`Error::Number`] if a radius is not positive.
    pub fn with_radii(self, radius: [f64; 2]) -> Result<Self, Error> {
        radius.iter().try_for_each(|&radius| check_positive("wheel_radius", radius).map(|_| ()))?;
        Ok(Self { radius, ..self })
    }

    /// Returns the drive with the radius of the `[left, right]` wheels and the track multiplied: what a robot believes whose
    /// calibration is wrong.
    ///
    /// # Errors
    /// [`Error::Number`] if a number is not positive.
    pub fn with_multipliers(self, radius: [f64; 2], track: f64) -> Result<Self, Error> {
        let left = self.radius[0] * check_positive("left_radius", radius[0])?;
        let right = self.radius[1] * check_positive("right_radius", radius[1])?;
        let track = self.track * check_positive("track", track)?;
        for (name, product) in [("the left radius", left), ("the right radius", right), ("the track", track)] {
            check_positive(name, product)?;
        }
        Ok(Self { radius: [left, right], track, ..self })
    }

    /// Returns the kind of the drive.
    #[must_use]
    pub fn kind(&self) -> DriveKind {
        self.kind
    }

    /// Returns the distance between the axles \[m\]; 0 for a differential drive.
    #[must_use]
    pub fn wheelbase(&self) -> f64 {
        self.wheelbase
    }

    /// Returns the distance between the wheels of one axle \[m\].
    #[must_use]
    pub fn track(&self) -> f64 {
        self.track
    }

    /// Returns the radius of the left and of the right wheels \[m\].
    #[must_use]
    pub fn wheel_radius(&self) -> [f64; 2] {
        self.radius
    }

    /// Returns the limit on the speed of the wheels \[rad/s\].
    #[must_use]
    pub fn wheel_speed_limit(&self) -> f64 {
        self.wheel_speed_limit
    }

    /// Returns the largest steering angle of the robot \[rad\]; 0 if it does not steer.
    #[must_use]
    pub fn steering_limit(&self) -> f64 {
        self.steering_limit
    }

    /// Returns the largest change of the steering angle per second \[rad/s\].
    #[must_use]
    pub fn steering_rate(&self) -> f64 {
        self.steering_rate
    }

    /// Returns the number of wheels.
    #[must_use]
    pub fn wheel_count(&self) -> usize {
        if self.kind == DriveKind::Differential { 2 } else { 4 }
    }

    /// Returns the rate of each wheel \[rad/s\] when the robot moves at `twist` and steers by `steering` \[rad\]. Entries past
    /// the last wheel are 0.
    ///
    /// A wheel does not feel motion across its rolling direction, for example `vy` on a differential drive.
    #[must_use]
    pub fn wheels(&self, twist: Twist, steering: f64) -> [f64; MAX_WHEELS] {
        let (DVec2 { x: vx, y: vy }, wz, [left, right]) = (twist.linear, twist.angular, self.radius);
        let across = 0.5 * self.track * wz;
        match self.kind {
            DriveKind::Differential => [(vx - across) / left, (vx + across) / right, 0.0, 0.0],
            DriveKind::Omni => {
                let turn = 0.5 * (self.wheelbase + self.track) * wz;
                [(vx - vy - turn) / left, (vx + vy + turn) / right, (vx + vy - turn) / left, (vx - vy + turn) / right]
            }
            DriveKind::Ackermann => {
                let sideways = vy + self.wheelbase * wz;
                let [left_angle, right_angle] = self.steering_angles(steering);
                let rolled = |forward: f64, angle: f64| {
                    let (sin, cos) = libm::sincos(angle);
                    forward * cos + sideways * sin
                };
                let (left_speed, right_speed) = (vx - across, vx + across);
                [
                    rolled(left_speed, left_angle) / left,
                    rolled(right_speed, right_angle) / right,
                    left_speed / left,
                    right_speed / right,
                ]
            }
        }
    }

    /// Returns the velocity of the robot whose wheels turn at these rates \[rad/s\] and do not slip; `wheels` has one entry for
    /// each wheel.
    ///
    /// An omni drive has more wheels than degrees of freedom, and the result is the mean of what its wheels say. On an
    /// Ackermann drive only the rear wheels count. If `steering` \[rad\] is given, the turn rate follows from it, and the speed
    /// is the mean of what the rear wheels say; a rear wheel that is so near to the centre of the turn that it has less than
    /// half the speed of the robot is left out.
    #[must_use]
    pub fn twist(&self, wheels: &[f64], steering: Option<f64>) -> Twist {
        let [left, right] = self.radius;
        match (self.kind, wheels) {
            (DriveKind::Omni, &[front_left, front_right, rear_left, rear_right]) => {
                let (front_left, rear_left) = (front_left * left, rear_left * left);
                let (front_right, rear_right) = (front_right * right, rear_right * right);
                let turn = 2.0 * (self.wheelbase + self.track);
                Twist::from([
                    0.25 * ((front_left + rear_right) + (front_right + rear_left)),
                    0.25 * ((front_right + rear_left) - (front_left + rear_right)),
                    ((front_right + rear_right) - (front_left + rear_left)) / turn,
                ])
            }
            (_, &[.., left_wheel, right_wheel]) => {
                let (left, right) = (left_wheel * left, right_wheel * right);
                match steering {
                    Some(steering) if self.kind == DriveKind::Ackermann => self.steered(left, right, steering),
                    _ => Twist::from([0.5 * (left + right), 0.0, (right - left) / self.track]),
                }
            }
            _ => Twist::default(),
        }
    }

    /// Returns [`wheels`](Self::wheels) for each twist `[vx, vy, wz]`, one robot after the other.
    ///
    /// Without steering angles, the steering is that of [`command`](Self::command).
    ///
    /// # Errors
    /// - [`Error::Length`]: there is not one steering angle for each twist.
    /// - [`Error::Row`], [`Error::Element`]: a number or a result is not finite, or a steering angle is refused as by
    ///   [`check_steering`](Self::check_steering).
    pub fn wheels_batch(&self, twists: &[[f64; 3]], steering: Option<&[f64]>) -> Result<Vec<f64>, Error> {
        check_rows("twists", twists, Some(1))?;
        self.check_steering(steering, twists.len())?;
        let rates = |(row, &twist): (usize, &[f64; 3])| {
            let steering = steering.map_or_else(|| self.command(twist.into(), 0.0).1, |angles| angles[row]);
            self.wheels(twist.into(), steering).into_iter().take(self.wheel_count())
        };
        let rates: Vec<f64> = twists.iter().enumerate().flat_map(rates).collect();
        check_all_finite("the resulting rates", &rates, self.wheel_count())?;
        Ok(rates)
    }

    /// Returns [`twist`](Self::twist) for each robot, as `[vx, vy, wz]`; `wheels` has the wheels of one robot after the other.
    ///
    /// # Errors
    /// - [`Error::Length`]: there is not one steering angle for each robot.
    /// - [`Error::Row`], [`Error::Element`]: a number or a result is not finite, or a steering angle is refused as by
    ///   [`check_steering`](Self::check_steering).
    pub fn twist_batch(&self, wheels: &[f64], steering: Option<&[f64]>) -> Result<Vec<[f64; 3]>, Error> {
        check_all_finite("wheels", wheels, self.wheel_count())?;
        self.check_steering(steering, wheels.len() / self.wheel_count())?;
        let twist = |(row, wheels)| self.twist(wheels, steering.map(|angles| angles[row])).to_array();
        let twists: Vec<_> = wheels.chunks_exact(self.wheel_count()).enumerate().map(twist).collect();
        check_rows("the resulting velocities", &twists, Some(1))?;
        Ok(twists)
    }

    /// Checks the steering angles of `count` robots \[rad\], if there are any.
    ///
    /// # Errors
    /// - [`Error::Length`]: there is not one for each robot.
    /// - [`Error::Element`]: one is not within [`MAX_STEERING`], or not 0 for a drive that does not steer.
    pub fn check_steering(&self, steering: Option<&[f64]>, count: usize) -> Result<(), Error> {
        let Some(angles) = steering else { return Ok(()) };
        if angles.len() != count {
            return Err(Error::Length { name: "steering", value: angles.len(), needed: count });
        }
        let (needed, largest) = self.steering_domain();
        match angles.iter().position(|angle| angle.is_nan() || angle.abs() > largest) {
            Some(row) => Err(Error::Element { name: "steering", row, value: angles[row], needed }),
            None => Ok(()),
        }
    }

    /// Returns what a steering angle of a robot with this drive must be, in words and as its largest absolute value \[rad\].
    fn steering_domain(&self) -> (&'static str, f64) {
        match self.kind {
            DriveKind::Ackermann => ("in -1.5..1.5 rad", MAX_STEERING),
            _ => ("0 for a drive that does not steer", 0.0),
        }
    }

    /// Returns a steering angle \[rad\], if a robot with this drive can have it.
    fn checked_steering(&self, name: &'static str, angle: f64) -> Result<f64, Error> {
        let (needed, largest) = self.steering_domain();
        if angle.abs() > largest && angle.is_finite() && largest > 0.0 {
            return Err(Error::Degrees { name, value: angle, needed });
        }
        check_number(name, angle, needed, |angle| angle.abs() <= largest)
    }

    /// Returns the velocity of a robot that steers, from the speeds of its rear wheels \[m/s\].
    fn steered(&self, left: f64, right: f64, steering: f64) -> Twist {
        /// Share of the robot's speed below which a wheel is left out.
        const SLOWEST: f64 = 0.5;
        let across = 0.5 * self.track * self.curvature(steering);
        let speed = match (1.0 - across, 1.0 + across) {
            (share, _) if share < SLOWEST => right / (1.0 + across),
            (_, share) if share < SLOWEST => left / (1.0 - across),
            (left_share, right_share) => 0.5 * (left / left_share + right / right_share),
        };
        self.rolling(speed, steering)
    }

    /// Returns the angles of the left and of the right front wheel \[rad\] when the steering angle of the robot is `steering`.
    ///
    /// The axes of all wheels meet in one point. Both angles are 0 on a drive that does not steer.
    #[must_use]
    pub fn steering_angles(&self, steering: f64) -> [f64; 2] {
        if self.kind != DriveKind::Ackermann {
            return [0.0; 2];
        }
        let (sin, cos) = libm::sincos(steering);
        let (ahead, across) = (self.wheelbase * sin, self.wheelbase * cos);
        let half = 0.5 * self.track * sin;
        [libm::atan2(ahead, across - half), libm::atan2(ahead, across + half)]
    }

    /// Returns the rates at which the left and the right front wheel steer \[rad/s\] when the steering angle is `steering` and
    /// changes at `rate`.
    #[must_use]
    pub fn steering_angle_rates(&self, steering: f64, rate: f64) -> [f64; 2] {
        if self.kind != DriveKind::Ackermann {
            return [0.0; 2];
        }
        // The derivative of atan2(L·sin δ, L·cos δ ∓ T/2·sin δ) with respect to δ.
        let (sin, cos) = libm::sincos(steering);
        let of_wheel = |half: f64| {
            let (ahead, across) = (self.wheelbase * sin, self.wheelbase * cos - half * sin);
            rate * self.wheelbase * self.wheelbase / (ahead * ahead + across * across)
        };
        [of_wheel(0.5 * self.track), of_wheel(-0.5 * self.track)]
    }

    /// Returns the curvature of the path \[1/m\] at a steering angle \[rad\].
    fn curvature(&self, steering: f64) -> f64 {
        libm::tan(steering) / self.wheelbase
    }

    /// Returns the velocity at a speed \[m/s\] and a steering angle \[rad\] of an Ackermann drive.
    fn rolling(&self, speed: f64, steering: f64) -> Twist {
        Twist { linear: DVec2::new(speed, 0.0), angular: speed * self.curvature(steering) }
    }

    /// Returns what the wheels can do of a commanded velocity: the velocity, and the steering angle \[rad\] of an Ackermann
    /// drive, whose velocity is `[speed, 0, 0]`.
    ///
    /// Only an omni drive can move sideways; the others ignore `vy`. An Ackermann drive steers so that its path has the
    /// curvature of the command, up to its limit. A command without forward speed does not say how to steer: the result is
    /// then `steering`, and the robot stands still.
    #[must_use]
    pub fn command(&self, wanted: Twist, steering: f64) -> (Twist, f64) {
        let speed = wanted.linear.x;
        match self.kind {
            DriveKind::Omni => (wanted, 0.0),
            DriveKind::Differential => (Twist { linear: DVec2::new(speed, 0.0), ..wanted }, 0.0),
            DriveKind::Ackermann => {
                let angle = if speed == 0.0 { steering } else { libm::atan(self.wheelbase * wanted.angular / speed) };
                (Twist::from([speed, 0.0, 0.0]), angle.clamp(-self.steering_limit, self.steering_limit))
            }
        }
    }

    /// Returns [`command`](Self::command) after a check of its arguments.
    ///
    /// # Errors
    /// [`Error::Number`]: a number is not finite, or there is a steering angle for a drive that does not steer.
    pub fn checked_command(&self, wanted: Twist, steering: f64) -> Result<(Twist, f64), Error> {
        wanted.to_array().iter().try_for_each(|&number| check_finite("twist", number).map(|_| ()))?;
        // An angle beyond the limit is limited.
        check_finite("steering_angle", steering)?;
        if self.kind != DriveKind::Ackermann {
            self.checked_steering("steering_angle", steering)?;
        }
        Ok(self.command(wanted, steering))
    }

    /// Returns the velocity, scaled down so that no wheel of a differential or omni drive exceeds its limit.
    fn scaled_to_limit(&self, twist: Twist) -> Twist {
        let fastest = self.fastest_wheel(twist);
        if fastest <= self.wheel_speed_limit {
            return twist;
        }
        twist.scaled(self.wheel_speed_limit / fastest)
    }

    /// Returns the speed of the fastest wheel \[rad/s\].
    fn fastest_wheel(&self, twist: Twist) -> f64 {
        self.wheels(twist, 0.0).iter().fold(0.0, |fastest: f64, rate| fastest.max(rate.abs()))
    }
}

fn check_positive_or_infinite(name: &'static str, value: f64) -> Result<f64, Error> {
    if value > 0.0 { Ok(value) } else { Err(Error::Number { name, value, needed: "positive or inf" }) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn car() -> Drive {
        Drive::ackermann(2.5, 1.5, 0.3, 0.6, 0.5).unwrap()
    }

    fn assert_close(left: Twist, right: [f64; 3], tolerance: f64) {
        let found = left.to_array();
        assert!(found.iter().zip(right).all(|(a, b)| (a - b).abs() <= tolerance), "{found:?} {right:?}");
    }

    #[test]
    fn wheels_and_twist_invert_each_other() {
        let twists: [[f64; 3]; 5] =
            [[0.0, 0.0, 0.0], [1.3, 0.0, -0.7], [-0.9, 0.4, 2.1], [0.0, 0.0, 3.0], [1e-9, 1e3, -1e-6]];
        for twist in twists {
            let omni = Drive::omni(0.37, 0.29, 0.07).unwrap();
            let size = twist.iter().fold(0.0, |size: f64, part: &f64| size.max(part.abs()));
            assert_close(omni.twist(&omni.wheels(twist.into(), 0.0), None), twist, 4.0 * f64::EPSILON * size);
            let rolling = [twist[0], 0.0, twist[2]];
            let differential = Drive::differential(0.31, 0.083).unwrap();
            assert_close(
                differential.twist(&differential.wheels(rolling.into(), 0.0)[..2], None),
                rolling,
                4.0 * f64::EPSILON * size,
            );
        }
    }

    #[test]
    fn all_wheels_of_a_car_roll_about_one_point() {
        let car = car();
        for (speed, steering) in [(2.0, 0.3), (-1.5, 0.6), (0.7, -0.45), (3.0, 0.0)] {
            let twist = car.rolling(speed, steering);
            let wheels = car.wheels(twist, steering);
            for (wheel, [x, y]) in [[2.5, 0.75], [2.5, -0.75], [0.0, 0.75], [0.0, -0.75]].into_iter().enumerate() {
                // The speed of a point of the robot is the turn rate times its distance from the centre of the turn.
                let velocity = DVec2::new(speed - twist.angular * y, twist.angular * x);
                assert!((wheels[wheel].abs() * 0.3 - velocity.length()).abs() < 1e-14, "{wheel} {wheels:?}");
                if wheel < 2 {
                    let along = DVec2::from_angle(car.steering_angles(steering)[wheel]) * velocity.length();
                    assert!((along * speed.signum() - velocity).length() < 1e-14, "{wheel}");
                }
            }
            assert_close(car.twist(&wheels, None), twist.to_array(), 1e-15);
            assert_close(car.twist(&wheels, Some(steering)), twist.to_array(), 1e-15);
        }
    }

    #[test]
    fn the_rates_of_the_front_wheels_are_derivatives_of_their_angles() {
        for steering in [-0.6, 0.0, 0.3] {
            let (before, after) = (car().steering_angles(steering - 1e-6), car().steering_angles(steering + 1e-6));
            let rates = car().steering_angle_rates(steering, 0.5);
            for wheel in 0..2 {
                assert!((rates[wheel] - 0.5 * (after[wheel] - before[wheel]) / 2e-6).abs() < 1e-9, "{steering} {wheel}");
            }
        }
        assert_eq!(Drive::differential(0.4, 0.1).unwrap().steering_angle_rates(0.3, 0.5), [0.0; 2]);
    }

    #[test]
    fn a_command_is_what_the_wheels_can_do() {
        let differential = Drive::differential(0.4, 0.1).unwrap();
        assert_eq!(differential.command([1.0, 0.5, 2.0].into(), 0.0), (Twist::from([1.0, 0.0, 2.0]), 0.0));
        let omni = Drive::omni(0.4, 0.3, 0.1).unwrap();
        assert_eq!(omni.command([1.0, 0.5, 2.0].into(), 0.0), (Twist::from([1.0, 0.5, 2.0]), 0.0));
        // A circle of radius 2.5 m needs a steering angle of 45°, which is beyond the limit; one of radius 10 m is not.
        let car = car();
        assert_eq!(car.command([1.0, 0.5, 0.4].into(), 0.0), (Twist::from([1.0, 0.0, 0.0]), 0.6));
        let (twist, steering) = car.command([-2.0, 0.0, 0.2].into(), 0.0);
        assert_eq!((twist.to_array(), steering), ([-2.0, 0.0, 0.0], -libm::atan(0.25)));
        // In place it cannot turn, and keeps its steering angle.
        assert_eq!(car.command([0.0, 0.0, 1.0].into(), 0.2), (Twist::default(), 0.2));
    }

    #[test]
    fn the_limit_of_the_wheels_keeps_the_path() {
        let drive = Drive::differential(0.4, 0.1).unwrap().with_wheel_speed_limit(10.0).unwrap();
        // The right wheel would turn at 15 rad/s: both velocities are divided by 1.5.
        assert_close(drive.scaled_to_limit([1.2, 0.0, 1.5].into()), [0.8, 0.0, 1.0], 1e-15);
        assert_eq!(drive.scaled_to_limit([0.8, 0.0, 1.0].into()).to_array(), [0.8, 0.0, 1.0]);
        // 1 + 1 + 0.35·1 m/s at the wheel, of which 1 m/s is possible.
        let omni = Drive::omni(0.4, 0.3, 0.1).unwrap().with_wheel_speed_limit(10.0).unwrap();
        assert_close(omni.scaled_to_limit([1.0, 1.0, 1.0].into()), [1.0 / 2.35; 3], 1e-15);
    }

    #[test]
    fn the_error_names_the_bad_number() {
        let text = |drive: Result<Drive, Error>| drive.unwrap_err().to_string();
        assert_eq!(text(Drive::differential(0.0, 0.1)), "track must be positive, got 0");
        assert_eq!(text(Drive::omni(f64::NAN, 1.0, 0.1)), "wheelbase must be positive, got NaN");
        let needed = "steering_limit must be greater than 0 and at most 1.5 rad, got 1.6";
        assert_eq!(text(Drive::ackermann(1.0, 1.0, 0.1, 1.6, 1.0)), needed);
        assert_eq!(text(Drive::ackermann(1.0, 1.0, 0.1, 0.6, 0.0)), "steering_rate must be positive or inf, got 0");
        let limited = Drive::differential(0.4, 0.1).unwrap().with_wheel_speed_limit(f64::NAN);
        assert_eq!(text(limited), "wheel_speed_limit must be positive or inf, got NaN");
        assert!(car().with_multipliers([1.0, f64::INFINITY], 1.0).is_err());
    }
}
