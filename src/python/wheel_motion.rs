//! The Python class `WheelMotion`.

use numpy::ndarray::Array2;
use numpy::{IntoPyArray, PyArray1, PyArray2};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use super::arrays::{numbers, type_name};
use super::drive::Drive;
use super::limits::{Limits, LimitsArgument};
use super::number::Argument;
use super::pose::{Pose, PoseArgument};
use super::{Recipe, recipe};
use crate::error::check_all_finite;
use crate::{MAX_WHEELS, Steering};

/// The motion of a robot from the time on at which its wheels begin to follow a command.
///
/// The velocity changes under limits as in `Limits.apply`, and the steering angle at its rate. No wheel turns faster than its
/// limit: the velocity is scaled down at each moment, so that the robot stays on its path.
///
/// The motion is exact up to rounding at a constant steering angle, where the path of an Ackermann drive is an arc. While the
/// steering angle changes, and while limits on acceleration and on the wheels act together, the pose is an integral by
/// Gauss-Legendre quadrature with an error below 1e-9 m, for a path of up to 1 km.
///
/// Args:
///     drive: Wheels of the robot.
///     current: Velocity (vx, vy, wz) at the start, in the robot's frame [m/s, m/s, rad/s].
///     wanted: Commanded velocity, as `Drive.command` returns it. Of an Ackermann drive, only vx counts, here and in `current`.
///     limits: Limits on the velocity and its change; of an Ackermann drive, only those of vx count. None for no limits.
///     steering_angle: Steering angle at the start, in -1.5..1.5 [rad]; limited to what the drive can do.
///     steering_goal: Steering angle to aim at [rad]; limited to what the drive can do. Default: `steering_angle`.
///     steering_rate: Largest change of the steering angle per second [rad/s], beside that of the drive.
///
/// Raises:
///     ValueError: A number is not finite, the angle at the start is out of range, the rate is not positive, or a drive that
///         does not steer has an angle other than 0 or a finite rate. The rate can be infinite.
///
/// Examples:
///     >>> import mobile_robot_simulator as mrs
///     >>> car = mrs.Drive.ackermann(wheelbase=2.5, track=1.5, wheel_radius=0.3, steering_limit=0.6, steering_rate=0.25)
///     >>> motion = mrs.WheelMotion(car, (1.0, 0.0, 0.0), (1.0, 0.0, 0.0), steering_goal=0.5)
///     >>> motion.steering(1.0), motion.steering(3.0)
///     (0.25, 0.5)
#[pyclass(frozen, module = "mobile_robot_simulator")]
pub struct WheelMotion {
    motion: crate::WheelMotion,
    drive: Drive,
    limits: Option<Limits>,
    current: [f64; 3],
    wanted: [f64; 3],
    steering: Steering,
}

