"""A square hall and simulations in it, shared by the tests of physics."""

from __future__ import annotations

import math

import numpy as np

import mobile_robot_simulator as mrs

SEED = 11


def hall(size: float = 20.0) -> mrs.OccupancyGrid:
    """A hall with the inner faces of its walls at 0.1 and size - 0.1 [m]."""
    cells = np.zeros((round(size * 10),) * 2, np.int8)
    cells[[0, -1], :] = cells[:, [0, -1]] = 100
    return mrs.OccupancyGrid(cells, resolution=0.1)


def simulation(start=(2.0, 2.0, 0.0), **parameters) -> mrs.Simulation:
    quiet = {"apply_noise": False, "velocity_timeout": 0, "laser_beam_count": 61, "laser_fov": 2 * math.pi}
    return mrs.Simulation(hall(), parameters={**quiet, **parameters}, seed=SEED, start=start)


def drive(sim: mrs.Simulation, vx: float, wz: float = 0.0, vy: float = 0.0, topic: str = "/cmd_vel") -> None:
    sim.publish(topic, mrs.messages.Twist(linear=mrs.messages.Vector3(x=vx, y=vy), angular=mrs.messages.Vector3(z=wz)))
