"""ConstrainedMotion: the trajectory of a robot with velocity limits and contact, computed in time steps."""

from __future__ import annotations

import copy
import math
from typing import Literal, NamedTuple

from .._core import Contact, Limits, Pose, advance
from ..instant import NANOSECONDS
from .motion import FOREVER, STANDING, ContactEvent, Motion, MotionSnapshot, Segment, SteppingSnapshot, Velocity
from .world import Body, World

Mode = Literal["stop", "slide", "report"]


class _Step(NamedTuple):
    """A time step with contact. Poses are in the map frame. Velocities are those of the wheels, except `twist`."""

    start_ns: int
    end_ns: int
    duration: float
    start: Pose
    reached: Pose
    before: Velocity
    """Velocity before the step."""
    velocity: Velocity
    """Velocity that the step would have without contact."""
    twist: Velocity
    """Velocity of the robot that belongs to `velocity`. Smaller than `velocity` if the wheels slip."""


class ConstrainedMotion(Motion):
    """A `Motion` with limits on velocity and acceleration, and contact with walls, obstacles and other robots.

    While neither limits nor contact act, the trajectory is bit-identical to that of `Motion`.
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
    ) -> None:
        self._world, self._body, self._limits, self._mode = world, body, limits, mode
        self._stepped_ns = time_ns
        self._requested: Velocity = STANDING
        self._requested_until_ns = time_ns
        self._touched: str | None = None
        self._preview: ConstrainedMotion | None = None
        self._reached: Pose | None = None
        """Pose in the map frame after the last step; None until it is needed."""
        super().__init__(time_ns, timeout, map_from_own, start)

    def step(self, time_ns: int) -> None:
        """Advances to a time [ns], in two steps if the command ends before it."""
        self._preview = None
        if self._stepped_ns < self._requested_until_ns < time_ns:
            self._take_step(self._requested_until_ns)
        if self._stepped_ns < time_ns:
            self._take_step(time_ns)

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

    def velocity(self, time_ns: int) -> Velocity:
        """Velocity of the robot."""
        return super().velocity(time_ns) if time_ns <= self._stepped_ns else Motion.velocity(self._at(time_ns), time_ns)

    def wheel_velocity(self, time_ns: int) -> Velocity:
        """Velocity that the robot would have if its wheels did not slip."""
        at = self if time_ns <= self._stepped_ns else self._at(time_ns)
        return Motion.wheel_velocity(at, time_ns)

    def distance(self, time_ns: int) -> float:
        """Length of the trajectory up to a time [m]."""
        return super().distance(time_ns) if time_ns <= self._stepped_ns else Motion.distance(self._at(time_ns), time_ns)

    def command(self, velocity: Velocity, time_ns: int) -> None:
        """Requests a velocity from now on; limits and contact decide what the robot does."""
        self.step(time_ns)
        self._requested = velocity
        self._requested_until_ns = self._end_of_command(time_ns)

    def set_timeout(self, timeout: float, time_ns: int) -> None:
        """Changes the timeout [s]. A command in force is held for the new timeout, counted from now."""
        self.timeout = timeout
        if time_ns < self._requested_until_ns:
            self.command(self._requested, time_ns)

    def stop(self, time_ns: int) -> None:
        """Stops the robot at once, regardless of the limits, and drops the command."""
        self.step(time_ns)
        self._requested = STANDING
        super().stop(time_ns)

    def place(self, pose: Pose, time_ns: int) -> None:
        """Moves the robot to a pose in the motion's own frame and sets `wheel_pose` to it. A command in force continues."""
        self.step(time_ns)
        super().place(pose, time_ns)
        self._reached = None

    def move_frame(self, map_from_own: Pose, time_ns: int) -> None:
        """Changes the pose of the motion's own frame in the map. The robot keeps its pose in this frame."""
        self.step(time_ns)
        super().move_frame(map_from_own, time_ns)
        self._reached = None

    def slip(self, share: float, time_ns: int) -> None:
        """Sets the slip from now on; see `Motion.slip`."""
        self.step(time_ns)
        super().slip(share, time_ns)

    def restore(self, state: MotionSnapshot) -> None:
        """Returns to the state of a snapshot."""
        super().restore(state)
        stepping = state.stepping
        assert stepping is not None and (stepping.preview is None or isinstance(stepping.preview, ConstrainedMotion))
        self._stepped_ns, self._touched = stepping.stepped_ns, stepping.touched
        self._requested, self._requested_until_ns = stepping.requested, stepping.requested_until_ns
        self._preview, self._reached = stepping.preview, stepping.reached

    def _save_stepping(self) -> SteppingSnapshot:
        return SteppingSnapshot(
            self._stepped_ns, self._requested, self._requested_until_ns, self._touched, self._preview, self._reached
        )

    def _at(self, time_ns: int) -> ConstrainedMotion:
        """Preview of this motion at a time between two steps. Holds only the segments and contacts since the last step."""
        preview = self._preview
        if preview is None or preview._stepped_ns != time_ns:
            preview = copy.copy(self)
            preview.segments, preview.contacts = [], []
            preview.step(time_ns)
            self._preview = preview
        return preview

    def _take_step(self, end_ns: int) -> None:
        """Takes a time step during which the command does not change."""
        start_ns, grid, footprint = self._stepped_ns, self._world.grid, self._body.footprint
        duration = (end_ns - start_ns) / NANOSECONDS
        before = Motion.wheel_velocity(self, start_ns)
        velocity = self._requested if start_ns < self._requested_until_ns else STANDING
        if self._limits is not None:
            velocity = self._limits.apply(velocity, before, duration)
        if grid is None or footprint is None:
            self._stepped_ns, self._reached = end_ns, None
            self._begin_if_changed(velocity, before, start_ns)
            return
        start, twist = self.pose_for_others(start_ns), self._with_slip(velocity)
        self._stepped_ns = end_ns
        others = self._world.obstacles_for(self._body)
        self._reached, contact = advance(grid, footprint, start, twist, duration, obstacles=others, mode=self._mode)
        if contact is None:
            self._touched = None
            self._begin_if_changed(velocity, before, start_ns)
            return
        step = _Step(start_ns, end_ns, duration, start, self._reached, before, velocity, twist)
        self._record_contact(step, contact)
        if self._mode == "report":
            self._begin_if_changed(velocity, before, start_ns)
        else:
            self._begin_after_contact(step, contact)

    def _begin_if_changed(self, velocity: Velocity, before: Velocity, time_ns: int) -> None:
        """Begins a segment if the velocity of the wheels changes."""
        if velocity != before:
            self._begin(time_ns, velocity, FOREVER if velocity != STANDING else time_ns)

    def _record_contact(self, step: _Step, contact: Contact) -> None:
        """Appends a contact event, unless the robot already touched the same thing in the previous step."""
        what = self._world.obstacle_name(self._body, contact.obstacle)
        if what == self._touched:
            return
        self._touched = what
        elapsed = contact.fraction * step.duration
        time = step.start_ns / NANOSECONDS + elapsed
        speed = math.hypot(step.twist[0], step.twist[1])
        pose = step.start.integrate(step.twist, elapsed).wrapped()
        self.contacts.append(ContactEvent(time, what, contact.point, speed, pose))

    def _begin_after_contact(self, step: _Step, contact: Contact) -> None:
        """Adds segments to the trajectory for a step in which contact stopped or deflected the robot."""
        end = self.map_from_own.inverse() * step.reached
        if self._mode == "stop" and contact.fraction > 0.0:
            stopped_ns = step.start_ns + int(contact.fraction * (step.end_ns - step.start_ns))
            self._begin(step.start_ns, step.velocity, stopped_ns)
            self._begin(step.end_ns, STANDING, step.end_ns, pose=end)
        elif step.reached == step.start:
            self._begin_if_changed(STANDING, step.before, step.start_ns)
        else:  # The robot slides along the contact, or drives out of an obstacle that moved onto it.
            vx, vy, wz = step.start.twist_to(step.reached, step.duration)
            grip = 1.0 - self._slip
            velocity = (vx / grip, vy / grip, wz / grip) if grip else step.velocity
            self._begin(step.start_ns, velocity, step.end_ns)
            self._begin(step.end_ns, velocity, FOREVER, pose=end)
