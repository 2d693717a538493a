"""Occupancy grids: loaded from map files, saved to map files, and generated as floor plans."""

from .floor_plans import floor_plan
from .formats import load_map
from .map_files import save_map
from .movingai import Scenario, load_scenarios

__all__ = ["Scenario", "floor_plan", "load_map", "load_scenarios", "save_map"]
