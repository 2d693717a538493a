"""The command `convert`: a world in another format becomes a map of map_server."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from .console import console
from .options import MapFile, Resolution, Unit


def convert(
    map_file: MapFile,
    file: Annotated[
        Path, typer.Argument(metavar="FILE.yaml", help="YAML file of map_server to write. Its folder must exist.")
    ],
    resolution: Resolution = None,
    unit: Unit = None,
) -> None:
    """Convert a world to a map of map_server: a YAML file and an image next to it."""
    from ..maps import load_map, save_map

    save_map(load_map(map_file, resolution=resolution, unit=unit), file)
    console.print(f"{file}", highlight=False)
