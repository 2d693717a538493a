"""The app: the command `mobile-robot-simulator` with its subcommands."""

from __future__ import annotations

import sys
from typing import Annotated

import typer

from .. import __version__
from .audit import audit
from .compare import compare
from .console import console, error_console, text_of, warnings_as_notes
from .convert import convert
from .dataset import dataset
from .falsify import falsify
from .floor_plan import generate_floor_plan
from .help_page import Command, Group
from .info import info
from .live import live
from .parameters import parameters
from .recover import recover
from .ros import PASSED_ON, ros1, ros2
from .run import run
from .scan import scan

app = typer.Typer(
    cls=Group,
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    help="Simulate mobile robots and laser scanners on occupancy grids: exact, fast and deterministic.",
)
app.command(cls=Command)(run)
app.command(cls=Command)(live)
app.command(cls=Command)(recover)
app.command(cls=Command)(audit)
app.command(cls=Command)(compare)
app.command(cls=Command)(falsify)
app.command(cls=Command)(scan)
app.command(cls=Command)(info)
app.command(cls=Command)(parameters)
app.command(cls=Command)(convert)
app.command(cls=Command)(dataset)
app.command("floor-plan", cls=Command)(generate_floor_plan)
app.command(cls=Command, context_settings=PASSED_ON)(ros1)
app.command(cls=Command, context_settings=PASSED_ON)(ros2)


def main() -> None:
    """Runs the command. Invalid input prints a message and exits with status 1."""
    try:
        with warnings_as_notes():
            app()
    except (ValueError, TypeError, OSError, ImportError) as error:
        error_console.print(f"error: {text_of(error)}", style="red", markup=False, highlight=False, soft_wrap=True)
        sys.exit(1)


def _print_version(wanted: bool) -> None:
    if wanted:
        console.print(__version__, highlight=False)
        raise typer.Exit


@app.callback()
def _common_options(
    version: Annotated[
        bool, typer.Option("--version", callback=_print_version, is_eager=True, help="Print the version and exit.")
    ] = False,
) -> None:
    pass
