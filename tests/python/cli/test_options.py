"""Options: parameter values, seeds and maps that commands read from them."""

import numpy as np
import pytest

import mobile_robot_simulator as mrs
from mobile_robot_simulator.cli.options import load_grid, read_values, seed_of


def test_assignments_override_the_file(tmp_path):
    file = tmp_path / "parameters.yaml"
    file.write_text("laser_scanner_simulator_node:\n  ros__parameters:\n    laser_beam_count: 5\n    laser_fov: 1.0\n")
    values = read_values(["laser_beam_count:=7"], file)
    assert values == {"laser_scanner_simulator_node:laser_fov": 1.0, "laser_beam_count": 7}
    assert read_values(None, None) == {}


def test_the_seed_of_the_command_line_comes_first():
    assert seed_of(3, {"seed": 5}) == 3
    assert seed_of(None, {"seed": 5}) == 5
    assert seed_of(None, {}) == 0
    with pytest.raises(ValueError, match="seed must be in"):
        seed_of(-1, {})


def test_unknown_cells_block_beams_if_the_parameter_says_so(tmp_path):
    cells = np.array([[0, -1, 100]], np.int8)
    file = tmp_path / "map.yaml"
    mrs.save_map(mrs.OccupancyGrid(cells, resolution=1.0), file)
    for unknown in ("free", "occupied"):
        assert load_grid(file, {"unknown": unknown}).unknown == unknown


def test_a_hint_says_when_no_cell_is_unknown(tmp_path, capsys):
    file = tmp_path / "map.yaml"
    for cells, unknown, hinted in (([[0, 100]], "occupied", True), ([[0, 100]], "free", False), ([[-1]], "occupied", False)):
        mrs.save_map(mrs.OccupancyGrid(np.array(cells, np.int8), resolution=1.0), file)
        load_grid(file, {"unknown": unknown})
        assert ("no cell is unknown, so unknown:=occupied has no effect" in capsys.readouterr().err) is hinted
