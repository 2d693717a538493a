"""A live view of a simulation in the browser: `Simulation.show` and the command `live`. It needs the extra `live`."""

from .view import LiveView

__all__ = ["LiveView"]
