"""svg: dark lines become walls and dark fills areas, in drawings written by hand."""

from __future__ import annotations

import re
import sys
from pathlib import Path

import numpy as np
import pytest

import mobile_robot_simulator as mrs

pytest.importorskip("svgelements", reason="the extra `worlds` is not installed")

WALL = "fill='none' stroke='black'"


def write(folder: Path, *elements: str, attributes: str = "width='8' height='8'", start: str = "") -> Path:
    path = folder / "plan.svg"
    path.write_text(
        f"{start}<svg xmlns='http://www.w3.org/2000/svg' {attributes}>{''.join(elements)}</svg>", encoding="utf-8"
    )
    return path


def drawn(path: Path, resolution: float = 1.0, unit: float | None = None) -> list[str]:
    """The cells without the free margin, top row first."""
    grid = mrs.load_map(path, resolution=resolution, unit=unit)
    return ["".join("#" if cell else "." for cell in row) for row in grid.cells[::-1]]


def test_y_points_down_in_a_drawing_and_up_in_the_map(tmp_path: Path) -> None:
    path = write(tmp_path, "<rect x='1' y='1' width='2' height='1'/>", "<rect x='1' y='2' width='1' height='2'/>")
    assert drawn(path) == ["....", ".##.", ".#..", ".#..", "...."]
    assert tuple(mrs.load_map(path, resolution=1.0).origin) == (0.0, -5.0, 0.0)


def test_lines_are_walls_without_thickness(tmp_path: Path) -> None:
    lines = (
        f"<path d='M 0.5 0.5 H 3.5 V 2.5' {WALL} stroke-width='9'/>",
        "<line x1='.5' y1='2.5' x2='1.5' y2='2.5' stroke='#222'/>",
    )
    assert drawn(write(tmp_path, *lines)) == ["......", ".####.", "....#.", ".##.#.", "......"]


def test_the_outline_of_a_room_has_a_free_inside(tmp_path: Path) -> None:
    path = write(tmp_path, f"<rect x='0.5' y='0.5' width='3' height='2' {WALL}/>")
    assert drawn(path) == ["......", ".####.", ".#..#.", ".####.", "......"]


@pytest.mark.parametrize(("rule", "middle"), [("evenodd", "."), ("nonzero", "#")])
def test_fill_rules(tmp_path: Path, rule: str, middle: str) -> None:
    path = write(tmp_path, f"<path d='M0 0H3V3H0Z M1 1H2V2H1Z' style='fill-rule:{rule}'/>")
    assert drawn(path) == [".....", ".###.", f".#{middle}#.", ".###.", "....."]


@pytest.mark.parametrize(
    ("style", "is_obstacle"),
    [
        ("fill='#7f7f7f'", True),
        ("fill='#818181'", False),
        ("fill='white'", False),
        ("fill='none'", False),
        ("fill='black' fill-opacity='0.6'", True),
        ("fill='black' fill-opacity='0.4'", False),
        ("visibility='hidden'", False),
        ("display='none'", False),
        ("fill='url(#gradient)'", True),
    ],
)
def test_what_is_dark_is_an_obstacle(tmp_path: Path, style: str, is_obstacle: bool) -> None:
    path = write(tmp_path, f"<rect x='2' width='1' height='1' {style}/><rect width='1' height='1'/>")
    assert drawn(path) == ([".....", ".#.#.", "....."] if is_obstacle else ["...", ".#.", "..."])


def test_only_what_is_drawn_counts(tmp_path: Path) -> None:
    hidden = ("mask", "marker", "clipPath", "pattern", "symbol", "defs")
    parts = [f"<{name} id='{name}'><rect width='9' height='9'/></{name}>" for name in hidden]
    symbol = "<symbol id='s'><rect width='1' height='1'/></symbol>"
    path = write(tmp_path, *parts, symbol, "<use href='#s' x='2'/>", "<use href='#s' y='1'/>", "<text y='9'>no wall</text>")
    assert drawn(path) == [".....", "...#.", ".#...", "....."]


def test_a_declared_encoding_does_not_matter(tmp_path: Path) -> None:
    start = "<?xml version='1.0' encoding='ISO-8859-1'?>"
    text = write(tmp_path, "<!-- caf\xe9 --><rect width='1' height='1'/>", start=start).read_text(encoding="utf-8")
    for encoding in ("latin-1", "utf-8", "utf-16"):
        (tmp_path / "plan.svg").write_bytes(text.encode(encoding))
        assert drawn(tmp_path / "plan.svg") == ["...", ".#.", "..."]


def test_coordinates_are_those_of_the_view_box(tmp_path: Path) -> None:
    rect = "<g transform='translate(1 0)'><rect width='2' height='1'/></g>"
    for attributes in ("width='210mm' height='297mm' viewBox='0 0 8 8'", "viewBox='0 0 8 8'", "width='8' height='8'", ""):
        path = write(tmp_path, rect, attributes=attributes)
        grid = mrs.load_map(path, resolution=0.5, unit=0.5)
        assert (grid.shape, tuple(grid.origin)) == ((3, 4), (0.0, -1.0, 0.0)), attributes


def test_a_circle_covers_the_cells_that_it_reaches(tmp_path: Path) -> None:
    grid = mrs.load_map(write(tmp_path, "<circle cx='2' cy='-2' r='1.5'/>"), resolution=0.1)
    rows, cols = np.indices(grid.shape)
    x, y = cols * 0.1 + grid.origin.x, rows * 0.1 + grid.origin.y
    distances = np.hypot(2 - np.clip(2, x, x + 0.1), 2 - np.clip(2, y, y + 0.1))
    assert (grid.cells[distances < 1.5 - 0.001] == 100).all() and (grid.cells[distances > 1.5 + 0.001] == 0).all()


@pytest.mark.parametrize(
    ("elements", "message"),
    [
        ("", "must have a wall or an area, got none"),
        ("<rect width='1'", "not valid XML: not well-formed"),
        ("<rect width='1e9' height='1'/>", "a grid must have at most"),
        ("<path d='M 0 0 L 1e999 0' stroke='black'/>", "not a valid drawing: coordinates must be finite"),
        ("<!ENTITY a 'b'>", "must define no entities"),
    ],
)
def test_drawings_that_are_empty_or_malformed_are_errors(tmp_path: Path, elements: str, message: str) -> None:
    path = write(tmp_path, elements)
    with pytest.raises(ValueError, match=re.escape(f"{path}: {message}")):
        mrs.load_map(path)


def test_another_namespace_is_an_error(tmp_path: Path) -> None:
    (tmp_path / "plan.svg").write_text("<svg><rect width='1' height='1'/></svg>")
    with pytest.raises(ValueError, match=r"the first element must be svg of http://www\.w3\.org/2000/svg, got 'svg'"):
        mrs.load_map(tmp_path / "plan.svg")


def test_without_the_extra_the_error_says_what_to_install(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "svgelements", None)
    with pytest.raises(ImportError, match=r"pip install 'mobile-robot-simulator\[worlds\]'"):
        mrs.load_map(write(tmp_path, "<rect width='1' height='1'/>"))
