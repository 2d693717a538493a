//! The Python class `Drive`.

use numpy::ndarray::{Array1, Array2};
use numpy::{IntoPyArray, PyArray1, PyArray2, PyUntypedArrayMethods};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use super::arrays::{numbers, rows, shape, typed};
use super::limits::LimitsArgument;
use super::number::{Argument, Numbers};
use crate::batch::check_rows;
use crate::error::check_all_finite;
use crate::{DriveCommands, DriveKind, Twist, memory};

/// The wheels of a robot: how they move it, and their limits.
///
/// Make one with `Drive.differential`, `Drive.omni` or `Drive.ackermann`.
///
/// Wheels are listed as (left, right) for a differential drive, and as (front left, front right, rear left, rear right) for the
/// others. A wheel turns at a positive rate when it rolls forward. Steering angles are positive to the left. The steering angle
/// of the robot is that of a wheel in the middle of the front axle (the bicycle model).
///
/// With the wheel base L, the track T, the radius r and k = (L + T) / 2:
///
/// - differential: the wheels turn at (vx ∓ wz·T/2) / r, left and right.
/// - omni: (vx ∓ vy ∓ k·wz) / r in front, (vx ± vy ∓ k·wz) / r at the rear, left and right.
/// - ackermann: wz = vx · tan(steering) / L; the rear wheels are those of a differential drive, and the axes of all wheels meet
///   in one point.
///
/// Source of the formulas: `diff_drive_controller`, `mecanum_drive_controller` and `steering_controllers_library` of
/// ros2_controllers.
///
/// Examples:
///     >>> import mobile_robot_simulator as mrs
///     >>> drive = mrs.Drive.differential(track=0.5, wheel_radius=0.1)
///     >>> drive.wheels_of_twist([(1.0, 0.0, 1.0)])
///     array([[ 7.5, 12.5]])
///     >>> drive.twist_of_wheels([(7.5, 12.5)])
///     array([[1., 0., 1.]])
#[pyclass(frozen, eq, module = "mobile_robot_simulator", from_py_object)]
#[derive(Clone, Copy, PartialEq)]
pub struct Drive(pub crate::Drive);

/// Rows of a batch: poses and states.
type PosesAndStates<'py> = (Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<f64>>);

/// Name of what is read from an array, in an error.
const WHAT: &str = "the rows of an array";

/// Radius of the left and of the right wheels: an argument that is one number or two.
struct Radii([f64; 2]);

impl Numbers for Radii {
    const NEEDED: &'static str = "a number or two numbers (left, right)";
}

impl<'py> FromPyObject<'_, 'py> for Radii {
    type Error = PyErr;

    fn extract(value: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        match value.extract::<f64>() {
            Ok(radius) => Ok(Self([radius; 2])),
            Err(error) if error.is_instance_of::<PyTypeError>(value.py()) => value.extract().map(Self),
            Err(error) => Err(error),
        }
    }
}

/// Returns a batch of shape `(N, width)`, one row after the other.
fn table(name: &str, value: &Bound<'_, PyAny>, width: usize) -> PyResult<Vec<f64>> {
    let array = typed::<f64>(name, value)?;
    match *array.shape() {
        [_, columns] if columns == width => Ok(memory::collected(WHAT, array.as_array().iter().copied())?),
        _ => Err(PyValueError::new_err(format!("{name} must have shape (N, {width}), got {}", shape(array.shape())))),
    }
}

