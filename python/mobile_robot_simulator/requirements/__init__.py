"""Requirements on drives as numbers: how far a drive was from violating them, and when.

A *signal* is a number over time, measured on the ground truth: `clearance`, `speed`, `goal_distance` and others. Comparing
it with a limit gives a requirement. `&`, `|`, `~`, `always`, `eventually` and `until` make requirements of requirements. The
*robustness* of a requirement says by how much it holds: positive if it holds, negative if it is violated. This is the
signal temporal logic of A. Donzé and O. Maler, *Robust satisfaction of temporal logic over real-valued signals*, FORMATS
2010, on samples.

Example:
    >>> import numpy as np
    >>> import mobile_robot_simulator as mrs
    >>> from mobile_robot_simulator.requirements import Trace, always, eventually, goal_distance, speed
    >>> grid = mrs.OccupancyGrid(np.zeros((100, 100), np.int8), resolution=0.1)
    >>> sim = mrs.Simulation(grid, start=(1.0, 5.0, 0.0), parameters={"velocity_timeout": 0.0})
    >>> sim.goal = (3.0, 5.0)
    >>> sim.publish("/cmd_vel", mrs.messages.Twist(linear=mrs.messages.Vector3(x=0.5)))
    >>> sim.run_for(5.0)
    >>> safe = always(speed < 0.75) & eventually(goal_distance < 0.5, within=(0.0, 3.5))
    >>> safe
    always(speed < 0.75 m/s) & eventually(goal_distance < 0.5 m, within=(0 s, 3.5 s))
    >>> round(safe.robustness(Trace(sim)), 6)
    0.25
"""

from .formula import Requirement, always, eventually, until
from .signals import (
    Signal,
    acceleration,
    clearance,
    distance_to,
    goal_distance,
    inside,
    jerk,
    speed,
    time_to_contact,
    turn_rate,
)
from .trace import Trace

__all__ = [
    "Requirement",
    "Signal",
    "Trace",
    "acceleration",
    "always",
    "clearance",
    "distance_to",
    "eventually",
    "goal_distance",
    "inside",
    "jerk",
    "speed",
    "time_to_contact",
    "turn_rate",
    "until",
]
