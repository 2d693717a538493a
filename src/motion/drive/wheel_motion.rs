//! Motion of a robot on wheels that follow one command.

use glam::DVec2;

use super::super::ramp::{LARGEST_TURN, Ramp, integrate_piece, length};
use super::super::{Limits, Twist, integrate, traced};
use super::{Drive, DriveKind, MAX_WHEELS, quadrature};
use crate::error::{Error, check_finite, check_number};
use crate::pose::Pose;

/// The steering angle of a robot over time: from `angle` it turns to `goal` at a constant rate, and stays there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Steering {
    /// Steering angle at the start \[rad\].
    pub angle: f64,
    /// Steering angle at the end \[rad\].
    pub goal: f64,
    /// Rate of change \[rad/s\]; infinite if it jumps to its goal.
    pub rate: f64,
}

impl Steering {
    /// Straight ahead.
    pub const STRAIGHT: Self = Self { angle: 0.0, goal: 0.0, rate: f64::INFINITY };

    /// Returns the steering of a robot with a drive: within its limits.
    ///
    /// # Errors
    /// [`Error::Number`] if an angle is not finite, the rate is not positive, or the drive does not steer and this is not
    /// [`STRAIGHT`](Self::STRAIGHT). The rate can be infinite. [`Error::Degrees`] if the angle at the start is beyond
    /// [`MAX_STEERING`](super::MAX_STEERING).
    pub(crate) fn of(self, drive: &Drive) -> Result<Self, Error> {
        drive.checked_steering("steering_angle", self.angle)?;
        if drive.kind != DriveKind::Ackermann {
            drive.checked_steering("steering_goal", self.goal)?;
            return if self.rate == f64::INFINITY {
                Ok(Self::STRAIGHT)
            } else {
                Err(Error::Number { name: "steering_rate", value: self.rate, needed: "inf for a drive that does not steer" })
            };
        }
        let limit = drive.steering_limit;
        check_finite("steering_goal", self.goal)?;
        super::check_positive_or_infinite("steering_rate", self.rate)?;
        let rate = self.rate.min(drive.steering_rate);
        Ok(Self { angle: self.angle.clamp(-limit, limit), goal: self.goal.clamp(-limit, limit), rate })
    }

    /// Returns the steering angle after a time \[s\].
    #[must_use]
    pub fn at(&self, time: f64) -> f64 {
        if time >= self.duration() { self.goal } else { self.angle + self.slope() * time }
    }

    /// Returns the rate of change after a time \[s\], in rad/s.
    #[must_use]
    pub fn rate_at(&self, time: f64) -> f64 {
        if time >= self.duration() { 0.0 } else { self.slope() }
    }

    /// Returns the time until the goal is reached \[s\].
    fn duration(&self) -> f64 {
        (self.goal - self.angle).abs() / self.rate
    }

    fn slope(&self) -> f64 {
        self.rate.copysign(self.goal - self.angle)
    }
}

/// The motion of a robot from the time on at which its wheels begin to follow a command.
///
/// The velocity changes under [`Limits`], as in [`Limits::apply`], and the steering angle at its rate. The wheels never turn
/// faster than their limit: the velocity is scaled down at each moment, so that the robot stays on its path.
///
/// While the steering angle does not change, the path of an Ackermann drive is an arc in closed form. Other motions are those of
/// [`Limits::integrate`], except while the steering angle changes or the wheels are at their limit: then the pose is an
/// integral by Gauss-Legendre quadrature with an error below 1e-9 m, for a path of up to 1 km.
#[derive(Debug, Clone, Copy)]
pub struct WheelMotion {
    drive: Drive,
    ramp: Ramp,
    steering: Steering,
}

/// A time in which the velocity of a robot follows one formula.
enum Piece {
    /// It changes at a constant rate.
    Linear { twist: Twist, slope: Twist },
    /// It changes at a constant rate, on an arc.
    Arc { speed: f64, slope: f64, curvature: f64 },
    /// It is smooth enough for a quadrature in so many pieces.
    Smooth(f64),
}