#[pymethods]
impl Drive {
    /// Returns a drive with two driven wheels on one axle.
    ///
    /// The origin of the robot is the middle of the axle.
    ///
    /// Args:
    ///     track: Distance between the wheels [m].
    ///     wheel_radius: Radius of the wheels, or of the (left, right) wheel [m].
    ///     wheel_speed_limit: Largest speed of a wheel [rad/s]. A faster velocity is scaled down, so that the robot stays on its
    ///         path. No limit by default.
    ///
    /// Raises:
    ///     ValueError: A number is not positive, or `wheel_radius` has another count of numbers.
    ///     TypeError: `wheel_radius` is neither a number nor two.
    ///
    /// Examples:
    ///     >>> import mobile_robot_simulator as mrs
    ///     >>> mrs.Drive.differential(track=0.5, wheel_radius=0.1).wheel_count
    ///     2
    #[staticmethod]
    #[pyo3(
        text_signature = "(*, track, wheel_radius, wheel_speed_limit=1e999)",
        signature = (*, track, wheel_radius, wheel_speed_limit = f64::INFINITY.into())
    )]
    fn differential(
        track: Argument<f64>,
        wheel_radius: Argument<Radii>,
        wheel_speed_limit: Argument<f64>,
    ) -> PyResult<Self> {
        let drive =
            crate::Drive::differential(track.named("track")?, 1.0)?.with_radii(wheel_radius.named("wheel_radius")?.0)?;
        Ok(Self(drive.with_wheel_speed_limit(wheel_speed_limit.named("wheel_speed_limit")?)?))
    }

    /// Returns a drive with four mecanum wheels, whose rollers form an X seen from above.
    ///
    /// The robot can move sideways. Its origin is the middle of the wheels.
    ///
    /// Args:
    ///     wheelbase: Distance between the axles [m].
    ///     track: Distance between the wheels of one axle [m].
    ///     wheel_radius: Radius of the wheels, or of the (left, right) wheels [m].
    ///     wheel_speed_limit: Largest speed of a wheel [rad/s]. A faster velocity is scaled down, so that the robot stays on its
    ///         path. No limit by default.
    ///
    /// Raises:
    ///     ValueError: A number is not positive, or `wheel_radius` has another count of numbers.
    ///     TypeError: `wheel_radius` is neither a number nor two.
    ///
    /// Examples:
    ///     >>> import mobile_robot_simulator as mrs
    ///     >>> mrs.Drive.omni(wheelbase=0.4, track=0.3, wheel_radius=0.1).wheel_count
    ///     4
    #[staticmethod]
    #[pyo3(
        text_signature = "(*, wheelbase, track, wheel_radius, wheel_speed_limit=1e999)",
        signature = (*, wheelbase, track, wheel_radius, wheel_speed_limit = f64::INFINITY.into())
    )]
    fn omni(
        wheelbase: Argument<f64>,
        track: Argument<f64>,
        wheel_radius: Argument<Radii>,
        wheel_speed_limit: Argument<f64>,
    ) -> PyResult<Self> {
        let drive = crate::Drive::omni(wheelbase.named("wheelbase")?, track.named("track")?, 1.0)?;
        let drive = drive.with_radii(wheel_radius.named("wheel_radius")?.0)?;
        Ok(Self(drive.with_wheel_speed_limit(wheel_speed_limit.named("wheel_speed_limit")?)?))
    }

    /// Returns a drive like that of a car: the front wheels steer, the rear wheels drive.
    ///
    /// The origin of the robot is the middle of the rear axle.
    ///
    /// Args:
    ///     wheelbase: Distance between the axles [m].
    ///     track: Distance between the wheels of one axle [m].
    ///     wheel_radius: Radius of the wheels, or of the (left, right) wheels [m].
    ///     steering_limit: Largest steering angle of the robot [rad], at most 1.5.
    ///     steering_rate: Largest change of the steering angle per second [rad/s]. No limit by default.
    ///     wheel_speed_limit: Largest mean speed of the two rear wheels [rad/s], which a differential gear joins. No limit by
    ///         default.
    ///
    /// Raises:
    ///     ValueError: A number is not positive, or the steering limit is above 1.5.
    ///     TypeError: `wheel_radius` is neither a number nor two.
    ///
    /// Examples:
    ///     The front wheels of a car on a circle to the left: the left one is nearer to the centre, so it steers more.
    ///
    ///     >>> import mobile_robot_simulator as mrs
    ///     >>> car = mrs.Drive.ackermann(wheelbase=2.5, track=1.5, wheel_radius=0.3, steering_limit=0.6)
    ///     >>> car.steering_angles([0.5]).round(3)
    ///     array([[0.579, 0.439]])
    #[staticmethod]
    #[pyo3(
        text_signature = "(*, wheelbase, track, wheel_radius, steering_limit, steering_rate=1e999, wheel_speed_limit=1e999)",
        signature = (
            *,
            wheelbase,
            track,
            wheel_radius,
            steering_limit,
            steering_rate = f64::INFINITY.into(),
            wheel_speed_limit = f64::INFINITY.into(),
        )
    )]
    fn ackermann(
        wheelbase: Argument<f64>,
        track: Argument<f64>,
        wheel_radius: Argument<Radii>,
        steering_limit: Argument<f64>,
        steering_rate: Argument<f64>,
        wheel_speed_limit: Argument<f64>,
    ) -> PyResult<Self> {
        let (wheelbase, track) = (wheelbase.named("wheelbase")?, track.named("track")?);
        let (limit, rate) = (steering_limit.named("steering_limit")?, steering_rate.named("steering_rate")?);
        let drive = crate::Drive::ackermann(wheelbase, track, 1.0, limit, rate)?
            .with_radii(wheel_radius.named("wheel_radius")?.0)?;
        Ok(Self(drive.with_wheel_speed_limit(wheel_speed_limit.named("wheel_speed_limit")?)?))
    }

    /// Kind of the drive: `differential`, `omni` or `ackermann`.
    #[getter]
    fn kind(&self) -> &'static str {
        match self.0.kind() {
            DriveKind::Differential => "differential",
            DriveKind::Omni => "omni",
            DriveKind::Ackermann => "ackermann",
        }
    }

    /// Distance between the axles [m]; 0 for a differential drive.
    #[getter]
    fn wheelbase(&self) -> f64 {
        self.0.wheelbase()
    }

    /// Distance between the wheels of one axle [m].
    #[getter]
    fn track(&self) -> f64 {
        self.0.track()
    }

    /// Radius of the (left, right) wheels [m].
    #[getter]
    fn wheel_radius(&self) -> (f64, f64) {
        self.0.wheel_radius().into()
    }

    /// Largest speed of a wheel [rad/s]; of an Ackermann drive, largest mean speed of the rear wheels.
    #[getter]
    fn wheel_speed_limit(&self) -> f64 {
        self.0.wheel_speed_limit()
    }

    /// Largest steering angle of the robot [rad]; 0 if it does not steer.
    #[getter]
    fn steering_limit(&self) -> f64 {
        self.0.steering_limit()
    }

    /// Largest change of the steering angle per second [rad/s].
    #[getter]
    fn steering_rate(&self) -> f64 {
        self.0.steering_rate()
    }

    /// Number of wheels: 2 or 4.
    #[getter]
    fn wheel_count(&self) -> usize {
        self.0.wheel_count()
    }

    /// Returns the drive with its radii and its track multiplied: what a robot believes whose calibration is wrong.
    ///
    /// Args:
    ///     left_radius: Factor of the radius of the left wheels.
    ///     right_radius: Factor of the radius of the right wheels.
    ///     track: Factor of the track.
    ///
    /// Raises:
    ///     ValueError: A factor or a product is not positive.
    ///
    /// Examples:
    ///     >>> import mobile_robot_simulator as mrs
    ///     >>> drive = mrs.Drive.differential(track=0.5, wheel_radius=0.1)
    ///     >>> drive.with_multipliers(track=1.5).track
    ///     0.75
    #[pyo3(
        text_signature = "($self, *, left_radius=1.0, right_radius=1.0, track=1.0)",
        signature = (*, left_radius = 1.0.into(), right_radius = 1.0.into(), track = 1.0.into())
    )]
    fn with_multipliers(
        &self,
        left_radius: Argument<f64>,
        right_radius: Argument<f64>,
        track: Argument<f64>,
    ) -> PyResult<Self> {
        let radius = [left_radius.named("left_radius")?, right_radius.named("right_radius")?];
        Ok(Self(self.0.with_multipliers(radius, track.named("track")?)?))
    }

    /// Returns the rates of the wheels of robots that move at these velocities.
    ///
    /// A wheel does not feel motion across its rolling direction, such as vy on a differential drive.
    ///
    /// Args:
    ///     twists: (N, 3), one row (vx, vy, wz) per robot, in the robot's frame [m/s, m/s, rad/s]. Anything that NumPy can
    ///         convert to float64 without loss.
    ///     steering: (N,) steering angles in -1.5..1.5 [rad]; 0 for drives that do not steer. By default those of
    ///         `steering_of_twist`.
    ///
    /// Returns:
    ///     (N, wheel_count) float64, rate of each wheel [rad/s].
    ///
    /// Raises:
    ///     ValueError: An array has the wrong shape, a number or a result is not finite, or a steering angle is too large or
    ///         not 0 for a drive that does not steer.
    ///     TypeError: An array cannot be converted to float64 without loss.
    ///
    /// Examples:
    ///     A robot with mecanum wheels that moves to the left:
    ///
    ///     >>> import mobile_robot_simulator as mrs
    ///     >>> drive = mrs.Drive.omni(wheelbase=0.4, track=0.3, wheel_radius=0.1)
    ///     >>> drive.wheels_of_twist([(0.0, 1.0, 0.0)])
    ///     array([[-10.,  10.,  10., -10.]])
    #[pyo3(signature = (twists, steering=None))]
    fn wheels_of_twist<'py>(
        &self,
        py: Python<'py>,
        twists: &Bound<'py, PyAny>,
        steering: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let twists = rows("twists", twists, None)?;
        let angles = steering.map(|angles| numbers("steering", angles)).transpose()?;
        let count = self.0.wheel_count();
        let twists: &[[f64; 3]] = &twists;
        let rates = py.detach(|| self.0.wheels_batch(twists, angles.as_deref()))?;
        Ok(Array2::from_shape_vec((twists.len(), count), rates).expect("one row per twist").into_pyarray(py))
    }

    /// Returns the velocities of robots whose wheels turn at these rates and do not slip: the inverse of `wheels_of_twist`.
    ///
    /// An omni drive has more wheels than it needs; the result is the mean of what they say. On an Ackermann drive, only the
    /// rear wheels count.
    ///
    /// Args:
    ///     wheels: (N, wheel_count) rate of each wheel [rad/s]. Anything that NumPy can convert to float64 without loss.
    ///     steering: (N,) steering angles of Ackermann drives in -1.5..1.5 [rad]. If they are given, the turn rate follows from them. The
    ///         speed is then the mean of what the rear wheels say, without a wheel that has less than half the speed of the
    ///         robot because it is too near to the centre of the turn. By default, the turn rate follows from the difference of
    ///         the rear wheels.
    ///
    /// Returns:
    ///     (N, 3) float64, one row (vx, vy, wz) per robot, in the robot's frame [m/s, m/s, rad/s].
    ///
    /// Raises:
    ///     ValueError: An array has the wrong shape, a number or a result is not finite, or a steering angle is too large or
    ///         not 0 for a drive that does not steer.
    ///     TypeError: An array cannot be converted to float64 without loss.
    ///
    /// Examples:
    ///     >>> import mobile_robot_simulator as mrs
    ///     >>> drive = mrs.Drive.omni(wheelbase=0.4, track=0.3, wheel_radius=0.1)
    ///     >>> drive.twist_of_wheels([(-10.0, 10.0, 10.0, -10.0)])
    ///     array([[0., 1., 0.]])
    #[pyo3(signature = (wheels, steering=None))]
    fn twist_of_wheels<'py>(
        &self,
        py: Python<'py>,
        wheels: &Bound<'py, PyAny>,
        steering: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let wheels = table("wheels", wheels, self.0.wheel_count())?;
        let angles = steering.map(|angles| numbers("steering", angles)).transpose()?;
        let twists = py.detach(|| self.0.twist_batch(&wheels, angles.as_deref()))?;
        Ok(Array2::from(twists).into_pyarray(py))
    }

    /// Returns the steering angles of Ackermann drives that move at these velocities: `atan(wheelbase * wz / vx)`.
    ///
    /// Args:
    ///     twists: (N, 3), one row (vx, vy, wz) per robot [m/s, m/s, rad/s]. vy is ignored.
    ///
    /// Returns:
    ///     (N,) float64 [rad], within the steering limit; 0 where vx is 0, and for drives that do not steer.
    ///
    /// Raises:
    ///     ValueError: The array has the wrong shape, or a number is not finite.
    ///     TypeError: The array cannot be converted to float64 without loss.
    ///
    /// Examples:
    ///     >>> import mobile_robot_simulator as mrs
    ///     >>> car = mrs.Drive.ackermann(wheelbase=2.0, track=1.5, wheel_radius=0.3, steering_limit=0.6)
    ///     >>> car.steering_of_twist([(2.0, 0.0, 0.5), (-2.0, 0.0, 0.5), (1.0, 0.0, 9.0)]).round(4)
    ///     array([ 0.4636, -0.4636,  0.6   ])
    fn steering_of_twist<'py>(&self, py: Python<'py>, twists: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let twists = rows("twists", twists, None)?;
        check_rows("twists", &twists, Some(1))?;
        Ok(Array1::from_iter(twists.iter().map(|twist| self.0.command((*twist).into(), 0.0).1)).into_pyarray(py))
    }

    /// Returns the angles of the front wheels, whose axes meet that of the rear axle in one point.
    ///
    /// Args:
    ///     steering: (N,) steering angles of robots in -1.5..1.5 [rad]; 0 for drives that do not steer.
    ///
    /// Returns:
    ///     (N, 2) float64, one row (left, right) per robot [rad]; 0 for drives that do not steer.
    ///
    /// Raises:
    ///     ValueError: The array has the wrong shape, or an angle is out of range.
    ///     TypeError: The array cannot be converted to float64 without loss.
    ///
    /// Examples:
    ///     >>> import mobile_robot_simulator as mrs
    ///     >>> car = mrs.Drive.ackermann(wheelbase=2.5, track=1.5, wheel_radius=0.3, steering_limit=0.6, steering_rate=0.25)
    ///     >>> car.steering_angles([0.0, 0.5]).round(3)
    ///     array([[0.   , 0.   ],
    ///            [0.579, 0.439]])
    fn steering_angles<'py>(&self, py: Python<'py>, steering: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let angles = numbers("steering", steering)?;
        self.0.check_steering(Some(&angles), angles.len())?;
        let angles: Vec<[f64; 2]> = angles.into_iter().map(|angle| self.0.steering_angles(angle)).collect();
        Ok(Array2::from(angles).into_pyarray(py))
    }

    /// Returns the rates at which the front wheels steer.
    ///
    /// Args:
    ///     steering: (N,) steering angles of robots in -1.5..1.5 [rad]; 0 for drives that do not steer.
    ///     rates: (N,) rates at which these angles change [rad/s].
    ///
    /// Returns:
    ///     (N, 2) float64, one row (left, right) per robot [rad/s]; 0 for drives that do not steer.
    ///
    /// Raises:
    ///     ValueError: An array has the wrong shape, the lengths differ, an angle is out of range, or a rate is not finite.
    ///     TypeError: An array cannot be converted to float64 without loss.
    ///
    /// Examples:
    ///     >>> import mobile_robot_simulator as mrs
    ///     >>> car = mrs.Drive.ackermann(wheelbase=2.5, track=1.5, wheel_radius=0.3, steering_limit=0.6, steering_rate=0.25)
    ///     >>> car.steering_angle_rates([0.0, 0.5], [0.25, 0.25]).round(3)
    ///     array([[0.25 , 0.25 ],
    ///            [0.325, 0.196]])
    fn steering_angle_rates<'py>(
        &self,
        py: Python<'py>,
        steering: &Bound<'py, PyAny>,
        rates: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let (angles, rates) = (numbers("steering", steering)?, numbers("rates", rates)?);
        if rates.len() != angles.len() {
            return Err(crate::Error::Length { name: "rates", value: rates.len(), needed: angles.len() }.into());
        }
        self.0.check_steering(Some(&angles), angles.len())?;
        check_all_finite("rates", &rates, 1)?;
        let rows = angles.into_iter().zip(rates).map(|(angle, rate)| self.0.steering_angle_rates(angle, rate));
        Ok(Array2::from(rows.collect::<Vec<_>>()).into_pyarray(py))
    }

    /// Returns what the wheels can do of a commanded velocity, before any limit on speeds.
    ///
    /// Only an omni drive can move sideways; the others ignore vy. An Ackermann drive steers so that its path has the curvature
    /// of the command, up to its limit. If vx is 0 it cannot turn: it stands still, and steers as before.
    ///
    /// Args:
    ///     twist: Commanded velocity (vx, vy, wz) in the robot's frame [m/s, m/s, rad/s].
    ///     steering_angle: Steering angle of the robot if the command does not say how to steer [rad]; 0 for drives that do not
    ///         steer.
    ///
    /// Returns:
    ///     The velocity, and the steering angle to aim at [rad]. The velocity of an Ackermann drive is (vx, 0, 0).
    ///
    /// Raises:
    ///     ValueError: A number is not finite, or there is a steering angle for a drive that does not steer.
    ///
    /// Examples:
    ///     >>> import mobile_robot_simulator as mrs
    ///     >>> car = mrs.Drive.ackermann(wheelbase=2.5, track=1.5, wheel_radius=0.3, steering_limit=0.6, steering_rate=0.25)
    ///     >>> car.command((2.0, 0.5, 0.0))
    ///     ((2.0, 0.0, 0.0), 0.0)
    ///     >>> car.command((1.0, 0.0, 3.0))
    ///     ((1.0, 0.0, 0.0), 0.6)
    #[pyo3(text_signature = "($self, twist, steering_angle=0.0)", signature = (twist, steering_angle = 0.0.into()))]
    fn command(&self, twist: Argument<[f64; 3]>, steering_angle: Argument<f64>) -> PyResult<((f64, f64, f64), f64)> {
        let twist = Twist::from(twist.named("twist")?);
        let (wanted, goal) = self.0.checked_command(twist, steering_angle.named("steering_angle")?)?;
        Ok((wanted.to_array().into(), goal))
    }

    /// Moves many robots with this drive for `dt` seconds, exactly.
    ///
    /// The motion of each robot is that of `WheelMotion`, on all cores. One long step ends where several short ones do, except
    /// while acceleration limits hold and wheels are at their limit.
    ///
    /// Args:
    ///     poses: (N, 3), one row (x, y, yaw) per robot [m, m, rad]. Anything that NumPy can convert to float64 without loss.
    ///     states: (N, 4), one row (vx, vy, wz, steering) per robot: velocity in the robot's frame and steering angle [m/s, m/s,
    ///         rad/s, rad]. On an Ackermann drive, only vx and steering count. Steering is in -1.5..1.5, and 0 for drives that
    ///         do not steer.
    ///     commands: (N, 3), one row (vx, vy, wz) per robot; see `command`. For an Ackermann drive also (N, 2), one row (speed,
    ///         steering angle) per robot [m/s, rad].
    ///     dt: Duration [s].
    ///     limits: Limits on the velocity and its change; of an Ackermann drive, only those of vx count. None for no limits.
    ///
    /// Returns:
    ///     Poses (N, 3) float64 and states (N, 4) float64 after the step. Yaws are not wrapped.
    ///
    /// Raises:
    ///     ValueError: A shape is wrong, a number or a result is not finite, a steering angle is out of range, or `dt` is
    ///         negative.
    ///     TypeError: An array cannot be converted to float64 without loss.
    ///
    /// Examples:
    ///     A quarter of a circle of 2 m radius, backwards:
    ///
    ///     >>> import math
    ///     >>> import mobile_robot_simulator as mrs
    ///     >>> car = mrs.Drive.ackermann(wheelbase=2.0, track=1.5, wheel_radius=0.3, steering_limit=0.8)
    ///     >>> turn = math.pi / 4
    ///     >>> poses, states = car.step([(0, 0, 0)], [(0, 0, 0, turn)], [(-1.0, turn)], dt=math.pi)
    ///     >>> poses.round(3)
    ///     array([[-2.   ,  2.   , -1.571]])
    #[pyo3(
        text_signature = "($self, poses, states, commands, dt, *, limits=None)",
        signature = (poses, states, commands, dt, *, limits = None)
    )]
    fn step<'py>(
        &self,
        py: Python<'py>,
        poses: &Bound<'py, PyAny>,
        states: &Bound<'py, PyAny>,
        commands: &Bound<'py, PyAny>,
        dt: Argument<f64>,
        limits: Option<LimitsArgument>,
    ) -> PyResult<PosesAndStates<'py>> {
        let (poses, states) = (rows("poses", poses, None)?, table("states", states, 4)?);
        if states.len() != 4 * poses.len() {
            return Err(crate::Error::Length { name: "states", value: states.len() / 4, needed: poses.len() }.into());
        }
        let array = typed::<f64>("commands", commands)?;
        let (is_steered, steers) = (matches!(array.shape(), [_, 2]), self.0.kind() == DriveKind::Ackermann);
        if !(matches!(array.shape(), [_, 3]) || is_steered && steers) {
            let needed = if steers { "(N, 3) or (N, 2)" } else { "(N, 3) for a drive that does not steer" };
            return Err(PyValueError::new_err(format!("commands must have shape {needed}, got {}", shape(array.shape()))));
        }
        let commands = table("commands", array.as_any(), if is_steered { 2 } else { 3 })?;
        let commands = if is_steered {
            DriveCommands::Steered(commands.as_chunks().0)
        } else {
            DriveCommands::Twists(commands.as_chunks().0)
        };
        let (dt, limits) = (dt.named("dt")?, limits.map_or(crate::Limits::NONE, |limits| limits.0.0));
        let states: &[[f64; 4]] = states.as_chunks().0;
        let mut rows = memory::collected(WHAT, poses.iter().copied().zip(states.iter().copied()))?;
        py.detach(|| self.0.step(&mut rows, commands, &limits, dt))?;
        let (poses, states): (Vec<_>, Vec<_>) = rows.into_iter().unzip();
        Ok((Array2::from(poses).into_pyarray(py), Array2::from(states).into_pyarray(py)))
    }

    /// Returns the motion that a robot with this drive computes from the angles of its wheels before and after it.
    ///
    /// Each wheel has an encoder that shows whole counts, so its error is less than one count and does not grow.
    ///
    /// Args:
    ///     before: Angle of each wheel before the motion [rad].
    ///     after: Angle of each wheel after the motion [rad].
    ///     steering_angle: Mean steering angle during the motion in -1.5..1.5 [rad]; see `twist_of_wheels`. None if it is not
    ///         measured.
    ///     ticks: Counts of an encoder per turn of its wheel; 0 for exact encoders.
    ///
    /// Returns:
    ///     Distances forward and to the left [m] and turn [rad] of an arc: `pose.integrate(arc, 1.0)` moves a pose along it.
    ///
    /// Raises:
    ///     ValueError: There is not one angle for each wheel, a number or the result is not finite, the steering angle is out of
    ///         range or not 0 for a drive that does not steer, or `ticks` is negative.
    ///
    /// Examples:
    ///     >>> import mobile_robot_simulator as mrs
    ///     >>> drive = mrs.Drive.differential(track=0.5, wheel_radius=0.1)
    ///     >>> drive.odometry((0.0, 0.0), (10.0, 10.0))
    ///     (1.0, 0.0, 0.0)
    #[pyo3(
        text_signature = "($self, before, after, *, steering_angle=None, ticks=0.0)",
        signature = (before, after, *, steering_angle = None, ticks = 0.0.into())
    )]
    fn odometry(
        &self,
        before: &Bound<'_, PyAny>,
        after: &Bound<'_, PyAny>,
        steering_angle: Option<Argument<f64>>,
        ticks: Argument<f64>,
    ) -> PyResult<(f64, f64, f64)> {
        let (before, after) = (numbers("before", before)?, numbers("after", after)?);
        let steering = steering_angle.map(|angle| angle.named("steering_angle")).transpose()?;
        Ok(self.0.odometry(&before, &after, steering, ticks.named("ticks")?)?.to_array().into())
    }

    pub fn __repr__(&self) -> String {
        let (drive, [left, right]) = (&self.0, self.0.wheel_radius());
        let radius = if left == right { format!("{left:?}") } else { format!("({left:?}, {right:?})") };
        let mut arguments = vec![format!("track={:?}, wheel_radius={radius}", drive.track())];
        if drive.kind() != DriveKind::Differential {
            arguments.insert(0, format!("wheelbase={:?}", drive.wheelbase()));
        }
        if drive.kind() == DriveKind::Ackermann {
            let (limit, rate) = (drive.steering_limit(), drive.steering_rate());
            arguments.push(format!("steering_limit={limit:?}, steering_rate={rate:?}"));
        }
        arguments.push(format!("wheel_speed_limit={:?}", drive.wheel_speed_limit()));
        format!("Drive.{}({})", self.kind(), arguments.join(", "))
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
        let keywords = PyDict::new(py);
        keywords.set_item("track", self.track())?;
        keywords.set_item("wheel_radius", self.wheel_radius())?;
        keywords.set_item("wheel_speed_limit", self.wheel_speed_limit())?;
        if self.0.kind() != DriveKind::Differential {
            keywords.set_item("wheelbase", self.wheelbase())?;
        }
        if self.0.kind() == DriveKind::Ackermann {
            keywords.set_item("steering_limit", self.steering_limit())?;
            keywords.set_item("steering_rate", self.steering_rate())?;
        }
        let constructor = py.get_type::<Self>().getattr(self.kind())?;
        let call = py.import("functools")?.getattr("partial")?.call((constructor,), Some(&keywords))?;
        Ok((call, PyTuple::empty(py)))
    }
}
