//! Motion in the plane, integrated exactly: under a constant twist, and under limits on acceleration.

mod course;
mod drive;
mod limits;
mod noise;
mod profile;
mod ramp;

use std::ops::Add;

use glam::DVec2;

pub use course::Course;
pub(crate) use course::PoseColumns;
pub(crate) use drive::SteeringProfile;
pub use drive::{Drive, DriveCommands, DriveKind, DriveState, MAX_STEERING, MAX_WHEELS, Steering, WheelMotion};
pub use limits::Limits;
pub use noise::MotionNoise;
pub(crate) use profile::{FOREVER, Profile, nanoseconds, seconds};

use crate::batch::check_rows;
use crate::error::{Error, check_finite};
use crate::interrupt::Watch;
use crate::memory;
use crate::pose::{Pose, rotate, wrap_angle};

/// Velocity of a robot in its own frame.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Twist {
    /// Velocity forward (x) and to the left (y) \[m/s\].
    pub linear: DVec2,
    /// Yaw rate \[rad/s\], counter-clockwise.
    pub angular: f64,
}

impl From<[f64; 3]> for Twist {
    fn from([vx, vy, wz]: [f64; 3]) -> Self {
        Self { linear: DVec2::new(vx, vy), angular: wz }
    }
}

impl Twist {
    /// Returns `[vx, vy, wz]` in m/s and rad/s.
    #[must_use]
    pub fn to_array(self) -> [f64; 3] {
        [self.linear.x, self.linear.y, self.angular]
    }

    /// Returns the twist unchanged if vx, vy and wz are finite.
    ///
    /// # Errors
    /// [`Error::Number`], which names the first component that is not finite.
    pub fn checked(self) -> Result<Self, Error> {
        check_finite("vx", self.linear.x)?;
        check_finite("vy", self.linear.y)?;
        check_finite("wz", self.angular)?;
        Ok(self)
    }

    /// Returns the twist times a factor.
    pub(crate) fn scaled(self, factor: f64) -> Self {
        Self { linear: self.linear * factor, angular: self.angular * factor }
    }

    /// Returns the constant twist that moves a robot from `start` to `end` in `duration` seconds, with a turn in (-π, π].
    ///
    /// The inverse of [`integrate`]: `integrate(start, twist, duration)` is `end` up to rounding and whole turns of yaw.
    /// `duration` must not be 0.
    #[must_use]
    pub fn between(start: Pose, end: Pose, duration: f64) -> Self {
        let turn = wrap_angle(end.yaw - start.yaw);
        let half = 0.5 * turn;
        let linear = rotate(end.position - start.position, -(start.yaw + half)) / (sinc(half) * duration);
        Self { linear, angular: turn / duration }
    }
}

impl Add for Twist {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self { linear: self.linear + other.linear, angular: self.angular + other.angular }
    }
}

/// Returns the pose of a robot that starts at `pose` and moves at a constant `twist` for `duration` seconds.
///
/// `twist` is in the robot's own frame, so the path is an arc of a circle (a straight line without turn). The result is
/// exact up to rounding for any duration, also a negative one. The yaw is not wrapped.
///
/// Formula: the exponential of SE(2). With `φ = ω · Δt` and `sinc(x) = sin(x) / x`:
///
/// ```text
/// Δp = Δt · sinc(φ/2) · R(θ + φ/2) · v
/// θ' = θ + φ
/// ```
///
/// ```
/// use mobile_robot_simulator::{Pose, Twist, integrate};
/// use std::f64::consts::FRAC_PI_2;
///
/// // 1 m/s at 1 rad/s is a circle of radius 1 m, to the left: a quarter of it ends at (1, 1), facing +y.
/// let end = integrate(Pose::default(), Twist::from([1.0, 0.0, 1.0]), FRAC_PI_2);
/// assert!((end.position.x - 1.0).abs() < 1e-15 && (end.position.y - 1.0).abs() < 1e-15);
/// assert_eq!(end.yaw, FRAC_PI_2);
/// ```
#[must_use]
pub fn integrate(pose: Pose, twist: Twist, duration: f64) -> Pose {
    let turn = twist.angular * duration;
    let half = 0.5 * turn;
    let step = rotate(twist.linear, pose.yaw + half) * (duration * sinc(half));
    Pose { position: pose.position + step, yaw: pose.yaw + turn }
}

/// Returns the position \[m\] that a robot at the origin reaches under a constant twist, and the derivative of this position
/// with respect to the turn rate.
pub(crate) fn arc(linear: DVec2, angular: f64, duration: f64) -> (DVec2, DVec2) {
    let half = 0.5 * angular * duration;
    let step = rotate(linear, half) * duration;
    // The derivative of Δt · sinc(φ/2) · R(φ/2) · v with respect to ω, where d(φ/2) = Δt/2 · dω.
    let by_turn = (step * sinc_slope(half) + step.perp() * sinc(half)) * (0.5 * duration);
    (step * sinc(half), by_turn)
}