impl WheelMotion {
    /// Returns the motion of a robot that moves at `current` and is commanded to move at `wanted`.
    ///
    /// Both are velocities as [`Drive::command`] returns them: an Ackermann drive has a speed only, and its path follows from
    /// the steering.
    ///
    /// # Errors
    /// [`Error::Number`] if a number is not finite; the rate of the steering may be infinite.
    pub fn new(drive: Drive, limits: &Limits, current: Twist, wanted: Twist, steering: Steering) -> Result<Self, Error> {
        for (wanted, current) in wanted.to_array().into_iter().zip(current.to_array()) {
            check_finite("wanted", wanted)?;
            check_finite("current", current)?;
        }
        let possible = |twist: Twist| match drive.kind {
            DriveKind::Omni => twist,
            DriveKind::Differential => Twist { linear: DVec2::new(twist.linear.x, 0.0), ..twist },
            DriveKind::Ackermann => Twist::from([twist.linear.x, 0.0, 0.0]),
        };
        let mut limits = *limits;
        if drive.kind == DriveKind::Ackermann {
            let axle = 0.5 * (drive.radius[0] + drive.radius[1]) * drive.wheel_speed_limit;
            limits.velocity[0] = limits.velocity[0].min(axle);
        }
        let ramp = Ramp::new(&limits, possible(current), possible(wanted));
        Ok(Self { drive, ramp, steering: steering.of(&drive)? })
    }

    /// Returns the velocity of the robot after a time \[s\], if its wheels do not slip.
    #[must_use]
    pub fn velocity(&self, time: f64) -> Twist {
        let twist = self.ramp.velocity(time);
        if self.drive.kind == DriveKind::Ackermann {
            self.drive.rolling(twist.linear.x, self.steering.at(time))
        } else {
            self.drive.scaled_to_limit(twist)
        }
    }

    /// Returns the velocity after a time \[s\] from which another motion goes on: before the limit of the wheels, and only the
    /// speed of an Ackermann drive.
    #[must_use]
    pub fn ramp_velocity(&self, time: f64) -> Twist {
        self.ramp.velocity(time)
    }

    /// Returns the steering angle after a time \[s\].
    #[must_use]
    pub fn steering(&self, time: f64) -> f64 {
        self.steering.at(time)
    }

    /// Returns the rate of change of the steering angle after a time \[s\], in rad/s.
    #[must_use]
    pub fn steering_rate(&self, time: f64) -> f64 {
        self.steering.rate_at(time)
    }

    /// Returns the rate of each wheel after a time \[rad/s\].
    #[must_use]
    pub fn wheels(&self, time: f64) -> [f64; MAX_WHEELS] {
        self.drive.wheels(self.velocity(time), self.steering(time))
    }

    /// Returns the pose that the robot reaches from `start` after a time \[s\], if it makes `grip` times the motion of its
    /// wheels. The yaw is not wrapped.
    ///
    /// # Errors
    /// [`Error::Number`] if a number or the resulting pose is not finite, the grip is not in 0..1, or the time is negative.
    pub fn integrate(&self, start: Pose, time: f64, grip: f64) -> Result<Pose, Error> {
        start.checked()?;
        check_grip(grip)?;
        check_time("time", time)?;
        self.moved(start, time, grip).checked()
    }

    /// Returns the pose of [`integrate`](Self::integrate) after each of several times \[s\], as `[x, y, yaw]`.
    ///
    /// # Errors
    /// - [`Error::Number`]: a number is not finite, the grip is not in 0..1, or a time is negative.
    /// - [`Error::Row`]: a resulting pose is not finite.
    /// - [`Error::Memory`]: there is not enough memory.
    pub fn trace(&self, start: Pose, times: &[f64], grip: f64) -> Result<Vec<[f64; 3]>, Error> {
        start.checked()?;
        check_grip(grip)?;
        traced(times, |time| Ok(self.moved(start, check_time("times", time)?, grip)))
    }

    pub(super) fn moved(&self, start: Pose, time: f64, grip: f64) -> Pose {
        let mut pose = start;
        self.for_each_piece(time, |from, duration, piece| {
            pose = match piece {
                Piece::Linear { twist, slope } => integrate_piece(pose, twist.scaled(grip), slope.scaled(grip), duration),
                Piece::Arc { speed, slope, curvature } => {
                    let arc = Twist::from([1.0, 0.0, curvature]);
                    integrate(pose, arc, grip * (speed + 0.5 * slope * duration) * duration)
                }
                Piece::Smooth(count) => {
                    quadrature::integrate(pose, duration, count, |time| self.velocity(from + time).scaled(grip))
                }
            };
        });
        pose
    }

