"""MovingAI files: maps of the pathfinding benchmarks, and the problems on them.

Source: N. Sturtevant, https://movingai.com/benchmarks/formats.html. A map is text:

    type octile
    height 2
    width 3
    map
    .@.
    ...

A scenario file has a line `version 1`, and then one problem per line: bucket, map, width, height, start x, start y, goal x,
goal y, length of the shortest path.
"""

from __future__ import annotations

import math
import os
import re
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .._core import OccupancyGrid, Pose
from ..quoting import quoted
from ..user_files import read_bytes, read_text
from .cell_map import CellMap

__all__ = ["Scenario", "load_scenarios", "read_movingai"]

FREE = b".GS"
"""Ground, ground, swamp."""

OCCUPIED = b"@OTW"
"""Out of bounds, out of bounds, trees, water."""

_LIMIT = 2**28
_SCENARIO_LIMIT = 2**26
_HEADER = re.compile(rb"\s*type[ \t]+(\S+)\s+(height|width)[ \t]+(\S+)\s+(height|width)[ \t]+(\S+)\s+map[ \t]*\r?\n")
_WHITE_SPACE = b" \t\r\n\f\v\x1a"  # with the end mark of DOS, which some editors leave
_UNREAD = 127


def read_movingai(path: Path, resolution: float) -> CellMap:
    """Returns the cells of a MovingAI map.

    Ground (`.` and `G`) and swamp (`S`) are free. Out of bounds (`@` and `O`), trees (`T`) and water (`W`) are occupied, as
    in the Grid-Based Path Planning Competition. The first line of the file is the top row of the grid. White space in and
    between the lines is ignored, as in the loaders of the benchmarks.

    Args:
        path: The file.
        resolution: Side of a cell [m]; the format has no unit.

    Returns:
        The cells, with the lower-left corner of the grid at (0, 0).

    Raises:
        OSError: The file cannot be read.
        ValueError: The file is malformed or truncated.
    """
    data = read_bytes(path, _LIMIT)
    header = _HEADER.match(data)
    if header is None or header[2] == header[4]:
        first = data[:60].decode("latin-1")
        raise ValueError(f"{path}: must begin with the lines type octile, height, width and map, got {quoted(first)}")
    kind = header[1].decode("latin-1")
    if kind != "octile":
        raise ValueError(f"{path}: the type must be octile, got {quoted(kind)}")
    sides = {header[2]: header[3], header[4]: header[5]}
    height, width = (_side(path, name, sides[name.encode()]) for name in ("height", "width"))
    terrain = data[header.end() :].translate(None, _WHITE_SPACE)
    if len(terrain) != height * width:
        raise ValueError(f"{path}: must have {height} x {width} = {height * width} cells, got {len(terrain)}")
    cells: NDArray[np.int8] = np.frombuffer(terrain.translate(_TABLE), np.int8).reshape(height, width)
    unread = int(cells.argmax())
    if cells.flat[unread] == _UNREAD:
        row, col = divmod(unread, width)
        raise ValueError(
            f"{path}: a cell must be one of {(FREE + OCCUPIED).decode()}, got {quoted(chr(terrain[unread]))} "
            f"in row {row + 1}, column {col + 1} of the map"
        )
    return CellMap(np.ascontiguousarray(cells[::-1]), resolution, (0.0, 0.0, 0.0))


def _table() -> bytes:
    table = bytearray([_UNREAD]) * 256
    for letters, cell in ((FREE, 0), (OCCUPIED, 100)):
        for letter in letters:
            table[letter] = cell
    return bytes(table)


_TABLE = _table()


def _side(path: Path, name: str, text: bytes) -> int:
    if not re.fullmatch(rb"[0-9]{1,6}", text) or int(text) == 0:
        raise ValueError(f"{path}: {name} must be a whole number from 1 to 999999, got {quoted(text.decode('latin-1'))}")
    return int(text)


