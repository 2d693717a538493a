"""WorldMap: rooms, floor plans and files, and the places of their lattice."""

from __future__ import annotations

import numpy as np
import pytest

import mobile_robot_simulator as mrs
from mobile_robot_simulator.maps.floor_plans import KINDS
from mobile_robot_simulator.scenarios import WorldMap, floor_plans


def test_a_room_is_empty_and_closed():
    grid = WorldMap("room", size=(2.0, 1.0), resolution=0.1).grid()
    assert grid.shape == (10, 20) and not grid.cells[1:-1, 1:-1].any()
    assert (grid.cells == 100).sum() == 2 * 20 + 2 * 8
    with pytest.raises(ValueError, match="a room must have 3 x 3 to 100 million cells, got 2 x 9"):
        WorldMap("room", size=(0.2, 0.9), resolution=0.1).grid()


def test_floor_plans_of_several_kinds():
    maps = floor_plans("maze", "office", seeds=(3, 5), size=(9.0, 8.0), resolution=0.1)
    assert [(map.kind, map.seed) for map in maps] == [("maze", 3), ("maze", 5), ("office", 3), ("office", 5)]
    assert (maps[1].grid().cells == mrs.floor_plan("maze", seed=5, size=(9.0, 8.0), resolution=0.1).cells).all()
    assert {map.kind for map in floor_plans()} == set(KINDS)


def test_places_are_all_points_of_the_lattice_where_the_disc_is_free():
    map = WorldMap("office", 2, (9.0, 8.0), 0.1)
    grid, radius = map.grid(), 0.4
    expected = []
    for x in np.arange(-8, 60) * 0.25:
        for y in np.arange(-8, 60) * 0.25:
            cell = grid.cell_at(x, y)
            if cell is not None and grid.cells[cell] == 0 and grid.is_free_disc(x, y, radius):
                expected.append((x, y))
    assert list(map.places(radius)) == expected and len(expected) > 100
    with pytest.raises(ValueError, match="must have a place for a disc of 9 m, it has none"):
        map.places(9.0)


def test_a_map_file_can_be_named_from_any_folder(tmp_path, monkeypatch):
    (tmp_path / "maps").mkdir()
    (tmp_path / "link").symlink_to(tmp_path / "maps")
    monkeypatch.chdir(tmp_path)
    for path in ("maps/a.yaml", "link/a.yaml", str(tmp_path / "maps" / "a.yaml")):
        named = WorldMap(path).in_folder(tmp_path / "cases" / "one")
        assert named.kind == "../../maps/a.yaml"
        assert named.from_folder(tmp_path / "cases" / "one").kind == str((tmp_path / "maps" / "a.yaml").resolve())
    for map in (WorldMap(), WorldMap("office", 3)):
        assert map.in_folder(tmp_path) == map == map.from_folder(tmp_path)


def test_a_relative_path_is_that_of_the_working_directory_of_the_moment(tmp_path, monkeypatch):
    for name, width in (("one", 20), ("two", 30)):
        (tmp_path / name).mkdir()
        mrs.save_map(mrs.OccupancyGrid(np.zeros((20, width), np.int8), resolution=0.1), tmp_path / name / "map.yaml")
        monkeypatch.chdir(tmp_path / name)
        assert WorldMap("map.yaml").grid().shape == (20, width)
        assert max(WorldMap("map.yaml").places(0.1))[0] == 0.1 * width - 0.25


def test_a_map_file_with_a_turned_origin(tmp_path):
    cells = np.zeros((20, 30), np.int8)
    cells[:, 0] = 100
    mrs.save_map(mrs.OccupancyGrid(cells, resolution=0.1, origin=(5.0, -3.0, np.pi / 2)), tmp_path / "map.yaml")
    places = WorldMap(str(tmp_path / "map.yaml")).places(0.15)
    assert {x for x, _ in places} == {3.25, 3.5, 3.75, 4.0, 4.25, 4.5, 4.75, 5.0}
    assert min(y for _, y in places) == -2.75 and max(y for _, y in places) == -0.25
