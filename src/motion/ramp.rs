//! Motion while the velocity changes under limits.

use glam::DVec2;

use super::{Limits, Twist, arc, integrate};
use crate::pose::{Pose, rotate};

/// Nodes and weights of the Gauss-Legendre quadrature with 8 points on \[-1, 1\], for the positive nodes.
/// Source: Abramowitz & Stegun, Handbook of Mathematical Functions, 1964, table 25.4.
pub(super) const NODES: [(f64, f64); 4] = [
    (0.183_434_642_495_649_8, 0.362_683_783_378_362),
    (0.525_532_409_916_329, 0.313_706_645_877_887_29),
    (0.796_666_477_413_626_7, 0.222_381_034_453_374_47),
    (0.960_289_856_497_536_2, 0.101_228_536_290_376_26),
];

/// Largest turn within one quadrature \[rad\]. The error of 8 points is then smaller than that of rounding.
pub(super) const LARGEST_TURN: f64 = 1.0;

/// Largest number of quadratures for one piece, so that the time is bounded. A robot whose turn rate changes so slowly that it
/// turns by more than 10⁶ rad before it reaches its goal is placed less exactly.
const MOST_QUADRATURES: f64 = 1e6;

/// The velocity of a robot over time when it is commanded to move at one velocity: each axis changes at a constant rate,
/// with a different rate before and after a change of direction, until it reaches its goal.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ramp {
    axes: [Axis; 3],
}

/// The velocity of one axis over time: at `slopes[i]` until `ends[i]`, then at `goal`.
#[derive(Debug, Clone, Copy)]
struct Axis {
    /// Velocity at the start of each phase.
    starts: [f64; 2],
    /// Change of the velocity in each phase.
    slopes: [f64; 2],
    /// End of each phase \[s\]; infinite if it never ends.
    ends: [f64; 2],
    goal: f64,
}

impl Axis {
    fn new(current: f64, wanted: f64, limits: [f64; 3]) -> Self {
        let [velocity, acceleration, deceleration] = limits;
        let (start, goal) = (current.clamp(-velocity, velocity), wanted.clamp(-velocity, velocity));
        // Mirror the axis so that the velocity increases.
        let sign = if goal < start { -1.0 } else { 1.0 };
        let (low, high) = (sign * start, sign * goal);
        // It slows down to 0 or to the goal, then speeds up from 0 or from the start.
        let (slowed, speeding) = (high.min(0.0), low.max(0.0));
        let first = if low < slowed { (slowed - low) / deceleration } else { 0.0 };
        let second = if high > speeding { (high - speeding) / acceleration } else { 0.0 };
        Self {
            starts: [start, sign * speeding],
            slopes: [sign * deceleration, sign * acceleration],
            ends: [first, first + second],
            goal,
        }
    }

    /// Returns the velocity at a time, and its rate of change after this time.
    fn at(&self, time: f64) -> (f64, f64) {
        if time < self.ends[0] {
            (self.starts[0] + self.slopes[0] * time, self.slopes[0])
        } else if time < self.ends[1] {
            (self.starts[1] + self.slopes[1] * (time - self.ends[0]), self.slopes[1])
        } else {
            (self.goal, 0.0)
        }
    }
}

impl Ramp {
    /// Returns the velocity over time of a robot that moves at `current` and is commanded to move at `wanted`.
    pub(super) fn new(limits: &Limits, current: Twist, wanted: Twist) -> Self {
        let (current, wanted) = (current.to_array(), wanted.to_array());
        let of_axis = |axis: usize| [limits.velocity[axis], limits.acceleration[axis], limits.deceleration[axis]];
        Self { axes: std::array::from_fn(|axis| Axis::new(current[axis], wanted[axis], of_axis(axis))) }
    }

    /// Returns the velocity after a time \[s\].
    pub(super) fn velocity(&self, time: f64) -> Twist {
        Twist::from(self.axes.map(|axis| axis.at(time).0))
    }

    /// Returns the pose that a robot reaches from `start` after a time \[s\], if it moves at `grip` times the velocity.
    ///
    /// The yaw is a polynomial of second degree in each piece, so the position is an integral over one variable. It is
    /// computed by Gauss-Legendre quadrature over pieces in which the robot turns by at most 1 rad. At constant velocity the
    /// result is that of [`integrate`].
    pub(super) fn integrate(&self, start: Pose, time: f64, grip: f64) -> Pose {
        let mut pose = start;
        self.for_each_piece(time, |duration, twist, slope| {
            pose = integrate_piece(pose, twist.scaled(grip), slope.scaled(grip), duration);
        });
        pose
    }

    /// Returns the length of the path driven in a time \[m\].
    pub(super) fn distance(&self, time: f64) -> f64 {
        let mut driven = 0.0;
        self.for_each_piece(time, |duration, twist, slope| driven += length(twist.linear, slope.linear, duration));
        driven
    }

