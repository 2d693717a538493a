"""The command `falsify`: searches worlds in which a controller violates a requirement."""

from __future__ import annotations

from enum import Enum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.progress import Progress, TextColumn, TimeElapsedColumn

from .console import console, error_console
from .signals import signals_as_interrupt

if TYPE_CHECKING:
    from ..falsification.case import Case

FAILED = 2
"""Status of the command if the requirement is violated."""


class MethodName(str, Enum):
    """Ways to search."""

    random = "random"
    sobol = "sobol"
    cma = "cma"


def falsify(
    case: Annotated[
        Path, typer.Argument(metavar="FILE", help="Python file that defines `controller`, `space` and `requirement`.")
    ],
    budget: Annotated[int, typer.Option(help="Largest number of drives.")] = 500,
    method: Annotated[
        MethodName, typer.Option(help="random; sobol fills the space evenly; cma learns. The last two need an extra.")
    ] = MethodName.random,
    seed: Annotated[int, typer.Option(help="Seed of the search.")] = 0,
    processes: Annotated[int, typer.Option(help="Number of processes. The result does not depend on it.")] = 1,
    corpus: Annotated[
        Path, typer.Option(metavar="DIR", help="Folder of counterexamples: old ones are run first, a new one is added.")
    ] = Path("counterexamples"),
    keep_going: Annotated[
        bool, typer.Option("--keep-going", help="Use the whole budget, and do not stop at failures.")
    ] = False,
    repeat: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE", help="Only repeat this counterexample.json, and compare its bytes, or this world.json."
        ),
    ] = None,
) -> None:
    """Search worlds in which a controller violates a requirement, and shrink the worst.

    The exit status is 0 if no drive violated the requirement, and 2 if one did.
    """
    from ..falsification import falsify as search
    from ..falsification.case import Case

    with signals_as_interrupt():
        loaded = Case.load(case)
        if repeat is not None:
            _repeat(loaded, repeat)
            return
        if loaded.space is None:
            raise ValueError(f"{case} must define space, a scenarios.Space")
        columns = (
            TextColumn("{task.completed} of {task.total} drives, nearest {task.fields[nearest]}"),
            TimeElapsedColumn(),
        )
        with Progress(*columns, console=error_console, transient=True) as bar:
            task = bar.add_task("", total=budget, nearest="-")
            found = search(
                loaded.controller,
                loaded.space,
                loaded.requirement,
                budget,
                method=method.value,
                seed=seed,
                processes=processes,
                corpus=corpus,
                keep_going=keep_going,
                progress=lambda drives, _, nearest: bar.update(task, completed=drives, nearest=f"{nearest:.3g}"),
            )
    console.print(str(found), markup=False, highlight=False, soft_wrap=True)
    if found.failed:
        raise typer.Exit(FAILED)


def _repeat(case: Case, file: Path) -> None:
    from ..falsification import Counterexample, load_world, run_drive
    from ..falsification.drive import check_world
    from ..falsification.lost_drive import WORLD_FILE

    bytes_are = ""
    if file.name == WORLD_FILE:
        world = load_world(file)
        check_world(world, file)
        drive = run_drive(world, case.controller, case.requirement)
    else:
        drive, is_same = Counterexample.load(file).repeat(case.controller, case.requirement)
        bytes_are = f"\n{'the same bytes as' if is_same else 'other bytes than'} when it was found"
    text = f"{'violated' if drive.failed else 'holds'}: {case.requirement}\n{drive}{bytes_are}"
    console.print(text, markup=False, highlight=False, soft_wrap=True)
    if drive.failed:
        raise typer.Exit(FAILED)
