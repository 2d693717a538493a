"""Script: a driver that sends velocity commands from a file."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

from .._core import MAX_COMMAND
from ..nodes.interface import Node
from ..quoting import quoted
from ..user_files import read_text
from .commander import Commander

COLUMNS = ("time", "vx", "vy", "wz")

LARGEST_FILE = 2**26
"""Largest size of a file of commands [bytes]: about 2 million rows."""

FIRST_STAMP = 1e6
"""First time [s] from which the times of a file are stamps of a clock. No drive begins with a pause of 11 days."""

_LARGEST_TIME = 1e11

REPEAT = 0.1
"""Time between repetitions of a command [s]. It is shorter than any sensible velocity timeout."""


@dataclass(frozen=True)
class Script:
    """A driver that sends velocity commands at given times. Each command applies until the next one.

    Args:
        rows: Commands: time [s], vx, vy [m/s], wz [rad/s]. The times must increase.
        origin: Time in the file at which the drive starts [s]: 0, or the first time if the file has stamps of a clock.
    """

    rows: tuple[tuple[float, float, float, float], ...]
    origin: float = 0.0

    @classmethod
    def read(cls, path: str | Path) -> Script:
        """Returns the commands in a CSV file.

        The first line names the columns: time, vx, vy and wz, in any order. Other columns are ignored. Commas, semicolons or
        tabs separate the values. With semicolons and tabs, numbers may have decimal commas, as spreadsheets write them.

        The times count from the start of the drive. If the first one is at least `FIRST_STAMP`, they are stamps of a clock,
        and count from the first row.

        Args:
            path: The file, in UTF-8, or in UTF-16 with a byte order mark. `-` is standard input.

        Raises:
            OSError: The file cannot be read.
            ValueError: The contents are invalid. The message gives the line, the column, the value and the requirement.
        """
        rows: list[tuple[float, float, float, float]] = []
        for where, row in _rows(read_text(path, LARGEST_FILE, allow_stdin=True), path):
            if rows and row[0] <= rows[-1][0]:
                raise ValueError(f"{where}, column time: must be above {rows[-1][0]}, the time before, got {row[0]}")
            rows.append(row)
        if not rows:
            raise ValueError(f"{path}: there must be at least one command, got none")
        origin = rows[0][0] if rows[0][0] >= FIRST_STAMP else 0.0
        return cls(tuple((time - origin, vx, vy, wz) for time, vx, vy, wz in rows), origin)

    def notes(self, duration: float) -> list[str]:
        """Returns what a user may not expect: times that are stamps of a clock, and commands after the end of the drive.

        Args:
            duration: Duration of the drive [s].
        """
        notes = []
        if self.origin:
            notes.append(f"the times are stamps of a clock, so they count from the first row, {self.origin} s")
        if late := sum(row[0] >= duration for row in self.rows):
            notes.append(f"{late} of {len(self.rows)} commands come after the drive of {duration:g} s")
        return notes

    def start(self, node: Node, commander: Commander) -> None:
        """Starts to send the commands. Their times are relative to this call."""
        velocity: tuple[float, float, float] | None = None

        def send() -> None:
            if velocity is not None:
                commander.command(*velocity)

        def change_to(row: tuple[float, float, float, float]) -> Callable[[], None]:
            def change() -> None:
                nonlocal velocity
                velocity = row[1:]
                send()

            return change

        for row in self.rows:
            call_once(node, row[0], change_to(row))
        node.create_timer(REPEAT, send)


def _rows(text: str, path: str | Path) -> Iterator[tuple[str, tuple[float, float, float, float]]]:
    """Yields each command with its file and line."""
    header, _, _ = text.lstrip().partition("\n")
    delimiter = next((mark for mark in ";\t" if mark in header), ",")
    lines = csv.reader(io.StringIO(text, newline=""), delimiter=delimiter)
    names: list[str] = []
    try:
        for cells in lines:
            if not any(cell.strip() for cell in cells):
                continue
            where = f"{path}, line {lines.line_num}"
            if not names:
                names = _header(cells, where, delimiter)
                continue
            if len(cells) < len(names) or any(cell.strip() for cell in cells[len(names) :]):
                hint = "; numbers with decimal commas need semicolons between them" if len(cells) > len(names) else ""
                line = quoted(delimiter.join(cells))
                raise ValueError(
                    f"{where}: must have {len(names)} values, as the first line, got {len(cells)}: {line}{hint}"
                )
            time, vx, vy, wz = (_number(cells[names.index(name)], f"{where}, column {name}", delimiter) for name in COLUMNS)
            yield where, (time, vx, vy, wz)
    except csv.Error as error:
        raise ValueError(f"{path}, line {lines.line_num}: not CSV: {error}") from None


def _header(cells: list[str], where: str, delimiter: str) -> list[str]:
    """Returns the names of the columns."""
    names = [cell.strip().lower() for cell in cells]
    if any(names.count(name) != 1 for name in COLUMNS):
        columns, got = ", ".join(COLUMNS), quoted(delimiter.join(cells))
        raise ValueError(f"{where}: the first line must name each of the columns {columns} once, got {got}")
    return names


def _number(cell: str, where: str, delimiter: str) -> float:
    """Returns the value of a cell. Times must be at least 0; the largest velocity is that of the robot node."""
    text = cell.strip() if delimiter == "," else cell.strip().replace(",", ".")
    try:
        value = math.nan if "_" in text else float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise ValueError(f"{where}: must be a finite number, got {quoted(cell)}")
    if where.endswith(" time"):
        if not 0.0 <= value < _LARGEST_TIME:
            raise ValueError(f"{where}: must be seconds, at least 0 and below {_LARGEST_TIME:g}, got {quoted(cell)}")
    elif abs(value) > MAX_COMMAND:
        raise ValueError(f"{where}: must be from -{MAX_COMMAND:g} to {MAX_COMMAND:g}, got {quoted(cell)}")
    return value


def call_once(node: Node, delay: float, callback: Callable[[], None]) -> None:
    """Calls a function once after a delay [s], or immediately if the delay is 0."""
    if delay == 0.0:
        callback()
        return

    def fire() -> None:
        node.destroy_timer(timer)
        callback()

    timer = node.create_timer(delay, fire)
