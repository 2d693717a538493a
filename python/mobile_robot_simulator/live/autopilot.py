"""Autopilots: the drivers that a live view can give a robot to."""

from __future__ import annotations

import math
from bisect import bisect_right
from typing import TYPE_CHECKING, Protocol

from .._core import Pose, Shape
from ..drivers.goal import Goal, Travel
from ..drivers.script import REPEAT, Script
from ..drivers.wander import Wander, Wandering
from ..instant import NANOSECONDS
from ..messages import LaserScan
from ..physics.velocity_profile import Velocity

if TYPE_CHECKING:
    from ..simulation.robots import SimulatedRobot
    from ..simulation.simulation import Simulation

INTERVAL_NS = round(REPEAT * NANOSECONDS)
"""Longest simulated time between two commands [ns]."""

USUAL_RADIUS = 0.2
"""Radius of a robot without a footprint [m]."""


class Autopilot(Protocol):
    """Decides the velocity of one robot."""

    @property
    def title(self) -> str:
        """Name on the page."""

    @property
    def goal(self) -> Pose | None:
        """Where it takes the robot, in the map frame; None if it has no goal."""

    def velocity(self) -> Velocity | None:
        """Returns the velocity (vx, vy, wz) [m/s, m/s, rad/s] from now on, or None if the robot has arrived.

        Raises:
            ValueError: It cannot go on. The message says why.
        """

    def interval_ns(self) -> int:
        """Returns the simulated time until it must be asked again [ns]."""


class WanderPilot:
    """Roams and avoids what the first scanner sees.

    Args:
        simulation: The simulation.
        robot: Name of the robot.
        seed: Seed of its random turns.
    """

    title, goal = "wander", None

    def __init__(self, simulation: Simulation, robot: str, seed: int) -> None:
        self._simulation, self._robot = simulation, robot
        self._wandering = Wandering(Wander(radius_of(simulation.named(robot))), seed)

    def velocity(self) -> Velocity:
        """Returns the velocity that follows from the last scan; 0 before the first one."""
        scan = self._simulation.latest(self._simulation.named(self._robot).laser.parameters.laser_topic)
        if not isinstance(scan, LaserScan):
            return 0.0, 0.0, 0.0
        return self._wandering.velocity(scan, round(self._simulation.time * NANOSECONDS))

    def interval_ns(self) -> int:
        """Returns the usual interval."""
        return INTERVAL_NS


class GoalPilot:
    """Takes the robot to a pose.

    Args:
        simulation: The simulation.
        robot: Name of the robot.
        goal: The pose, in the map frame.
    """

    title = "goal"

    def __init__(self, simulation: Simulation, robot: str, goal: Pose) -> None:
        self._simulation, self._robot, self.goal = simulation, robot, goal
        self._travel = Travel(Goal(goal, radius_of(simulation.named(robot))))

    def velocity(self) -> Velocity | None:
        """Returns the velocity on the way to the goal, around obstacles and other robots where they are now."""
        simulation = self._simulation
        now_ns = round(simulation.time * NANOSECONDS)
        around = [(each.shape, each.pose(now_ns)) for each in simulation.obstacles]
        for name, other in simulation.robots.items():
            if name != self._robot and (footprint := other.robot.footprint) is not None:
                around.append((footprint, other.pose))
        return self._travel.velocity(simulation.grid, around, simulation.named(self._robot).pose)

    def interval_ns(self) -> int:
        """Returns the usual interval."""
        return INTERVAL_NS


class ScriptPilot:
    """Sends the commands of a file, whose times count from now.

    Args:
        simulation: The simulation.
        script: The commands.
    """

    title, goal = "commands", None

    def __init__(self, simulation: Simulation, script: Script) -> None:
        self._simulation, self._rows = simulation, script.rows
        self._times_ns = [round(row[0] * NANOSECONDS) for row in script.rows]
        self._began_ns = round(simulation.time * NANOSECONDS)

    def velocity(self) -> Velocity:
        """Returns the command that applies now; 0 before the first one."""
        index = bisect_right(self._times_ns, self._passed_ns)
        return self._rows[index - 1][1:] if index else (0.0, 0.0, 0.0)

    def interval_ns(self) -> int:
        """Returns the time to the next command, at most the usual interval."""
        index = bisect_right(self._times_ns, self._passed_ns)
        if index == len(self._times_ns):
            return INTERVAL_NS
        return min(INTERVAL_NS, self._times_ns[index] - self._passed_ns)

    @property
    def _passed_ns(self) -> int:
        return round(self._simulation.time * NANOSECONDS) - self._began_ns


def radius_of(robot: SimulatedRobot) -> float:
    """Returns the radius of the circle around a robot's origin that contains its footprint [m]."""
    footprint: Shape | None = robot.robot.footprint
    if footprint is None:
        return USUAL_RADIUS
    return footprint.radius if footprint.radius is not None else max(math.hypot(x, y) for x, y in footprint.points)
