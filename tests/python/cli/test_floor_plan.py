"""The command floor-plan."""

import numpy as np

import mobile_robot_simulator as mrs


def test_floor_plan_writes_a_map(command, tmp_path):
    file = tmp_path / "office.yaml"
    assert command("floor-plan", file, "--seed", 2).returncode == 0
    assert np.array_equal(mrs.load_map(file).cells, mrs.floor_plan("office", seed=2).cells)


def test_floor_plan_makes_no_folder(command, tmp_path):
    done = command("floor-plan", tmp_path / "deep" / "office.yaml")
    assert done.returncode == 1 and "no such folder" in done.stderr and "Traceback" not in done.stderr
    assert list(tmp_path.iterdir()) == []
