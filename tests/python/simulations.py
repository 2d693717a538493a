"""Maps, simulations and commands that several tests share."""

from __future__ import annotations

import math

import numpy as np

import mobile_robot_simulator as mrs

SEED = 11


def hall(size: float = 20.0) -> mrs.OccupancyGrid:
    """Returns a square hall. The inner faces of its walls are at 0.1 m and size - 0.1 m."""
    cells = np.zeros((round(size * 10),) * 2, np.int8)
    cells[[0, -1], :] = cells[:, [0, -1]] = 100
    return mrs.OccupancyGrid(cells, resolution=0.1)


def simulation(start: tuple[float, float, float] = (2.0, 2.0, 0.0), **parameters: object) -> mrs.Simulation:
    """Returns a simulation of a hall without noise, with a scanner of 360 degrees. Commands hold until the next one."""
    quiet = {"apply_noise": False, "velocity_timeout": 0, "laser_beam_count": 61, "laser_fov": 2 * math.pi}
    return mrs.Simulation(hall(), parameters={**quiet, **parameters}, seed=SEED, start=start)


def small_room() -> mrs.Simulation:
    """Returns a simulation of 5 m by 5 m with a wall at its lower side. Commands hold until the next one."""
    cells = np.zeros((50, 50), np.int8)
    cells[0] = 100
    grid = mrs.OccupancyGrid(cells, resolution=0.1)
    return mrs.Simulation(grid, parameters={"velocity_timeout": 0, "laser_beam_count": 11}, start=(1, 1, 0))


def open_field(**parameters: object) -> mrs.Simulation:
    """Returns a simulation of a hall of 20 m with a robot at (5, 5). Commands hold until the next one."""
    quiet = {"velocity_timeout": 0, "laser_beam_count": 61, "laser_fov": 3.0}
    return mrs.Simulation(hall(), parameters={**quiet, **parameters}, seed=5, start=(5, 5, 0))


def pair(**parameters: object) -> mrs.Simulation:
    """Returns a simulation of two robots that face each other, 4 m apart. Commands hold until the next one."""
    quiet = {"apply_noise": False, "velocity_timeout": 0, "laser_beam_count": 60, "laser_fov": 2 * math.pi}
    robots = {"robot1": (5.0, 10.0, 0.0), "robot2": (9.0, 10.0, math.pi)}
    return mrs.Simulation(hall(), parameters={**quiet, **parameters}, seed=SEED, robots=robots)


def twist(vx: float = 0.0, vy: float = 0.0, wz: float = 0.0) -> mrs.messages.Twist:
    """Returns a velocity command: forward and to the left [m/s], counterclockwise [rad/s]."""
    return mrs.messages.Twist(linear=mrs.messages.Vector3(x=vx, y=vy), angular=mrs.messages.Vector3(z=wz))


def drive(sim: mrs.Simulation, vx: float = 0.5, wz: float = 0.0, vy: float = 0.0, topic: str = "/cmd_vel") -> None:
    """Publishes a velocity command."""
    sim.publish(topic, twist(vx, vy, wz))


def arrivals(sim: mrs.Simulation, topic: str, seconds: float) -> list[tuple[float, float]]:
    """Runs a simulation for a while. Returns the arrival time and the stamp [s] of each message of a topic."""
    times: list[tuple[float, float]] = []
    start_ns = round(sim.time * 1e9)

    def tap(name: str, message: mrs.messages.Message, time_ns: int) -> None:
        if name == topic and time_ns > start_ns:
            times.append((time_ns / 1e9, message.header.stamp.nanoseconds / 1e9))

    sim.record(tap)
    sim.run_for(seconds)
    sim.stop_recording(tap)
    return times


def notes(sim: mrs.Simulation, seconds: float) -> list[str]:
    """Runs a simulation for a while. Returns what faults report meanwhile."""
    texts: list[str] = []
    subscription = sim.subscribe("/faults", mrs.messages.String, lambda message: texts.append(message.data))
    sim.run_for(seconds)
    sim.unsubscribe(subscription)
    return texts
