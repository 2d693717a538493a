"""ConstrainedMotion: the trajectory of a robot that touches things, computed in time steps."""

from __future__ import annotations

import copy
import math
from typing import Literal, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from .._core import Contact, Drive, Limits, Obstacles, OccupancyGrid, Pose, Shape, advance, stays_clear
from ..instant import NANOSECONDS
from .motion import MAX_CONTACTS, ContactEvent, Motion, MotionSnapshot, Segment, SteppingSnapshot
from .push import Push, displaced, with_push
from .velocity_profile import FOREVER, STANDING, Velocity, VelocityProfile, scaled
from .wheel_course import WheelCourse
from .world import Body, World

C = TypeVar("C", bound="ConstrainedMotion")

Mode = Literal["stop", "slide", "report"]

LARGEST_TURN = 3.0
"""Turn in a time step [rad] up to which the twist between two poses is unique. It must be below pi."""

LOOK_NS = 1_000_000_000
"""Time for which a look for contact shall hold [ns]. A longer one finds something more often, and is then in vain."""


class _Step(NamedTuple):
    """A time step with contact. Poses are in the map frame."""

    start_ns: int
    end_ns: int
    duration: float
    start: Pose
    reached: Pose
    twist: Velocity
    """Velocity that the robot would have in the step without contact."""
    profile: VelocityProfile
    """What the wheels would do in the step without contact."""