    /// Returns the length of the path driven in a time \[m\].
    ///
    /// # Errors
    /// [`Error::Number`] if the time is negative or not finite, or the length is too large for a number.
    pub fn distance(&self, time: f64) -> Result<f64, Error> {
        check_time("time", time)?;
        if self.drive.kind == DriveKind::Ackermann {
            return check_finite("the resulting distance", self.ramp.distance(time));
        }
        let mut driven = 0.0;
        self.for_each_piece(time, |from, duration, piece| {
            driven += match piece {
                Piece::Linear { twist, slope } => length(twist.linear, slope.linear, duration),
                Piece::Arc { .. } => unreachable!("only an Ackermann drive has arcs"),
                Piece::Smooth(count) => {
                    quadrature::integral(duration, count, |time| [self.velocity(from + time).linear.length()])[0]
                }
            };
        });
        check_finite("the resulting distance", driven)
    }

    /// Returns the angle by which each wheel turns in a time \[rad\].
    ///
    /// # Errors
    /// [`Error::Number`] if the time is negative or not finite.
    pub fn rolled(&self, time: f64) -> Result<[f64; MAX_WHEELS], Error> {
        check_time("time", time)?;
        let mut rolled = [0.0; MAX_WHEELS];
        self.for_each_piece(time, |from, duration, piece| {
            let part = match piece {
                // The rates are linear, so that the mean rate is that in the middle.
                Piece::Linear { .. } | Piece::Arc { .. } => self.wheels(from + 0.5 * duration).map(|rate| rate * duration),
                Piece::Smooth(count) => quadrature::integral(duration, count, |time| self.wheels(from + time)),
            };
            for (sum, part) in rolled.iter_mut().zip(part) {
                *sum += part;
            }
        });
        Ok(rolled)
    }

    /// Calls `visit(from, duration, piece)` for each piece of a time.
    fn for_each_piece(&self, time: f64, mut visit: impl FnMut(f64, f64, Piece)) {
        let mut from = 0.0;
        self.ramp.for_each_piece(time, |duration, twist, slope| {
            if self.drive.kind == DriveKind::Ackermann {
                self.for_each_arc(from, duration, twist.linear.x, slope.linear.x, &mut visit);
            } else {
                self.for_each_limited(from, duration, twist, slope, &mut visit);
            }
            from += duration;
        });
    }

    /// Divides a piece of constant acceleration of an Ackermann drive where it stops to steer.
    fn for_each_arc(&self, from: f64, duration: f64, speed: f64, slope: f64, visit: &mut impl FnMut(f64, f64, Piece)) {
        let steered = (self.steering.duration() - from).clamp(0.0, duration);
        if steered > 0.0 {
            let (first, last) = (self.steering.at(from), self.steering.at(from + steered));
            let sharpest = first.abs().max(last.abs());
            let fastest = speed.abs().max((speed + slope * steered).abs());
            let turn = fastest * self.drive.curvature(sharpest).abs() * steered;
            // The tangent has a pole at a quarter turn. Far enough from it, 8 points are exact up to rounding.
            let widest = 0.5 * (std::f64::consts::FRAC_PI_2 - sharpest);
            let count = quadrature::piece_count((turn / LARGEST_TURN).max((last - first).abs() / widest));
            visit(from, steered, Piece::Smooth(count));
        }
        if steered < duration {
            let curvature = self.drive.curvature(self.steering.goal);
            let arc = Piece::Arc { speed: speed + slope * steered, slope, curvature };
            visit(from + steered, duration - steered, arc);
        }
    }

