"""Motion: the way of a robot under velocity commands, exact at any time."""

from __future__ import annotations

import math
from bisect import bisect_right
from dataclasses import dataclass, replace
from typing import Any, TypeVar

from .._core import Pose
from ..instant import NANOSECONDS

M = TypeVar("M", bound="Motion")

Velocity = tuple[float, float, float]
STANDING: Velocity = (0.0, 0.0, 0.0)


FOREVER = 2**62
"""The time at which what holds for ever ends [ns]."""


@dataclass(frozen=True, slots=True)
class Piece:
    """A part of the way: from a time on, from a pose in the map, under one velocity, and standing from `until_ns` on."""

    start_ns: int
    pose: Pose
    velocity: Velocity
    until_ns: int


@dataclass(frozen=True, slots=True)
class ContactEvent:
    """A contact begun: when [s], with what, where in the map [m], how fast [m/s], and where the robot was then."""

    time: float
    what: str
    point: tuple[float, float]
    speed: float
    pose: Pose


class Motion:
    """Commands, each held until the next or for `timeout` seconds (0: for ever), integrated exactly.

    The pose at any time is computed from the last change of velocity on, so that it does not depend on when it is asked for.
    Poses are in a frame of the motion's own, whose pose in the map can be changed.
    Wheels that slip turn as told while the robot moves by less: `wheels` is where the robot would be had they not.
    """

    def __init__(self, time_ns: int, timeout: float, map_from_own: Pose, start: Pose) -> None:
        self.map_from_own = map_from_own
        self.timeout = timeout
        self._start_ns, self._start = time_ns, start
        self._command = self._twist = STANDING
        self._until_ns = time_ns
        self._slip = 0.0
        self._wheels: Pose | None = None
        self._driven = 0.0
        self.pieces: list[Piece] = []
        self.contacts: list[ContactEvent] = []
        self._begin(time_ns, STANDING, time_ns)

    steps = False
    """Whether the way must be gone step by step."""

    def step(self, time_ns: int) -> None:
        """Go on to a time."""

    def standing_pose(self, time_ns: int) -> Pose:
        """Where the robot is in the map while others take the step to a time."""
        return self.map_pose(time_ns)

    def pose(self, time_ns: int) -> Pose:
        """Where the robot is, in the motion's own frame."""
        return self._start.integrate(self._twist, self._moving(time_ns))

    def map_pose(self, time_ns: int) -> Pose:
        """Where the robot is, in the map."""
        return (self.map_from_own * self.pose(time_ns)).wrapped()

    def map_pose_at(self, time_ns: int) -> Pose:
        """Where the robot was in the map at a time past."""
        index = bisect_right(self.pieces, time_ns, key=lambda piece: piece.start_ns)
        piece = self.pieces[max(0, index - 1)]
        moving = max(0, min(time_ns, piece.until_ns) - piece.start_ns) / NANOSECONDS
        return piece.pose.integrate(piece.velocity, moving).wrapped()

    def way(self, time_ns: int) -> list[Piece]:
        """The way up to a time that has come."""
        return self.pieces

    def met(self, time_ns: int) -> list[ContactEvent]:
        """The contacts up to a time that has come."""
        return self.contacts

    def wheels(self, time_ns: int) -> Pose:
        """Where the robot would be had its wheels never slipped, in the motion's own frame."""
        if self._wheels is None:
            return self.pose(time_ns)
        return self._wheels.integrate(self._command, self._moving(time_ns))

    @property
    def slipped(self) -> bool:
        """Whether the wheels ever slipped."""
        return self._wheels is not None

    def velocity(self, time_ns: int) -> Velocity:
        """How the robot moves: forward, leftward [m/s] and turning [rad/s]."""
        return self._twist if time_ns < self._until_ns else STANDING

    def wheel_velocity(self, time_ns: int) -> Velocity:
        """How the robot would move did its wheels not slip."""
        return self._command if time_ns < self._until_ns else STANDING

    def distance(self, time_ns: int) -> float:
        """Length of the way so far [m]."""
        return self._driven + math.hypot(self._twist[0], self._twist[1]) * self._moving(time_ns)

    def command(self, velocity: Velocity, time_ns: int) -> None:
        """Move at a velocity from now on."""
        if velocity == self._command and time_ns < self._until_ns:
            self._until_ns = self._end_of_command(time_ns)
            self.pieces[-1] = replace(self.pieces[-1], until_ns=self._until_ns)
        else:
            self._begin(time_ns, velocity, self._end_of_command(time_ns))

    def hold_anew(self, timeout: float, time_ns: int) -> None:
        """Hold commands so long from now on, the one in force too, as if it came now."""
        self.timeout = timeout
        velocity = self.wheel_velocity(time_ns)
        if velocity != STANDING:
            self.command(velocity, time_ns)

    def stand(self, time_ns: int) -> None:
        """Move no more."""
        self._begin(time_ns, STANDING, time_ns)

    def place(self, pose: Pose, time_ns: int) -> None:
        """Be at a pose of the motion's own frame, the wheels too, and go on from there as before."""
        self._begin(time_ns, self._command, self._until_ns, pose=pose)
        if self._wheels is not None:
            self._wheels = pose

    def move_frame(self, map_from_own: Pose, time_ns: int) -> None:
        """Have the motion's own frame elsewhere in the map, and the robot with it."""
        self.map_from_own = map_from_own
        self._begin(time_ns, self._command, self._until_ns)

    def slip(self, share: float, time_ns: int) -> None:
        """From now on, move by this share less than the wheels turn."""
        self._begin(time_ns, self._command, self._until_ns)
        if self._wheels is None:
            self._wheels = self._start
        self._slip = share
        self.pieces.pop()
        self._begin(time_ns, self._command, self._until_ns)

    def after(self: M, before: Motion) -> M:
        """The same, as the rest of a way that began before."""
        self.pieces[:0], self.contacts[:0] = before.pieces, before.contacts
        self._driven = before.distance(self._start_ns)
        self._slip, self._wheels = before._slip, before._wheels and before.wheels(self._start_ns)
        return self

    def save(self) -> Any:
        """All that `restore` needs."""
        return {**vars(self), "pieces": tuple(self.pieces), "contacts": tuple(self.contacts)}

    def restore(self, state: Any) -> None:
        """Be as when the state was saved."""
        vars(self).update(state)
        self.pieces, self.contacts = list(state["pieces"]), list(state["contacts"])

    def _begin(self, time_ns: int, command: Velocity, until_ns: int, *, pose: Pose | None = None) -> None:
        """Begin another piece of the way, at a pose if not where the robot is."""
        driven, wheels = self.distance(time_ns), self._wheels and self.wheels(time_ns)
        start = (self.pose(time_ns) if pose is None else pose).wrapped()
        vx, vy, wz = command
        rest = 1.0 - self._slip
        self._command, self._twist = command, command if rest == 1.0 else (vx * rest, vy * rest, wz * rest)
        self._driven, self._wheels, self._start = driven, wheels, start
        self._start_ns, self._until_ns = time_ns, max(time_ns, until_ns)
        self.pieces.append(Piece(time_ns, (self.map_from_own * start).wrapped(), self._twist, self._until_ns))

    def _end_of_command(self, time_ns: int) -> int:
        return time_ns + round(min(self.timeout * NANOSECONDS, FOREVER)) if self.timeout else FOREVER

    def _moving(self, time_ns: int) -> float:
        """Seconds that the robot has moved since the piece began."""
        return max(0, min(time_ns, self._until_ns) - self._start_ns) / NANOSECONDS
