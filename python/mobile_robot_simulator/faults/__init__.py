"""Faults for simulations: lost or late messages, a blocked scanner, slipping wheels, pushes, stopped nodes, jumping clocks.

A fault is added with `Simulation.add_fault`. It acts from its `start` until just before its `end`, in simulated time. Faults
are seeded: the same fault always disturbs the same simulation in the same way. Each fault reports its actions on the topic
`/faults` (std_msgs/String). Several faults of one topic apply in the order in which they were added. Recordings contain the
messages after all faults.

Example:
    >>> import numpy as np
    >>> import mobile_robot_simulator as mrs
    >>> sim = mrs.Simulation(mrs.OccupancyGrid(np.zeros((100, 100), np.int8), resolution=0.1), start=(5.0, 5.0, 0.0))
    >>> sim.add_fault(mrs.faults.Blackout("/scan", start=1.0, end=2.0))
    Blackout('/scan', start=1 s, end=2 s)
    >>> sim.run_for(1.5)
    >>> sim.latest("/faults").data
    'blackout of /scan'
"""

from ..simulation.fault import Fault
from .messages import Blackout, BlockedSector, Delay, Drop, Duplicate, MessageFault, Reorder, StuckRanges
from .robots import ClockJump, OdometryDrift, Outage, Push, Slip

__all__ = [
    "Blackout",
    "BlockedSector",
    "ClockJump",
    "Delay",
    "Drop",
    "Duplicate",
    "Fault",
    "MessageFault",
    "OdometryDrift",
    "Outage",
    "Push",
    "Reorder",
    "Slip",
    "StuckRanges",
]
