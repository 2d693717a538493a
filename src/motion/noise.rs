//! Odometry noise: the velocity motion model (Thrun, Burgard & Fox, *Probabilistic Robotics*, 2006, sec. 5.3, table 5.3).

use glam::{DMat3, DVec2, DVec3};
use rand::Rng;

use super::{Twist, arc, integrate};
use crate::error::{Error, check_finite, check_number};
use crate::numeric::normal;
use crate::pose::{Pose, rotate};
use crate::random;

/// The velocity motion model with parameters α1 to α6. The default has no noise: all parameters are 0.
///
/// For a commanded speed v \[m/s\] and turn rate ω \[rad/s\] the noise of one step has three independent normal parts:
///
/// | noise of | variance |
/// |---|---|
/// | speed v | `α1·v² + α2·ω²` |
/// | turn rate ω | `α3·v² + α4·ω²` |
/// | rate γ of the rotation at the end | `α5·v² + α6·ω²` |
///
/// v is the length of the linear velocity. The book has no robot that moves sideways; here the error of v acts along the
/// direction of travel, or forward if the robot turns in place.
///
/// The variances are per step, as in the book: a path has less noise if it is split into more steps. With a reference step
/// ([`with_reference_step`](Self::with_reference_step)) they are those of a step of this duration, and a step of `Δt` has the
/// variances times `reference / Δt`. Independent errors of the steps then add up to the same variance for any number of steps.
///
/// ```
/// use glam::DMat3;
/// use mobile_robot_simulator::{MotionNoise, Pose, Twist, integrate};
///
/// let (pose, twist) = (Pose::default(), Twist::from([1.0, 0.0, 0.0]));
/// let no_noise = MotionNoise::default().sample_from(pose, twist, 2.0, 1, 0)?;
/// assert_eq!(no_noise, integrate(pose, twist, 2.0));
///
/// // 1 m/s for 2 s: a speed of variance α1 = 0.01 m²/s² gives a position of variance 0.01 · 2² = 0.04 m² ahead.
/// let noise = MotionNoise::new([0.01, 0.0, 0.0, 0.0, 0.0, 0.0])?;
/// let covariance = noise.propagate(DMat3::ZERO, pose, twist, 2.0)?;
/// assert_eq!(covariance, DMat3::from_diagonal([0.04, 0.0, 0.0].into()));
/// # Ok::<(), mobile_robot_simulator::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct MotionNoise {
    alpha: [f64; 6],
    reference_step: Option<f64>,
}

impl MotionNoise {
    /// Returns the model with parameters α1 to α6.
    ///
    /// # Errors
    /// [`Error::Number`] if a parameter is negative or not finite.
    pub fn new(alpha: [f64; 6]) -> Result<Self, Error> {
        let names = ["alpha1", "alpha2", "alpha3", "alpha4", "alpha5", "alpha6"];
        for (name, value) in names.into_iter().zip(alpha) {
            check_number(name, value, "at least 0", |value| value >= 0.0)?;
        }
        Ok(Self { alpha, reference_step: None })
    }

    /// Returns the same model, with variances for a step of `reference_step` seconds.
    ///
    /// # Errors
    /// [`Error::Number`] if `reference_step` is not positive or not finite.
    pub fn with_reference_step(self, reference_step: f64) -> Result<Self, Error> {
        check_number("reference_step", reference_step, "more than 0", |value| value > 0.0)?;
        Ok(Self { reference_step: Some(reference_step), ..self })
    }

    /// Returns the duration of the step for which the variances hold \[s\], or `None` if they hold for every step.
    #[must_use]
    pub fn reference_step(&self) -> Option<f64> {
        self.reference_step
    }

    /// Returns α1 to α6.
    #[must_use]
    pub fn alpha(&self) -> [f64; 6] {
        self.alpha
    }

    /// Draws a pose that a robot reaches from `pose` when it is commanded to move at `twist` for `duration` seconds.
    ///
    /// Source: `sample_motion_model_velocity`, table 5.3. With the variances of [`MotionNoise`]:
    ///
    /// ```text
    /// v̂ ~ N(v, α1·v² + α2·ω²)    ω̂ ~ N(ω, α3·v² + α4·ω²)    γ̂ ~ N(0, α5·v² + α6·ω²)
    /// ```
    ///
    /// The robot moves along the arc of v̂ and ω̂, then turns by γ̂·Δt. Every call draws three normal numbers from `stream`,
    /// also for a twist of 0. The input is not checked.
    pub fn sample(&self, pose: Pose, twist: Twist, duration: f64, stream: &mut impl Rng) -> Pose {
        let deviations = self.variances(twist, duration).map(f64::sqrt);
        let [speed, turn, last] = deviations.map(|deviation| deviation * normal::sample(stream));
        let moved = Twist { linear: twist.linear + speed * direction(twist), angular: twist.angular + turn };
        let moved = integrate(pose, moved, duration);
        Pose { yaw: moved.yaw + last * duration, ..moved }
    }