/// Returns [`integrate`]`(poses[i], twists[i], duration)` for each i.
///
/// `poses[i]` is `[x, y, yaw]` \[m, rad\], `twists[i]` is `[vx, vy, wz]` \[m/s, rad/s\], `duration` is in seconds.
///
/// # Errors
/// - [`Error::Length`]: `poses` and `twists` have different lengths.
/// - [`Error::Row`]: a pose, a twist or a resulting pose is not finite.
/// - [`Error::Number`]: `duration` is not finite.
/// - [`Error::Interrupted`]: the call was interrupted.
pub fn integrate_batch(poses: &[[f64; 3]], twists: &[[f64; 3]], duration: f64) -> Result<Vec<[f64; 3]>, Error> {
    /// Number of rows between two looks at whether the call was interrupted.
    const ROWS_PER_CHECK: usize = 1024;
    if poses.len() != twists.len() {
        return Err(Error::Length { name: "twists", value: twists.len(), needed: poses.len() });
    }
    check_rows("poses", poses, Some(1))?;
    check_rows("twists", twists, Some(1))?;
    check_finite("dt", duration)?;
    let step = |(pose, twist): (&[f64; 3], &[f64; 3])| integrate((*pose).into(), (*twist).into(), duration).to_array();
    let mut reached = memory::with_room("the resulting poses", poses.len())?;
    let watch = Watch::new();
    for (poses, twists) in poses.chunks(ROWS_PER_CHECK).zip(twists.chunks(ROWS_PER_CHECK)) {
        watch.check()?;
        reached.extend(poses.iter().zip(twists).map(step));
    }
    check_rows("the resulting poses", &reached, Some(1))?;
    Ok(reached)
}

/// Returns [`integrate`]`(pose, twist, times[i])` for each i, as `[x, y, yaw]`.
///
/// # Errors
/// - [`Error::Number`]: a number is not finite.
/// - [`Error::Row`]: a resulting pose is not finite.
/// - [`Error::Memory`]: there is not enough memory.
pub fn trace(pose: Pose, twist: Twist, times: &[f64]) -> Result<Vec<[f64; 3]>, Error> {
    let (pose, twist) = (pose.checked()?, twist.checked()?);
    traced(times, |time| Ok(integrate(pose, twist, time)))
}

/// Returns the pose at each time \[s\] as `[x, y, yaw]`, after a check that all numbers are finite.
fn traced(times: &[f64], pose_at: impl Fn(f64) -> Result<Pose, Error>) -> Result<Vec<[f64; 3]>, Error> {
    let mut poses = memory::with_room("the resulting poses", times.len())?;
    for &time in times {
        check_finite("times", time)?;
        poses.push(pose_at(time)?.to_array());
    }
    check_rows("the resulting poses", &poses, Some(1))?;
    Ok(poses)
}

/// Returns the pose at `fraction` of the arc from `start` (fraction 0) to `end` (fraction 1), with its yaw in (-π, π].
///
/// The arc is that of the constant twist [`Twist::between`]. Fractions outside of \[0, 1\] continue the arc.
///
/// ```
/// use mobile_robot_simulator::{Pose, interpolate};
///
/// let (start, end) = (Pose::default(), Pose::new(2.0, 0.0, 0.0));
/// assert_eq!(interpolate(start, end, 0.5), Pose::new(1.0, 0.0, 0.0));
/// assert_eq!(interpolate(start, end, 2.0), Pose::new(4.0, 0.0, 0.0));
/// ```
#[must_use]
pub fn interpolate(start: Pose, end: Pose, fraction: f64) -> Pose {
    integrate(start, Twist::between(start, end, 1.0), fraction).wrapped()
}

/// Returns sin(x)/x, computed by its series near 0.
fn sinc(x: f64) -> f64 {
    sinc_of(x, libm::sin(x))
}

/// Returns sin(x)/x for a sine that is known.
#[inline(always)]
fn sinc_of(x: f64, sin: f64) -> f64 {
    let square = x * x;
    // Below this limit the first omitted term, x⁶/5040, is smaller than 2⁻⁵³.
    if square < 1e-5 { 1.0 - square / 6.0 * (1.0 - square / 20.0) } else { sin / x }
}

