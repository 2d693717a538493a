"""Motion: the trajectory of a robot under velocity commands, exact at any time."""

from __future__ import annotations

import math
from bisect import bisect_right
from dataclasses import dataclass, replace
from typing import TypeAlias, TypeVar

from .._core import Pose
from ..instant import NANOSECONDS

M = TypeVar("M", bound="Motion")

Velocity: TypeAlias = tuple[float, float, float]
"""Velocity (vx, vy, wz) in the robot's frame: forward and to the left [m/s], counter-clockwise [rad/s]."""

STANDING: Velocity = (0.0, 0.0, 0.0)

FOREVER = 2**62
"""End time of a command without a timeout [ns]."""


@dataclass(frozen=True, slots=True)
class Segment:
    """A part of a trajectory: constant velocity, then standing still.

    Attributes:
        start_ns: Start time [ns]. The segment ends where the next one starts.
        pose: Pose of the robot at the start, in the map frame.
        velocity: Velocity of the robot until `until_ns`.
        until_ns: Time from which the robot stands still [ns].

    """

    start_ns: int
    pose: Pose
    velocity: Velocity
    until_ns: int


@dataclass(frozen=True, slots=True)
class ContactEvent:
    """The start of a contact between a robot and a wall, an obstacle or another robot.

    Attributes:
        time: Simulated time [s].
        what: What the robot touched: `a wall`, `obstacle NAME` or `robot NAME`.
        point: Contact point (x, y) in the map frame [m].
        speed: Linear speed of the robot at that time [m/s].
        pose: Pose of the robot at that time, in the map frame.

    """

    time: float
    what: str
    point: tuple[float, float]
    speed: float
    pose: Pose


@dataclass(frozen=True, slots=True)
class SteppingSnapshot:
    """State that only a `ConstrainedMotion` has; see its attributes."""

    stepped_ns: int
    requested: Velocity
    requested_until_ns: int
    touched: str | None
    preview: Motion | None
    reached: Pose | None


@dataclass(frozen=True, slots=True)
class MotionSnapshot:
    """State of a `Motion` at one time, as returned by `Motion.save`. Poses and segments are shared; they are immutable."""

    map_from_own: Pose
    timeout: float
    start_ns: int
    start: Pose
    command: Velocity
    twist: Velocity
    until_ns: int
    slip: float
    wheels: Pose | None
    driven: float
    segments: tuple[Segment, ...]
    contacts: tuple[ContactEvent, ...]
    stepping: SteppingSnapshot | None


