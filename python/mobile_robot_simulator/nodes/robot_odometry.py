"""RobotOdometry: where a robot believes it is, by its wheels and their encoders."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from .._core import MotionNoise, Pose
from ..parameters import RobotParameters
from ..physics.odometer import Odometer, OdometerReading, OdometerSnapshot
from ..physics.velocity_profile import Velocity
from ..physics.wheel_odometer import WheelOdometer, WheelReading
from ..physics.world import Body


class Robot(Body, Protocol):
    """What the odometry and the output need to know about their robot."""

    @property
    def parameters(self) -> RobotParameters:
        """Current parameters."""


@dataclass(frozen=True)
class RobotOdometrySnapshot:
    """Saved state of a `RobotOdometry`.

    Attributes:
        drift: Noise and seed of the last call of `RobotOdometry.drift`.
        odometer: The odometer and its saved state.
        wheel_odometer: The odometer that reads the encoders and its saved state; None if they are exact.
    """

    drift: tuple[MotionNoise | None, int]
    odometer: tuple[Odometer, OdometerSnapshot]
    wheel_odometer: tuple[WheelOdometer, WheelReading] | None


class RobotOdometry:
    """Estimates the pose and the velocity of a robot.

    The encoders of the wheels are exact, or a `WheelOdometer` reads them. An `Odometer` adds noise to what they say. Neither
    notices slip, pushes, or that the robot is carried.

    Args:
        robot: The robot. `begin` must be called once it has a motion.
    """

    def __init__(self, robot: Robot) -> None:
        self._robot = robot
        self._drift: tuple[MotionNoise | None, int] = (None, 0)

    def begin(self, pose: Pose, now_ns: int) -> None:
        """Starts again now [ns], at a pose in the odometry frame. What `drift` has set stays in effect."""
        noise, seed = self._noise()
        self._odometer = Odometer(pose, now_ns, noise=noise, seed=seed)
        self.begin_wheels(pose, now_ns)

    def begin_wheels(self, pose: Pose, now_ns: int) -> None:
        """Reads the encoders with the current parameters from now on [ns], beginning at a pose that they report."""
        parameters, self._wheel_odometer = self._robot.parameters, None
        if (believed := parameters.believed_wheels) is not None:
            self._wheel_odometer = WheelOdometer(believed, parameters.encoder_ticks, self._robot.motion, pose, now_ns)

    @property
    def is_exact(self) -> bool:
        """True if the estimate is the pose of the wheels, which slip can still make wrong."""
        return self._wheel_odometer is None and self._odometer.is_exact

    def drift(self, noise: MotionNoise | None, seed: int, now_ns: int) -> None:
        """Changes the noise from now on [ns]. The error and the covariance so far stay.

        Args:
            noise: Noise of the odometry; None for that of the parameters.
            seed: Seed of the noise.
            now_ns: Simulated time [ns].
        """
        self._drift = noise, seed
        self.update_noise(now_ns)

    def update_noise(self, now_ns: int) -> None:
        """Takes over the noise of the parameters from now on [ns], unless `drift` has set another one."""
        self._odometer.read(self.read_wheels(now_ns)[0], now_ns)
        self._odometer.set_noise(*self._noise())

    def read(self, now_ns: int) -> tuple[OdometerReading, Velocity]:
        """Reads the odometry now [ns]. Returns the reading, and the velocity that belongs to it."""
        wheels, velocity = self.read_wheels(now_ns)
        reading = self._odometer.read(wheels, now_ns)
        return reading, velocity if reading.twist is None else reading.twist

    def read_wheels(self, now_ns: int) -> tuple[Pose, Velocity]:
        """Returns pose and velocity as the encoders of the wheels tell them now [ns]."""
        motion = self._robot.motion
        if self._wheel_odometer is None:
            return motion.wheel_pose(now_ns).wrapped(), motion.wheel_velocity(now_ns)
        reading = self._wheel_odometer.read(motion, now_ns)
        return reading.pose, reading.velocity

    def pose(self, now_ns: int) -> Pose:
        """Returns the pose now [ns], as if there had been no error since the last reading. Changes no later reading."""
        wheels = self._robot.motion.wheel_pose(now_ns).wrapped()
        if self._wheel_odometer is not None:
            wheels = self._wheel_odometer.pose_at(wheels)
        return self._odometer.pose_at(wheels)

    def save(self) -> RobotOdometrySnapshot:
        """Returns the state that `restore` takes."""
        odometer, wheels = self._odometer, self._wheel_odometer
        return RobotOdometrySnapshot(
            self._drift, (odometer, odometer.save()), None if wheels is None else (wheels, wheels.save())
        )

    def restore(self, state: RobotOdometrySnapshot) -> None:
        """Returns to a saved state."""
        self._drift, (self._odometer, reading) = state.drift, state.odometer
        self._odometer.restore(reading)
        self._wheel_odometer = None
        if state.wheel_odometer is not None:
            self._wheel_odometer, wheel_reading = state.wheel_odometer
            self._wheel_odometer.restore(wheel_reading)

    def _noise(self) -> tuple[MotionNoise | None, int]:
        """Returns the noise and its seed: those of `drift`, or else those of the parameters."""
        noise, seed = self._drift
        parameters = self._robot.parameters
        return (parameters.motion_noise, parameters.odometry_seed) if noise is None else (noise, seed)
