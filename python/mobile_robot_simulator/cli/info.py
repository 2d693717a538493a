"""The command `info`: properties of a map."""

from __future__ import annotations

import json
from typing import Annotated

import typer

from .console import print_table
from .options import Assignments, MapFile, ParamsFile, Resolution, RosArgs, Unit, load_grid, read_values


def info(
    map_file: MapFile,
    as_json: Annotated[bool, typer.Option("--json", help="Print the properties as JSON.")] = False,
    resolution: Resolution = None,
    unit: Unit = None,
    param: Assignments = None,
    params_file: ParamsFile = None,
    ros_args: RosArgs = False,
) -> None:
    """Show the size, resolution, origin and cell counts of a map."""
    grid = load_grid(map_file, read_values(param, params_file), resolution=resolution, unit=unit)
    height, width = grid.shape
    cells = grid.cells
    occupied, unknown = int((cells >= grid.occupied_threshold).sum()), int((cells < 0).sum())
    free = cells.size - occupied - unknown
    if as_json:
        origin = [grid.origin.x, grid.origin.y, grid.origin.yaw]
        counts = {"occupied": occupied, "free": free, "unknown": unknown}
        print(json.dumps({"width": width, "height": height, "resolution": grid.resolution, "origin": origin, **counts}))
        return
    rows = [
        ("cells", f"{width} x {height}"),
        ("resolution", f"{grid.resolution:g} m"),
        ("size", f"{width * grid.resolution:g} m x {height * grid.resolution:g} m"),
        ("origin", f"({grid.origin.x:g}, {grid.origin.y:g}, {grid.origin.yaw:g})"),
    ]
    for name, count in (("occupied", occupied), ("free", free), ("unknown", unknown)):
        rows.append((name, f"{count} ({count / cells.size:.1%})"))
    print_table(f"{map_file}", rows)
