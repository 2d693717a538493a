"""The command `floor-plan`: a generated map."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ..maps.floor_plans import KINDS, floor_plan
from ..maps.map_files import save_map
from .console import console


def generate_floor_plan(
    file: Annotated[Path, typer.Argument(metavar="FILE.yaml", help="Map file to write. Its folder must exist.")],
    kind: Annotated[str, typer.Option(help=f"Kind of floor plan: {', '.join(KINDS[:-1])} or {KINDS[-1]}.")] = "office",
    size: Annotated[
        tuple[float, float] | None, typer.Option(metavar="WIDTH HEIGHT", help="Width and height in metres.")
    ] = None,
    resolution: Annotated[float, typer.Option(help="Cell size in metres.")] = 0.05,
    seed: Annotated[int, typer.Option(help="Random seed. The same seed always gives the same floor plan.")] = 0,
) -> None:
    """Generate a floor plan and save it as a map."""
    options = {} if size is None else {"size": size}
    save_map(floor_plan(kind, seed=seed, resolution=resolution, **options), file)
    console.print(f"{file}", highlight=False)
