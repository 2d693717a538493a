"""map_server and AMCL (ros-planning/navigation), which serve the map and find the robot in it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import mobile_robot_simulator as mrs
from office import Office
from workspace import client_environment, find_program
from worlds import wait_until

AMCL = {
    # Of AMCL's models, only the corrected one lets the noise of short steps add up as that of wheels does.
    "odom_model_type": "diff-corrected",
    **{f"odom_alpha{number}": 0.02 for number in (1, 2, 3, 4)},
    "min_particles": 500,
    "max_particles": 30000,
    "laser_max_beams": 120,
    "laser_max_range": 29.0,
    "recovery_alpha_slow": 0.001,
    "recovery_alpha_fast": 0.1,
    "update_min_d": 0.1,
    "update_min_a": 0.1,
    "transform_tolerance": 0.5,
}


def start_localized(world: Any, map_file: Path, start: mrs.Pose, offset: mrs.Pose) -> Office:
    """Starts map_server, the robot, and AMCL, which believes that the robot starts elsewhere: at `start * offset`."""
    amcl, map_server = find_program("amcl", "amcl"), find_program("map_server", "map_server")
    environment = client_environment(world.environment)
    world.run(map_server, str(map_file), environment=environment)
    office = Office(world, None, start)
    believed = {f"initial_pose_{name}": value for name, value in zip("xya", start * offset, strict=True)}
    world.run(amcl, *world.arguments({**AMCL, **believed}, ()), environment=environment)
    wait_until(lambda: office.tf_error() is not None, "a pose from AMCL")
    return office
