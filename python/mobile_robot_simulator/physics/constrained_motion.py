"""ConstrainedMotion: the way of a robot that limits and contact hold back, gone step by step."""

from __future__ import annotations

import copy
import math
from typing import Literal

from .._core import Limits, Pose, advance
from ..instant import NANOSECONDS
from .motion import FOREVER, STANDING, ContactEvent, Motion, Piece, Velocity
from .world import Body, World

Mode = Literal["stop", "slide", "report"]


class ConstrainedMotion(Motion):
    """As `Motion`, but velocities change no faster than limits let them, and what is in the way counts.

    While nothing holds the robot back its way is that of `Motion`, to the last bit. world: what there is to meet, and when
    steps are taken. body: the robot, as the world knows it. mode: what contact does, as in `advance`.
    """

    steps = True

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
        self._wanted: Velocity = STANDING
        self._wanted_until = time_ns
        self._met: str | None = None
        self._ahead: ConstrainedMotion | None = None
        self._standing: Pose | None = None
        super().__init__(time_ns, timeout, map_from_own, start)

    def step(self, time_ns: int) -> None:
        """Go on to a time."""
        self._ahead = None
        if self._stepped_ns < self._wanted_until < time_ns:
            self._go_on(self._wanted_until)
        if self._stepped_ns < time_ns:
            self._go_on(time_ns)

    def standing_pose(self, time_ns: int) -> Pose:
        """Where the robot has come to, in the map."""
        if self._standing is None:
            self._standing = self.map_from_own * super().pose(self._stepped_ns)
        return self._standing

    def pose(self, time_ns: int) -> Pose:
        """Where the robot is, in the motion's own frame."""
        return super().pose(time_ns) if time_ns <= self._stepped_ns else Motion.pose(self._at(time_ns), time_ns)

    def map_pose_at(self, time_ns: int) -> Pose:
        """Where the robot was in the map at a time past."""
        return super().map_pose_at(time_ns) if time_ns <= self._stepped_ns else self.map_pose(time_ns)

    def way(self, time_ns: int) -> list[Piece]:
        """The way up to a time that has come."""
        return self.pieces if time_ns <= self._stepped_ns else self.pieces + self._at(time_ns).pieces

    def met(self, time_ns: int) -> list[ContactEvent]:
        """The contacts up to a time that has come."""
        return self.contacts if time_ns <= self._stepped_ns else self.contacts + self._at(time_ns).contacts

    def wheels(self, time_ns: int) -> Pose:
        """Where the robot would be had its wheels never slipped, in the motion's own frame."""
        return super().wheels(time_ns) if time_ns <= self._stepped_ns else Motion.wheels(self._at(time_ns), time_ns)

    def velocity(self, time_ns: int) -> Velocity:
        """How the robot moves: forward, leftward [m/s] and turning [rad/s]."""
        return super().velocity(time_ns) if time_ns <= self._stepped_ns else Motion.velocity(self._at(time_ns), time_ns)

    def wheel_velocity(self, time_ns: int) -> Velocity:
        """How the robot would move did its wheels not slip."""
        at = self if time_ns <= self._stepped_ns else self._at(time_ns)
        return Motion.wheel_velocity(at, time_ns)

    def distance(self, time_ns: int) -> float:
        """Length of the way so far [m]."""
        return super().distance(time_ns) if time_ns <= self._stepped_ns else Motion.distance(self._at(time_ns), time_ns)

    def command(self, velocity: Velocity, time_ns: int) -> None:
        """Move at a velocity from now on, as far as the robot can."""
        self.step(time_ns)
        self._wanted = velocity
        self._wanted_until = self._end_of_command(time_ns)

    def hold_anew(self, timeout: float, time_ns: int) -> None:
        """Hold commands so long from now on, the one in force too, as if it came now."""
        self.timeout = timeout
        if time_ns < self._wanted_until:
            self.command(self._wanted, time_ns)

    def stand(self, time_ns: int) -> None:
        """Move no more."""
        self.step(time_ns)
        self._wanted = STANDING
        super().stand(time_ns)

    def place(self, pose: Pose, time_ns: int) -> None:
        """Be at a pose of the motion's own frame, the wheels too, and go on from there as before."""
        self.step(time_ns)
        super().place(pose, time_ns)
        self._standing = None

    def move_frame(self, map_from_own: Pose, time_ns: int) -> None:
        """Have the motion's own frame elsewhere in the map, and the robot with it."""
        self.step(time_ns)
        super().move_frame(map_from_own, time_ns)
        self._standing = None

    def slip(self, share: float, time_ns: int) -> None:
        """From now on, move by this share less than the wheels turn."""
        self.step(time_ns)
        super().slip(share, time_ns)

    def _at(self, time_ns: int) -> ConstrainedMotion:
        """Where it gets to by a time between two steps: a copy of it, which itself stays where it is."""
        ahead = self._ahead
        if ahead is None or ahead._stepped_ns != time_ns:
            ahead = copy.copy(self)
            ahead.pieces, ahead.contacts = [], []
            ahead.step(time_ns)
            self._ahead = ahead
        return ahead

    def _go_on(self, to_ns: int) -> None:
        """Take a step under one command."""
        from_ns, grid, footprint = self._stepped_ns, self._world.grid, self._body.footprint
        dt = (to_ns - from_ns) / NANOSECONDS
        wanted = self._wanted if from_ns < self._wanted_until else STANDING
        command = Motion.wheel_velocity(self, from_ns)
        if self._limits is not None:
            wanted = self._limits.apply(wanted, command, dt)
        if grid is None or footprint is None:
            self._stepped_ns, self._standing = to_ns, None
            self._take_up(wanted, command, from_ns)
            return
        start, rest = self.standing_pose(from_ns), 1.0 - self._slip
        self._stepped_ns = to_ns
        twist = wanted if rest == 1.0 else (wanted[0] * rest, wanted[1] * rest, wanted[2] * rest)
        others = self._world.in_the_way(self._body)
        reached, contact = advance(grid, footprint, start, twist, dt, obstacles=others, mode=self._mode)
        self._standing = reached
        if contact is None:
            self._met = None
            self._take_up(wanted, command, from_ns)
            return
        what = self._world.name(self._body, contact.obstacle)
        if what != self._met:
            self._met = what
            time = from_ns / NANOSECONDS + contact.fraction * dt
            touching = start.integrate(twist, contact.fraction * dt).wrapped()
            self.contacts.append(ContactEvent(time, what, contact.point, math.hypot(twist[0], twist[1]), touching))
        if self._mode == "report":
            self._take_up(wanted, command, from_ns)
            return
        end = self.map_from_own.inverse() * reached
        if self._mode == "stop" and contact.fraction > 0.0:
            self._begin(from_ns, wanted, from_ns + int(contact.fraction * (to_ns - from_ns)))
            self._begin(to_ns, STANDING, to_ns, pose=end)
        elif reached == start:
            self._take_up(STANDING, command, from_ns)
        else:  # along what it met, or out of what came over it
            vx, vy, wz = start.twist_to(reached, dt)
            held = (vx / rest, vy / rest, wz / rest) if rest else wanted
            self._begin(from_ns, held, to_ns)
            self._begin(to_ns, held, FOREVER, pose=end)

    def _take_up(self, wanted: Velocity, current: Velocity, time_ns: int) -> None:
        """Move at a velocity from a time on, unless the robot does so already."""
        if wanted != current:
            self._begin(time_ns, wanted, FOREVER if wanted != STANDING else time_ns)
