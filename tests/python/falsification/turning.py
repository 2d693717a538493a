"""Turning: a space with a known rate of failure: the robot has a random heading and fails if it looks ahead."""

from __future__ import annotations

from mobile_robot_simulator.requirements import always, speed
from mobile_robot_simulator.scenarios import Free, Space, WorldMap

SPACE = Space(
    [WorldMap("room", size=(4.0, 4.0), resolution=0.1)],
    start=Free(1.5),
    goal=None,
    parameters={"laser_beam_count": 5, "apply_noise": False, "publish_map_transform": False},
    duration=0.3,
    is_noisy=False,
)
requirement = always(speed < 0.05)


class GoesWhereItLooks:
    """Drives if it starts with a heading of at most 1 rad to the side."""

    def __init__(self, sim):
        self.goes = abs(sim.pose.yaw) <= 1.0

    def __call__(self, seen):
        return 0.1 if self.goes else 0.0, 0.0


class Stands:
    """Never moves."""

    def __init__(self, sim):
        pass

    def __call__(self, seen):
        return 0.0, 0.0