class Motion:
    """Executes velocity commands and integrates them exactly.

    The pose at any time is computed from the last change of velocity, so it does not depend on when it is read.
    Poses are in the motion's own frame, which is the robot's odometry frame. The pose of this frame in the map can change.
    When the wheels slip, they turn as commanded, but the robot moves less. `wheel_pose` is the pose without any slip.

    Args:
        time_ns: Start time [ns].
        timeout: Time for which a command is held [s]; 0 holds it until the next command.
        map_from_own: Pose of the motion's own frame in the map frame.
        start: First pose of the robot, in the motion's own frame.

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
        self.segments: list[Segment] = []
        self.contacts: list[ContactEvent] = []
        self._begin(time_ns, STANDING, time_ns)

    is_stepped = False
    """True if the world must advance this motion in time steps."""

    def step(self, time_ns: int) -> None:
        """Advances to a time [ns]."""

    def pose_for_others(self, time_ns: int) -> Pose:
        """Pose in the map frame that other robots can collide with during the time step that ends at a time [ns]."""
        return self.map_pose(time_ns)

    def pose(self, time_ns: int) -> Pose:
        """Pose of the robot in the motion's own frame."""
        return self._start.integrate(self._twist, self._moving(time_ns))

    def map_pose(self, time_ns: int) -> Pose:
        """Pose of the robot in the map frame, now."""
        return (self.map_from_own * self.pose(time_ns)).wrapped()

    def map_pose_at(self, time_ns: int) -> Pose:
        """Pose of the robot in the map frame, at a time in the past."""
        index = bisect_right(self.segments, time_ns, key=lambda segment: segment.start_ns)
        segment = self.segments[max(0, index - 1)]
        moving = max(0, min(time_ns, segment.until_ns) - segment.start_ns) / NANOSECONDS
        return segment.pose.integrate(segment.velocity, moving).wrapped()

    def trajectory(self, time_ns: int) -> list[Segment]:
        """Trajectory from the start up to a time, at most the present."""
        return self.segments

    def contacts_until(self, time_ns: int) -> list[ContactEvent]:
        """Contacts from the start up to a time, at most the present."""
        return self.contacts

    def wheel_pose(self, time_ns: int) -> Pose:
        """Pose that the robot would have if its wheels had never slipped, in the motion's own frame."""
        if self._wheels is None:
            return self.pose(time_ns)
        return self._wheels.integrate(self._command, self._moving(time_ns))

    @property
    def slipped(self) -> bool:
        """True if the wheels have ever slipped."""
        return self._wheels is not None

    def velocity(self, time_ns: int) -> Velocity:
        """Velocity of the robot."""
        return self._twist if time_ns < self._until_ns else STANDING

    def wheel_velocity(self, time_ns: int) -> Velocity:
        """Velocity that the robot would have if its wheels did not slip."""
        return self._command if time_ns < self._until_ns else STANDING

    def distance(self, time_ns: int) -> float:
        """Length of the trajectory up to a time [m]."""
        return self._driven + math.hypot(self._twist[0], self._twist[1]) * self._moving(time_ns)

    def command(self, velocity: Velocity, time_ns: int) -> None:
        """Sets the velocity from now on."""
        if velocity == self._command and time_ns < self._until_ns:
            self._until_ns = self._end_of_command(time_ns)
            self.segments[-1] = replace(self.segments[-1], until_ns=self._until_ns)
        else:
            self._begin(time_ns, velocity, self._end_of_command(time_ns))

    def set_timeout(self, timeout: float, time_ns: int) -> None:
        """Changes the timeout [s]. A command in force is held for the new timeout, counted from now."""
        self.timeout = timeout
        velocity = self.wheel_velocity(time_ns)
        if velocity != STANDING:
            self.command(velocity, time_ns)

    def stop(self, time_ns: int) -> None:
        """Stops the robot and drops the command."""
        self._begin(time_ns, STANDING, time_ns)

    def place(self, pose: Pose, time_ns: int) -> None:
        """Moves the robot to a pose in the motion's own frame and sets `wheel_pose` to it. A command in force continues."""
        self._begin(time_ns, self._command, self._until_ns, pose=pose)
        if self._wheels is not None:
            self._wheels = pose

    def move_frame(self, map_from_own: Pose, time_ns: int) -> None:
        """Changes the pose of the motion's own frame in the map. The robot keeps its pose in this frame."""
        self.map_from_own = map_from_own
        self._begin(time_ns, self._command, self._until_ns)

    def slip(self, share: float, time_ns: int) -> None:
        """Sets the slip from now on.

        Args:
            share: Slip, 0 to 1: the robot moves at (1 - share) times the velocity of its wheels.
            time_ns: The present [ns].

        """
        self._begin(time_ns, self._command, self._until_ns)
        if self._wheels is None:
            self._wheels = self._start
        self._slip = share
        self.segments.pop()
        self._begin(time_ns, self._command, self._until_ns)

    def continuing(self: M, before: Motion) -> M:
        """Prepends trajectory, contacts and distance of an earlier motion, takes over its slip, and returns this motion."""
        self.segments[:0], self.contacts[:0] = before.segments, before.contacts
        self._driven = before.distance(self._start_ns)
        self._slip, self._wheels = before._slip, before._wheels and before.wheel_pose(self._start_ns)
        return self

    def save(self) -> MotionSnapshot:
        """Returns a snapshot for `restore`."""
        return MotionSnapshot(
            self.map_from_own,
            self.timeout,
            self._start_ns,
            self._start,
            self._command,
            self._twist,
            self._until_ns,
            self._slip,
            self._wheels,
            self._driven,
            tuple(self.segments),
            tuple(self.contacts),
            self._save_stepping(),
        )

    def restore(self, state: MotionSnapshot) -> None:
        """Returns to the state of a snapshot."""
        self.map_from_own, self.timeout = state.map_from_own, state.timeout
        self._start_ns, self._start = state.start_ns, state.start
        self._command, self._twist, self._until_ns = state.command, state.twist, state.until_ns
        self._slip, self._wheels, self._driven = state.slip, state.wheels, state.driven
        self.segments, self.contacts = list(state.segments), list(state.contacts)

    def _save_stepping(self) -> SteppingSnapshot | None:
        return None

    def _begin(self, time_ns: int, command: Velocity, until_ns: int, *, pose: Pose | None = None) -> None:
        """Begins a segment at `pose` in the motion's own frame. Default: the pose of the robot."""
        driven, wheels = self.distance(time_ns), self._wheels and self.wheel_pose(time_ns)
        start = (self.pose(time_ns) if pose is None else pose).wrapped()
        self._command, self._twist = command, self._with_slip(command)
        self._driven, self._wheels, self._start = driven, wheels, start
        self._start_ns, self._until_ns = time_ns, max(time_ns, until_ns)
        self.segments.append(Segment(time_ns, (self.map_from_own * start).wrapped(), self._twist, self._until_ns))

    def _with_slip(self, command: Velocity) -> Velocity:
        """Velocity of the robot when its wheels turn at the commanded velocity."""
        grip = 1.0 - self._slip
        return command if grip == 1.0 else (command[0] * grip, command[1] * grip, command[2] * grip)

    def _end_of_command(self, time_ns: int) -> int:
        return time_ns + round(min(self.timeout * NANOSECONDS, FOREVER)) if self.timeout else FOREVER

    def _moving(self, time_ns: int) -> float:
        """Time for which the robot has moved in the current segment [s]."""
        return max(0, min(time_ns, self._until_ns) - self._start_ns) / NANOSECONDS