    /// Same as [`sample`](Self::sample), from the random stream named by `(seed, index)`.
    ///
    /// The result is the same on every machine. The stream differs from that of a scan with the same seed and index.
    ///
    /// # Errors
    /// [`Error::Number`] if `pose`, `twist`, `duration` or the resulting pose is not finite.
    pub fn sample_from(&self, pose: Pose, twist: Twist, duration: f64, seed: u64, index: u64) -> Result<Pose, Error> {
        check(pose, twist, duration)?;
        self.sample(pose, twist, duration, &mut random::stream(seed ^ ODOMETRY, index)).checked()
    }

    /// Returns the covariance of (x, y, yaw) \[m, m, rad\] after a step: `F·P·Fᵀ + V·M·Vᵀ`.
    ///
    /// - P is `covariance`: the covariance before the step, in the frame in which `pose` is given.
    /// - F and V are the exact derivatives of the arc: F with respect to the pose, V with respect to (v, ω, γ).
    /// - M is the diagonal matrix of the variances in [`MotionNoise`].
    /// - `pose` is the pose at the start of the step: the true pose, or the one the robot believes in.
    ///
    /// The result is symmetric to the last bit. It is of first order in the errors, which is accurate while the standard
    /// deviation of the yaw is below about 0.2 rad.
    ///
    /// Source: *Probabilistic Robotics*, table 7.2, lines 3 to 7, extended by γ.
    ///
    /// # Errors
    /// [`Error::Number`] if `covariance`, `pose`, `twist`, `duration` or the resulting covariance is not finite.
    pub fn propagate(&self, covariance: DMat3, pose: Pose, twist: Twist, duration: f64) -> Result<DMat3, Error> {
        check(pose, twist, duration)?;
        check_matrix("covariance", covariance)?;
        let (step, by_turn) = arc(twist.linear, twist.angular, duration);
        let step = rotate(step, pose.yaw);
        // A change of the start yaw rotates the step about the start position.
        let by_pose = DMat3::from_cols(DVec3::X, DVec3::Y, step.perp().extend(1.0));
        let by_speed = rotate(arc(direction(twist), twist.angular, duration).0, pose.yaw);
        let by_noise = DMat3::from_cols(
            by_speed.extend(0.0),
            rotate(by_turn, pose.yaw).extend(duration),
            DVec3::new(0.0, 0.0, duration),
        );
        let noise = DMat3::from_diagonal(self.variances(twist, duration).into());
        let sum = by_pose * covariance * by_pose.transpose() + by_noise * noise * by_noise.transpose();
        // Rounding leaves `sum` slightly asymmetric.
        check_matrix("the resulting covariance", (sum + sum.transpose()) * 0.5)
    }

    /// Returns the covariance of the mean velocity (vx, vy, ω) in a step \[m²/s², m·rad/s², rad²/s²\].
    ///
    /// The mean velocity is the constant twist between the poses at the start and at the end of the step. The covariance is of
    /// first order in the errors, and in the turn during the step.
    ///
    /// # Errors
    /// [`Error::Number`] if `twist`, `duration` or the resulting covariance is not finite.
    pub fn twist_covariance(&self, twist: Twist, duration: f64) -> Result<DMat3, Error> {
        check(Pose::default(), twist, duration)?;
        let [speed, turn, last] = self.variances(twist, duration);
        let along = direction(twist).extend(0.0);
        let linear = DMat3::from_cols(along * along.x, along * along.y, DVec3::ZERO) * speed;
        check_matrix("the resulting covariance", linear + DMat3::from_diagonal(DVec3::Z * (turn + last)))
    }

    /// Returns the variances of v \[m²/s²\], ω and γ \[rad²/s²\] in a step.
    fn variances(&self, twist: Twist, duration: f64) -> [f64; 3] {
        let (v, w) = (twist.linear.length_squared(), twist.angular * twist.angular);
        let [a1, a2, a3, a4, a5, a6] = self.alpha;
        // A step of duration 0 moves nowhere, so its velocity does not matter.
        let share = self.reference_step.map_or(1.0, |step| if duration == 0.0 { 0.0 } else { step / duration.abs() });
        [a1 * v + a2 * w, a3 * v + a4 * w, a5 * v + a6 * w].map(|variance| variance * share)
    }
}

/// Combined with the seed, so that odometry and scans with the same seed use different streams: "odometry" in ASCII.
const ODOMETRY: u64 = 0x6f64_6f6d_6574_7279;

/// Returns the unit vector along the linear velocity; the x axis if the velocity is 0.
fn direction(twist: Twist) -> DVec2 {
    twist.linear.try_normalize().unwrap_or(DVec2::X)
}

fn check(pose: Pose, twist: Twist, duration: f64) -> Result<(), Error> {
    pose.checked()?;
    twist.checked()?;
    check_finite("dt", duration)?;
    Ok(())
}

fn check_matrix(name: &'static str, matrix: DMat3) -> Result<DMat3, Error> {
    for value in matrix.to_cols_array() {
        check_finite(name, value)?;
    }
    Ok(matrix)
}
