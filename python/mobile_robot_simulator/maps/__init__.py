"""Occupancy grids: loaded from map files, saved to map files, and generated as floor plans."""

from .floor_plans import floor_plan
from .map_files import load_map, save_map

__all__ = ["floor_plan", "load_map", "save_map"]
