"""The command floor-plan."""

import numpy as np

import mobile_robot_simulator as mrs


def test_floor_plan_writes_a_map(command, tmp_path):
    file = tmp_path / "deep" / "office.yaml"
    assert command("floor-plan", file, "--seed", 2).returncode == 0
    assert np.array_equal(mrs.load_map(file).cells, mrs.floor_plan("office", seed=2).cells)