    /// Divides a piece of constant acceleration where the wheels reach their limit, and where another wheel becomes the
    /// fastest one.
    fn for_each_limited(
        &self,
        from: f64,
        duration: f64,
        twist: Twist,
        slope: Twist,
        visit: &mut impl FnMut(f64, f64, Piece),
    ) {
        let limit = self.drive.wheel_speed_limit;
        let twist_at = |time: f64| twist + slope.scaled(time);
        let (first, last) = (self.drive.fastest_wheel(twist), self.drive.fastest_wheel(twist_at(duration)));
        // The fastest wheel is a convex function of time.
        if first.max(last) <= limit {
            return visit(from, duration, Piece::Linear { twist, slope });
        }
        if slope == Twist::default() {
            return visit(from, duration, Piece::Linear { twist: self.drive.scaled_to_limit(twist), slope });
        }
        let (rates, changes) = (self.drive.wheels(twist, 0.0), self.drive.wheels(slope, 0.0));
        let mut cuts = vec![0.0, duration];
        for wheel in 0..self.drive.wheel_count() {
            cuts.extend([(limit - rates[wheel]) / changes[wheel], (-limit - rates[wheel]) / changes[wheel]]);
            for other in 0..wheel {
                cuts.push((rates[other] - rates[wheel]) / (changes[wheel] - changes[other]));
                cuts.push(-(rates[other] + rates[wheel]) / (changes[wheel] + changes[other]));
            }
        }
        cuts.retain(|cut| (0.0..=duration).contains(cut));
        cuts.sort_by(f64::total_cmp);
        for pair in cuts.windows(2) {
            let (start, length) = (pair[0], pair[1] - pair[0]);
            if length <= 0.0 {
                continue;
            }
            let (before, after) = (twist_at(start), twist_at(pair[1]));
            if self.drive.fastest_wheel(twist_at(start + 0.5 * length)) <= limit {
                visit(from + start, length, Piece::Linear { twist: before, slope });
                continue;
            }
            let fastest = self.drive.fastest_wheel(before).max(self.drive.fastest_wheel(after));
            let turn = before.angular.abs().max(after.angular.abs()) * length;
            // The scaled velocity has a pole where the fastest wheel would stand still.
            let count = quadrature::piece_count((turn / LARGEST_TURN).max((fastest - limit) / (0.5 * limit)));
            visit(from + start, length, Piece::Smooth(count));
        }
    }
}

fn check_time(name: &'static str, time: f64) -> Result<f64, Error> {
    check_number(name, time, "at least 0", |value| value >= 0.0)
}

