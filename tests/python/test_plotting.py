"""plotting: what is drawn lies where it is in the map, the same bytes every time, and no file is left half written."""

from __future__ import annotations

import importlib
import math
import subprocess
import sys
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from numpy.typing import NDArray

from mobile_robot_simulator import OccupancyGrid, plotting
from mobile_robot_simulator._core import Pose, Shape
from mobile_robot_simulator.plotting import plot_drive, plot_scan

FREE, OCCUPIED, UNKNOWN = plotting._FREE, plotting._OCCUPIED, plotting._UNKNOWN
ROBOT, GOAL, SCAN, SHAPE = (
    tuple(round(255 * share) for share in to_rgb(name))
    for name in (plotting._ROBOT, plotting._GOAL, plotting._SCAN, plotting._SHAPE)
)
PATH = np.column_stack([np.linspace(1.0, 4.0, 50), np.linspace(1.0, 2.0, 50), np.zeros(50)])
HITS = np.array([[4.5, 2.0], [4.5, 2.5], [4.0, 3.0]])
SUFFIXES = (".png", ".pdf", ".svg")


def room(size: int = 100, **options: Any) -> OccupancyGrid:
    cells = np.full((size, size), -1, np.int8)
    cells[10:-10, 10:-10] = 100
    cells[12:-12, 12:-12] = 0
    return OccupancyGrid(cells, resolution=0.05, **options)


