//! The error of odometry: Thrun, Burgard & Fox, *Probabilistic Robotics* (2006), ch. 5.3, table 5.3.

use glam::{DMat3, DVec2, DVec3};
use rand::Rng;

use crate::beam_model::normal;
use crate::error::{Error, check_number};
use crate::motion::{Twist, arc, integrate};
use crate::pose::{Pose, rotate};
use crate::random;

/// Parameters α1 to α6 of the velocity motion model; none of them unless said otherwise.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct MotionNoise {
    alpha: [f64; 6],
}

impl MotionNoise {
    /// The model with these parameters: variance of speed by speed² and by turn², of turn by the same, and of the final rotation.
    ///
    /// # Errors
    /// Parameters that are negative or not finite.
    pub fn new(alpha: [f64; 6]) -> Result<Self, Error> {
        let names = ["alpha1", "alpha2", "alpha3", "alpha4", "alpha5", "alpha6"];
        for (name, value) in names.into_iter().zip(alpha) {
            check_number(name, value, "at least 0", |value| value >= 0.0)?;
        }
        Ok(Self { alpha })
    }

    /// α1 to α6.
    #[must_use]
    pub fn alpha(&self) -> [f64; 6] {
        self.alpha
    }

    /// A pose reached from `pose` by a robot that was told to move at `twist` for `duration` seconds: `sample_motion_model_velocity`.
    ///
    /// With speed v and turn rate ω, `v̂ ~ N(v, α1·v² + α2·ω²)`, `ω̂ ~ N(ω, α3·v² + α4·ω²)` and `γ̂ ~ N(0, α5·v² + α6·ω²)`; the robot
    /// goes along the arc of v̂ and ω̂ and turns by γ̂·Δt at its end. v is along the direction of travel, or forward for a robot
    /// that turns in place; a base that moves sideways is none of the book's. Three numbers are drawn whatever the twist.
    pub fn sample(&self, pose: Pose, twist: Twist, duration: f64, stream: &mut impl Rng) -> Pose {
        let deviations = self.variances(twist).map(f64::sqrt);
        let [speed, turn, last] = deviations.map(|deviation| deviation * normal::sample(stream));
        let moved = Twist { linear: twist.linear + speed * direction(twist), angular: twist.angular + turn };
        let moved = integrate(pose, moved, duration);
        Pose { yaw: moved.yaw + last * duration, ..moved }
    }

    /// [`sample`](Self::sample) from a stream named by `(seed, index)`: the same on every machine, and none that a scan draws from.
    ///
    /// # Errors
    /// A pose, given or reached, a twist or a duration that is not finite.
    pub fn sample_from(&self, pose: Pose, twist: Twist, duration: f64, seed: u64, index: u64) -> Result<Pose, Error> {
        check(pose, twist, duration)?;
        self.sample(pose, twist, duration, &mut random::stream(seed ^ ODOMETRY, index)).checked()
    }

    /// Covariance of (x, y, yaw) after a step, from that before it: `F·P·Fᵀ + V·M·Vᵀ`, to first order in the errors.
    ///
    /// `pose` is that at the start of the step, true or believed; F and V are the exact derivatives of the arc by the pose and
    /// by (v, ω, γ), and M the variances of [`sample`](Self::sample). *Probabilistic Robotics*, table 7.2, lines 3 to 7, with γ.
    /// First order holds while the yaw is known to some 0.2 rad.
    ///
    /// # Errors
    /// A pose, a twist, a duration or a covariance, given or reached, that is not finite.
    pub fn propagate(&self, covariance: DMat3, pose: Pose, twist: Twist, duration: f64) -> Result<DMat3, Error> {
        check(pose, twist, duration)?;
        check_matrix("covariance", covariance)?;
        let (step, by_turn) = arc(twist.linear, twist.angular, duration);
        let step = rotate(step, pose.yaw);
        // Turning the start turns the step about it.
        let by_pose = DMat3::from_cols(DVec3::X, DVec3::Y, step.perp().extend(1.0));
        let by_speed = rotate(arc(direction(twist), twist.angular, duration).0, pose.yaw);
        let by_noise = DMat3::from_cols(
            by_speed.extend(0.0),
            rotate(by_turn, pose.yaw).extend(duration),
            DVec3::new(0.0, 0.0, duration),
        );
        let noise = DMat3::from_diagonal(self.variances(twist).into());
        let sum = by_pose * covariance * by_pose.transpose() + by_noise * noise * by_noise.transpose();
        // Symmetric to the last bit, which rounding does not see to.
        check_matrix("the covariance reached", (sum + sum.transpose()) * 0.5)
    }

    /// Variances of speed, turn rate and final turn rate.
    fn variances(&self, twist: Twist) -> [f64; 3] {
        let (v, w) = (twist.linear.length_squared(), twist.angular * twist.angular);
        let [a1, a2, a3, a4, a5, a6] = self.alpha;
        [a1 * v + a2 * w, a3 * v + a4 * w, a5 * v + a6 * w]
    }
}

/// Sets the streams of odometry apart from those of scans under the same seed: "odometry" in ASCII.
const ODOMETRY: u64 = 0x6f64_6f6d_6574_7279;

/// Unit vector that a robot's speed is counted along.
fn direction(twist: Twist) -> DVec2 {
    twist.linear.try_normalize().unwrap_or(DVec2::X)
}

fn check(pose: Pose, twist: Twist, duration: f64) -> Result<(), Error> {
    pose.checked()?;
    for (name, value) in ["vx", "vy", "wz"].into_iter().zip(twist.to_array()) {
        check_number(name, value, "finite", |_| true)?;
    }
    check_number("dt", duration, "finite", |_| true)?;
    Ok(())
}

fn check_matrix(name: &'static str, matrix: DMat3) -> Result<DMat3, Error> {
    for value in matrix.to_cols_array() {
        check_number(name, value, "finite", |_| true)?;
    }
    Ok(matrix)
}
