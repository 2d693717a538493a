"""Occupancy grids from map files, to map files, and from generators of floor plans."""

from .floor_plans import floor_plan
from .map_files import load_map, save_map

__all__ = ["floor_plan", "load_map", "save_map"]