class Drawn:
    """A picture held back from its file, to ask for the colour at a point of the map."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setattr(plotting, "_save", self._keep)

    def _keep(self, figure: Figure, _: Path) -> None:
        canvas = FigureCanvasAgg(figure)
        canvas.draw()  # type: ignore[no-untyped-call]
        self.axes: Axes = figure.axes[0]
        self.pixels: NDArray[np.uint8] = np.asarray(canvas.buffer_rgba())  # type: ignore[no-untyped-call]

    def __call__(self, x: float, y: float) -> tuple[int, ...]:
        col, row = self.axes.transData.transform((x, y))
        return tuple(int(value) for value in self.pixels[len(self.pixels) - 1 - int(row), int(col), :3])


@pytest.fixture
def drawn(monkeypatch: pytest.MonkeyPatch) -> Drawn:
    return Drawn(monkeypatch)


# --- Where things lie ---


@pytest.mark.parametrize("origin", [(0.0, 0.0, 0.0), (-3.0, 7.5, 0.0), (10.0, -4.0, 0.7), (1.0, 2.0, -2.0)])
def test_every_cell_lies_where_it_is(drawn: Drawn, origin: tuple[float, float, float]) -> None:
    cells = np.array([[0, 100, 0, -1], [100, 0, 0, 0], [0, 0, 100, 100]], np.int8)
    grid = OccupancyGrid(cells, resolution=2.0, origin=origin)
    # The path is away from all centres.
    corner = Pose(*origin) * Pose(0.05, 0.05)
    plot_drive("a.png", grid, np.array([[corner.x, corner.y]]))
    for (row, col), value in np.ndenumerate(cells):
        if (row, col) != (0, 0):
            expected = {0: FREE, 100: OCCUPIED, -1: UNKNOWN}[int(value)]
            assert drawn(*grid.center(row, col)) == expected, (row, col)


def test_shades_between_free_and_occupied(drawn: Drawn) -> None:
    cells = np.array([[0, 25, 50, 75, 100]], np.int8)
    grid = OccupancyGrid(cells, resolution=1.0)
    plot_drive("a.png", grid, np.array([[0.1, 0.1]]))
    shades = [drawn(col + 0.5, 0.8)[0] for col in range(5)]
    assert shades == sorted(shades, reverse=True) and len(set(shades)) == 5


def test_a_pole_shows_on_a_large_map(drawn: Drawn) -> None:
    cells = np.zeros((4000, 6000), np.int8)
    cells[2345, 4321] = 100
    grid = OccupancyGrid(cells, resolution=0.01)
    plot_drive("a.png", grid, np.array([[30.0, 10.0], [55.0, 12.0]]))
    # Which pixel of the few around it is a matter of rounding.
    x, y = grid.center(2345, 4321)
    assert min(drawn(x + dx, y + dy)[0] for dx in (-0.05, 0.0, 0.05) for dy in (-0.05, 0.0, 0.05)) < 160


def test_path_scan_robot_and_goal_lie_where_they_are(drawn: Drawn) -> None:
    path = np.array([[1.0, 1.0, 0.0], [2.5, 1.0, 0.0], [2.5, 2.5, 0.5]])
    plot_drive("a.png", room(), path, scan_points=HITS, laser_pose=(2.5, 2.5, 0.5), goal=(1.5, 3.0), title="Office")
    assert drawn(2.5, 2.5) == ROBOT
    assert drawn(1.5, 3.0) == GOAL
    assert drawn(1.0, 1.0) == (255, 255, 255)  # the start is a ring
    assert all(drawn(*hit) == SCAN for hit in HITS)
    red, green, blue = drawn(1.75, 1.0)  # the path, first of two pieces: blue
    assert blue > 120 > max(red, green)
    red, green, blue = drawn(3.25, 2.75)  # a beam: a tint
    assert red > 240 and 150 < green < 250 and 150 < blue < 250
    assert drawn(1.75, 1.75) == FREE
    assert drawn.axes.get_title(loc="left") == "Office"
    assert [text.get_text() for text in drawn.axes.texts] == []


def test_the_arrow_points_along_the_heading(drawn: Drawn) -> None:
    for yaw in (0.0, math.pi / 2, 2.5):
        plot_drive("a.png", room(), np.array([[1.0, 1.0, 0.0], [2.5, 2.5, yaw]]))
        along = np.linspace(-0.1, 0.1, 201)
        blue = [d for d in along if drawn(2.5 + d * math.cos(yaw), 2.5 + d * math.sin(yaw)) == ROBOT]
        assert max(blue) > -1.5 * min(blue) > 0


# --- What is in view ---


def view(drawn: Drawn) -> tuple[float, ...]:
    return tuple(round(float(value), 2) for value in (*drawn.axes.get_xlim(), *drawn.axes.get_ylim()))


def test_the_view_is_what_is_known(drawn: Drawn) -> None:
    plot_drive("a.png", room(), PATH)
    assert view(drawn) == (0.42, 4.58, 0.42, 4.58)


def test_the_view_holds_a_path_off_the_map(drawn: Drawn) -> None:
    plot_drive("a.png", room(), np.array([[-8.0, 2.0], [2.0, 2.0]]))
    assert view(drawn)[0] < -8.0


def test_the_view_stays_near_a_short_drive_on_a_large_map(drawn: Drawn) -> None:
    grid = OccupancyGrid(np.zeros((4000, 4000), np.int8), resolution=0.05)
    plot_drive("a.png", grid, 100.0 + PATH)
    low_x, high_x, low_y, high_y = view(drawn)
    assert 80 < low_x < 100 < high_x < 120 and 80 < low_y < 100 < high_y < 120


def test_the_view_of_a_scan_is_where_it_reaches(drawn: Drawn) -> None:
    plot_scan("a.png", room(), Pose(2.5, 2.5), HITS + np.array([3.0, 0.0]))
    low_x, high_x, _, _ = view(drawn)
    assert -2.0 < low_x < -0.5 and 7.5 < high_x < 9.0


def test_x_and_y_have_one_scale(drawn: Drawn) -> None:
    for grid in (room(), OccupancyGrid(np.zeros((3, 4000), np.int8), resolution=0.05)):
        plot_drive("a.png", grid, np.array([[1.0, 0.1], [190.0, 0.1]]))
        origin, x, y = drawn.axes.transData.transform([(0, 0), (1, 0), (0, 1)])
        assert x[0] - origin[0] == pytest.approx(y[1] - origin[1])
        height, width = drawn.pixels.shape[:2]
        assert height < 2000 and width < 2000


@pytest.mark.parametrize(
    "grid",
    [
        OccupancyGrid(np.full((4, 4), -1, np.int8), resolution=0.05),
        OccupancyGrid(np.zeros((1, 1), np.int8), resolution=1e-3),
        room(origin=(1e4, -1e4, 3.0)),
    ],
)
def test_odd_maps(tmp_path: Path, grid: OccupancyGrid) -> None:
    x, y, _ = grid.origin
    plot_drive(tmp_path / "drive.png", grid, np.array([[x, y]]))
    plot_scan(tmp_path / "scan.png", grid, (x, y, 0.0), np.zeros((0, 2)))


# --- The file ---


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_same_arguments_same_bytes(tmp_path: Path, suffix: str) -> None:
    files = [tmp_path / f"{name}{suffix}" for name in "abc"]
    for file in files[:2]:
        plot_drive(file, room(), PATH, scan_points=HITS, laser_pose=(4.0, 2.0, 0.0), goal=(1, 3), title="Office")
    assert files[0].read_bytes() == files[1].read_bytes()
    plot_drive(files[2], room(), PATH)
    assert files[2].read_bytes() != files[0].read_bytes()
    assert not any(word in files[0].read_bytes() for word in (b"atplotlib v", b"CreationDate", b"dc:date"))


def test_settings_of_the_user_do_not_count_and_stay(tmp_path: Path) -> None:
    plot_scan(tmp_path / "a.png", room(), (2.5, 2.5, 0.0), HITS)
    with matplotlib.rc_context({"font.size": 20, "xtick.major.size": 20}):
        before = dict(matplotlib.rcParams)
        plot_scan(tmp_path / "b.png", room(), (2.5, 2.5, 0.0), HITS)
        assert dict(matplotlib.rcParams) == before
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()


def test_an_older_picture_is_replaced_or_stays(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = tmp_path / "drive.png"
    file.write_text("older")
    with monkeypatch.context() as patch:

        def full(_: Figure, draft: Path, **__: object) -> None:
            draft.write_text("half")
            raise OSError(28, "No space left on device")

        patch.setattr(Figure, "savefig", full)
        with pytest.raises(OSError, match="No space left"):
            plot_drive(file, room(), PATH)
    assert list(tmp_path.iterdir()) == [file]
    assert file.read_text() == "older"
    plot_drive(file, room(), PATH)
    assert list(tmp_path.iterdir()) == [file]
    assert file.read_bytes().startswith(b"\x89PNG")


def test_no_pyplot_and_no_display(tmp_path: Path) -> None:
    script = f"""