    /// Calls `visit` for each piece of time in which no axis changes its rate, with the duration, the velocity at the start of
    /// the piece, and the rate of change of the velocity.
    pub(super) fn for_each_piece(&self, time: f64, mut visit: impl FnMut(f64, Twist, Twist)) {
        let mut ends = [time; 7];
        for (nth, axis) in self.axes.iter().enumerate() {
            ends[2 * nth..2 * nth + 2].copy_from_slice(&axis.ends.map(|end| end.min(time)));
        }
        ends.sort_by(f64::total_cmp);
        let mut from = 0.0;
        for end in ends {
            if end > from {
                let at = self.axes.map(|axis| axis.at(from));
                visit(end - from, Twist::from(at.map(|it| it.0)), Twist::from(at.map(|it| it.1)));
                from = end;
            }
        }
    }
}

/// Returns the pose after a time in which the velocity changes at a constant rate.
pub(super) fn integrate_piece(start: Pose, twist: Twist, slope: Twist, duration: f64) -> Pose {
    if slope.angular != 0.0 {
        integrate_linear(start, twist, slope, duration)
    } else if slope.linear != DVec2::ZERO {
        integrate_at_constant_turn_rate(start, twist, slope.linear, duration)
    } else {
        integrate(start, twist, duration)
    }
}

/// Returns the pose after a time in which the linear velocity changes at a constant rate, in closed form.
fn integrate_at_constant_turn_rate(start: Pose, twist: Twist, slope: DVec2, duration: f64) -> Pose {
    // The derivative of ∫ a·exp(iωt) dt with respect to ω is i·∫ a·t·exp(iωt) dt.
    let gained = -arc(slope, twist.angular, duration).1.perp();
    let moved = integrate(start, twist, duration);
    Pose { position: moved.position + rotate(gained, start.yaw), ..moved }
}

/// Returns the pose after a time in which the velocity changes at a constant rate, by quadrature.
fn integrate_linear(start: Pose, twist: Twist, slope: Twist, duration: f64) -> Pose {
    let fastest = twist.angular.abs().max((twist.angular + slope.angular * duration).abs());
    let count = (fastest * duration / LARGEST_TURN).ceil().clamp(1.0, MOST_QUADRATURES);
    let half = 0.5 * duration / count;
    let mut moved = DVec2::ZERO;
    let mut piece = 0.0;
    while piece < count {
        let middle = (2.0 * piece + 1.0) * half;
        for (node, weight) in NODES {
            for time in [middle - node * half, middle + node * half] {
                let turned = (twist.angular + 0.5 * slope.angular * time) * time;
                moved += rotate(twist.linear + slope.linear * time, start.yaw + turned) * (weight * half);
            }
        }
        piece += 1.0;
    }
    let turned = (twist.angular + 0.5 * slope.angular * duration) * duration;
    Pose { position: start.position + moved, yaw: start.yaw + turned }
}

