"""Script: a driver that sends velocity commands from a file."""

from __future__ import annotations

import csv
import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from ..nodes.interface import Node
from .commander import Commander

COLUMNS = ("time", "vx", "vy", "wz")

REPEAT = 0.1
"""Time between repetitions of a command [s]. It is shorter than any sensible velocity timeout."""


@dataclass(frozen=True)
class Script:
    """A driver that sends velocity commands at given times. Each command applies until the next one.

    Args:
        rows: Commands: time [s], vx, vy [m/s], wz [rad/s]. The times must increase.
    """

    rows: tuple[tuple[float, float, float, float], ...]

    @classmethod
    def read(cls, path: str | Path) -> Script:
        """Returns the commands in a CSV file with the header `time,vx,vy,wz`.

        Raises:
            OSError: The file cannot be read.
            ValueError: The contents are invalid. The message names the line.
        """
        with open(path, newline="", encoding="utf-8") as file:
            lines = list(csv.reader(file))
        if not lines or tuple(cell.strip() for cell in lines[0]) != COLUMNS:
            header = ",".join(lines[0]) if lines else ""
            raise ValueError(f"{path}: the first line must be {','.join(COLUMNS)}, got {header!r}")
        rows: list[tuple[float, float, float, float]] = []
        for number, cells in enumerate(lines[1:], start=2):
            if cells:
                rows.append(_row(cells, where=f"{path}, line {number}", previous_time=rows[-1][0] if rows else None))
        if not rows:
            raise ValueError(f"{path}: there must be at least one command, got none")
        return cls(tuple(rows))

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


def _row(cells: list[str], *, where: str, previous_time: float | None) -> tuple[float, float, float, float]:
    """Returns the command of a line. `previous_time` [s] is that of the previous command."""
    try:
        time, vx, vy, wz = map(float, cells)
    except ValueError:
        raise ValueError(f"{where}: must be four numbers, got {','.join(cells)!r}") from None
    if not all(map(math.isfinite, (time, vx, vy, wz))):
        raise ValueError(f"{where}: must be finite, got {','.join(cells)!r}")
    if time < 0.0 or (previous_time is not None and time <= previous_time):
        raise ValueError(f"{where}: times must be at least 0 and increase, got {time}")
    return time, vx, vy, wz


def call_once(node: Node, delay: float, callback: Callable[[], None]) -> None:
    """Calls a function once after a delay [s], or immediately if the delay is 0."""
    if delay == 0.0:
        callback()
        return

    def fire() -> None:
        node.destroy_timer(timer)
        callback()

    timer = node.create_timer(delay, fire)
