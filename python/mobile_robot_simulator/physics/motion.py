"""Motion: the trajectory of a robot under velocity commands, exact at any time."""

from __future__ import annotations

import math
from bisect import bisect_right
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from .._core import Drive, Limits, Pose
from ..instant import NANOSECONDS
from .drive_profile import DriveProfile, Steering
from .push import Push, displaced, turned, with_push
from .velocity_profile import FOREVER, STANDING, Velocity, VelocityProfile, scaled
from .wheel_course import WheelCourse

M = TypeVar("M", bound="Motion")

MAX_SEGMENTS = 20_000
"""Number of segments of a trajectory from which on its older half is thinned. They take 6 to 7 MB."""

MAX_CONTACTS = 10_000
"""Number of contacts from which on the oldest ones are dropped."""

SAME_PLACE = 1e-6
"""Distance [m] up to which a segment counts as the continuation of the one before; see `_distance`."""

LEVER = 0.3
"""Distance [m] that turns a difference in heading [rad] into a distance: about the radius of a robot."""


@dataclass(slots=True)
class Segment:
    """A part of a trajectory, in which the robot follows one velocity profile.

    Segments never change, since trajectories share them. The class is not `frozen`, because such an object takes three times
    as long to make, and each command makes one.

    Attributes:
        start_ns: Start time [ns]. The segment ends where the next one starts.
        pose: Pose of the robot at the start, in the map frame.
        profile: Velocity of the wheels from the start on.
        grip: Share of the motion of the wheels that the robot makes; 1 without slip.
        push: Push that acts from the start on, None without.

    """

    start_ns: int
    pose: Pose
    profile: VelocityProfile
    grip: float
    push: Push | None = None

    def pose_at(self, time_ns: float) -> Pose:
        """Pose of the robot in the map frame, at a time [ns] in the segment."""
        pose = self.profile.move(self.pose, time_ns, self.grip)
        if self.push is not None:
            pose = displaced(pose, self.push, _seconds_between(self.start_ns, time_ns))
        return pose.wrapped()

    def velocity_at(self, time_ns: int) -> Velocity:
        """Velocity of the robot in its own frame, at a time [ns] in the segment."""
        velocity = scaled(self.profile.velocity_at(time_ns), self.grip)
        return velocity if self.push is None else with_push(velocity, self.push, self.pose_at(time_ns).yaw)

    def trace(self, times_ns: NDArray[np.int64]) -> NDArray[np.float64]:
        """Poses at several times in the segment, (N, 3): those of `pose_at`, with yaws that are not wrapped."""
        poses = self.profile.trace(self.pose, times_ns, self.grip)
        if self.push is not None:
            seconds = np.maximum(times_ns - self.start_ns, 0) / NANOSECONDS
            poses[:, :2] += seconds[:, None] * np.array(self.push)
        return poses


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
    is_blocked: bool
    touched: str | None
    reached: Pose | None


@dataclass(frozen=True, slots=True)
class MotionSnapshot:
    """State of a `Motion` at one time, as returned by `Motion.save`. Poses and segments are shared; they are immutable."""

    map_from_own: Pose
    timeout: float
    start: Pose
    profile: VelocityProfile
    grip: float
    push: Push | None
    acting_push: Push | None
    wheels: Pose | None
    driven: float
    segments: tuple[Segment, ...]
    contacts: tuple[ContactEvent, ...]
    steering: Steering | None
    rolled: NDArray[np.float64] | None
    stepping: SteppingSnapshot | None


