"""AMCL finds a robot whose odometry drifts, from scans that show where it truly is."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import mobile_robot_simulator as mrs
from localizer import start_localized
from office import LOOP, START, Route, save_office
from test_nodes import SET_POSE, pose_message
from worlds import wait_until

AROUND_THE_LOBBY: Route = ((15.5, 4.0), (15.5, 6.6), (2.0, 6.6), (9.0, 6.6))
"""Out of the lobby of the small office, and along its corridor."""
TOLERANCE = 0.15
"""Largest error of the estimated position [m]."""


def test_amcl_started_half_a_metre_off_converges_and_stays(world: Any, tmp_path: Path) -> None:
    office = start_localized(world, save_office(tmp_path), START, mrs.Pose(0.4, 0.3, 0.2))
    assert office.tf_error() == pytest.approx(0.5, abs=0.1)
    errors = [(at, office.tf_error()) for at in office.drive(LOOP)]
    late = np.array([error for at, error in errors if at > 20.0])
    drift = office.odometry_error()
    print(f"AMCL: median {np.median(late):.3f} m, largest {late.max():.3f} m; odometry {drift:.2f} m")
    assert drift > 0.5
    assert late.max() < TOLERANCE


def test_amcl_finds_a_kidnapped_robot_by_global_localization(world: Any, tmp_path: Path) -> None:
    map_file = save_office(tmp_path, seed=2, size=(18.0, 12.0))
    office = start_localized(world, map_file, mrs.Pose(3.0, 6.6, 0.0), mrs.Pose())
    for _ in office.drive(((5.0, 6.6),)):
        pass
    assert office.tf_error() < TOLERANCE
    world.call("set_pose", SET_POSE, pose=pose_message(12.0, 4.2, 0.5))
    wait_until(lambda: office.tf_error() > 3.0, "the kidnapping")
    world.call("global_localization", "std_srvs/srv/Empty")
    errors = [(at, office.tf_error()) for at in office.drive(AROUND_THE_LOBBY, speed=0.5)]
    late = np.array([error for at, error in errors if at > 20.0])
    found = next((at for at, error in errors if error < TOLERANCE), None)
    print(f"AMCL kidnapped: found after {found} s, later median {np.median(late):.3f} m, largest {late.max():.3f} m")
    assert np.median(late) < TOLERANCE
    assert late.max() < 2.0 * TOLERANCE
