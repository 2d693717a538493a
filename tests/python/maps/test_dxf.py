"""dxf: entities become walls and areas, in drawings that ezdxf writes and in one written by hand."""

from __future__ import annotations

import re
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import mobile_robot_simulator as mrs

ezdxf = pytest.importorskip("ezdxf", reason="the extra `worlds` is not installed")

BY_HAND = "0\nSECTION\n2\nENTITIES\n0\nLINE\n8\n0\n10\n0.5\n20\n0.5\n11\n2.5\n21\n0.5\n0\nENDSEC\n0\nEOF\n"
METRES = 6
MILLIMETRES = 4


def save(folder: Path, document: Any, kind: str = "asc") -> Path:
    document.saveas(folder / "plan.dxf", fmt=kind)
    return folder / "plan.dxf"


def drawn(path: Path, resolution: float = 1.0, unit: float | None = None) -> list[str]:
    grid = mrs.load_map(path, resolution=resolution, unit=unit)
    return ["".join("#" if cell else "." for cell in row) for row in grid.cells[::-1]]


@pytest.mark.parametrize("start", ["", "999\nwritten by hand\n", "  "])
def test_a_file_written_by_hand(tmp_path: Path, start: str) -> None:
    (tmp_path / "plan.dxf").write_text(start + BY_HAND)
    assert drawn(tmp_path / "plan.dxf") == [".....", ".###.", "....."]


@pytest.mark.parametrize("kind", ["asc", "bin"])
def test_y_points_up_and_both_kinds_of_files_are_read(tmp_path: Path, kind: str) -> None:
    document = ezdxf.new(units=METRES)
    document.modelspace().add_lwpolyline([(0.5, 3.5), (0.5, 0.5), (2.5, 0.5)])
    path = save(tmp_path, document, kind)
    assert drawn(path) == [".....", ".#...", ".#...", ".#...", ".###.", "....."]
    assert tuple(mrs.load_map(path, resolution=1.0).origin) == (-1.0, -1.0, 0.0)


@pytest.mark.parametrize(
    ("units", "unit", "metres"), [(METRES, None, 1.0), (MILLIMETRES, None, 0.001), (0, None, 1.0), (1, 0.5, 0.5)]
)
def test_units(tmp_path: Path, units: int, unit: float | None, metres: float) -> None:
    document = ezdxf.new(units=units)
    document.modelspace().add_line((0, 0), (4 / metres, 2 / metres))
    grid = mrs.load_map(save(tmp_path, document), resolution=0.5, unit=unit)
    assert grid.shape == (6, 10)


def test_all_lines_are_walls_and_solids_are_areas(tmp_path: Path) -> None:
    document = ezdxf.new(units=METRES)
    space = document.modelspace()
    space.add_solid([(0, 0), (2, 0), (0, 2), (2, 2)])
    hatch = space.add_hatch()
    hatch.paths.add_polyline_path([(4, 0), (7, 0), (7, 3), (4, 3)], is_closed=True)
    hatch.paths.add_polyline_path([(5, 1), (6, 1), (6, 2), (5, 2)], is_closed=True)
    space.add_lwpolyline([(0.5, 3.5), (3.5, 3.5), (3.5, 4.5), (0.5, 4.5)], close=True)
    space.add_text("no wall").set_placement((20, 20))
    pattern = space.add_hatch()
    pattern.set_pattern_fill("ANSI31")
    pattern.paths.add_polyline_path([(9, 9), (10, 9), (10, 10)], is_closed=True)
    assert drawn(save(tmp_path, document)) == [
        ".........",
        ".####....",
        ".####....",
        ".....###.",
        ".##..#.#.",
        ".##..###.",
        ".........",
    ]


def test_circles_arcs_ellipses_and_splines_are_close_to_their_curve(tmp_path: Path) -> None:
    document = ezdxf.new(units=METRES)
    document.modelspace().add_circle((5, 5), 3)
    document.modelspace().add_arc((5, 5), 2, 0, 90)
    grid = mrs.load_map(save(tmp_path, document), resolution=0.05)
    rows, cols = np.nonzero(grid.cells)
    x, y = (cols + 0.5) * 0.05 + grid.origin.x - 5, (rows + 0.5) * 0.05 + grid.origin.y - 5
    radii = np.hypot(x, y)
    assert (np.minimum(abs(radii - 3), abs(radii - 2)) < 0.04).all()
    on_arc = radii < 2.5
    assert (x[on_arc] > -0.05).all() and (y[on_arc] > -0.05).all() and on_arc.sum() > 60


def test_blocks_are_read_and_hidden_layers_are_not(tmp_path: Path) -> None:
    document = ezdxf.new(units=METRES)
    block = document.blocks.new("DOOR")
    block.add_line((0.5, 0.5), (1.5, 0.5))
    space = document.modelspace()
    space.add_blockref("DOOR", (0, 0))
    space.add_blockref("DOOR", (4, 0), dxfattribs={"rotation": 90})
    document.layers.add("OFF").off()
    document.layers.add("FROZEN").freeze()
    for layer in ("OFF", "frozen"):
        space.add_line((0, 9), (9, 9), dxfattribs={"layer": layer})
    assert drawn(save(tmp_path, document)) == ["......", "....#.", ".##.#.", "......"]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (BY_HAND.replace("LINE", "POINT"), "must have a wall or an area, got none"),
        (BY_HAND.replace("2.5", "1e9"), "a grid must have at most"),
        (BY_HAND.replace("2.5", "nan"), "cannot be drawn: coordinates must be finite"),
        ("0\nSECTION\nhello\n", "not a valid DXF drawing: "),
        ("AutoCAD Binary DXF\r\n\x1a", "not a valid DXF drawing: "),
    ],
)
def test_drawings_that_are_empty_or_malformed_are_errors(tmp_path: Path, text: str, message: str) -> None:
    path = tmp_path / "plan.dxf"
    path.write_text(text)
    with pytest.raises(ValueError, match=re.escape(f"{path}: {message}")):
        mrs.load_map(path)


def test_a_block_that_contains_itself_does_not_hang(tmp_path: Path) -> None:
    document = ezdxf.new(units=METRES)
    block = document.blocks.new("LOOP")
    block.add_line((0, 0), (1, 0))
    block.add_blockref("LOOP", (1, 1))
    document.modelspace().add_blockref("LOOP", (0, 0))
    with pytest.raises(ValueError, match=r"blocks must be nested at most 32 times|must have a wall or an area"):
        mrs.load_map(save(tmp_path, document))


def test_without_the_extra_the_error_says_what_to_install(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "plan.dxf").write_text(BY_HAND)
    monkeypatch.setitem(sys.modules, "ezdxf.recover", None)
    with pytest.raises(ImportError, match=r"pip install 'mobile-robot-simulator\[worlds\]'"):
        mrs.load_map(tmp_path / "plan.dxf")