#[pymethods]
impl WheelMotion {
    #[new]
    #[pyo3(
        text_signature = "(drive, current, wanted, *, limits=None, steering_angle=0.0, steering_goal=None, steering_rate=1e999)",
        signature = (
            drive,
            current,
            wanted,
            *,
            limits = None,
            steering_angle = 0.0.into(),
            steering_goal = None,
            steering_rate = f64::INFINITY.into(),
        )
    )]
    fn new(
        drive: &Bound<'_, PyAny>,
        current: Argument<[f64; 3]>,
        wanted: Argument<[f64; 3]>,
        limits: Option<LimitsArgument>,
        steering_angle: Argument<f64>,
        steering_goal: Option<Argument<f64>>,
        steering_rate: Argument<f64>,
    ) -> PyResult<Self> {
        let drive = drive.cast::<Drive>().map(|drive| *drive.get()).map_err(|_| {
            let hint = "; make one with Drive.differential, Drive.omni or Drive.ackermann";
            PyTypeError::new_err(format!("drive must be a Drive, got {}{hint}", type_name(drive)))
        })?;
        let (current, wanted) = (current.named("current")?, wanted.named("wanted")?);
        let angle = steering_angle.named("steering_angle")?;
        let goal = steering_goal.map_or(Ok(angle), |goal| goal.named("steering_goal"))?;
        let steering = Steering { angle, goal, rate: steering_rate.named("steering_rate")? };
        let limits = limits.map(|limits| limits.0);
        let of = limits.map_or(crate::Limits::NONE, |limits| limits.0);
        let motion = crate::WheelMotion::new(drive.0, &of, current.into(), wanted.into(), steering)?;
        Ok(Self { motion, drive, limits, current, wanted, steering })
    }

    /// Wheels of the robot.
    #[getter]
    fn drive(&self) -> Drive {
        self.drive
    }

    /// Returns the velocity of the robot if its wheels do not slip.
    ///
    /// Args:
    ///     time: Time from the start on [s].
    ///
    /// Returns:
    ///     (vx, vy, wz) in the robot's frame [m/s, m/s, rad/s].
    ///
    /// Raises:
    ///     ValueError: The time is negative or not finite.
    ///
    /// Examples:
    ///     >>> import mobile_robot_simulator as mrs
    ///     >>> car = mrs.Drive.ackermann(wheelbase=2.5, track=1.5, wheel_radius=0.3, steering_limit=0.6, steering_rate=0.25)
    ///     >>> limits = mrs.Limits(acceleration=(0.5, 0.5, 0.5))
    ///     >>> motion = mrs.WheelMotion(car, (0.0, 0.0, 0.0), (1.5, 0.0, 0.0), limits=limits)
    ///     >>> motion.velocity(2.0)
    ///     (1.0, 0.0, 0.0)
    fn velocity(&self, time: Argument<f64>) -> PyResult<(f64, f64, f64)> {
        Ok(self.motion.velocity(checked_time(time)?).to_array().into())
    }

    /// Returns the velocity from which another motion goes on, as the argument `current`.
    ///
    /// Args:
    ///     time: Time from the start on [s].
    ///
    /// Returns:
    ///     (vx, vy, wz) before the limit of the wheels; only the speed of an Ackermann drive [m/s, m/s, rad/s].
    ///
    /// Raises:
    ///     ValueError: The time is negative or not finite.
    ///
    /// Examples:
    ///     >>> import mobile_robot_simulator as mrs
    ///     >>> drive = mrs.Drive.differential(track=0.5, wheel_radius=0.1, wheel_speed_limit=10.0)
    ///     >>> motion = mrs.WheelMotion(drive, (0.0, 0.0, 0.0), (2.0, 0.0, 0.0))
    ///     >>> motion.velocity(0.0), motion.ramp_velocity(0.0)
    ///     ((1.0, 0.0, 0.0), (2.0, 0.0, 0.0))
    fn ramp_velocity(&self, time: Argument<f64>) -> PyResult<(f64, f64, f64)> {
        Ok(self.motion.ramp_velocity(checked_time(time)?).to_array().into())
    }

    /// Returns the steering angle of the robot.
    ///
    /// Args:
    ///     time: Time from the start on [s].
    ///
    /// Returns:
    ///     Steering angle [rad].
    ///
    /// Raises:
    ///     ValueError: The time is negative or not finite.
    ///
    /// Examples:
    ///     >>> import mobile_robot_simulator as mrs
    ///     >>> car = mrs.Drive.ackermann(wheelbase=2.5, track=1.5, wheel_radius=0.3, steering_limit=0.6, steering_rate=0.25)
    ///     >>> motion = mrs.WheelMotion(car, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), steering_goal=-0.5)
    ///     >>> motion.steering(1.0)
    ///     -0.25
    fn steering(&self, time: Argument<f64>) -> PyResult<f64> {
        Ok(self.motion.steering(checked_time(time)?))
    }

    /// Returns the rate of change of the steering angle.
    ///
    /// Args:
    ///     time: Time from the start on [s].
    ///
    /// Returns:
    ///     Rate of change [rad/s].
    ///
    /// Raises:
    ///     ValueError: The time is negative or not finite.
    ///
    /// Examples:
    ///     >>> import mobile_robot_simulator as mrs
    ///     >>> car = mrs.Drive.ackermann(wheelbase=2.5, track=1.5, wheel_radius=0.3, steering_limit=0.6, steering_rate=0.25)
    ///     >>> motion = mrs.WheelMotion(car, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), steering_goal=-0.5)
    ///     >>> motion.steering_rate(1.0), motion.steering_rate(3.0)
    ///     (-0.25, 0.0)
    fn steering_rate(&self, time: Argument<f64>) -> PyResult<f64> {
        Ok(self.motion.steering_rate(checked_time(time)?))
    }

    /// Returns the rate of each wheel.
    ///
    /// Args:
    ///     time: Time from the start on [s].
    ///
    /// Returns:
    ///     (wheel_count,) float64 [rad/s].
    ///
    /// Raises:
    ///     ValueError: The time is negative or not finite.
    ///
    /// Examples:
    ///     >>> import mobile_robot_simulator as mrs
    ///     >>> drive = mrs.Drive.differential(track=0.5, wheel_radius=0.1)
    ///     >>> mrs.WheelMotion(drive, (0.0, 0.0, 0.0), (1.0, 0.0, 1.0)).wheels(0.0)
    ///     array([ 7.5, 12.5])
    fn wheels<'py>(&self, py: Python<'py>, time: Argument<f64>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        self.of_wheels(py, "the resulting rates", self.motion.wheels(checked_time(time)?))
    }

    /// Returns the angle by which each wheel has turned.
    ///
    /// Args:
    ///     time: Time from the start on [s].
    ///
    /// Returns:
    ///     (wheel_count,) float64 [rad].
    ///
    /// Raises:
    ///     ValueError: The time is negative or not finite.
    ///
    /// Examples:
    ///     >>> import mobile_robot_simulator as mrs
    ///     >>> drive = mrs.Drive.differential(track=0.5, wheel_radius=0.1)
    ///     >>> mrs.WheelMotion(drive, (0.0, 0.0, 0.0), (1.0, 0.0, 1.0)).rolled(2.0)
    ///     array([15., 25.])
    fn rolled<'py>(&self, py: Python<'py>, time: Argument<f64>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        self.of_wheels(py, "the resulting angles", self.motion.rolled(time.named("time")?)?)
    }

    /// Returns the pose that the robot reaches.
    ///
    /// Args:
    ///     pose: Pose at the start.
    ///     time: Duration [s].
    ///     grip: Share of the motion of the wheels that the robot makes, in 0..1; 1 without slip.
    ///
    /// Returns:
    ///     The pose after the time. Its yaw is not wrapped.
    ///
    /// Raises:
    ///     ValueError: A number or the resulting pose is not finite, the grip is not in 0..1, or the time is negative.
    ///
    /// Examples:
    ///     >>> import mobile_robot_simulator as mrs
    ///     >>> car = mrs.Drive.ackermann(wheelbase=2.5, track=1.5, wheel_radius=0.3, steering_limit=0.6)
    ///     >>> motion = mrs.WheelMotion(car, (0.0, 0.0, 0.0), (1.5, 0.0, 0.0))
    ///     >>> motion.integrate(mrs.Pose(), 2.0)
    ///     Pose(3.0, 0.0, 0.0)
    #[pyo3(text_signature = "($self, pose, time, *, grip=1.0)", signature = (pose, time, *, grip = 1.0.into()))]
    fn integrate(&self, pose: PoseArgument, time: Argument<f64>, grip: Argument<f64>) -> PyResult<Pose> {
        Ok(Pose(self.motion.integrate(pose.0, time.named("time")?, grip.named("grip")?)?))
    }

    /// Returns the poses that the robot reaches at several times: those of `integrate`.
    ///
    /// Args:
    ///     pose: Pose at the start.
    ///     times: (N,) times from the start on [s]. Anything that NumPy can convert to float64 without loss.
    ///     grip: Share of the motion of the wheels that the robot makes, in 0..1; 1 without slip.
    ///
    /// Returns:
    ///     (N, 3) float64, one row (x, y, yaw) per time [m, m, rad]. Yaws are not wrapped.
    ///
    /// Raises:
    ///     ValueError: `times` is not one-dimensional, a time is negative, the grip is not in 0..1, or a number or a pose reached
    ///         is not finite.
    ///     TypeError: `times` cannot be converted to float64 without loss.
    ///
    /// Examples:
    ///     >>> import mobile_robot_simulator as mrs
    ///     >>> drive = mrs.Drive.differential(track=0.5, wheel_radius=0.1)
    ///     >>> mrs.WheelMotion(drive, (0.0, 0.0, 0.0), (1.0, 0.0, 0.0)).trace(mrs.Pose(), [0.0, 0.5])
    ///     array([[0. , 0. , 0. ],
    ///            [0.5, 0. , 0. ]])
    #[pyo3(text_signature = "($self, pose, times, *, grip=1.0)", signature = (pose, times, *, grip = 1.0.into()))]
    fn trace<'py>(
        &self,
        py: Python<'py>,
        pose: PoseArgument,
        times: &Bound<'py, PyAny>,
        grip: Argument<f64>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let poses = self.motion.trace(pose.0, &numbers("times", times)?, grip.named("grip")?)?;
        Ok(Array2::from(poses).into_pyarray(py))
    }

    /// Returns the length of the path that the robot has driven without slip. Turning in place adds nothing.
    ///
    /// Args:
    ///     time: Time from the start on [s].
    ///
    /// Returns:
    ///     The length [m].
    ///
    /// Raises:
    ///     ValueError: The time is negative or not finite.
    ///
    /// Examples:
    ///     >>> import mobile_robot_simulator as mrs
    ///     >>> drive = mrs.Drive.differential(track=0.5, wheel_radius=0.1)
    ///     >>> mrs.WheelMotion(drive, (0.0, 0.0, 0.0), (-1.0, 0.0, 0.5)).distance(2.0)
    ///     2.0
    fn distance(&self, time: Argument<f64>) -> PyResult<f64> {
        Ok(self.motion.distance(time.named("time")?)?)
    }

    fn __repr__(&self) -> String {
        let ([vx, vy, wz], [to_x, to_y, to_z]) = (self.current, self.wanted);
        let Steering { angle, goal, rate } = self.steering;
        let limits = self.limits.map_or(String::new(), |limits| format!(", limits={}", limits.__repr__()));
        format!(
            "WheelMotion({}, ({vx:?}, {vy:?}, {wz:?}), ({to_x:?}, {to_y:?}, {to_z:?}){limits}, steering_angle={angle:?}, \
             steering_goal={goal:?}, steering_rate={rate:?})",
            self.drive.__repr__()
        )
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Recipe<'py>> {
        let keywords = PyDict::new(py);
        keywords.set_item("limits", self.limits)?;
        keywords.set_item("steering_angle", self.steering.angle)?;
        keywords.set_item("steering_goal", self.steering.goal)?;
        keywords.set_item("steering_rate", self.steering.rate)?;
        let [current, wanted] = [self.current, self.wanted].map(<(f64, f64, f64)>::from);
        let arguments = (self.drive, current, wanted).into_pyobject(py)?;
        recipe::<Self>(py, arguments, keywords)
    }
}

impl WheelMotion {
    /// Returns the numbers of the wheels, after a check that they are finite.
    fn of_wheels<'py>(
        &self,
        py: Python<'py>,
        name: &'static str,
        values: [f64; MAX_WHEELS],
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        check_all_finite(name, &values, 1)?;
        Ok(values[..self.drive.0.wheel_count()].to_vec().into_pyarray(py))
    }
}

fn checked_time(time: Argument<f64>) -> PyResult<f64> {
    let time = time.named("time")?;
    if time >= 0.0 && time.is_finite() {
        return Ok(time);
    }
    Err(crate::Error::Number { name: "time", value: time, needed: "at least 0" }.into())
}
