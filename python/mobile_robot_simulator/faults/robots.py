"""Faults to order: small seeded objects that go wrong in a simulation, each time in the same way.

Added with `Simulation.add_fault`. What each does, and when, goes over /faults (std_msgs/String), so that a recording shows
it; messages are recorded as they went out after all faults. Faults of one topic act in the order in which they were added.
Times are simulated seconds; a fault acts from `start` until before `end`.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import partial
from typing import TYPE_CHECKING, Any, Protocol, TypeVar

from ..bus.bus import Bus
from ..instant import NANOSECONDS
from ..parameters import motion_noise
from ..simulation.fault import Fault
from ..simulation.robots import SimulatedRobot
from ..simulation.simulation import Simulation

if TYPE_CHECKING:
    from ..simulation.robots import SimulatedRobot
    from ..simulation.simulation import Simulation


F = TypeVar("F", bound="Fault")


class Slip(Fault):
    """Wheels that slip: a robot moves by this share less than they turn, of which its odometry knows nothing.

    What several let pass at one time is multiplied.
    """

    def __init__(self, share: float, *, robot: str | None = None, **options: Any) -> None:
        super().__init__(**options)
        if not 0.0 <= share <= 1.0:
            raise ValueError(f"the share must be in 0..1, got {share}")
        self.share, self.robot = share, robot

    def _prepare(self, simulation: Simulation, bus: Bus) -> None:
        robot = simulation.named(self.robot)
        for time in (self.start, self.end):
            self._plan(bus, time, partial(self._slip, simulation, robot))

    def _slip(self, simulation: Simulation, robot: SimulatedRobot) -> None:
        shares = [fault.share for fault in _acting(simulation, Slip) if simulation.named(fault.robot) is robot]
        share = shares[0] if len(shares) == 1 else 1.0 - math.prod(1.0 - share for share in shares)
        robot.robot.slip(share)
        self._note(f"{robot.name or 'the robot'} slips by {share:g}")


class OdometryDrift(Fault):
    """Odometry that errs by the velocity motion model of Probabilistic Robotics, table 5.3, and says how far.

    alphas: alpha1 to alpha6. Instead of the parameter odometry_alphas; from the end on odometry is exact again, as seen from
    where the robot is by then. raises: ValueError when added, if another is to act on the robot at the same time.
    """

    def __init__(self, alphas: Sequence[float], *, robot: str | None = None, seed: int = 0, **options: Any) -> None:
        super().__init__(seed=seed, **options)
        if len(alphas) != 6:
            raise ValueError(f"alphas must be six numbers, got {len(alphas)}")
        self.noise, self.robot, self._seed = motion_noise(alphas), robot, seed

    def _prepare(self, simulation: Simulation, bus: Bus) -> None:
        robot = simulation.named(self.robot)
        for other in simulation.faults:
            same = isinstance(other, OdometryDrift) and simulation.named(other.robot) is robot
            if same and other.start < self.end and self.start < other.end:
                raise ValueError(
                    f"odometry can drift in one way at a time, and does from {other.start:g} s to {other.end:g} s already"
                )
        self._plan(bus, self.start, partial(self._drift, robot, drifts=True))
        self._plan(bus, self.end, partial(self._drift, robot, drifts=False))

    def _drift(self, robot: SimulatedRobot, *, drifts: bool) -> None:
        robot.robot.drift(self.noise if drifts else None, self._seed)
        self._note(f"odometry of {robot.name or 'the robot'} {'drifts' if drifts else 'is exact'}")


class ClockJump(Fault):
    """Clocks that jump by some seconds, either way: /clock, all stamps, and `get_clock()`. Robots move on evenly."""

    def __init__(self, seconds: float, *, at: float = 0.0) -> None:
        super().__init__(start=at)
        if not math.isfinite(seconds) or seconds == 0.0:
            raise ValueError(f"a jump must be finite and not 0 s, got {seconds}")
        self.seconds = seconds

    def _prepare(self, simulation: Simulation, bus: Bus) -> None:
        self._plan(bus, self.start, partial(self._jump, bus))

    def _jump(self, bus: Bus) -> None:
        bus.clock_offset_ns += round(self.seconds * NANOSECONDS)
        self._note(f"the clock jumps by {self.seconds:g} s")


class Startable(Protocol):
    """A node that can be stopped and started."""

    def start(self) -> None:
        """Go on."""

    def stop(self) -> None:
        """Do nothing more."""


class Outage(Fault):
    """A node that stops and comes back: "robot", which stands still meanwhile, "laser" or "map_server".

    Of several that overlap, the last to end brings it back.
    """

    def __init__(self, node: str, *, robot: str | None = None, start: float = 0.0, end: float = math.inf) -> None:
        super().__init__(start=start, end=end)
        if node not in ("robot", "laser", "map_server"):
            raise ValueError(f"the node must be robot, laser or map_server, got {node!r}")
        self.node, self.robot = node, robot

    def _prepare(self, simulation: Simulation, bus: Bus) -> None:
        robot = simulation.named(self.robot)
        nodes: dict[str, Startable] = {"robot": robot.robot, "laser": robot.laser, "map_server": simulation.map_server}
        self._node = nodes[self.node]
        self._plan(bus, self.start, self._stop)
        self._plan(bus, self.end, partial(self._come_back, simulation))

    def _stop(self) -> None:
        self._node.stop()
        self._note(f"{self.node} stops")

    def _come_back(self, simulation: Simulation) -> None:
        if any(fault._node is self._node for fault in _acting(simulation, Outage)):
            return
        self._node.start()
        self._note(f"{self.node} is back")


def _acting(simulation: Simulation, kind: type[F]) -> list[F]:
    """The faults of a kind that act now."""
    return [fault for fault in simulation.faults if isinstance(fault, kind) and fault.acts]
