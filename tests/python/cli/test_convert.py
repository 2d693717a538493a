"""The command convert, and worlds in other commands."""

import json

import numpy as np
import pytest

import mobile_robot_simulator as mrs

ROOM = "type octile\nheight 12\nwidth 30\nmap\n" + "@" * 30 + "\n" + ("@" + "." * 28 + "@\n") * 10 + "@" * 30 + "\n"


def test_convert_writes_a_map_of_map_server(command, tmp_path):
    world, file = tmp_path / "room.map", tmp_path / "map.yaml"
    world.write_text(ROOM)
    assert command("convert", world, file, "--resolution", 0.5).returncode == 0
    converted = mrs.load_map(file)
    assert converted.resolution == 0.5
    assert np.array_equal(converted.cells, mrs.load_map(world).cells)
    assert "image: map.pgm" in file.read_text()


def test_convert_writes_nothing_if_the_world_is_wrong(command, tmp_path):
    (tmp_path / "room.map").write_text(ROOM[:-5])
    done = command("convert", tmp_path / "room.map", tmp_path / "map.yaml")
    assert done.returncode == 1 and "must have 12 x 30 = 360 cells, got 356" in done.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["room.map"]


def test_info_and_run_take_worlds(command, tmp_path):
    world = tmp_path / "room.map"
    world.write_text(ROOM)
    properties = json.loads(command("info", world, "--json").stdout)
    assert (properties["width"], properties["height"], properties["occupied"]) == (30, 12, 80)
    done = command("run", world, "--duration", 2, "--out", tmp_path / "drive")
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "drive" / "summary.json").exists()


def test_unknown_cells_of_worlds_are_no_matter_of_thresholds(command, tmp_path):
    (tmp_path / "room.map").write_text(ROOM)
    done = command("info", tmp_path / "room.map", "-p", "unknown:=occupied")
    assert done.returncode == 0 and done.stderr == ""


def test_worlds_have_the_cell_size_that_is_asked_for(command, tmp_path):
    world = tmp_path / "room.map"
    world.write_text(ROOM)
    assert json.loads(command("info", world, "--json", "--resolution", 0.5).stdout)["resolution"] == 0.5
    # From the middle of the room, the walls at the sides are 2.5 m away, and not 5 m.
    scan = ("scan", world, "--pose", 7.5, 3, 0, "--json", "--resolution", 0.5, "-p", "apply_noise:=false")
    assert min(json.loads(command(*scan).stdout)["ranges"]) == pytest.approx(2.5)
    out = tmp_path / "drive"
    for option, message in (
        ("--resolution", "resolution must be positive"),
        ("--unit", "only drawings, SVG and DXF, have a"),
    ):
        done = command("run", world, "--out", out, option, 0 if option == "--resolution" else 0.5)
        assert done.returncode == 1 and message in done.stderr and not out.exists()
