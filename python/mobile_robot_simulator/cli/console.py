"""Output of commands: results go to standard output, errors and progress to standard error."""

from __future__ import annotations

import os
import warnings
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from typing import Any

from rich.console import Console
from rich.progress import (
    BarColumn,
    Progress,
    ProgressColumn,
    Task,
    TaskID,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)
from rich.table import Table
from rich.text import Text

console = Console()
error_console = Console(stderr=True)


def print_table(title: str, rows: Iterable[tuple[str, str]]) -> None:
    """Prints a title on a line of its own, so that a long path stays whole, and a table of names and values."""
    console.print(title, highlight=False, markup=False, soft_wrap=True)
    table = Table(show_header=False)
    for name, value in rows:
        table.add_row(name, Text(value))  # text, because Rich would take [brackets] for markup
    console.print(table)


def print_note(text: str) -> None:
    """Prints a note on standard error, so that it does not mix with results."""
    error_console.print(text, markup=False, highlight=False, soft_wrap=True)


def text_of(error: Exception) -> str:
    """Returns the message of an error. That of an operating system gives the file, then what is wrong."""
    if not isinstance(error, OSError) or not error.strerror or error.filename is None:
        return f"{error}"
    files = [name for name in (error.filename, error.filename2) if name is not None]
    shown = " -> ".join(os.fsdecode(name) if isinstance(name, bytes) else f"{name}" for name in files)
    return f"{shown}: {error.strerror[:1].lower()}{error.strerror[1:]}"


@contextmanager
def warnings_as_notes() -> Iterator[None]:
    """Prints Python's UserWarnings as notes while the context is open. Others are printed as Python does."""
    with warnings.catch_warnings():
        print_as_python_does = warnings.showwarning

        def show(message: Warning | str, category: type[Warning], *place: Any, **options: Any) -> None:
            if issubclass(category, UserWarning):
                print_note(f"warning: {message}")
            else:
                print_as_python_does(message, category, *place, **options)

        warnings.showwarning = show
        yield


@contextmanager
def progress_bar(duration: float) -> Iterator[Callable[[float], None]]:
    """Shows a progress bar while the context is open.

    Args:
        duration: Simulated time at the end of the bar [s].

    Yields:
        A function that moves the bar to a simulated time [s].
    """
    columns = (TextColumn("simulating"), BarColumn(), TextColumn("{task.completed:.0f}/{task.total:.0f} s"))
    with Progress(*columns, TimeElapsedColumn(), TimeRemainingColumn(), console=error_console, transient=True) as bar:
        task = bar.add_task("", total=duration)
        yield lambda seconds: bar.update(task, completed=seconds)


@contextmanager
def stage_bar() -> Iterator[Callable[[str, float], None]]:
    """Shows a progress bar for work in several stages while the context is open.

    Yields:
        A function that takes what is being done and the share of it that is done, 0 to 1. Other words start a new stage.
    """
    columns = (TextColumn("{task.description}"), BarColumn(), TextColumn("{task.percentage:.0f} %"))
    hidden = not error_console.is_terminal
    with Progress(*columns, TimeElapsedColumn(), console=error_console, transient=True, disable=hidden) as bar:
        stages: dict[str, TaskID] = {}

        def advance(stage: str, share: float) -> None:
            if stage not in stages:
                stages[stage] = bar.add_task(stage, total=1.0)
            bar.update(stages[stage], completed=share)

        yield advance


@contextmanager
def dataset_bar() -> Iterator[Callable[[int, int], None]]:
    """Shows a progress bar for scans that are made, with their rate and the time left, while the context is open.

    Yields:
        A function that takes the number of scans that are made, and their total. The rate counts from its first call.
    """
    columns = (TextColumn("scans"), BarColumn(), TextColumn("{task.completed:.0f}/{task.total:.0f}"), _Rate())
    hidden = not error_console.is_terminal
    with Progress(*columns, TimeRemainingColumn(), console=error_console, transient=True, disable=hidden) as bar:
        tasks: list[TaskID] = []

        def advance(scans: int, total: int) -> None:
            if not tasks:
                tasks.append(bar.add_task("", total=total, completed=scans))
            bar.update(tasks[0], completed=scans)

        yield advance


class _Rate(ProgressColumn):
    """Scans per second."""

    def render(self, task: Task) -> Text:
        """Returns the rate as text."""
        return Text("" if task.speed is None else f"{task.speed:.0f} scans/s")