/// Returns the derivative of sin(x)/x, computed by its series near 0.
fn sinc_slope(x: f64) -> f64 {
    let square = x * x;
    // Below this limit the first omitted term, x⁷/45360, is smaller than 1e-13 of the first one. Above it the cancellation
    // in the closed form costs no more than that.
    if square < 1e-3 {
        -x / 3.0 * (1.0 - square / 10.0 * (1.0 - square / 28.0))
    } else {
        (libm::cos(x) - libm::sin(x) / x) / x
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{FRAC_PI_2, PI, TAU};

    fn assert_close(left: Pose, right: Pose, tolerance: f64) {
        assert!((left.position - right.position).length() < tolerance, "{left:?} {right:?}");
        assert!((left.yaw - right.yaw).abs() < tolerance, "{left:?} {right:?}");
    }

    /// Position after a constant twist, by the power series of the matrix exponential: an oracle without trigonometry.
    fn by_power_series(pose: Pose, twist: Twist, duration: f64) -> DVec2 {
        let (wx, vx, vy) = (twist.angular * duration, twist.linear.x * duration, twist.linear.y * duration);
        // M = [[0, -w, vx], [w, 0, vy], [0, 0, 0]]; column (x, y) of exp(M) is the sum of Mᵏ⁻¹·v / k!.
        let (mut term, mut sum) = (DVec2::new(vx, vy), DVec2::ZERO);
        for k in 1..60 {
            sum += term;
            term = DVec2::new(-wx * term.y, wx * term.x) / f64::from(k + 1);
        }
        pose.position + rotate(sum, pose.yaw)
    }

    #[test]
    fn without_turn_the_path_is_straight() {
        let moved = integrate(Pose::new(1.0, 2.0, FRAC_PI_2), [2.0, 1.0, 0.0].into(), 1.5);
        assert_close(moved, Pose::new(1.0 - 1.5, 2.0 + 3.0, FRAC_PI_2), 1e-15);
    }

    #[test]
    fn a_quarter_circle_ends_beside_its_centre() {
        let moved = integrate(Pose::default(), [1.0, 0.0, 1.0].into(), FRAC_PI_2);
        assert_close(moved, Pose::new(1.0, 1.0, FRAC_PI_2), 1e-15);
    }

    #[test]
    fn a_full_circle_closes_for_any_number_of_steps() {
        for steps in [1, 3, 63, 1000] {
            let mut pose = Pose::new(0.5, -0.5, 0.25);
            for _ in 0..steps {
                pose = integrate(pose, [1.0, 0.3, 1.0].into(), TAU / f64::from(steps));
            }
            assert_close(pose, Pose::new(0.5, -0.5, 0.25 + TAU), 1e-12);
        }
    }

    #[test]
    fn every_turn_rate_agrees_with_the_power_series() {
        let pose = Pose::new(3.0, -1.0, 0.7);
        for exponent in -40..2 {
            for sign in [-1.0, 1.0] {
                let twist = Twist::from([0.8, -0.3, sign * libm::exp2(f64::from(exponent))]);
                let moved = integrate(pose, twist, 1.7).position;
                assert!((moved - by_power_series(pose, twist, 1.7)).length() < 1e-14, "2^{exponent}");
            }
        }
    }

    #[test]
    fn the_twist_between_two_poses_inverts_integration() {
        let start = Pose::new(1.0, 2.0, 3.0);
        for twist in [[1.0, 0.0, 0.0], [0.4, -0.2, 1.3], [0.0, 0.0, -2.0], [1.0, 1.0, 1e-9]] {
            let end = integrate(start, twist.into(), 0.5);
            let found = Twist::between(start, end, 0.5).to_array();
            assert!(found.iter().zip(twist).all(|(a, b)| (a - b).abs() < 1e-12), "{found:?} {twist:?}");
        }
    }

    #[test]
    fn interpolation_stays_on_the_arc() {
        let middle = interpolate(Pose::default(), Pose::new(1.0, 1.0, FRAC_PI_2), 0.5);
        assert_close(middle, Pose::new((PI / 4.0).sin(), 1.0 - (PI / 4.0).cos(), PI / 4.0), 1e-15);
        let beyond = interpolate(Pose::default(), Pose::new(1.0, 1.0, FRAC_PI_2), 2.0);
        assert_close(beyond, Pose::new(0.0, 2.0, PI), 1e-15);
    }

    #[test]
    fn the_error_names_the_bad_array() {
        let error =
            |poses: &[[f64; 3]], twists: &[[f64; 3]], dt| integrate_batch(poses, twists, dt).unwrap_err().to_string();
        assert_eq!(error(&[[0.0; 3]], &[], 0.1), "twists must have 1 elements, got 0");
        assert_eq!(error(&[[0.0; 3]], &[[0.0, f64::NAN, 0.0]], 0.1), "twists must be finite, got [0.0, NaN, 0.0] in row 0");
        assert_eq!(error(&[], &[], f64::INFINITY), "dt must be finite, got inf");
    }
}
