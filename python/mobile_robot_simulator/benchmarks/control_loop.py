"""ControlLoop: asks a controller for a command at equal times, from the last scan and odometry."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple

from .._core import Pose
from ..bus.topic import absolute
from ..messages import LaserScan, Odometry, Twist, Vector3
from ..simulation.simulation import Simulation

__all__ = ["STEP", "ControlLoop", "Controller", "Observation"]

STEP = 0.1
"""Time between two commands [s], after which contact and arrival are checked, as in the BARN challenge."""


class Observation(NamedTuple):
    """What a controller knows."""

    time: float
    """Time since the start [s]."""

    scan: LaserScan
    """The last scan."""

    odometry: Odometry
    """The last odometry. Its frame is the pose of the robot at the start."""

    goal: tuple[float, float]
    """Goal (x, y) in the frame of the robot, x forward, by odometry [m]; NaN if there is none."""


Controller = Callable[[Observation], tuple[float, float]]
"""Returns the command for the next `STEP`: forward velocity [m/s] and turn rate [rad/s]."""


class ControlLoop:
    """Lets a controller drive the first robot of a simulation.

    Args:
        simulation: The simulation, at the start of the drive.
        control: The controller.
        goal: Goal (x, y) in the map frame [m], or None.
        name: Name of the drive in error messages.
    """

    def __init__(
        self, simulation: Simulation, control: Controller, goal: tuple[float, float] | None, *, name: str = "the drive"
    ) -> None:
        self._simulation, self._control, self._name = simulation, control, name
        self._goal = None if goal is None else Pose(*goal)
        robot, scans = simulation.robot.parameters, simulation.laser.parameters.laser_topic
        self._scans, self._odometry = absolute(scans), absolute(robot.odometry_topic)
        self._commands = absolute(robot.velocity_topic)
        self._start = simulation.pose
        # The odometry has a frame of its own, in which the start need not be 0.
        self._map_from_odom: Pose | None = None

    def command(self) -> tuple[float, float] | None:
        """Asks the controller and publishes its command. Does nothing as long as there is no scan or no odometry.

        Returns:
            The command: forward velocity [m/s] and turn rate [rad/s]; None if nothing was published.

        Raises:
            ValueError: The command is not two finite numbers.
            Exception: Any error that the controller raises.
        """
        sim = self._simulation
        scan, odometry = sim.latest(self._scans), sim.latest(self._odometry)
        if scan is None or odometry is None:
            return None
        goal = (math.nan, math.nan)
        if self._goal is not None:
            odom_from_base = _pose(odometry)
            if self._map_from_odom is None:
                self._map_from_odom = self._start * odom_from_base.inverse()
            seen = (self._map_from_odom * odom_from_base).inverse() * self._goal
            goal = seen.x, seen.y
        speed, turn_rate = _checked(self._name, self._control(Observation(sim.time, scan, odometry, goal)))
        sim.publish(self._commands, Twist(linear=Vector3(x=speed), angular=Vector3(z=turn_rate)))
        return speed, turn_rate


def _pose(odometry: Odometry) -> Pose:
    position, rotation = odometry.pose.pose.position, odometry.pose.pose.orientation
    return Pose.from_quaternion(position.x, position.y, qx=rotation.x, qy=rotation.y, qz=rotation.z, qw=rotation.w)


def _checked(name: str, command: Sequence[float]) -> tuple[float, float]:
    try:
        speed, turn_rate = command
        speed, turn_rate = float(speed), float(turn_rate)
    except (TypeError, ValueError):
        raise ValueError(f"{name}: a command must be two numbers (speed, turn rate), got {command!r}") from None
    if not (math.isfinite(speed) and math.isfinite(turn_rate)):
        raise ValueError(f"{name}: a command must be finite, got {command!r}")
    return speed, turn_rate