fn check_grip(grip: f64) -> Result<f64, Error> {
    check_number("grip", grip, "in 0..1", |value| (0.0..=1.0).contains(&value))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pose::rotate;

    const START: Pose = Pose::new(3.0, -1.0, 0.7);

    fn car() -> Drive {
        Drive::ackermann(2.5, 1.5, 0.3, 0.6, 0.5).unwrap()
    }

    fn limits() -> Limits {
        Limits::new([2.0, 1.5, 3.0], [1.0, 0.7, 1.5], [2.0, 1.0, 4.0]).unwrap()
    }

    fn steered(limits: &Limits, speeds: [f64; 2], angles: [f64; 2]) -> WheelMotion {
        let [current, wanted] = speeds.map(|speed| Twist::from([speed, 0.0, 0.0]));
        let steering = Steering { angle: angles[0], goal: angles[1], rate: f64::INFINITY };
        WheelMotion::new(car(), limits, current, wanted, steering).unwrap()
    }

    /// Motions with everything that changes: steering, speed, and wheels at their limit.
    fn motions() -> Vec<WheelMotion> {
        let differential = Drive::differential(0.4, 0.1).unwrap().with_wheel_speed_limit(8.0).unwrap();
        let omni = Drive::omni(0.4, 0.3, 0.1).unwrap().with_wheel_speed_limit(8.0).unwrap();
        let straight = Steering::STRAIGHT;
        let of = |drive: Drive, current: [f64; 3], wanted: [f64; 3]| {
            WheelMotion::new(drive, &limits(), current.into(), wanted.into(), straight).unwrap()
        };
        vec![
            steered(&Limits::NONE, [1.5, 1.5], [0.0, 0.5]),
            steered(&Limits::NONE, [-1.5, -1.5], [-0.6, 0.6]),
            steered(&limits(), [0.0, 2.0], [-0.3, 0.4]),
            steered(&limits(), [1.5, -1.0], [0.6, -0.6]),
            of(differential, [0.8, 0.0, 0.0], [0.0, 0.0, 3.0]),
            of(differential, [-0.7, 0.0, 0.5], [1.5, 0.0, 2.5]),
            of(omni, [0.8, 0.0, 0.0], [-0.5, 1.2, 2.0]),
            of(omni, [0.1, -0.6, 0.2], [1.8, 0.9, -1.0]),
        ]
    }

    /// Pose, path length and angles of the wheels by the midpoint rule with a million steps, from velocities alone.
    fn summed(motion: &WheelMotion, time: f64, grip: f64) -> (Pose, f64, [f64; 4]) {
        let (mut pose, mut driven, mut rolled) = (START, 0.0, [0.0; 4]);
        let step = time / 1e6;
        for nth in 0..1_000_000 {
            let moment = (f64::from(nth) + 0.5) * step;
            let twist = motion.velocity(moment);
            pose.position += rotate(twist.linear, pose.yaw + 0.5 * grip * twist.angular * step) * (grip * step);
            pose.yaw += grip * twist.angular * step;
            driven += twist.linear.length() * step;
            for (sum, rate) in rolled.iter_mut().zip(motion.wheels(moment)) {
                *sum += rate * step;
            }
        }
        (pose, driven, rolled)
    }

    #[test]
    fn motions_agree_with_a_sum_of_small_steps() {
        for (nth, motion) in motions().iter().enumerate() {
            for (time, grip) in [(0.4, 1.0), (2.5, 0.7)] {
                let (pose, driven, rolled) = summed(motion, time, grip);
                let found = motion.integrate(START, time, grip).unwrap();
                let far = (found.position - pose.position).length();
                assert!(far < 1e-10, "{nth} {time}: {far:e}");
                assert!((found.yaw - pose.yaw).abs() < 1e-10, "{nth} {time}: {found:?} {pose:?}");
                assert!((motion.distance(time).unwrap() - driven).abs() < 1e-9, "{nth} {time}: {driven}");
                let turned = motion.rolled(time).unwrap();
                assert!(turned.iter().zip(rolled).all(|(a, b)| (a - b).abs() < 1e-9), "{nth} {turned:?} {rolled:?}");
            }
        }
    }

    #[test]
    fn at_constant_steering_the_path_is_an_arc() {
        // From 2 m/s to a stop at 2 m/s²: 1 m on a circle of radius 2.5 / tan(0.5).
        let radius = 2.5 / libm::tan(0.5);
        let end = steered(&limits(), [2.0, 0.0], [0.5, 0.5]).integrate(Pose::default(), 9.0, 1.0).unwrap();
        let (sin, cos) = libm::sincos(1.0 / radius);
        assert!((end.position - DVec2::new(radius * sin, radius * (1.0 - cos))).length() < 1e-15, "{end:?}");
        assert!((end.yaw - 1.0 / radius).abs() < 1e-15);
        // Without limits, the twist is constant.
        let motion = steered(&Limits::NONE, [0.0, 1.2], [-0.4, -0.4]);
        let expected = integrate(START, motion.velocity(0.0), 3.0);
        let found = motion.integrate(START, 3.0, 1.0).unwrap();
        assert!((found.position - expected.position).length() < 1e-14 && (found.yaw - expected.yaw).abs() < 1e-15);
    }

    #[test]
    fn the_heading_of_a_steering_ramp_has_a_closed_form() {
        // The integral of v/L · tan(a + r·t) is v/(L·r) · ln(cos a / cos(a + r·t)).
        for (speed, angles) in [(1.5, [0.0_f64, 0.5]), (-2.0, [0.6, -0.6])] {
            let time = (angles[1] - angles[0]).abs() / 0.5;
            let end = steered(&Limits::NONE, [speed; 2], angles).integrate(Pose::default(), time, 1.0).unwrap();
            let rate = 0.5_f64.copysign(angles[1] - angles[0]);
            let yaw = speed / (2.5 * rate) * libm::log(libm::cos(angles[0]) / libm::cos(angles[1]));
            assert!((end.yaw - yaw).abs() < 1e-14, "{} {yaw}", end.yaw);
        }
    }

    #[test]
    fn the_widest_steering_is_as_exact() {
        // From one side to the other at 1.5 rad, in two parts and in one hundred.
        let drive = Drive::ackermann(1.0, 0.5, 0.1, 1.5, 1.0).unwrap();
        let speed = Twist::from([0.5, 0.0, 0.0]);
        let part = |angle: f64| {
            let steering = Steering { angle, goal: 1.5, rate: f64::INFINITY };
            WheelMotion::new(drive, &Limits::NONE, speed, speed, steering).unwrap()
        };
        let whole = part(-1.5).integrate(START, 3.0, 1.0).unwrap();
        let mut pose = START;
        for nth in 0..100 {
            pose = part(-1.5 + 0.03 * f64::from(nth)).integrate(pose, 0.03, 1.0).unwrap();
        }
        assert!((whole.position - pose.position).length() < 1e-12, "{whole:?} {pose:?}");
        assert!((whole.yaw - pose.yaw).abs() < 1e-11, "{whole:?} {pose:?}");
    }

    #[test]
    fn parts_add_up_to_the_whole() {
        for (nth, whole) in motions().into_iter().enumerate() {
            let (mut pose, mut part, mut driven) = (START, whole, 0.0);
            for _ in 0..250 {
                pose = part.integrate(pose, 0.01, 1.0).unwrap();
                driven += part.distance(0.01).unwrap();
                let limits = if nth < 2 { Limits::NONE } else { limits() };
                let steering = Steering { angle: part.steering(0.01), ..part.steering };
                let wanted = whole.ramp_velocity(1e3);
                part = WheelMotion::new(whole.drive, &limits, part.ramp_velocity(0.01), wanted, steering).unwrap();
            }
            let end = whole.integrate(START, 2.5, 1.0).unwrap();
            assert!((end.position - pose.position).length() < 1e-12, "{nth}: {end:?} {pose:?}");
            assert!((end.yaw - pose.yaw).abs() < 1e-12, "{nth}");
            assert!((whole.distance(2.5).unwrap() - driven).abs() < 1e-9, "{nth}");
        }
    }

    #[test]
    fn steering_takes_its_time_and_keeps_its_limit() {
        let motion = steered(&Limits::NONE, [0.0, 0.0], [0.2, -2.0]);
        assert_eq!([0.0, 0.4, 1.5, 1.7].map(|time| motion.steering(time)), [0.2, 0.0, 0.2 - 0.75, -0.6]);
        assert_eq!([0.0, 1.0, 1.7].map(|time| motion.steering_rate(time)), [-0.5, -0.5, 0.0]);
        // A robot that stands can steer.
        assert_eq!(motion.integrate(START, 5.0, 1.0).unwrap(), START);
        let slow = Steering { angle: 0.0, goal: 0.6, rate: 0.1 };
        let motion = WheelMotion::new(car(), &Limits::NONE, Twist::default(), Twist::default(), slow).unwrap();
        assert_eq!((motion.steering(2.0), motion.steering(6.0)), (0.2, 0.6));
    }

    #[test]
    fn wheels_reach_their_limit_and_not_more() {
        for (nth, motion) in motions().iter().enumerate().skip(4) {
            let fastest = |time: f64| motion.wheels(time).iter().fold(0.0, |most: f64, rate| most.max(rate.abs()));
            let rates: Vec<f64> = (0..500).map(|step| fastest(f64::from(step) * 0.005)).collect();
            assert!(rates.iter().all(|rate| *rate <= 8.0 + 1e-14), "{nth}");
            assert!(rates.iter().any(|rate| *rate >= 8.0 - 1e-14), "{nth}");
        }
        // 8 rad/s of the shaft that drives both rear wheels are 2.4 m/s.
        let car = car().with_wheel_speed_limit(8.0).unwrap();
        let fast = Twist::from([9.0, 0.0, 0.0]);
        let motion = WheelMotion::new(car, &Limits::NONE, fast, fast, Steering::STRAIGHT).unwrap();
        assert!((motion.velocity(0.0).linear.x - 2.4).abs() < 1e-15);
    }

    #[test]
    fn bad_numbers_are_refused() {
        let steering = Steering { rate: 0.0, ..Steering::STRAIGHT };
        let motion = WheelMotion::new(car(), &Limits::NONE, Twist::default(), Twist::default(), steering);
        assert_eq!(motion.unwrap_err().to_string(), "steering_rate must be positive or inf, got 0");
        let motion = steered(&limits(), [0.0, 2.0], [0.0, 0.4]);
        assert_eq!(motion.distance(-1.0).unwrap_err().to_string(), "time must be at least 0, got -1");
        assert!(motion.integrate(START, f64::NAN, 1.0).is_err());
    }
}
