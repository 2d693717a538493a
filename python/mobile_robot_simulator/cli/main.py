"""The app: the command `mobile-robot-simulator` with its subcommands."""

from __future__ import annotations

import atexit
import gc
import sys
from collections.abc import Iterable, Mapping
from importlib import import_module
from typing import Annotated

import typer

from .. import __version__
from .console import console, error_console, text_of, warnings_as_notes
from .help_page import Command, Group

COMMANDS: Mapping[str, tuple[str, str]] = {
    "run": ("run", "run"),
    "live": ("live", "live"),
    "recover": ("recover", "recover"),
    "audit": ("audit", "audit"),
    "compare": ("compare", "compare"),
    "falsify": ("falsify", "falsify"),
    "scan": ("scan", "scan"),
    "info": ("info", "info"),
    "parameters": ("parameters", "parameters"),
    "convert": ("convert", "convert"),
    "dataset": ("dataset", "dataset"),
    "floor-plan": ("floor_plan", "generate_floor_plan"),
    "ros1": ("ros", "ros1"),
    "ros2": ("ros", "ros2"),
}
"""Module and function of each subcommand."""

PASSED_ON = {"allow_extra_args": True, "ignore_unknown_options": True}
"""Typer settings for commands that pass their extra arguments on to ROS."""


COLLECTED_AFTER = 200_000
"""Number of new objects after which Python looks for garbage. By default it is 700, and imports alone make far more."""


def app_of(names: Iterable[str]) -> typer.Typer:
    """Returns the app with some of the subcommands, whose modules are imported now."""
    app = typer.Typer(
        cls=Group,
        no_args_is_help=True,
        pretty_exceptions_enable=False,
        help="Simulate mobile robots and laser scanners on occupancy grids: exact, fast and deterministic.",
    )
    app.callback()(_common_options)
    for name in names:
        module, function = COMMANDS[name]
        command = getattr(import_module(f".{module}", __package__), function)
        app.command(name, cls=Command, context_settings=PASSED_ON if module == "ros" else None)(command)
    return app


def main() -> None:
    """Runs the command. Invalid input prints a message and exits with status 1."""
    gc.set_threshold(COLLECTED_AFTER)
    # Without this, Python looks through all objects for garbage at exit, for a tenth of the time of the demo.
    atexit.register(gc.freeze)
    try:
        with warnings_as_notes():
            first = sys.argv[1] if len(sys.argv) > 1 else ""
            # The modules of all commands take longer to import than many a command takes.
            app_of([first] if first in COMMANDS else COMMANDS)()
    except (ValueError, TypeError, OSError, ImportError) as error:
        error_console.print(f"error: {text_of(error)}", style="red", markup=False, highlight=False, soft_wrap=True)
        sys.exit(1)


def _print_version(wanted: bool) -> None:
    if wanted:
        console.print(__version__, highlight=False)
        raise typer.Exit


def _common_options(
    version: Annotated[
        bool, typer.Option("--version", callback=_print_version, is_eager=True, help="Print the version and exit.")
    ] = False,
) -> None:
    pass
