"""World: what robots move in and bump into, and the time they move by."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Protocol, TypeAlias

from .._core import OccupancyGrid, Pose, Shape, touches
from ..handle import Handle
from .motion import Motion
from .obstacles import Obstacle

STEP_NS = 20_000_000
"""Robots that something can push back move by steps of so many nanoseconds, during which all others stand."""

Placed: TypeAlias = tuple[Shape, Pose]


class Body(Protocol):
    """A robot, as others meet it."""

    body_name: str

    @property
    def footprint(self) -> Shape | None:
        """Its outline; without one, nobody meets it."""

    @property
    def motion(self) -> Motion:
        """Its way."""


class Carrier(Protocol):
    """What a scanner stands on."""

    @property
    def pose(self) -> Pose:
        """Where it really is now, in the map frame."""

    @property
    def surroundings(self) -> list[Placed]:
        """What can be seen from it now, but for the map."""


class World(Handle):
    """What robots move in.

    Robots without footprint and limits move exactly as they are told, at any time. The others are pushed back, in steps of
    STEP_NS on a grid of times of the world's own, in the order in which they joined; while one takes a step, all others
    stand. What is asked for between steps does not change what happens later.

    clock: the time [ns] that things move by, which goes on steadily whatever the clocks of nodes show. grid: the map;
    without one there are no walls, and nobody meets anybody.
    """

    def __init__(self, clock: Callable[[], int], grid: OccupancyGrid | None = None) -> None:
        self._clock, self.grid = clock, grid
        self.obstacles: list[Obstacle] = []
        self._bodies: list[Body] = []
        self._stepped_ns = clock()
        self._stepping = False
        self._standing: list[tuple[Body | Obstacle, Placed]] = []
        self._places: dict[Body, int] = {}
        self._seen: tuple[int, list[tuple[Body | Obstacle, Placed]]] | None = None

    def now_ns(self) -> int:
        """The time it is, to which all robots have come."""
        now = self._clock()
        if now - self._stepped_ns >= STEP_NS:
            self._step_to(now)
        return now

    def join(self, body: Body) -> None:
        """Have another robot in the world."""
        self.now_ns()
        self._bodies.append(body)
        self.changed()

    def place(self, obstacle: Obstacle) -> None:
        """Have another obstacle in the world."""
        self.now_ns()
        self.obstacles.append(obstacle)
        self.changed()

    def changed(self) -> None:
        """Something is elsewhere all of a sudden."""
        self._seen = None
        self._stand()

    def in_the_way(self, body: Body) -> list[Placed]:
        """All but the map that a robot can meet while it takes a step."""
        return [placed for other, placed in self._standing if other is not body]

    def name(self, body: Body, index: int | None) -> str:
        """What a robot met: the wall, or the thing of an index in `in_the_way`."""
        if index is None:
            return "a wall"
        return _named([other for other, _ in self._standing if other is not body][index])

    def touched(self, shape: Shape, pose: Pose) -> str | None:
        """What a shape at a pose would touch now, but for walls; None if nothing."""
        for other, placed in self.everybody():
            if self.grid is not None and touches(self.grid, shape, pose, obstacles=[placed]):
                return _named(other)
        return None

    def everybody(self) -> list[tuple[Body | Obstacle, Placed]]:
        """All but the map, where it is now."""
        now = self.now_ns()
        if self._seen is None or self._seen[0] != now:
            self._seen = now, self._everybody(now, lambda body: body.motion.map_pose(now))
        return self._seen[1]

    def seen_by(self, body: Body) -> list[Placed]:
        """All but the map that can be seen from a robot now."""
        return [placed for other, placed in self.everybody() if other is not body]

    def around_at(self, body: Body, time_ns: int) -> list[Placed]:
        """All but the map that was around a robot at a time past."""
        everybody = self._everybody(time_ns, lambda body: body.motion.map_pose_at(time_ns))
        return [placed for other, placed in everybody if other is not body]

    def save(self) -> Any:
        """All that `restore` needs but the robots' ways."""
        return self._stepped_ns, tuple(self.obstacles), tuple(self._bodies)

    def restore(self, state: Any) -> None:
        """Be as when the state was saved, once the robots' ways are."""
        self._stepped_ns, obstacles, bodies = state
        self.obstacles, self._bodies = list(obstacles), list(bodies)
        self.changed()

    def _step_to(self, now: int) -> None:
        stepping = [body for body in self._bodies if body.motion.steps]
        if not stepping:
            self._stepped_ns = now - now % STEP_NS
            return
        if self._stepping:  # an obstacle's function asks
            return
        self._stepping = True
        try:
            while now - self._stepped_ns >= STEP_NS:
                self._stepped_ns += STEP_NS - self._stepped_ns % STEP_NS
                for index, obstacle in enumerate(self.obstacles):
                    self._standing[index] = obstacle, (obstacle.shape, obstacle.pose(self._stepped_ns))
                for body in stepping:
                    motion = body.motion
                    motion.step(self._stepped_ns)
                    if body in self._places:
                        place = self._places[body]
                        shape, _ = self._standing[place][1]
                        self._standing[place] = body, (shape, motion.standing_pose(self._stepped_ns))
        finally:
            self._stepping = False

    def _stand(self) -> None:
        self._standing = self._everybody(self._stepped_ns, lambda body: body.motion.standing_pose(self._stepped_ns))
        self._places = {other: index for index, (other, _) in enumerate(self._standing) if not isinstance(other, Obstacle)}

    def _everybody(self, time_ns: int, pose_of: Callable[[Body], Pose]) -> list[tuple[Body | Obstacle, Placed]]:
        everybody: list[tuple[Body | Obstacle, Placed]] = [
            (obstacle, (obstacle.shape, obstacle.pose(time_ns))) for obstacle in self.obstacles
        ]
        everybody += [(body, (body.footprint, pose_of(body))) for body in self._bodies if body.footprint is not None]
        return everybody


def _named(other: Body | Obstacle) -> str:
    return f"obstacle {other.name}" if isinstance(other, Obstacle) else f"robot {other.body_name}"
