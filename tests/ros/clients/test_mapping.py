"""gmapping (ros-perception/slam_gmapping) draws the office from scans and drifting odometry."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

import mobile_robot_simulator as mrs
from office import LOOP, Office, save_office, share_near_walls
from test_nodes import MAP, pose_of
from workspace import client_environment, find_program
from worlds import wait_until

GMAPPING = {
    # Far enough to see the end of each corridor: elsewhere in a corridor, all scans look the same.
    "maxUrange": 28.0,
    "maxRange": 29.0,
    "particles": 30,
    "linearUpdate": 0.4,
    "angularUpdate": 0.2,
    "map_update_interval": 2.0,
    "xmin": -5.0,
    "ymin": -5.0,
    "xmax": 45.0,
    "ymax": 30.0,
    "delta": 0.05,
}


def test_gmapping_draws_the_walls_where_they_are(world: Any, tmp_path: Path) -> None:
    gmapping = find_program("gmapping", "slam_gmapping")
    map_file = save_office(tmp_path)
    office = Office(world, map_file)
    # The drawn map has a topic of its own, because the laser measures in the true one.
    drawn = world.subscribe("drawn_map", MAP)
    arguments = world.arguments(GMAPPING, ("map:=drawn_map",))
    world.run(gmapping, *arguments, environment=client_environment(world.environment))
    wait_until(lambda: office.tf_error() is not None, "a pose from gmapping")
    errors = np.array([office.tf_error() for _ in office.drive(LOOP)])
    # gmapping draws only while the robot drives, so this is the last map.
    info, data = drawn[-1].info, drawn[-1].data
    grid = mrs.OccupancyGrid(
        np.asarray(data, np.int8).reshape(info.height, info.width),
        resolution=info.resolution,
        origin=pose_of(info.origin.position, info.origin.orientation),
    )
    count = np.count_nonzero(grid.cells >= grid.occupied_threshold)
    share = share_near_walls(grid, mrs.load_map(map_file), 0.1)
    print(f"gmapping: {share:.1%} of {count} cells within 0.1 m of walls")
    print(f"gmapping: pose median {np.median(errors):.3f} m, largest {errors.max():.3f} m")
    print(f"gmapping: odometry {office.odometry_error():.2f} m")
    assert office.odometry_error() > 0.5
    assert count > 2000
    assert share >= 0.9
    assert errors.max() < 0.5
