"""Faults that a simulation can be given: lost messages, slipping wheels, stopped nodes, jumping clocks.

Each fault is seeded, so that the same fault goes wrong in the same way each time.
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
