"""Faults of robots and their nodes: wheel slip, pushes, odometry drift, clock jumps and outages."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import partial
from typing import Any

import numpy as np

from .._core import MAX_COMMAND
from ..bus.bus import Bus
from ..instant import NANOSECONDS
from ..parameters import motion_noise
from ..physics.push import turned
from ..quoting import quoted
from ..simulation.arguments import check_at_least_0, check_numbers
from ..simulation.fault import F, Fault, FaultBus, FaultTarget, Startable


class Slip(Fault):
    """The wheels of a robot slip, so it moves less than they turn. Its odometry does not notice this.

    If several slips act at the same time, their remaining shares of motion (1 - share) are multiplied.

    Args:
        share: Share of the motion that is lost, in 0..1.
        robot: Name of the robot; None for the first.
        **options: As for `Fault`.

    Raises:
        ValueError: The share is not in 0..1.
    """

    def __init__(self, share: float, *, robot: str | None = None, **options: Any) -> None:
        super().__init__(**options)
        check_numbers(share=share)
        if not 0.0 <= share <= 1.0:
            raise ValueError(f"the share must be in 0..1, got {quoted(share)}")
        self.share, self.robot = share, robot

    def _prepare(self, simulation: FaultTarget, bus: FaultBus) -> None:
        self._simulation, self._node = simulation, simulation.named(self.robot).robot
        for time in (self.start, self.end):
            self._plan(bus, time, self._finish)

    def _finish(self) -> None:
        """Lets the robot slip as the slips that act now say."""
        simulation, robot = self._simulation, self._node
        shares = [fault.share for fault in _acting(simulation, Slip) if simulation.named(fault.robot).robot is robot]
        share = shares[0] if len(shares) == 1 else 1.0 - math.prod(1.0 - share for share in shares)
        robot.slip(share or None)
        self._note(f"{robot.body_name or 'the robot'} slips by {share:g}")

    def _arguments(self) -> list[str]:
        return [f"{self.share:g}", *_robot_argument(self.robot)]


class Push(Fault):
    """Something pushes a robot, as wind, a slope or a person does. Its wheels and its odometry do not notice this.

    The velocity of the push is added to that of the robot. It does not turn the robot. Contact with walls and obstacles
    holds a pushed robot as it holds a driving one. If several pushes act at the same time, their velocities are added.

    Args:
        speed: Speed [m/s].
        direction: Direction in the map frame, counter-clockwise from the x axis [rad].
        robot: Name of the robot; None for the first.
        **options: As for `Fault`.

    Raises:
        ValueError: The speed is negative or not finite, or the direction is not finite.
    """

    def __init__(self, speed: float, direction: float = 0.0, *, robot: str | None = None, **options: Any) -> None:
        super().__init__(**options)
        check_at_least_0(speed=speed)
        check_numbers(direction=direction)
        if not (speed <= MAX_COMMAND and abs(direction) <= MAX_COMMAND):
            raise ValueError(f"speed and direction of a push must be at most {MAX_COMMAND:g}, got {speed} and {direction}")
        self.speed, self.direction, self.robot = speed, direction, robot

    def _prepare(self, simulation: FaultTarget, bus: FaultBus) -> None:
        self._simulation, self._node = simulation, simulation.named(self.robot).robot
        for time in (self.start, self.end):
            self._plan(bus, time, self._finish)

    def _finish(self) -> None:
        """Pushes the robot as the pushes that act now say."""
        simulation, robot = self._simulation, self._node
        acting = [fault for fault in _acting(simulation, Push) if simulation.named(fault.robot).robot is robot]
        velocities = [turned((fault.speed, 0.0), fault.direction) for fault in acting]
        vx, vy = math.fsum(vx for vx, _ in velocities), math.fsum(vy for _, vy in velocities)
        robot.push((vx, vy) if velocities else None)
        self._note(f"{robot.body_name or 'the robot'} is pushed by ({vx:.3g}, {vy:.3g}) m/s")

    def _arguments(self) -> list[str]:
        direction = [f"direction={self.direction:g} rad"] if self.direction else []
        return [f"{self.speed:g} m/s", *direction, *_robot_argument(self.robot)]


class OdometryDrift(Fault):
    """The odometry of a robot drifts, and its covariance grows accordingly.

    The errors follow the velocity motion model of Thrun, Burgard and Fox, Probabilistic Robotics (2005), table 5.3, for
    steps of 0.1 s, as with the parameter `odometry_alphas`. The fault replaces this parameter while it acts. When it ends,
    the error that it has caused stays, as on a real robot; a reset removes it.

    Args:
        alphas: The six noise parameters alpha1 to alpha6 of the model.
        robot: Name of the robot; None for the first.
        seed: Seed of the errors.
        **options: As for `Fault`.

    Raises:
        ValueError: There are not six alphas. Also raised by `Simulation.add_fault` if another `OdometryDrift` acts on the
            same robot at the same time.
    """

    def __init__(self, alphas: Sequence[float], *, robot: str | None = None, seed: int = 0, **options: Any) -> None:
        super().__init__(seed=seed, **options)
        if not isinstance(alphas, Sequence | np.ndarray) or len(alphas) != 6:
            got = len(alphas) if isinstance(alphas, Sequence | np.ndarray) else quoted(alphas)
            raise ValueError(f"alphas must be six numbers, got {got}")
        self.alphas, self.noise, self.robot = tuple(alphas), motion_noise(alphas), robot

    def _prepare(self, simulation: FaultTarget, bus: FaultBus) -> None:
        robot = simulation.named(self.robot).robot
        for other in simulation.faults:
            same = isinstance(other, OdometryDrift) and simulation.named(other.robot).robot is robot
            if same and not other.is_stopped and other.start < self.end and self.start < other.end:
                raise ValueError(
                    f"two faults must not make the odometry of one robot drift at the same time: "
                    f"another acts from {other.start:g} s to {other.end:g} s"
                )
        self._node = robot
        self._plan(bus, self.start, self._begin)
        self._plan(bus, self.end, self._finish)

    def _begin(self) -> None:
        self._node.drift(self.noise, self.seed)
        self._note(f"odometry of {self._node.body_name or 'the robot'} drifts")

    def _finish(self) -> None:
        self._node.drift(None, self.seed)
        self._note(f"odometry of {self._node.body_name or 'the robot'} no longer drifts")

    def _arguments(self) -> list[str]:
        return [f"({', '.join(f'{alpha:g}' for alpha in self.alphas)})", *_robot_argument(self.robot)]


class ClockJump(Fault):
    """All clocks of nodes jump, and with them `/clock` and all stamps. The motion of robots is not affected.

    Args:
        seconds: Size of the jump [s]; negative for a jump back.
        at: Time of the jump [s].

    Raises:
        ValueError: The jump is 0 or not finite.
    """

    def __init__(self, seconds: float, *, at: float = 0.0) -> None:
        super().__init__(start=at)
        check_numbers(seconds=seconds)
        if not math.isfinite(seconds) or seconds == 0.0:
            raise ValueError(f"a jump must be finite and not 0 s, got {quoted(seconds)}")
        self.seconds = seconds

    def __repr__(self) -> str:
        return f"ClockJump({self.seconds:g} s, at={self.start:g} s)"

    def _prepare(self, simulation: FaultTarget, bus: FaultBus) -> None:
        if not isinstance(bus, Bus):
            raise ValueError(f"{self!r} needs the simulated clock of a Simulation; on ROS, clocks cannot jump")
        self._plan(bus, self.start, partial(self._jump, bus))

    def _jump(self, bus: Bus) -> None:
        bus.clock_offset_ns += round(self.seconds * NANOSECONDS)
        self._note(f"the clock jumps by {self.seconds:g} s")


class Outage(Fault):
    """A node stops, and starts again when the fault ends. A robot stands still while its node is stopped.

    If several outages of a node overlap, it starts again when the last of them ends.

    Args:
        node: The node: "robot", "laser" or "map_server".
        robot: Name of the robot; None for the first.
        start: Time at which the node stops [s].
        end: Time at which the node starts again [s].

    Raises:
        ValueError: The node is not one of the three.
    """

    def __init__(self, node: str, *, robot: str | None = None, start: float = 0.0, end: float = math.inf) -> None:
        super().__init__(start=start, end=end)
        if node not in ("robot", "laser", "map_server"):
            raise ValueError(f"the node must be robot, laser or map_server, got {quoted(node)}")
        self.node, self.robot = node, robot

    def _prepare(self, simulation: FaultTarget, bus: FaultBus) -> None:
        # A process on ROS may have only one of these nodes.
        self._nodes: tuple[Startable, ...]
        if self.node == "map_server":
            self._nodes = (simulation.map_server,)
        elif self.node == "laser":
            self._nodes = tuple(simulation.named(self.robot).scanners.values())
        else:
            self._nodes = (simulation.named(self.robot).robot,)
        self._simulation = simulation
        self._plan(bus, self.start, self._begin)
        self._plan(bus, self.end, self._finish)

    def _begin(self) -> None:
        for node in self._nodes:
            node.stop()
        self._note(f"{self.node} stops")

    def _finish(self) -> None:
        if any(fault._nodes == self._nodes for fault in _acting(self._simulation, Outage)):
            return
        for node in self._nodes:
            node.start()
        self._note(f"{self.node} is back")

    def _arguments(self) -> list[str]:
        return [repr(self.node), *_robot_argument(self.robot)]


def _acting(simulation: FaultTarget, kind: type[F]) -> list[F]:
    """Returns the faults of a kind that act now."""
    return [fault for fault in simulation.faults if isinstance(fault, kind) and fault.acts]


def _robot_argument(robot: str | None) -> list[str]:
    return [] if robot is None else [f"robot={robot!r}"]
