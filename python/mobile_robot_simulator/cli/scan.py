"""The command `scan`: one scan of a map."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from .._core import LaserScanner
from .console import console, print_table
from .options import (
    Assignments,
    MapFile,
    ParamsFile,
    Resolution,
    RosArgs,
    Seed,
    Unit,
    load_grid,
    pose_of,
    read_values,
    seed_of,
)

if TYPE_CHECKING:
    import numpy as np


def scan(
    map_file: MapFile,
    pose: Annotated[tuple[float, float, float], typer.Option(metavar="X Y YAW", help="Pose of the robot in the map frame.")],
    plot: Annotated[Path | None, typer.Option(help="Picture to save: a .png, .pdf or .svg file.")] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print angles and ranges as JSON.")] = False,
    seed: Seed = None,
    resolution: Resolution = None,
    unit: Unit = None,
    param: Assignments = None,
    params_file: ParamsFile = None,
    ros_args: RosArgs = False,
) -> None:
    """Take one scan of a map, as the laser node does. A range equal to range_max means no return."""
    import numpy as np

    from ..parameters import LaserParameters, for_node

    place = pose_of(pose, "--pose")
    values = read_values(param, params_file)
    grid = load_grid(map_file, values, resolution=resolution, unit=unit)
    parameters = for_node(LaserParameters, values)
    scanner = parameters.scanner()
    noise = parameters.beam_model if parameters.apply_noise else None
    ranges = scanner.scan_batch(grid, np.array([pose]), noise=noise, seed=seed_of(seed, values))[0]
    points = scanner.end_points(pose, ranges)
    if plot is not None:
        from ..plotting import ScanPicture

        ScanPicture(grid, place * scanner.mount, points).save(plot)
    if as_json:
        print(_json(pose, scanner, ranges))
        return
    rows = [
        ("beams", f"{len(ranges)}"),
        ("returns", f"{len(points)}"),
        ("nearest", f"{ranges.min():.3f} m"),
        ("median", f"{np.median(ranges):.3f} m"),
        ("farthest", f"{ranges.max():.3f} m"),
    ]
    print_table(f"{map_file} from {pose}", rows)
    laser = place * scanner.mount
    cell = grid.cell_at(laser.x, laser.y)
    if cell is None:
        console.print("The scanner is off the map. Only beams that reach the map can have a return.")
    elif grid.cells[cell] >= grid.occupied_threshold:
        console.print("The scanner is inside a wall (an occupied cell), so its ranges say nothing about the map.")


def _json(pose: tuple[float, float, float], scanner: LaserScanner, ranges: np.ndarray) -> str:
    content = {
        "pose": list(pose),
        "angle_min": scanner.angle_min,
        "angle_increment": scanner.angle_increment,
        "range_min": scanner.min_range,
        "range_max": scanner.max_range,
        "ranges": ranges.tolist(),
    }
    return json.dumps(content)
