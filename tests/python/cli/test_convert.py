"""The command convert, and worlds in other commands."""

import json

import numpy as np

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
