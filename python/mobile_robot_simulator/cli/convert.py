"""The command `convert`: a world in another format becomes a map of map_server."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ..maps import load_map, save_map
from .console import console
from .options import MapFile


def convert(
    map_file: MapFile,
    file: Annotated[
        Path, typer.Argument(metavar="FILE.yaml", help="YAML file of map_server to write. Its folder must exist.")
    ],
    resolution: Annotated[
        float | None, typer.Option(help="Cell size in metres. Without it, the usual one of the format is used.")
    ] = None,
    unit: Annotated[
        float | None,
        typer.Option(help="Length of a unit of a drawing, SVG or DXF, in metres. Without it: that of a DXF file, or 1."),
    ] = None,
) -> None:
    """Convert a world to a map of map_server: a YAML file and an image next to it."""
    save_map(load_map(map_file, resolution=resolution, unit=unit), file)
    console.print(f"{file}", highlight=False)
