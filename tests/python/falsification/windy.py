"""Windy: a robot that drives along a corridor by its odometry alone, which pushes do not change."""

from __future__ import annotations

from mobile_robot_simulator.requirements import always, clearance
from mobile_robot_simulator.scenarios import Drift, Pushes, Range, Slips, Space, WorldMap

space = Space(
    [WorldMap("room", size=(8.0, 2.0), resolution=0.1)],
    start=(1.0, 1.0, 0.0),
    goal=None,
    parameters={"robot_radius": 0.25, "laser_beam_count": 11, "apply_noise": False},
    duration=8.0,
    disturbances=[Pushes(3, duration=Range(0.5, 3.0, "s"), speed=Range(0.05, 0.4, "m/s")), Slips(2), Drift()],
)
requirement = always(clearance > 0.0)


def controller(sim):
    """Drives 1 m straight on."""
    return lambda seen: (0.5 if seen.time < 2.0 else 0.0, 0.0)
