"""Crossing: a small space with a controller that fails in few of its worlds, as a case for searches."""

from __future__ import annotations

from mobile_robot_simulator.requirements import always, clearance
from mobile_robot_simulator.scenarios import Moving, Range, Space, WorldMap

ROBOT = {"robot_radius": 0.25, "laser_beam_count": 11, "apply_noise": False, "publish_map_transform": False}
SPACE = Space(
    [WorldMap("room", size=(6.0, 6.0), resolution=0.1)],
    start=(1.0, 3.0, 0.0),
    goal=None,
    obstacles=Moving(4, radius=Range(0.05, 0.15, "m")),
    parameters=ROBOT,
    duration=3.0,
)


class Crosser:
    """Drives straight on, across the room."""

    def __init__(self, sim):
        pass

    def __call__(self, seen):
        return 0.5, 0.0


class Halting(Crosser):
    """Drives a little, and stays where no obstacle can be."""

    def __call__(self, seen):
        return (0.5, 0.0) if seen.time < 0.6 else (0.0, 0.0)


controller, requirement, space = Crosser, always(clearance > 0.0), SPACE
