"""Sessions that several tests of the live view share."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import mobile_robot_simulator as mrs
from mobile_robot_simulator.live.inputs import read_input
from mobile_robot_simulator.live.journal import Journal
from mobile_robot_simulator.live.session import Session
from simulations import SEED, hall

TURN = 0.02
"""Wall time of a turn [s]."""


def robot(**parameters: Any) -> mrs.Simulation:
    """Returns a simulation of a hall with one robot at (3, 3)."""
    values = {"robot_radius": 0.2, "laser_frequency": 20.0, "laser_beam_count": 61}
    return mrs.Simulation(hall(), parameters={**values, **parameters}, seed=SEED, start=(3.0, 3.0, 0.0))


def session_of(simulation: mrs.Simulation, folder: Path = Path("live")) -> Session:
    return Session(simulation, Journal(), folder)


def do(session: Session, kind: str, **values: Any) -> Any:
    """Lets a session do an input, as a page sends it."""
    return session.do(read_input({"kind": kind, **values}))


def turns(session: Session, seconds: float, wall: float = 100.0) -> float:
    """Runs turns for a wall time. Returns the wall time at the end."""
    for _ in range(round(seconds / TURN)):
        wall += TURN
        session.turn(wall)
    return wall