class Scenario(NamedTuple):
    """A problem of a MovingAI scenario file. Cells are (x, y) from the upper-left corner of the map, y downwards."""

    bucket: int
    """Group of problems of similar length."""

    map: str
    """Path of the map, as the file gives it."""

    size: tuple[int, int]
    """Width and height of the map [cells]."""

    start: tuple[int, int]
    """Cell of the start."""

    goal: tuple[int, int]
    """Cell of the goal."""

    optimal_length: float
    """Length of the shortest path [cells]: over edges and corners of cells, without cutting the corners of walls."""

    def poses_on(self, grid: OccupancyGrid) -> tuple[Pose, Pose]:
        """Returns the centres of the cells of start and goal in the map frame, with yaw 0 in the frame of the grid.

        Args:
            grid: The map of the problem, as `load_map` returns it.

        Raises:
            ValueError: The grid has another size than the map of the problem.

        Example:
            >>> import numpy as np
            >>> import mobile_robot_simulator as mrs
            >>> from mobile_robot_simulator.maps import Scenario
            >>> grid = mrs.OccupancyGrid(np.zeros((2, 3), np.int8), resolution=1.0)
            >>> start, goal = Scenario(0, "small.map", (3, 2), (0, 0), (2, 1), 2.41).poses_on(grid)
            >>> (start.x, start.y), (goal.x, goal.y)
            ((0.5, 1.5), (2.5, 0.5))
        """
        height, width = grid.shape
        if (width, height) != self.size:
            raise ValueError(
                f"the map of this problem must have {self.size[0]} x {self.size[1]} cells, got {width} x {height}"
            )
        start, goal = (
            grid.origin * Pose((x + 0.5) * grid.resolution, (height - y - 0.5) * grid.resolution, 0.0)
            for x, y in (self.start, self.goal)
        )
        return start, goal


def load_scenarios(path: str | os.PathLike[str]) -> list[Scenario]:
    """Loads the problems of a MovingAI scenario file.

    Args:
        path: The file, often with the ending .scen.

    Returns:
        The problems in the order of the file. The file of the map is not read.

    Raises:
        OSError: The file cannot be read.
        ValueError: A line is malformed, or a start or goal is not on the map. The message gives the line.
    """
    lines = read_text(path, _SCENARIO_LIMIT).splitlines()
    if not lines or not re.fullmatch(r"version\s+1(\.0*)?", lines[0].strip()):
        raise ValueError(f"{path}: must begin with the line version 1, got {quoted(lines[0] if lines else '')}")
    scenarios = []
    for number, line in enumerate(lines[1:], 2):
        if line.strip():
            try:
                scenarios.append(_scenario(line))
            except ValueError as error:
                raise ValueError(f"{path}, line {number}: {error}") from None
    return scenarios


def _scenario(line: str) -> Scenario:
    # Tabs separate the fields, so that the path of the map may contain blanks. Some files have blanks instead.
    fields = line.strip().split("\t") if "\t" in line else line.split()
    if len(fields) != 9:
        raise ValueError(f"must have 9 fields, got {len(fields)}: {quoted(line)}")
    bucket, width, height, *cells = (_whole(fields[index]) for index in (0, 2, 3, 4, 5, 6, 7))
    start, goal = (cells[0], cells[1]), (cells[2], cells[3])
    for name, (x, y) in (("start", start), ("goal", goal)):
        if not (x < width and y < height):
            raise ValueError(f"the {name} must be on the map of {width} x {height} cells, got ({x}, {y})")
    try:
        length = float(fields[8])
    except ValueError:
        length = math.nan
    if not 0 <= length < math.inf:
        raise ValueError(f"the length must be a number of at least 0, got {quoted(fields[8])}")
    return Scenario(bucket, fields[1], (width, height), start, goal, length)


def _whole(text: str) -> int:
    if not re.fullmatch(r"\s*[0-9]{1,9}\s*", text):
        raise ValueError(f"must have whole numbers, got {quoted(text)}")
    return int(text)