def thinned(segments: list[Segment]) -> list[Segment]:
    """Returns a trajectory with an eighth fewer segments, all taken from its older half.

    A segment of constant velocity replaces two neighbours. The poses at its ends stay exact. Pairs are chosen where this
    changes the path least, so a part that was thinned often is not thinned again while others lose less. Where the robot was
    moved to another pose, nothing is replaced. If too few pairs could be replaced, the oldest eighth is dropped.
    """
    half, eighth = len(segments) // 2, len(segments) // 8
    old = segments[: half + 2]
    continues = [_continues(before, after) for before, after in pairwise(old)]
    mergeable = [index for index in range(half) if continues[index] and continues[index + 1]]
    deviation = {index: _deviation_of_merged(*old[index : index + 3]) for index in mergeable}
    chosen: set[int] = set()
    for index in sorted(mergeable, key=deviation.__getitem__):
        if len(chosen) == eighth:
            break
        if index - 1 not in chosen and index + 1 not in chosen:
            chosen.add(index)
    kept = [
        _merged(segment, segments[index + 2]) if index in chosen else segment
        for index, segment in enumerate(segments)
        if index - 1 not in chosen
    ]
    return kept if len(chosen) == eighth else kept[eighth:]


def _seconds_between(start_ns: float, time_ns: float) -> float:
    """Returns the time from a start to a time [s]; 0 if it is before the start."""
    return max(0, time_ns - start_ns) / NANOSECONDS


def _merged(first: Segment, after: Segment) -> Segment:
    """Returns the segment of constant velocity from the start of a segment to the start of a later one."""
    velocity = first.pose.twist_to(after.pose, (after.start_ns - first.start_ns) / NANOSECONDS)
    return Segment(first.start_ns, first.pose, VelocityProfile(first.start_ns, velocity, velocity, after.start_ns), 1.0)


def _deviation_of_merged(first: Segment, middle: Segment, after: Segment) -> float:
    """Returns how far the robot is from its trajectory if `first` and `middle` are merged [m].

    It is the largest distance at the start of `middle` and half-way before and after it.
    """
    merged = _merged(first, after)
    before_ns, after_ns = (first.start_ns + middle.start_ns) // 2, (middle.start_ns + after.start_ns) // 2
    return max(
        _distance(merged.pose_at(before_ns), first.pose_at(before_ns)),
        _distance(merged.pose_at(middle.start_ns), middle.pose),
        _distance(merged.pose_at(after_ns), middle.pose_at(after_ns)),
    )


def _continues(before: Segment, after: Segment) -> bool:
    """Returns True if a segment begins where the one before it ends."""
    return before.start_ns < after.start_ns and _distance(before.pose_at(after.start_ns), after.pose) < SAME_PLACE


def _distance(pose: Pose, other: Pose) -> float:
    """Returns how far a point of the robot at `LEVER` from its origin moves between two poses, at most [m]."""
    x, y, turn = pose.twist_to(other, 1.0)
    return math.hypot(x, y) + LEVER * abs(turn)


