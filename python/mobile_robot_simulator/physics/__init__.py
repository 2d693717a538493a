"""Physics of a simulation: motion of robots, obstacles, contact between them, and odometry."""

from .crowd import Placed
from .motion import ContactEvent
from .obstacles import Obstacle, PoseLike, Trajectory, Waypoints
from .velocity_profile import Velocity
from .world import Carrier, World

__all__ = ["Carrier", "ContactEvent", "Obstacle", "Placed", "PoseLike", "Trajectory", "Velocity", "Waypoints", "World"]
