"""World: the map, the obstacles and the robots of a simulation, advanced on one clock."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from itertools import compress
from typing import Protocol, TypeAlias

import numpy as np
from numpy.typing import NDArray

from .._core import Obstacles, OccupancyGrid, Pose, Shape, touches
from ..handle import Handle
from ..instant import NANOSECONDS
from ..quoting import quoted
from .crowd import Crowd, Placed
from .motion import Motion
from .obstacles import Course, Obstacle, ObstacleSnapshot
from .velocity_profile import Velocity

STEP_NS = 20_000_000
"""Time step for robots with a footprint [ns]; all other bodies are frozen during a step."""

SKIPPED_NS = 10 * STEP_NS
"""Longest time for which a robot moves without a look for contact, if everything else stands and is far away [ns]."""

HEADROOM, HEADROOM_SPEED = 1.25, 0.1
"""Robots that are free may drive faster than the fastest one does by this factor and this speed [m/s]."""

SHOWN_NAMES = 10
"""Number of obstacles that a message names at most."""

Passing: TypeAlias = tuple[Shape, Course]
"""A shape, and its pose or its poses at several times in the map frame."""


class Body(Protocol):
    """What the world needs to know about a robot."""

    body_name: str

    @property
    def footprint(self) -> Shape | None:
        """Outline of the robot; None if nothing collides with it or sees it."""

    @property
    def motion(self) -> Motion:
        """Motion of the robot."""


class Carrier(Protocol):
    """The body on which a scanner is mounted."""

    @property
    def pose(self) -> Pose:
        """True pose now, in the map frame."""

    @property
    def seen(self) -> Obstacles:
        """Obstacles and other robots now; scanners see these in addition to the map."""

    def poses_at(self, offsets_ns: NDArray[np.int64]) -> NDArray[np.float64]:
        """Returns the true poses in the map frame at times up to now.

        Args:
            offsets_ns: (N,) int64, increasing times [ns] relative to now; none is positive.

        Returns:
            (N, 3) float64, rows (x, y, yaw) [m, m, rad].
        """

    def surroundings_at(self, offsets_ns: NDArray[np.int64]) -> list[Passing]:
        """Returns the obstacles and other robots that are here now, and where they were at times up to now.

        Args:
            offsets_ns: (N,) int64, increasing times [ns] relative to now; none is positive.
        """

    def publish_transforms(self, stamp_ns: int) -> None:
        """Publishes the transforms of the body, unless it has done so at this stamp [ns].

        Scanners call it before each scan.
        """


@dataclass(frozen=True, slots=True)
class WorldSnapshot:
    """State of a `World` at one time, as returned by `World.save`. The motion of each robot is saved with the robot."""

    stepped_ns: int
    obstacles: tuple[ObstacleSnapshot, ...]
    placed: int
    bodies: tuple[Body, ...]
    grid: OccupancyGrid | None


class World(Handle):
    """The map, the obstacles and the robots of a simulation.

    Robots without footprint do not touch anything, so they can be read at any time. The others advance in time
    steps of `STEP_NS`, which start at multiples of `STEP_NS`. In each step they move one after another, in the order in
    which they joined; while one robot moves, everything else is frozen. Reading a state between two steps does not change
    later results.

    Args:
        clock: Returns the simulated time [ns]. It increases steadily, even if the clock that nodes see jumps.
        grid: The map, None until it is known; without one there is no contact, neither with walls nor between bodies.

    """

    def __init__(self, clock: Callable[[], int], grid: OccupancyGrid | None = None) -> None:
        self._clock, self.grid = clock, grid
        self.obstacles: list[Obstacle] = []
        self.placed = 0
        """Number of obstacles that were ever placed."""
        self._bodies: list[Body] = []
        self._stepped_ns = clock()
        self._stepping = False
        self.changes = 0
        """Number of calls of `changed`."""
        self._frozen: Crowd[Body | Obstacle] = Crowd()
        """The obstacles, then the robots, where others can collide with them during the current step."""
        self._moving: list[tuple[int, Obstacle]] = []
        """Obstacles that do not stand, each with its index in `_frozen`."""
        self._stepped: list[Body] = []
        """Robots that advance in time steps."""
        self._lone: Body | None = None
        """The robot that advances in time steps, if it is the only one and no other robot has a footprint."""
        self._free: list[Body] = []
        """Robots that touch nothing and that nobody touches until `_look_again_ns`. Their places in `_frozen` are old."""
        self._free_motions: list[Motion] = []
        """Their motions."""
        self._bound: list[Body] = []
        """The other robots that advance in time steps."""
        self._free_speed = 0.0
        """Speed that no robot exceeds meanwhile [m/s]."""
        self._free_revision = 0
        """Revision of the map at the last look for free robots."""
        self._look_again_ns = 0
        """Time of the next look for free robots [ns]."""
        self._latest: tuple[int, Crowd[Body | Obstacle]] | None = None
        """Obstacles and robots at the last time at which somebody asked for them."""

    @property
    def bodies(self) -> tuple[Body, ...]:
        """The robots, in the order in which they joined."""
        return tuple(self._bodies)

    def now_ns(self) -> int:
        """Advances all robots to the present and returns it [ns]."""
        now = self._clock()
        if now - self._stepped_ns >= STEP_NS:
            self._step_to(now)
        return now

    def join(self, body: Body) -> None:
        """Adds a robot."""
        now = self.now_ns()
        self._bodies.append(body)
        if now > self._stepped_ns or len(self._stepped) < 2:
            self.changed()
            return
        # Everything is where it was frozen, so only what is new is computed, and many robots can be added.
        self.changes += 1
        self._wake()
        self._look_again_ns = 0
        if body.motion.is_stepped:
            self._stepped.append(body)
        if body.footprint is not None:
            self._frozen.insert(len(self._frozen.things), body, (body.footprint, body.motion.pose_for_others(now)))
            if self._latest is not None and self._latest[0] == now:
                present = self._latest[1]
                present.insert(len(present.things), body, (body.footprint, body.motion.map_pose(now)))

    def leave(self, body: Body) -> None:
        """Removes a robot."""
        self._bodies.remove(body)
        self.changed()

    def use_map(self, grid: OccupancyGrid) -> None:
        """Replaces the map from now on."""
        self.now_ns()
        self.grid = grid
        self.changed()

    def place(self, obstacle: Obstacle) -> None:
        """Adds an obstacle."""
        self.now_ns()
        placed = obstacle.placed(self._stepped_ns)
        self._wake()
        # Only what is new is computed, so that many obstacles can be added.
        self._frozen.insert(len(self.obstacles), obstacle, placed)
        if not obstacle.stands:
            self._moving.append((len(self.obstacles), obstacle))
        self.obstacles.append(obstacle)
        self.placed += 1
        self._latest = None

    def remove(self, obstacle: Obstacle) -> None:
        """Removes an obstacle.

        Raises:
            ValueError: The obstacle is not in the world.
        """
        self.now_ns()
        self._check_is_here(obstacle)
        self.obstacles.remove(obstacle)
        self.changed()

    def _check_is_here(self, obstacle: Obstacle) -> None:
        if obstacle not in self.obstacles:
            raise ValueError(f"the obstacle must be in the world, got {quoted(obstacle)}")

    def obstacle(self, name: str) -> Obstacle:
        """Returns the obstacle with this name: the first, if there are several.

        Raises:
            ValueError: There is none.
        """
        for obstacle in self.obstacles:
            if obstacle.name == name:
                return obstacle
        known = ", ".join(sorted(quoted(each.name) for each in self.obstacles)[:SHOWN_NAMES])
        raise ValueError(f"unknown obstacle {quoted(name)}; " + (f"there are {known}" if known else "there are none"))

    def move(self, obstacle: Obstacle, pose: Pose | None, velocity: Velocity | None) -> None:
        """Moves an obstacle from now on; see `Obstacle.move`.

        Raises:
            ValueError: The obstacle is not in the world, or cannot be moved.
        """
        self._check_is_here(obstacle)
        obstacle.move(self.now_ns(), pose=pose, velocity=velocity)
        self.changed()

    def changed(self) -> None:
        """Updates the poses that robots can collide with.

        Must be called when a robot was added or removed, when an obstacle was removed or moved, when the map or a footprint
        changed, and when a robot was moved by anything other than a velocity command.
        """
        self.changes += 1
        self._latest = None
        self._freeze()

    def obstacles_for(self, body: Body) -> Obstacles:
        """Obstacles and other robots that a robot can collide with during the current step.

        It is the same object until an obstacle or a robot comes, goes or is moved by something other than its own motion.
        """
        return self._frozen.around(body)

    def obstacle_name(self, index: int | None) -> str:
        """Name of the thing at an index of `obstacles_for`; None stands for a wall."""
        return "a wall" if index is None else _name_of(self._frozen.things[index][0])

    def check_place(self, what: str, pose: Pose, shape: Shape | None, body: Body | None = None) -> None:
        """Checks that a robot can stand at a pose now. Without a map it can stand anywhere.

        Args:
            what: Name of the pose in the error message.
            pose: The pose, in the map frame.
            shape: Footprint of the robot; None if it has none.
            body: The robot, if it is in the world already.

        Raises:
            ValueError: The robot's origin would be inside a wall, or its footprint would touch a wall, an obstacle or
                another robot.
        """
        shown = f"({pose.x}, {pose.y}, {pose.yaw})"
        if self.grid is None:
            return
        if not self.grid.is_free_disc(pose.x, pose.y, 0.0):
            raise ValueError(f"{what} must not be inside a wall, got {shown}")
        if shape is None:
            return
        if touches(self.grid, shape, pose):
            raise ValueError(f"{what} must leave the robot room beside walls, got {shown}")
        touched = self._present().touches(shape, pose, body)
        if touched:
            raise ValueError(f"{what} must leave the robot room beside {_name_of(touched[0])}, got {shown}")

    def everybody(self) -> list[tuple[Body | Obstacle, Placed]]:
        """All obstacles and all robots with a footprint, where they are now."""
        return self._present().things

    def _present(self) -> Crowd[Body | Obstacle]:
        now = self.now_ns()
        if self._latest is None or self._latest[0] != now:
            self._latest = now, Crowd(self._everybody(now, lambda body: body.motion.map_pose(now)))
        return self._latest[1]

    def seen_by(self, body: Body) -> Obstacles:
        """Obstacles and other robots, where they are now."""
        if body is self._lone and not self._moving:
            return self.obstacles_for(body)
        return self._present().around(body)

    @property
    def has_looked(self) -> bool:
        """True if somebody has asked where all obstacles and robots are now, so that to ask again computes nothing."""
        return self._latest is not None and self._latest[0] == self._clock()

    def around_at(self, body: Body, time_ns: int) -> list[Placed]:
        """Obstacles and other robots, where they were at a time in the past."""
        everybody = self._everybody(time_ns, lambda body: body.motion.map_pose_at(time_ns))
        return [placed for other, placed in everybody if other is not body]

    def stands_around(self, body: Body) -> bool:
        """True if all obstacles stand and no other robot has a footprint, so that nothing around the robot ever moves."""
        return not self._moving and all(other is body or other.footprint is None for other in self._bodies)

    def around_during(self, body: Body, times_ns: NDArray[np.int64]) -> list[Passing]:
        """Obstacles and other robots that are here now, and where they were at several times in the past.

        Args:
            body: The robot to leave out.
            times_ns: (N,) int64, increasing times [ns].
        """
        around: list[Passing] = [(obstacle.shape, obstacle.course(times_ns)) for obstacle in self.obstacles]
        for other in self._bodies:
            if other is not body and other.footprint is not None:
                around.append((other.footprint, other.motion.map_poses_at(times_ns)))
        return around

    def save(self) -> WorldSnapshot:
        """Returns a snapshot for `restore`."""
        obstacles = tuple(obstacle.save() for obstacle in self.obstacles)
        return WorldSnapshot(self._stepped_ns, obstacles, self.placed, tuple(self._bodies), self.grid)

    def restore(self, state: WorldSnapshot) -> None:
        """Returns to the state of a snapshot. The motions of the robots must be restored first."""
        self._stepped_ns, self.grid, self.placed = state.stepped_ns, state.grid, state.placed
        self.obstacles, self._bodies = [each.obstacle for each in state.obstacles], list(state.bodies)
        for each in state.obstacles:
            each.obstacle.restore(each)
        self.changed()

    def _step_to(self, now: int) -> None:
        if not self._stepped:
            self._stepped_ns = now - now % STEP_NS
            return
        if self._stepping:  # The trajectory function of an obstacle reads the world during a step.
            return
        self._stepping = True
        try:
            while now - self._stepped_ns >= STEP_NS:
                first = self._stepped_ns + STEP_NS - self._stepped_ns % STEP_NS
                last = min(first + SKIPPED_NS - STEP_NS, now - now % STEP_NS)
                if self._lone is not None and not self._moving and self._lone.motion.skip(last):
                    self._stepped_ns = last
                    continue
                for time_ns in range(first, last + 1, STEP_NS):
                    self._take_step(time_ns)
        finally:
            self._stepping = False

    def _take_step(self, time_ns: int) -> None:
        """Moves everything until the end of a time step [ns]."""
        self._find_free(self._stepped_ns, time_ns)
        self._stepped_ns = time_ns
        for index, obstacle in self._moving:
            self._frozen.move(index, obstacle.pose(time_ns))
        for motion in self._free_motions:
            motion.skip_to(time_ns)
        for body in self._bound:
            motion = body.motion
            motion.step(time_ns)
            if len(self._bodies) > 1 and (own := self._frozen.index_of(body)) is not None:
                self._frozen.move(own, motion.pose_for_others(time_ns))

    def _find_free(self, start_ns: int, end_ns: int) -> None:
        """Finds the robots that touch nothing in a time step, unless those that were found before are still free.

        A robot is free if everything around it is farther away than it and another robot can drive until the next look, in
        any direction, at most as fast as `_free_speed`. So nobody needs to look for contact with it.
        """
        grid = self.grid
        if self._free and (end_ns > self._look_again_ns or grid is None or grid.revision != self._free_revision):
            self._wake()
        if start_ns < self._look_again_ns or grid is None or self._moving or len(self._stepped) < 2:
            return
        self._look_again_ns = start_ns - start_ns % STEP_NS + SKIPPED_NS
        speed = HEADROOM * max(body.motion.top_speed() for body in self._stepped) + HEADROOM_SPEED
        if math.isinf(speed) or any(body.footprint is not None and not body.motion.is_stepped for body in self._bodies):
            return
        self._free_speed, self._free_revision = speed, grid.revision
        seconds = (self._look_again_ns - start_ns) / NANOSECONDS
        free = [body.motion.stays_clear(2.0 * speed, seconds) for body in self._stepped]
        self._free = list(compress(self._stepped, free))
        self._free_motions = [body.motion for body in self._free]
        self._bound = [body for body, is_free in zip(self._stepped, free, strict=True) if not is_free]

    def expect_speed(self, speed: float) -> None:
        """Must be called before a robot may exceed the speed that it had so far.

        Args:
            speed: Speed that it will not exceed [m/s].
        """
        if speed > self._free_speed:
            self._wake()

    def _wake(self) -> None:
        """Ends the time of the free robots. Their places become those after the last time step."""
        free = self._free
        self._free, self._free_motions, self._bound = [], [], self._stepped
        for body in free:
            index = self._frozen.index_of(body)
            assert index is not None
            self._frozen.move(index, body.motion.pose_for_others(self._stepped_ns))

    def _freeze(self) -> None:
        self._stepped = [body for body in self._bodies if body.motion.is_stepped]
        self._lone = self._stepped[0] if len(self._stepped) == 1 else None
        if any(body is not self._lone and body.footprint is not None for body in self._bodies):
            self._lone = None
        self._moving = [(index, obstacle) for index, obstacle in enumerate(self.obstacles) if not obstacle.stands]
        self._free, self._free_motions, self._bound, self._look_again_ns = [], [], self._stepped, 0
        self._frozen = Crowd(self._everybody(self._stepped_ns, lambda body: body.motion.pose_for_others(self._stepped_ns)))

    def _everybody(self, time_ns: int, pose_of: Callable[[Body], Pose]) -> list[tuple[Body | Obstacle, Placed]]:
        everybody: list[tuple[Body | Obstacle, Placed]] = [
            (obstacle, obstacle.placed(time_ns)) for obstacle in self.obstacles
        ]
        everybody += [(body, (body.footprint, pose_of(body))) for body in self._bodies if body.footprint is not None]
        return everybody


def _name_of(other: Body | Obstacle) -> str:
    return f"obstacle {other.name}" if isinstance(other, Obstacle) else f"robot {other.body_name}"