/// Returns the length of the path at a velocity that changes at a constant rate.
pub(super) fn length(velocity: DVec2, slope: DVec2, duration: f64) -> f64 {
    let rate = slope.length();
    if rate * duration <= 0.25 * velocity.length() {
        // The speed is far from 0, so it is smooth.
        let half = 0.5 * duration;
        let speed = |time: f64| (velocity + slope * time).length();
        let at = |(node, weight): (f64, f64)| weight * (speed(half - node * half) + speed(half + node * half));
        return half * NODES.map(at).iter().sum::<f64>();
    }
    // With s, the time from the slowest moment, the speed is rate · √(s² + d²).
    let from = velocity.dot(slope) / (rate * rate);
    let across = velocity.perp_dot(slope).abs() / (rate * rate);
    let antiderivative = |s: f64| {
        let root = libm::hypot(s, across);
        let curved = if across > 0.0 { across * across * libm::asinh(s / across) } else { 0.0 };
        0.5 * rate * (s * root + curved)
    };
    antiderivative(from + duration) - antiderivative(from)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ramp(wanted: [f64; 3], current: [f64; 3]) -> Ramp {
        let limits = Limits::new([1.0, 0.8, 2.0], [0.5, 0.7, 1.5], [2.0, 1.0, 4.0]).unwrap();
        Ramp::new(&limits, current.into(), wanted.into())
    }

    const COMMANDS: [([f64; 3], [f64; 3]); 6] = [
        ([2.0, 0.0, 0.0], [0.0, 0.0, 0.0]),
        ([0.0, 0.0, 0.0], [1.0, 0.3, -2.0]),
        ([-0.7, 0.5, 1.7], [0.9, -0.4, -1.1]),
        ([0.6, -0.6, 0.4], [0.6, 0.6, 0.4]),
        ([0.8, 0.0, 1e-9], [-0.8, 0.0, 0.0]),
        ([0.5, 0.0, 2.0], [0.5, 0.0, -2.0]),
    ];

    /// Position and path length by the midpoint rule with a million steps, from velocities alone.
    fn summed(ramp: &Ramp, start: Pose, time: f64, grip: f64) -> (Pose, f64) {
        let (mut pose, mut driven) = (start, 0.0);
        let step = time / 1e6;
        for nth in 0..1_000_000 {
            let twist = ramp.velocity((f64::from(nth) + 0.5) * step);
            let middle = pose.yaw + 0.5 * grip * twist.angular * step;
            pose.position += rotate(twist.linear, middle) * (grip * step);
            pose.yaw += grip * twist.angular * step;
            driven += twist.linear.length() * step;
        }
        (pose, driven)
    }

    #[test]
    fn poses_and_path_lengths_agree_with_a_sum_of_small_steps() {
        let start = Pose::new(3.0, -1.0, 0.7);
        for (wanted, current) in COMMANDS {
            for (time, grip) in [(0.3, 1.0), (2.5, 1.0), (2.5, 0.4)] {
                let ramp = ramp(wanted, current);
                let (pose, driven) = summed(&ramp, start, time, grip);
                let found = ramp.integrate(start, time, grip);
                assert!((found.position - pose.position).length() < 1e-10, "{wanted:?} {time}: {found:?} {pose:?}");
                assert!((found.yaw - pose.yaw).abs() < 1e-9, "{wanted:?} {time}: {found:?} {pose:?}");
                assert!((ramp.distance(time) - driven).abs() < 1e-10, "{wanted:?} {time}: {driven}");
            }
        }
    }

    #[test]
    fn a_straight_ramp_has_the_position_of_school_physics() {
        // 2 s at 0.5 m/s² up to the limit of 1 m/s, then 2 s at 1 m/s.
        assert_eq!(ramp([2.0, 0.0, 0.0], [0.0; 3]).integrate(Pose::default(), 4.0, 1.0), Pose::new(3.0, 0.0, 0.0));
        // From 1 m/s to a stop at 2 m/s²: 0.25 m.
        assert_eq!(ramp([0.0; 3], [1.0, 0.0, 0.0]).integrate(Pose::default(), 9.0, 1.0), Pose::new(0.25, 0.0, 0.0));
        assert_eq!(ramp([0.0; 3], [1.0, 0.0, 0.0]).distance(9.0), 0.25);
        // Back and forth: 0.0625 m forward in 0.25 s, 0.140625 m back in 0.75 s.
        let turned = ramp([-1.0, 0.0, 0.0], [0.5, 0.0, 0.0]);
        assert_eq!(turned.integrate(Pose::default(), 1.0, 1.0), Pose::new(0.0625 - 0.140_625, 0.0, 0.0));
        assert!((turned.distance(1.0) - 0.203_125).abs() < 1e-15);
    }

    #[test]
    fn parts_of_a_ramp_add_up_to_the_whole() {
        let limits = Limits::new([1.0, 0.8, 2.0], [0.5, 0.7, 1.5], [2.0, 1.0, 4.0]).unwrap();
        for (wanted, current) in COMMANDS {
            let whole = ramp(wanted, current);
            let (mut pose, mut velocity, mut driven) = (Pose::default(), Twist::from(current), 0.0);
            for _ in 0..250 {
                let part = Ramp::new(&limits, velocity, wanted.into());
                driven += part.distance(0.01);
                pose = part.integrate(pose, 0.01, 1.0);
                velocity = part.velocity(0.01);
            }
            let end = whole.integrate(Pose::default(), 2.5, 1.0);
            assert!((end.position - pose.position).length() < 1e-12, "{wanted:?}: {end:?} {pose:?}");
            assert!((end.yaw - pose.yaw).abs() < 1e-12 && (whole.distance(2.5) - driven).abs() < 1e-12);
        }
    }

    #[test]
    fn without_limits_the_motion_is_that_of_a_constant_twist() {
        let (start, wanted) = (Pose::new(1.0, 2.0, 3.0), Twist::from([0.4, -0.2, 1.3]));
        let ramp = Ramp::new(&Limits::NONE, Twist::from([-1.0, 0.0, 0.0]), wanted);
        assert_eq!(ramp.integrate(start, 0.7, 1.0), integrate(start, wanted, 0.7));
        assert_eq!(ramp.velocity(1e-9), wanted);
    }

    #[test]
    fn slow_ramps_are_as_exact_and_do_not_take_longer() {
        // Almost constant: the position is that of a constant velocity, up to half of the acceleration times time squared.
        let limits = Limits::new([f64::INFINITY; 3], [1e-12; 3], [1e-12; 3]).unwrap();
        let slow = Ramp::new(&limits, Twist::from([1.0, 0.0, 0.0]), Twist::from([2.0, 0.0, 0.0]));
        assert!((slow.distance(1e3) - (1e3 + 0.5e-6)).abs() < 1e-12);
        assert!((slow.integrate(Pose::default(), 1e3, 1.0).position.x - (1e3 + 0.5e-6)).abs() < 1e-12);
        let spinning = Ramp::new(&limits, Twist::from([0.0, 0.0, 1e3]), Twist::from([0.0, 0.0, 2e3]));
        assert!(spinning.integrate(Pose::default(), 1e9, 1.0).yaw.is_finite());
    }
}