class ConstrainedMotion(Motion):
    """A `Motion` with contact with walls, obstacles and other robots.

    While there is no contact, the trajectory is bit-identical to that of `Motion`. Contact is looked for in time steps.
    Within a step, the robot is moved at a constant twist. If limits change its velocity during the step, this is the twist
    between its exact poses at both ends. In between it is off by at most `acceleration * duration**2 / 8` along the path.
    A pose between two time steps comes from a preview: a copy that takes a shorter step. It does not affect later steps.

    Args:
        time_ns: Start time [ns].
        timeout: Time for which a command is held [s]; 0 holds it until the next command.
        map_from_own: Pose of the motion's own frame in the map frame.
        start: First pose of the robot, in the motion's own frame.
        world: Holds the map, the obstacles and the other robots, and calls `step`.
        body: The robot, as the world sees it.
        limits: Limits on the velocity and its change; None for no limits.
        mode: Effect of contact on the motion, as in `advance`.
        drive: The wheels; None for a robot that moves in any direction.

    """

    is_stepped = True

    def __init__(
        self,
        time_ns: int,
        timeout: float,
        map_from_own: Pose,
        start: Pose,
        *,
        world: World,
        body: Body,
        limits: Limits | None,
        mode: Mode,
        drive: Drive | None = None,
    ) -> None:
        self._world, self._body, self._mode = world, body, mode
        self._stepped_ns = time_ns
        self._requested: Velocity = STANDING
        self._requested_until_ns = time_ns
        self.is_blocked = False
        self._touched: str | None = None
        self._preview: ConstrainedMotion | None = None
        self._preview_key = (time_ns, 0)
        self._looked_at: Obstacles | None = None
        """What was around the robot at the last look that found it free; None if it may have moved faster since."""
        self._looked_revision = 0
        """Revision of the map at that look. Its owner may change it at any time."""
        self._clear_ns = self._look_again_ns = time_ns
        """Time until which this look holds, and time from which on another one for as long is worth while [ns]."""
        self._clear_speeds = (0.0, 0.0)
        """Speeds along x and y for which it holds [m/s]."""
        self._reached: Pose | None = None
        """Pose in the map frame after the last step, if contact moved the robot there. Else that of the profile, once it is
        needed; None before."""
        super().__init__(time_ns, timeout, map_from_own, start, limits, drive)

    def step(self, time_ns: int) -> None:
        """Advances to a time [ns], in two steps if the command ends before it."""
        self._preview = None
        if self._stepped_ns < self._requested_until_ns < time_ns:
            self._take_step(self._requested_until_ns)
        if self._stepped_ns < time_ns:
            self._take_step(time_ns)

    def skip(self, time_ns: int) -> bool:
        """Advances to a time [ns] as `step` would in several steps, if a quick look shows that it touches nothing before.

        Nothing around the robot may move until then. Returns False, and does nothing, if it may touch something.
        """
        grid, footprint, profile, start_ns = self._world.grid, self._body.footprint, self._profile, self._stepped_ns
        if grid is None or footprint is None or self.is_blocked or type(profile) is not VelocityProfile:
            return False
        if self._push is not None:
            return False
        others = self._world.obstacles_for(self._body)
        holds = others is self._looked_at and grid.revision == self._looked_revision and time_ns <= self._clear_ns
        if not holds or not self._is_slow(profile):
            until_ns = time_ns if start_ns < self._look_again_ns else max(time_ns, start_ns + LOOK_NS)
            if not self._look(grid, footprint, others, until_ns):
                self._look_again_ns = start_ns + LOOK_NS
                if until_ns == time_ns or not self._look(grid, footprint, others, time_ns):
                    return False
        self.skip_to(time_ns)
        return True

    def skip_to(self, time_ns: int) -> None:
        """Advances to a time [ns]; see `Motion.skip_to`."""
        self._stepped_ns = time_ns
        self._preview = self._reached = self._touched = None

    def top_speed(self, command: Velocity = STANDING) -> float:
        """Returns a speed [m/s] that the robot does not exceed; see `Motion.top_speed`."""
        profile = self._profile
        if type(profile) is not VelocityProfile or self._push is not None:
            return math.inf
        requested = self._requested if self._stepped_ns < self._requested_until_ns else STANDING
        velocities = profile.velocity, profile.command, requested, command
        vx, vy = (max(abs(velocity[axis]) for velocity in velocities) for axis in (0, 1))
        return math.hypot(vx, vy) * max(1.0, self._grip)

    def stays_clear(self, speed: float, seconds: float) -> bool:
        """Returns True if the robot would touch nothing; see `Motion.stays_clear`."""
        grid, footprint = self._world.grid, self._body.footprint
        if grid is None or footprint is None or self.is_blocked:
            return False
        pose, velocity = self.pose_for_others(self._stepped_ns), (speed, 0.0, 0.0)
        others = self._world.obstacles_for(self._body)
        return stays_clear(grid, footprint, pose, velocity, velocity, seconds, obstacles=others)

    def _look(self, grid: OccupancyGrid, footprint: Shape, others: Obstacles, until_ns: int) -> bool:
        """Returns True if a quick look shows that the robot touches nothing before a time [ns], and remembers it.

        It then also holds for any other velocities that are not larger, because it looks at all places that the robot can
        reach. Whatever changes around the robot while nothing moves makes other `others`.
        """
        profile, start_ns = self._profile, self._stepped_ns
        (vx, vy, _), (to_vx, to_vy, _) = profile.velocity, profile.command
        pose, duration = self.pose_for_others(start_ns), (until_ns - start_ns) / NANOSECONDS
        revision = grid.revision
        is_clear = stays_clear(grid, footprint, pose, profile.velocity, profile.command, duration, obstacles=others)
        self._looked_at, self._looked_revision, self._clear_ns = others if is_clear else None, revision, until_ns
        self._clear_speeds = max(abs(vx), abs(to_vx)), max(abs(vy), abs(to_vy))
        return is_clear

    def _is_slow(self, profile: VelocityProfile) -> bool:
        """Returns True if the last look holds for the velocities of a profile."""
        (vx, vy, _), (to_vx, to_vy, _), (most_vx, most_vy) = profile.velocity, profile.command, self._clear_speeds
        return abs(vx) <= most_vx and abs(to_vx) <= most_vx and abs(vy) <= most_vy and abs(to_vy) <= most_vy

    def pose_for_others(self, time_ns: int) -> Pose:
        """Pose in the map frame after the last step. Other robots can collide with it during their current step."""
        if self._reached is None:
            self._reached = self.map_from_own * super().pose(self._stepped_ns)
        return self._reached

    def pose(self, time_ns: int) -> Pose:
        """Pose of the robot in the motion's own frame."""
        return super().pose(time_ns) if time_ns <= self._stepped_ns else Motion.pose(self._at(time_ns), time_ns)

    def map_pose_at(self, time_ns: int) -> Pose:
        """Pose of the robot in the map frame, at a time in the past."""
        return super().map_pose_at(time_ns) if time_ns <= self._stepped_ns else self.map_pose(time_ns)

    def trajectory(self, time_ns: int) -> list[Segment]:
        """Trajectory from the start up to a time, at most the present."""
        return self.segments if time_ns <= self._stepped_ns else self.segments + self._at(time_ns).segments

    def contacts_until(self, time_ns: int) -> list[ContactEvent]:
        """Contacts from the start up to a time, at most the present."""
        return self.contacts if time_ns <= self._stepped_ns else self.contacts + self._at(time_ns).contacts

    def wheel_pose(self, time_ns: int) -> Pose:
        """Pose that the robot would have if its wheels had never slipped, in the motion's own frame."""
        return super().wheel_pose(time_ns) if time_ns <= self._stepped_ns else Motion.wheel_pose(self._at(time_ns), time_ns)

    def wheel_course(self, time_ns: int) -> WheelCourse:
        """Where the wheels are at a time; see `Motion.wheel_course`."""
        if time_ns <= self._stepped_ns:
            return super().wheel_course(time_ns)
        return Motion.wheel_course(self._at(time_ns), time_ns)

    def velocity(self, time_ns: int) -> Velocity:
        """Velocity of the robot."""
        return super().velocity(time_ns) if time_ns <= self._stepped_ns else Motion.velocity(self._at(time_ns), time_ns)

    def wheel_velocity(self, time_ns: int) -> Velocity:
        """Velocity that the robot would have if its wheels did not slip."""
        at = self if time_ns <= self._stepped_ns else self._at(time_ns)
        return Motion.wheel_velocity(at, time_ns)

    def ramp_velocity(self, time_ns: int) -> Velocity:
        """Velocity of the wheels from which another profile goes on; see `VelocityProfile.ramp_velocity_at`."""
        at = self if time_ns <= self._stepped_ns else self._at(time_ns)
        return Motion.ramp_velocity(at, time_ns)

    def rolled(self, time_ns: int) -> NDArray[np.float64]:
        """Angle by which each wheel has turned since the start [rad]."""
        return super().rolled(time_ns) if time_ns <= self._stepped_ns else Motion.rolled(self._at(time_ns), time_ns)

    def distance(self, time_ns: int) -> float:
        """Length of the trajectory up to a time [m]."""
        return super().distance(time_ns) if time_ns <= self._stepped_ns else Motion.distance(self._at(time_ns), time_ns)

    @property
    def request(self) -> tuple[Velocity, int]:
        """The last command: its velocity, and the time at which it ends [ns]."""
        return self._requested, self._requested_until_ns

    def _follow(self, velocity: Velocity, time_ns: int) -> None:
        """Requests a velocity of the wheels from now on; limits and contact decide what the robot does."""
        self._world.expect_speed(self.top_speed(velocity))
        self.step(time_ns)
        self._requested, self._requested_until_ns = velocity, self._end_of_command(time_ns)
        if not self.is_blocked:
            super()._follow(velocity, time_ns)

    def stop(self, time_ns: int) -> None:
        """Stops the robot at once, regardless of the limits, and drops the command."""
        self.step(time_ns)
        self._requested, self._requested_until_ns = STANDING, time_ns
        super().stop(time_ns)

    def move_frame(self, map_from_own: Pose, time_ns: int) -> None:
        """Changes the pose of the motion's own frame in the map. The robot keeps its pose in this frame."""
        self.step(time_ns)
        super().move_frame(map_from_own, time_ns)
        self._reached = self._looked_at = None

    def slip(self, share: float, time_ns: int) -> None:
        """Sets the slip from now on; see `Motion.slip`."""
        self.step(time_ns)
        super().slip(share, time_ns)

    def push(self, push: Push | None, time_ns: int) -> None:
        """Sets the push from now on; see `Motion.push`."""
        self._world.expect_speed(math.inf)
        self.step(time_ns)
        super().push(push, time_ns)
        self._looked_at = None

    def continuing(self: C, before: Motion) -> C:
        """Takes over everything of an earlier motion, and returns this motion; see `Motion.continuing`."""
        if self._kind == before._kind:
            self._requested, self._requested_until_ns = before.request
        return super().continuing(before)

    def restore(self, state: MotionSnapshot) -> None:
        """Returns to the state of a snapshot."""
        super().restore(state)
        stepping = state.stepping
        assert stepping is not None
        self._stepped_ns, self.is_blocked, self._touched = stepping.stepped_ns, stepping.is_blocked, stepping.touched
        self._requested, self._requested_until_ns = stepping.requested, stepping.requested_until_ns
        self._preview, self._reached, self._looked_at = None, stepping.reached, None

    def _save_stepping(self) -> SteppingSnapshot:
        return SteppingSnapshot(
            self._stepped_ns, self._requested, self._requested_until_ns, self.is_blocked, self._touched, self._reached
        )

    def _at(self, time_ns: int) -> ConstrainedMotion:
        """Preview of this motion at a time between two steps. Holds only the segments and contacts since the last step."""
        preview, key = self._preview, (time_ns, self._world.changes)
        if preview is None or self._preview_key != key:
            preview = copy.copy(self)
            preview.segments, preview.contacts = [], []
            preview.step(time_ns)
            self._preview, self._preview_key = preview, key
        return preview

    def _take_step(self, end_ns: int) -> None:
        """Takes a time step during which the command does not change."""
        start_ns, grid, footprint = self._stepped_ns, self._world.grid, self._body.footprint
        profile = self._following(*self._request_at(start_ns)) if self.is_blocked else self._profile
        start, contact = self.pose_for_others(start_ns), None
        self._stepped_ns = end_ns
        self._reached = self._looked_at = None
        if grid is not None and footprint is not None:
            duration = (end_ns - start_ns) / NANOSECONDS
            twist = self._twist(profile, start, start_ns, end_ns)
            others = self._world.obstacles_for(self._body)
            reached, contact = advance(grid, footprint, start, twist, duration, obstacles=others, mode=self._mode)
            if contact is not None:
                self._reached = reached
                step = _Step(start_ns, end_ns, duration, start, reached, twist, profile)
                self._record_contact(step, contact)
                if self._mode != "report":
                    self.is_blocked = True
                    self._begin_after_contact(step, contact)
                return
        self._touched = None
        if self.is_blocked:
            self.is_blocked = False
            self._begin(profile)

    def _request_at(self, time_ns: int) -> tuple[Velocity, int, int]:
        """Arguments of `_following` for the command in force at a time."""
        velocity = self._requested if time_ns < self._requested_until_ns else STANDING
        return velocity, time_ns, self._requested_until_ns

    def _twist(self, profile: VelocityProfile, start: Pose, start_ns: int, end_ns: int) -> Velocity:
        """Constant velocity of the robot that moves it in a time step from a pose in the map frame as the profile does."""
        first, last = profile.velocity_at(start_ns), profile.velocity_at(end_ns)
        duration = (end_ns - start_ns) / NANOSECONDS
        if self._push is None and (profile.is_constant or first == last):
            return scaled(first, self._grip)
        if max(abs(first[2]), abs(last[2])) * duration > LARGEST_TURN:
            vx, vy, wz = (0.5 * (before + after) for before, after in zip(first, last, strict=True))
            mean = scaled((vx, vy, wz), self._grip)
            return mean if self._push is None else with_push(mean, self._push, start.yaw)
        from_profile = Motion.pose(self, start_ns) if self.is_blocked else self._start
        end = self.map_from_own * profile.move(from_profile, end_ns, self._grip)
        if self._push is not None:
            end = displaced(end, self._push, (end_ns - profile.start_ns) / NANOSECONDS)
        return start.twist_to(end, duration)

    def _record_contact(self, step: _Step, contact: Contact) -> None:
        """Appends a contact event, unless the robot already touched the same thing in the previous step."""
        what = self._world.obstacle_name(contact.obstacle)
        if what == self._touched:
            return
        self._touched = what
        elapsed = contact.fraction * step.duration
        time = step.start_ns / NANOSECONDS + elapsed
        speed = math.hypot(step.twist[0], step.twist[1])
        pose = step.start.integrate(step.twist, elapsed).wrapped()
        self.contacts.append(ContactEvent(time, what, contact.point, speed, pose))
        del self.contacts[:-MAX_CONTACTS]

    def _begin_after_contact(self, step: _Step, contact: Contact) -> None:
        """Adds segments to the trajectory for a step in which contact stopped or deflected the robot."""
        end = self.map_from_own.inverse() * step.reached
        if self._push is not None:
            self._begin_pushed_contact(step, contact, end)
        elif self._mode == "stop" and contact.fraction > 0.0:
            stopped_ns = step.start_ns + int(contact.fraction * (step.end_ns - step.start_ns))
            self._begin(VelocityProfile(step.start_ns, STANDING, self._of_wheels(step.twist), stopped_ns))
            self._begin(VelocityProfile(step.end_ns, STANDING, STANDING, step.end_ns), pose=end)
        elif step.reached == step.start:
            if Motion.wheel_velocity(self, step.start_ns) != STANDING or self._profile.limits is not None:
                self._begin(VelocityProfile(step.start_ns, STANDING, STANDING, step.start_ns))
        else:  # The robot slides along the contact, or drives out of an obstacle that moved onto it.
            velocity = self._of_wheels(step.start.twist_to(step.reached, step.duration))
            self._begin(VelocityProfile(step.start_ns, STANDING, velocity, step.end_ns))
            self._begin(VelocityProfile(step.end_ns, STANDING, velocity, FOREVER), pose=end)

    def _begin_pushed_contact(self, step: _Step, contact: Contact, end: Pose) -> None:
        """Adds segments to the trajectory for a step in which contact stopped or deflected a robot that is pushed.

        Along each axis, the wheels move the robot as far as it gets, and at most as far as they would without contact. The
        push does the rest.

        Args:
            step: The step.
            contact: The contact.
            end: Pose at the end of the step, in the motion's own frame.
        """
        stops = self._mode == "stop"
        share = contact.fraction if stops else 1.0
        stopped_ns = step.start_ns + int(share * (step.end_ns - step.start_ns))
        if step.reached == step.start or stopped_ns == step.start_ns:
            moves = Motion.wheel_velocity(self, step.start_ns) != STANDING or self._profile.limits is not None
            if moves or self._acting_push is not None:
                self._begin_pushed(VelocityProfile(step.start_ns, STANDING, STANDING, step.start_ns), None, end)
            return
        robot = self._of_wheels(step.twist if stops else step.start.twist_to(step.reached, step.duration))
        first, last = step.profile.velocity_at(step.start_ns), step.profile.velocity_at(step.end_ns)
        limits = [(min(0.0, *both), max(0.0, *both)) for both in zip(first, last, strict=True)]
        vx, vy = (min(max(robot[axis], least), most) for axis, (least, most) in enumerate(limits[:2]))
        velocity, seconds = (vx, vy, robot[2]), (stopped_ns - step.start_ns) / NANOSECONDS
        driven = step.start.integrate(scaled(velocity, self._grip), seconds)
        push = (step.reached.x - driven.x) / seconds, (step.reached.y - driven.y) / seconds
        self._begin_pushed(VelocityProfile(step.start_ns, STANDING, velocity, FOREVER), push, None)
        if stops:
            self._begin_pushed(VelocityProfile(stopped_ns, STANDING, STANDING, stopped_ns), None, end)
        else:
            self._begin_pushed(VelocityProfile(step.end_ns, STANDING, velocity, FOREVER), push, end)

    def _of_wheels(self, velocity: Velocity) -> Velocity:
        """Velocity of the wheels when the robot moves at a velocity. Without grip, that of the robot."""
        return scaled(velocity, 1.0 / self._grip) if self._grip else velocity
