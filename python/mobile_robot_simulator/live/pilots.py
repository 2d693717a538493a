"""Pilots: who drives each robot of a live view, a viewer or an autopilot, and the commands that follow."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

from ..instant import NANOSECONDS
from ..messages import Header, Time, Twist, TwistStamped, Vector3
from ..physics.velocity_profile import Velocity
from .autopilot import INTERVAL_NS, Autopilot
from .journal import Command, Journal
from .pace import GRAIN_NS

if TYPE_CHECKING:
    from ..simulation.simulation import Simulation

HOLD = 0.5
"""Wall time for which a velocity from a page is held [s]. Pages repeat it more often; a closed tab does not."""


@dataclass
class _Pilot:
    """Who drives a robot.

    Attributes:
        velocity: Last velocity (vx, vy, wz) [m/s, m/s, rad/s].
        until: Wall time at which a velocity from a page ends unless the page repeats it [s].
        next_ns: Simulated time of the next command [ns].
        autopilot: The driver, or None if it is a viewer.
    """

    velocity: Velocity
    until: float
    next_ns: int
    autopilot: Autopilot | None = None


class Pilots:
    """Drives the robots of a simulation. Each command goes to the journal.

    Args:
        simulation: The simulation.
        journal: Takes the commands.

    Attributes:
        notes: What viewers should be told, such as that a goal was reached. Whoever tells them, clears it.
    """

    def __init__(self, simulation: Simulation, journal: Journal) -> None:
        self._simulation, self._journal = simulation, journal
        self._pilots: dict[str, _Pilot] = {}
        self.notes: list[str] = []

    @property
    def autopilots(self) -> Mapping[str, Autopilot]:
        """The autopilots by the names of their robots."""
        return {robot: each.autopilot for robot, each in self._pilots.items() if each.autopilot is not None}

    def hold(self, robot: str, velocity: Velocity, wall: float) -> None:
        """Drives a robot at a velocity for `HOLD` seconds of wall time. It takes the robot from an autopilot.

        A velocity of 0 stops a robot that a viewer drives, and has no effect on others.

        Args:
            robot: Name of the robot.
            velocity: vx, vy, wz [m/s, m/s, rad/s].
            wall: Present wall time [s].
        """
        before = self._pilots.get(robot)
        if not any(velocity):
            if before is not None and before.autopilot is None:
                self.stop(robot)
        elif before is not None and before.autopilot is None and before.velocity == velocity:
            before.until = wall + HOLD
        else:
            self._command(robot, velocity)
            self._pilots[robot] = _Pilot(velocity, wall + HOLD, self._now_ns + self._interval_ns(robot))

    def engage(self, robot: str, autopilot: Autopilot) -> None:
        """Gives a robot to an autopilot.

        Raises:
            ValueError: The autopilot cannot drive from here. Nothing changes.
        """
        autopilot.velocity()
        self._pilots[robot] = _Pilot((0.0, 0.0, 0.0), float("inf"), self._now_ns, autopilot)

    def stop(self, robot: str) -> None:
        """Stops a robot that a viewer or an autopilot drives. Has no effect on others."""
        if self._pilots.pop(robot, None) is not None:
            self._command(robot, (0.0, 0.0, 0.0))

    def release(self) -> None:
        """Stops all robots that a viewer drives. Autopilots go on."""
        for robot, pilot in list(self._pilots.items()):
            if pilot.autopilot is None:
                self.stop(robot)

    def forget(self) -> None:
        """Nobody drives any longer. Nothing is sent."""
        self._pilots.clear()

    def end_held(self, wall: float) -> None:
        """Stops the robots whose page has been silent for too long, at a wall time [s]."""
        for robot, pilot in list(self._pilots.items()):
            if pilot.until < wall:
                self.stop(robot)

    def send_due(self) -> None:
        """Sends the commands that are due now."""
        for robot, pilot in list(self._pilots.items()):
            if self._now_ns >= pilot.next_ns:
                self._send(robot, pilot)

    def until_next_ns(self, most_ns: int) -> int:
        """Returns the simulated time until the next command [ns], at most a given time and at least one grain."""
        return max(GRAIN_NS, min([most_ns, *(pilot.next_ns - self._now_ns for pilot in self._pilots.values())]))

    def _send(self, robot: str, pilot: _Pilot) -> None:
        interval_ns = self._interval_ns(robot)
        if pilot.autopilot is not None:
            try:
                velocity = pilot.autopilot.velocity()
                interval_ns = min(interval_ns, pilot.autopilot.interval_ns())
            except ValueError as error:
                self.notes.append(f"{self._simulation.named(robot).title} stops: {error}")
                self.stop(robot)
                return
            if velocity is None:
                self.notes.append(f"{self._simulation.named(robot).title} has arrived")
                self.stop(robot)
                return
            pilot.velocity = velocity
        self._command(robot, pilot.velocity)
        # Rounded up, because the simulation stops at whole grains only.
        pilot.next_ns = self._now_ns - -max(GRAIN_NS, interval_ns) // GRAIN_NS * GRAIN_NS

    def _interval_ns(self, robot: str) -> int:
        """Returns the simulated time between two commands, within which no command times out [ns]."""
        timeout = self._simulation.named(robot).robot.parameters.velocity_timeout
        if not timeout:
            return INTERVAL_NS
        return max(GRAIN_NS, min(INTERVAL_NS, round(timeout / 2 * NANOSECONDS)) // GRAIN_NS * GRAIN_NS)

    def _command(self, robot: str, velocity: Velocity) -> None:
        parameters = self._simulation.named(robot).robot.parameters
        vx, vy, wz = velocity
        twist = Twist(Vector3(vx, vy), Vector3(z=wz))
        topic, stamped = parameters.velocity_topic, parameters.cmd_vel_stamped
        if stamped:
            header = Header(Time.from_nanoseconds(self._now_ns), "base_link")
            self._simulation.publish(topic, TwistStamped(header, twist))
        else:
            self._simulation.publish(topic, twist)
        self._journal.add_command(Command(self._now_ns, robot, velocity), topic, stamped=stamped)

    @property
    def _now_ns(self) -> int:
        return round(self._simulation.time * NANOSECONDS)