class Motion:
    """Executes velocity commands, under limits if there are any, and integrates them exactly.

    The pose at any time is computed from the last change of velocity, so it does not depend on when it is read.
    Poses are in the motion's own frame, which is the robot's odometry frame. The pose of this frame in the map can change.
    When the wheels slip, they turn as commanded, but the robot moves less. A push moves the robot, but not its wheels.
    `wheel_pose` is the pose without any slip or push.
    With a drive, the robot follows commands as far as its wheels can.

    Args:
        time_ns: Start time [ns].
        timeout: Time for which a command is held [s]; 0 holds it until the next command.
        map_from_own: Pose of the motion's own frame in the map frame.
        start: First pose of the robot, in the motion's own frame.
        limits: Limits on the velocity of the wheels and its change; None for no limits.
        drive: The wheels; None for a robot that moves in any direction.

    """

    def __init__(
        self,
        time_ns: int,
        timeout: float,
        map_from_own: Pose,
        start: Pose,
        limits: Limits | None = None,
        drive: Drive | None = None,
    ) -> None:
        self.map_from_own = map_from_own
        self.timeout = timeout
        self._read_ns: int | None = None
        """Time of the last call of `pose`; None if a segment has begun since."""
        self._read_pose, self._read_profile = start, VelocityProfile(time_ns, STANDING, STANDING, time_ns)
        """Result of that call, and the profile at that time."""
        self._read_map_pose: Pose | None = None
        """The same pose in the map frame, None until it is needed."""
        self._limits = limits
        self._steering = None if drive is None else Steering(drive, time_ns)
        self._rolled = None if drive is None else np.zeros(drive.wheel_count)
        """Angle by which each wheel has turned before the current segment [rad]."""
        self._start = start
        self._profile = self._profile_of(time_ns, STANDING, STANDING, time_ns)
        self._grip = 1.0
        """Share of the motion of the wheels that the robot makes."""
        self._push: Push | None = None
        """The push that was set last."""
        self._acting_push: Push | None = None
        """The push of the current segment, in the motion's own frame; contact can hinder the one that was set."""
        self._wheels: Pose | None = None
        self._driven = 0.0
        self.segments: list[Segment] = []
        self.contacts: list[ContactEvent] = []
        self._begin(self._profile)

    is_stepped = False
    """True if the world must advance this motion in time steps."""

    is_blocked = False
    """True if contact keeps the robot from following its command."""

    def step(self, time_ns: int) -> None:
        """Advances to a time [ns]."""

    def skip(self, time_ns: int) -> bool:
        """Advances to a time [ns] if nothing can happen before. Returns False if the motion must be stepped there."""
        return False

    def skip_to(self, time_ns: int) -> None:
        """Advances to a time [ns] as `step` would, if it is known that the robot touches nothing before."""

    def top_speed(self, command: Velocity = STANDING) -> float:
        """Returns a speed [m/s] that the robot does not exceed under its commands and another one; infinity if unknown."""
        return math.inf

    def stays_clear(self, speed: float, seconds: float) -> bool:
        """Returns True if a quick look shows that the robot would touch nothing for some time, whatever it does.

        Args:
            speed: Speed that it does not exceed [m/s].
            seconds: The time [s].
        """
        return False

    def pose_for_others(self, time_ns: int) -> Pose:
        """Pose in the map frame that other robots can collide with during the time step that ends at a time [ns]."""
        return self.map_pose(time_ns)

    def pose(self, time_ns: int) -> Pose:
        """Pose of the robot in the motion's own frame."""
        # Odometry, scanner and driver often read the same pose.
        profile = self._profile
        if self._read_ns != time_ns or self._read_profile is not profile:
            pose = profile.move(self._start, time_ns, self._grip)
            if self._acting_push is not None:
                pose = displaced(pose, self._acting_push, _seconds_between(profile.start_ns, time_ns))
            self._read_pose, self._read_map_pose = pose, None
            self._read_ns, self._read_profile = time_ns, profile
        return self._read_pose

    def map_pose(self, time_ns: int) -> Pose:
        """Pose of the robot in the map frame, now."""
        if self._read_map_pose is None or self._read_ns != time_ns or self._read_profile is not self._profile:
            pose = (self.map_from_own * self.pose(time_ns)).wrapped()
            if self._read_ns != time_ns:
                return pose
            self._read_map_pose = pose
        return self._read_map_pose

    def map_pose_at(self, time_ns: int) -> Pose:
        """Pose of the robot in the map frame, at a time in the past."""
        index = bisect_right(self.segments, time_ns, key=lambda segment: segment.start_ns)
        return self.segments[max(0, index - 1)].pose_at(time_ns)

    def map_poses_at(self, times_ns: NDArray[np.int64]) -> NDArray[np.float64]:
        """Poses of the robot in the map frame at past times: those of `map_pose_at`, with yaws that are not wrapped.

        Args:
            times_ns: (N,) int64, increasing times [ns]; at least one.

        Returns:
            (N, 3) float64, rows (x, y, yaw) [m, m, rad].
        """
        return np.concatenate([segment.trace(times) for segment, times in self._parts(times_ns)])

    def velocities_at(self, times_ns: NDArray[np.int64]) -> NDArray[np.float64]:
        """Velocities of the robot at past times. Where the velocity jumps, it is the one after the jump.

        Args:
            times_ns: (N,) int64, increasing times [ns]; at least one.

        Returns:
            (N, 3) float64, rows (vx, vy, wz) in the robot's frame [m/s, m/s, rad/s].
        """
        return np.array(
            [segment.velocity_at(time_ns) for segment, times in self._parts(times_ns) for time_ns in times.tolist()]
        )

    def _parts(self, times_ns: NDArray[np.int64]) -> list[tuple[Segment, NDArray[np.int64]]]:
        """Returns the segments that contain the times, each with its times [ns]."""
        segments = self.trajectory(int(times_ns[-1]))
        first = max(0, bisect_right(segments, times_ns[0], key=lambda segment: segment.start_ns) - 1)
        last = bisect_right(segments, times_ns[-1], key=lambda segment: segment.start_ns)
        segments = segments[first : max(last, first + 1)]
        ends = np.searchsorted(times_ns, [segment.start_ns for segment in segments[1:]])
        return list(zip(segments, np.split(times_ns, ends), strict=True))

    def trajectory(self, time_ns: int) -> list[Segment]:
        """Trajectory from the start up to a time, at most the present."""
        return self.segments

    def contacts_until(self, time_ns: int) -> list[ContactEvent]:
        """Contacts from the start up to a time, at most the present."""
        return self.contacts

    def wheel_pose(self, time_ns: int) -> Pose:
        """Pose that the robot would have without any slip or push, in the motion's own frame."""
        if self._wheels is None:
            return self.pose(time_ns)
        return self._profile.move(self._wheels, time_ns)

    def wheel_course(self, time_ns: int) -> WheelCourse:
        """Where the wheels are at a time, as `wheel_pose` and `wheel_velocity` tell, to be computed when it is needed."""
        return WheelCourse(self._profile, self._start if self._wheels is None else self._wheels, time_ns)

    @property
    def slipped(self) -> bool:
        """True if the wheels have ever slipped, or the robot was ever pushed."""
        return self._wheels is not None

    def velocity(self, time_ns: int) -> Velocity:
        """Velocity of the robot."""
        velocity = scaled(self._profile.velocity_at(time_ns), self._grip)
        return velocity if self._acting_push is None else with_push(velocity, self._acting_push, self.pose(time_ns).yaw)

    def wheel_velocity(self, time_ns: int) -> Velocity:
        """Velocity that the robot would have without slip or push."""
        return self._profile.velocity_at(time_ns)

    def ramp_velocity(self, time_ns: int) -> Velocity:
        """Velocity of the wheels from which another profile goes on; see `VelocityProfile.ramp_velocity_at`."""
        return self._profile.ramp_velocity_at(time_ns)

    def steering_at(self, time_ns: int) -> float:
        """Steering angle since the last command [rad]; 0 for a robot that does not steer."""
        return 0.0 if self._steering is None else self._steering.at(time_ns)

    def rolled(self, time_ns: int) -> NDArray[np.float64]:
        """Angle by which each wheel has turned since the start [rad], (wheel_count,). The motion must have a drive."""
        profile, steering = self._profile, self._steering
        assert self._rolled is not None and steering is not None
        since = profile.rolled(time_ns, steering.drive, steering.at(profile.start_ns))
        rolled: NDArray[np.float64] = self._rolled + since
        return rolled

    def joints(self, time_ns: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Positions [rad] and velocities [rad/s] of the wheels, then those of the left and right steering, if it steers.

        The motion must have a drive.
        """
        assert self._steering is not None
        drive, angle, rate = self._steering.drive, self._steering.at(time_ns), self._steering.rate_at(time_ns)
        positions, rates = self.rolled(time_ns), drive.wheels_of_twist([self.wheel_velocity(time_ns)], [angle])[0]
        if drive.kind != "ackermann":
            return positions, rates
        steered, steering = drive.steering_angles([angle])[0], drive.steering_angle_rates([angle], [rate])[0]
        return np.concatenate([positions, steered]), np.concatenate([rates, steering])

    def distance(self, time_ns: int) -> float:
        """Length of the path driven up to a time, without what pushes add [m]."""
        return self._driven + self._profile.distance(time_ns) * self._grip

    @property
    def request(self) -> tuple[Velocity, int]:
        """The last command: its velocity, and the time at which it ends [ns]."""
        return self._profile.command, self._profile.until_ns

    def command(self, velocity: Velocity, time_ns: int) -> None:
        """Sets the commanded velocity from now on. A robot with a drive does of it what `Drive.command` says."""
        if self._steering is not None:
            self.step(time_ns)
            velocity, goal = self._steering.drive.command(velocity, self._steering.goal)
            self._steer(goal, math.inf, time_ns)
        self._follow(velocity, time_ns)

    def command_steering(self, speed: float, angle: float, rate: float, time_ns: int) -> None:
        """Sets the commanded speed [m/s] and steering angle [rad] of an Ackermann drive from now on.

        Args:
            speed: Speed forward [m/s].
            angle: Steering angle to aim at [rad].
            rate: Largest rate of change of the steering angle [rad/s], beside that of the drive.
            time_ns: The present [ns].

        """
        self.step(time_ns)
        self._steer(angle, rate, time_ns)
        self._follow((speed, 0.0, 0.0), time_ns)

    def _steer(self, goal: float, rate: float, time_ns: int) -> None:
        """Begins to steer to a goal, unless this is what the robot does."""
        now = self._steering
        assert now is not None
        if (goal, rate) != (now.goal, now.rate):
            self._steering = Steering(now.drive, time_ns, now.at(time_ns), goal, rate)

    def _follow(self, velocity: Velocity, time_ns: int) -> None:
        """Sets the velocity that the wheels are commanded to have from now on."""
        until_ns, profile = self._end_of_command(time_ns), self._profile
        steers_as_before = not isinstance(profile, DriveProfile) or profile.steering is self._steering
        if velocity == profile.command and time_ns < profile.until_ns and steers_as_before:
            self._profile, last = profile.held_until(until_ns), self.segments[-1]
            self.segments[-1] = Segment(last.start_ns, last.pose, self._profile, last.grip, last.push)
        else:
            self._begin(self._following(velocity, time_ns, until_ns))

    def set_timeout(self, timeout: float, time_ns: int) -> None:
        """Changes the timeout [s]. A command in force is held for the new timeout, counted from now."""
        self.timeout = timeout
        velocity, until_ns = self.request
        if time_ns < until_ns and velocity != STANDING:
            self._follow(velocity, time_ns)

    def stop(self, time_ns: int) -> None:
        """Stops the robot at once, regardless of the limits, and drops the command."""
        self._begin(self._profile_of(time_ns, STANDING, STANDING, time_ns))

    def move_frame(self, map_from_own: Pose, time_ns: int) -> None:
        """Changes the pose of the motion's own frame in the map. The robot keeps its pose in this frame.

        A command in force continues.
        """
        self.map_from_own = map_from_own
        self._begin(self._continued(time_ns))

    def slip(self, share: float, time_ns: int) -> None:
        """Sets the slip from now on.

        Args:
            share: Slip, 0 to 1: the robot moves at (1 - share) times the velocity of its wheels.
            time_ns: The present [ns].

        """
        self._begin(self._continued(time_ns))
        if self._wheels is None:
            self._wheels = self._start
        self._grip = 1.0 - share
        self._begin(self._profile)

    def push(self, push: Push | None, time_ns: int) -> None:
        """Sets the push from now on.

        Args:
            push: Velocity that is added to that of the robot; None ends the push.
            time_ns: The present [ns].

        """
        self._begin(self._continued(time_ns))
        if self._wheels is None:
            self._wheels = self._start
        self._push = push
        self._begin(self._profile)

    def continuing(self: M, before: Motion) -> M:
        """Takes over trajectory, contacts, distance, slip, push and command of an earlier motion, and returns this motion.

        With another kind of drive, the robot stands still until the next command.
        """
        now_ns = self._profile.start_ns
        self.segments[:0], self.contacts[:0] = before.segments, before.contacts
        self._driven = before.distance(now_ns)
        self._grip, self._push = before._grip, before._push
        self._wheels = before._wheels and before.wheel_pose(now_ns)
        if self._kind != before._kind:
            self._begin(self._profile_of(now_ns, STANDING, STANDING, now_ns))
            return self
        if self._steering is not None and before._steering is not None:
            old = before._steering
            self._steering = replace(self._steering, angle=old.at(now_ns), goal=old.goal, rate=old.rate)
            self._rolled = before.rolled(now_ns)
        command, until_ns = before.request
        self._begin(self._profile_of(now_ns, before.ramp_velocity(now_ns), command, max(now_ns, until_ns)))
        return self

    @property
    def _kind(self) -> str:
        """Kind of the drive. Commands of one kind mean nothing to another one."""
        return "planar" if self._steering is None else self._steering.drive.kind

    def save(self) -> MotionSnapshot:
        """Returns a snapshot for `restore`."""
        return MotionSnapshot(
            self.map_from_own,
            self.timeout,
            self._start,
            self._profile,
            self._grip,
            self._push,
            self._acting_push,
            self._wheels,
            self._driven,
            tuple(self.segments),
            tuple(self.contacts),
            self._steering,
            self._rolled,
            self._save_stepping(),
        )

    def restore(self, state: MotionSnapshot) -> None:
        """Returns to the state of a snapshot."""
        self.map_from_own, self.timeout = state.map_from_own, state.timeout
        self._start, self._profile = state.start, state.profile
        self._grip, self._wheels, self._driven, self._read_ns = state.grip, state.wheels, state.driven, None
        self._push, self._acting_push = state.push, state.acting_push
        self.segments, self.contacts = list(state.segments), list(state.contacts)
        self._steering, self._rolled = state.steering, state.rolled

    def _save_stepping(self) -> SteppingSnapshot | None:
        return None

    def _begin(self, profile: VelocityProfile, *, pose: Pose | None = None) -> None:
        """Begins a segment at `pose` in the motion's own frame. Default: the pose of the robot."""
        self._begin_pushed(profile, self._push, pose)

    def _begin_pushed(self, profile: VelocityProfile, push: Push | None, pose: Pose | None) -> None:
        """Begins a segment at `pose` in the motion's own frame with a push, in the map frame."""
        time_ns = profile.start_ns
        driven, wheels = self.distance(time_ns), self._wheels and self.wheel_pose(time_ns)
        if self._rolled is not None:
            self._rolled = self.rolled(time_ns)
        start = (self.pose(time_ns) if pose is None else pose).wrapped()
        self._profile, self._driven, self._wheels, self._start, self._read_ns = profile, driven, wheels, start, None
        self._acting_push = None if push is None else self._in_own_frame(push)
        segment = Segment(time_ns, (self.map_from_own * start).wrapped(), profile, self._grip, push)
        if self.segments and (self.segments[-1].start_ns, self.segments[-1].pose) == (time_ns, segment.pose):
            # Nothing has happened in the last segment.
            self.segments.pop()
        self.segments.append(segment)
        if len(self.segments) > MAX_SEGMENTS:
            self.segments = thinned(self.segments)

    def _in_own_frame(self, push: Push) -> Push:
        return turned(push, -self.map_from_own.yaw)

    def _following(self, command: Velocity, time_ns: int, until_ns: int) -> VelocityProfile:
        """Profile of a robot that follows a command from now on."""
        return self._profile_of(time_ns, self.ramp_velocity(time_ns), command, max(time_ns, until_ns))

    def _profile_of(self, start_ns: int, velocity: Velocity, command: Velocity, until_ns: int) -> VelocityProfile:
        """Profile under the limits of the robot and its wheels."""
        if self._steering is None:
            return VelocityProfile(start_ns, velocity, command, until_ns, self._limits)
        return DriveProfile(start_ns, velocity, command, until_ns, self._limits, steering=self._steering)

    def _continued(self, time_ns: int) -> VelocityProfile:
        """Profile that goes on like the current one, from now on."""
        velocity = self.ramp_velocity(time_ns)
        return replace(self._profile, start_ns=time_ns, velocity=velocity, until_ns=max(time_ns, self._profile.until_ns))

    def _end_of_command(self, time_ns: int) -> int:
        held_ns = self.timeout * NANOSECONDS
        return time_ns + (round(held_ns) if held_ns < FOREVER else FOREVER) if held_ns else FOREVER