import sys, numpy as np, mobile_robot_simulator as mrs
from mobile_robot_simulator.plotting import plot_drive
plot_drive({str(tmp_path / "a.png")!r}, mrs.OccupancyGrid(np.zeros((9, 9), np.int8), resolution=1.0), np.zeros((1, 3)))
assert "matplotlib.pyplot" not in sys.modules
"""
    subprocess.run([sys.executable, "-c", script], check=True, timeout=60, env={"MPLBACKEND": "TkAgg"})


# --- Refusals ---


@pytest.mark.parametrize("name", ["drive", "drive.bmp", "drive.png.txt"])
def test_endings(tmp_path: Path, name: str) -> None:
    with pytest.raises(ValueError, match=r"must end in \.png, \.pdf, \.svg, got .*drive"):
        plot_drive(tmp_path / name, room(), PATH)
    assert not list(tmp_path.iterdir())


def test_folders(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError, match=r"No such folder to save a picture in.*nowhere"):
        plot_drive(tmp_path / "nowhere" / "drive.png", room(), PATH)
    (tmp_path / "drive.png").mkdir()
    with pytest.raises(IsADirectoryError, match=r"drive\.png"):
        plot_drive(tmp_path / "drive.png", room(), PATH)


@pytest.mark.parametrize(
    ("arguments", "match"),
    [
        ({"path": np.zeros((0, 3))}, "path must have at least one row"),
        ({"path": np.zeros((5, 4))}, r"path must have shape \(N, 2\) or \(N, 3\), got \(5, 4\)"),
        ({"path": np.full((2, 2), np.nan)}, "path must be finite, got"),
        ({"scan_points": np.zeros((3, 3))}, r"scan_points must have shape \(N, 2\), got \(3, 3\)"),
        ({"scan_points": np.array([[1.0, np.inf]])}, r"scan_points must be finite, got \[ *1\. +inf\]"),
        ({"laser_pose": (0.0, 1.0)}, "laser_pose must have shape"),
        ({"goal": (0.0,)}, "goal must have shape"),
    ],
)
def test_shapes_and_numbers(tmp_path: Path, arguments: dict[str, Any], match: str) -> None:
    with pytest.raises(ValueError, match=match):
        plot_drive(tmp_path / "drive.png", room(), **({"path": PATH} | arguments))
    assert not list(tmp_path.iterdir())


def test_without_matplotlib(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "matplotlib.figure", None)
    monkeypatch.delitem(sys.modules, "mobile_robot_simulator.plotting")
    with pytest.raises(ImportError, match=r"pip install 'mobile-robot-simulator\[plotting\]'"):
        importlib.import_module("mobile_robot_simulator.plotting")


def test_other_robots_and_shapes_lie_where_they_are(drawn: Drawn) -> None:
    other = np.column_stack([np.full(20, 1.5), np.linspace(3.0, 4.0, 20), np.zeros(20)])
    disc, box = Shape.disc(0.2), Shape.rectangle(0.6, 0.2)
    shapes = [(disc, Pose(3.5, 3.5, 0.0)), (box, Pose(2.5, 3.5, math.pi / 2))]
    plot_drive("held.png", room(), PATH, others={"two": other}, shapes=shapes)
    assert drawn(1.5, 4.0) == ROBOT and drawn(1.5, 3.4) not in (FREE, ROBOT)
    assert [text.get_text() for text in drawn.axes.texts] == ["two"]
    for x, y, filled in ((3.65, 3.5, True), (3.75, 3.5, False), (2.5, 3.75, True), (2.65, 3.5, False)):
        assert drawn(x, y) == (SHAPE if filled else FREE)
    assert drawn.axes.get_legend_handles_labels()[1] == ["start", "path", "end"]


def test_the_view_holds_other_robots_and_shapes(drawn: Drawn) -> None:
    plot_drive(
        "held.png", room(), PATH, others={"two": np.array([[30.0, 2.0]])}, shapes=[(Shape.disc(1.0), Pose(2.0, -20.0))]
    )
    assert drawn.axes.get_xlim()[1] > 30.0 and drawn.axes.get_ylim()[0] < -21.0
