"""Faults for simulations: lost or late messages, a blocked scanner, slipping wheels, stopped nodes, jumping clocks.

A fault is added with `Simulation.add_fault`. It acts from its `start` until just before its `end`, in simulated time. Faults
are seeded: the same fault disturbs the same simulation in the same way every time. Each fault reports what it does on the
topic `/faults` (std_msgs/String). Recordings contain the messages as they are after all faults. Faults of one topic are
applied in the order in which they were added.
"""

from ..simulation.fault import Fault
from .messages import Blackout, BlockedSector, Delay, Drop, Duplicate, MessageFault, Reorder, StuckRanges
from .robots import ClockJump, OdometryDrift, Outage, Slip

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
    "Reorder",
    "Slip",
    "StuckRanges",
]
