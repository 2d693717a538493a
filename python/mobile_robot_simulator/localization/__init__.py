"""Localization: where in a map a scan was taken."""

from .location import Location, locate

__all__ = ["Location", "locate"]
