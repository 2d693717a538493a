"""formats: the content of a file decides its format, and an unknown one gets a list of the known ones."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import mobile_robot_simulator as mrs

DRAWINGS = {
    "small.svg": b"<?xml version='1.0'?><!DOCTYPE svg><svg xmlns='http://www.w3.org/2000/svg'>"
    b"<rect width='2' height='1'/></svg>",
    "small.dxf": b"0\nSECTION\n2\nENTITIES\n0\nLINE\n8\n0\n10\n0\n20\n0\n11\n2\n21\n1\n0\nENDSEC\n0\nEOF\n",
}
"""Small drawings. They need the extra `worlds`."""

WORLDS = {
    "small.map": b"type octile\nheight 2\nwidth 3\nmap\n..@\n...\n",
    "small.json": b'{"verts": [[0, 0], [2, 0], [2, 1], [0, 1]], "id": "small"}',
    "small.world": b"""<?xml version="1.0" ?>
        <!-- small -->
        <sdf version="1.6"><world name="default"><model name="a"><link name="b"><collision name="c">
        <geometry><cylinder><radius>1</radius><length>1</length></cylinder></geometry>
        </collision></link></model></world></sdf>""",
    **DRAWINGS,
}
"""One small file of each format."""

worlds = pytest.mark.parametrize("name", WORLDS)


def write(folder: Path, name: str, other_name: str | None = None) -> Path:
    path = folder / (other_name or name)
    path.write_bytes(WORLDS[name])
    if name in DRAWINGS:
        pytest.importorskip("svgelements", reason="the extra `worlds` is not installed")
        pytest.importorskip("ezdxf", reason="the extra `worlds` is not installed")
    return path


@pytest.mark.parametrize("name", DRAWINGS)
def test_a_drawing_may_have_a_unit(tmp_path: Path, name: str) -> None:
    grid = mrs.load_map(write(tmp_path, name), resolution=0.25, unit=0.5)
    assert grid.shape[1] in (4 + 2, 5 + 2) and grid.resolution == 0.25


@pytest.mark.parametrize("name", sorted({*WORLDS} - {*DRAWINGS}))
def test_others_may_not(tmp_path: Path, name: str) -> None:
    with pytest.raises(ValueError, match=r"only drawings, SVG and DXF, have a unit, so none can be given here; got 0\.5"):
        mrs.load_map(write(tmp_path, name), unit=0.5)


@worlds
def test_the_content_decides_and_not_the_ending(tmp_path: Path, name: str) -> None:
    grid = mrs.load_map(write(tmp_path, name))
    assert 0 < (grid.cells == 100).sum() < grid.cells.size
    for other in ("world", "world.txt", "world.map"):
        same = mrs.load_map(write(tmp_path, name, other))
        assert np.array_equal(same.cells, grid.cells) and same.origin == grid.origin


@worlds
def test_options_of_the_grid_reach_it(tmp_path: Path, name: str) -> None:
    grid = mrs.load_map(write(tmp_path, name), occupied_threshold=70, unknown="occupied", resolution=0.25)
    assert (grid.occupied_threshold, grid.unknown, grid.resolution) == (70, "occupied", 0.25)


@worlds
def test_a_converted_map_is_the_same(tmp_path: Path, name: str) -> None:
    grid = mrs.load_map(write(tmp_path, name))
    mrs.save_map(grid, tmp_path / "map.yaml")
    same = mrs.load_map(tmp_path / "map.yaml")
    assert np.array_equal(same.cells, grid.cells)
    assert (same.resolution, same.origin) == (grid.resolution, grid.origin)


@pytest.mark.parametrize("data", [b"", b"hello\n", b"\x1f\x8b\x08", b"<html></html>", bytes(100)])
def test_an_unknown_format_is_an_error_that_says_what_is_known(tmp_path: Path, data: bytes) -> None:
    path = tmp_path / "world.bin"
    path.write_bytes(data)
    with pytest.raises(ValueError) as caught:
        mrs.load_map(path)
    assert str(caught.value) == (
        f"{path}: the format of this map is unknown; the known formats are map_server (.yaml, .yml), MovingAI map (.map), "
        "HouseExpo (.json), Gazebo world (.world, .sdf), SVG (.svg), DXF (.dxf)"
    )


def test_a_map_server_file_may_have_any_ending(tmp_path: Path) -> None:
    mrs.save_map(mrs.OccupancyGrid(np.zeros((2, 3), np.int8), resolution=0.5), tmp_path / "map.yaml")
    (tmp_path / "map.yaml").rename(tmp_path / "map.txt")
    assert mrs.load_map(tmp_path / "map.txt").shape == (2, 3)


def test_an_image_with_any_ending_is_called_one(tmp_path: Path) -> None:
    (tmp_path / "map.pgm").write_bytes(b"P5\n3 2\n255\n......")
    with pytest.raises(ValueError, match="this is an image; give the YAML file of the map"):
        mrs.load_map(tmp_path / "map.pgm")


@pytest.mark.parametrize(
    ("resolution", "error", "message"),
    [
        (0.0, ValueError, r"resolution must be positive and finite \[m\], got 0.0"),
        (float("nan"), ValueError, r"resolution must be positive and finite \[m\], got nan"),
        (float("inf"), ValueError, r"resolution must be positive and finite \[m\], got inf"),
        ("0.05", TypeError, r"resolution must be a number \[m\], got str"),
        (True, TypeError, r"resolution must be a number \[m\], got bool"),
    ],
)
def test_a_size_of_cells_that_is_none_is_an_error(
    tmp_path: Path, resolution: Any, error: type[Exception], message: str
) -> None:
    with pytest.raises(error, match=message):
        mrs.load_map(write(tmp_path, "small.map"), resolution=resolution)


def test_a_map_server_file_has_its_own_resolution(tmp_path: Path) -> None:
    mrs.save_map(mrs.OccupancyGrid(np.zeros((2, 3), np.int8), resolution=0.5), tmp_path / "map.yaml")
    with pytest.raises(
        ValueError, match=r"the YAML file of a map gives its resolution, so none can be given here; got 0\.1"
    ):
        mrs.load_map(tmp_path / "map.yaml", resolution=0.1)
