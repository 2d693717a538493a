"""The command `mobile-robot-simulator`."""

from .main import main

__all__ = ["main"]
