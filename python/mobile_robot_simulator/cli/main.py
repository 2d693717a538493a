"""The command mobile-robot-simulator."""

from __future__ import annotations

import json
import math
import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from enum import Enum
from pathlib import Path
from typing import Annotated, Any, NoReturn

import numpy as np
import typer
from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn
from rich.table import Table

from .. import __version__
from .._core import OccupancyGrid, Pose
from ..maps.map_files import load_map, save_map
from ..parameter_files import read_assignment, read_file, to_yaml
from ..parameters import LaserParameters, for_node

app = typer.Typer(
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    help="Simulate mobile robots and laser scanners on occupancy grids: exact, fast and deterministic.",
)
console = Console()
errors = Console(stderr=True)


class Format(str, Enum):
    """Formats of a recording."""

    mcap = "mcap"
    bag = "bag"
    sqlite3 = "sqlite3"


class Node(str, Enum):
    """Nodes that run in ROS."""

    robot = "robot"
    laser = "laser"
    map = "map"
    all = "all"


class Driver(str, Enum):
    """Drivers that come along."""

    wander = "wander"


MapFile = Annotated[Path, typer.Argument(metavar="MAP", help="A map_server YAML file.")]
Assignments = Annotated[
    list[str] | None, typer.Option("-p", "--param", metavar="NAME:=VALUE", help="Set a parameter, as often as need be.")
]
ParamsFile = Annotated[
    Path | None, typer.Option("--params-file", metavar="FILE", help="Parameters in the shape of a ROS 2 YAML file.")
]
RosArgs = Annotated[bool, typer.Option("--ros-args", help="May stand before -p and --params-file, as in ROS 2.")]
Seed = Annotated[int | None, typer.Option(help="Seed of everything drawn; the parameter seed, or 0, if not given.")]


def main() -> None:
    """Run the command; bad input ends it with a message and exit status 1."""
    try:
        app()
    except (ValueError, TypeError, OSError, ImportError) as error:
        errors.print(f"error: {error}", style="red", markup=False, highlight=False, soft_wrap=True)
        sys.exit(1)


def _version(wanted: bool) -> None:
    if wanted:
        console.print(__version__, highlight=False)
        raise typer.Exit


@app.callback()
def _options(
    version: Annotated[bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version.")] = False,
) -> None:
    pass


@app.command()
def run(
    map_file: MapFile,
    duration: Annotated[float, typer.Option(help="Simulated seconds.")] = 60.0,
    start: Annotated[
        tuple[float, float, float] | None,
        typer.Option(metavar="X Y YAW", help="First pose in the map frame; drawn from free space if not given."),
    ] = None,
    commands: Annotated[
        Path | None, typer.Option(help="CSV file with the header time,vx,vy,wz; each command holds until the next.")
    ] = None,
    driver: Annotated[Driver, typer.Option(help="Who drives when there are no commands.")] = Driver.wander,
    radius: Annotated[float, typer.Option(help="Radius of the robot, for collisions and for keeping clear, m.")] = 0.2,
    out: Annotated[Path, typer.Option(help="Folder for the recording, drive.png and summary.json.")] = Path("drive"),
    seed: Seed = None,
    format: Annotated[
        Format, typer.Option(help="Format of the recording: ROS 2 MCAP or SQLite, or ROS 1 bag.")
    ] = Format.mcap,
    real_time: Annotated[bool, typer.Option("--real-time", help="Pace the run at speed_factor times real time.")] = False,
    overwrite: Annotated[bool, typer.Option("--overwrite", help="Replace a recording that is there.")] = False,
    param: Assignments = None,
    params_file: ParamsFile = None,
    ros_args: RosArgs = False,
) -> None:
    """Drive through a map: record odometry, transforms and scans, and draw a picture."""
    from ..recording.recorder import Recorder
    from .drive import Drive
    from .drivers import Script, Wander

    if not 0.0 < duration < math.inf:
        raise ValueError(f"--duration must be positive and finite, got {duration}")
    if not 0.0 < radius < math.inf:
        raise ValueError(f"--radius must be positive and finite, got {radius}")
    values = _values(param, params_file)
    drive = Drive(
        _load(map_file, values),
        Script.read(commands) if commands else Wander(radius),
        values,
        _seed(seed, values),
        start=Pose(*start) if start else None,
        radius=radius,
    )
    with Recorder(out, format=format.value, overwrite=overwrite) as recorder:
        drive.simulation.record(recorder.write)
        with _progress(duration) as advance:
            summary = drive.run(duration, real_time=real_time, progress=advance)
    summary.save(out / "summary.json")
    drive.draw(out / "drive.png")

    table = Table(title=f"{map_file}" + (" (interrupted)" if summary.interrupted else ""), show_header=False)
    for name, text in (
        ("simulated", f"{summary.simulated_seconds:.1f} s"),
        ("wall", f"{summary.wall_seconds:.2f} s"),
        ("real-time factor", f"{summary.real_time_factor:.0f}"),
        ("scans", f"{summary.scans}"),
        ("beams per second", f"{summary.beams_per_second:,.0f}"),
        ("distance driven", f"{summary.distance:.1f} m"),
        ("collisions", f"{summary.collisions}"),
        ("in unknown space", f"{summary.unknown_share:.0%}"),
        ("recording", f"{recorder.path}"),
        ("picture", f"{out / 'drive.png'}"),
    ):
        table.add_row(name, text)
    console.print(table)
    if summary.unknown_share > 0.1 and drive.simulation.laser.parameters.unknown == "free":
        console.print("Unknown cells let beams and robots pass; -p unknown:=occupied makes walls of them.")
    if summary.interrupted:
        raise typer.Exit(130)


@app.command()
def scan(
    map_file: MapFile,
    pose: Annotated[tuple[float, float, float], typer.Option(metavar="X Y YAW", help="Pose of the robot in the map frame.")],
    plot: Annotated[Path | None, typer.Option(help="Picture to draw.")] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print angles and ranges as JSON.")] = False,
    seed: Seed = None,
    param: Assignments = None,
    params_file: ParamsFile = None,
    ros_args: RosArgs = False,
) -> None:
    """Scan a map once, as the laser node does; range_max means no return."""
    values = _values(param, params_file)
    grid = _load(map_file, values)
    parameters = for_node(LaserParameters, values)
    scanner = parameters.scanner()
    noise = parameters.beam_model if parameters.apply_noise else None
    ranges = scanner.scan_batch(grid, np.array([pose]), noise=noise, seed=_seed(seed, values))[0]
    points = scanner.end_points(pose, ranges)
    if plot is not None:
        from ..plotting import ScanPicture

        ScanPicture(grid, Pose(*pose) * scanner.mount, points).save(plot)
    if as_json:
        content = {
            "pose": list(pose),
            "angle_min": scanner.angle_min,
            "angle_increment": scanner.angle_increment,
            "range_min": scanner.min_range,
            "range_max": scanner.max_range,
            "ranges": ranges.tolist(),
        }
        print(json.dumps(content))
        return
    table = Table(title=f"{map_file} from {pose}", show_header=False)
    table.add_row("beams", f"{len(ranges)}")
    table.add_row("returns", f"{len(points)}")
    table.add_row("nearest", f"{ranges.min():.3f} m")
    table.add_row("median", f"{np.median(ranges):.3f} m")
    table.add_row("farthest", f"{ranges.max():.3f} m")
    console.print(table)


@app.command()
def info(map_file: MapFile, param: Assignments = None, params_file: ParamsFile = None, ros_args: RosArgs = False) -> None:
    """Describe a map."""
    grid = _load(map_file, _values(param, params_file))
    height, width = grid.shape
    cells = grid.cells
    occupied, unknown = int((cells >= grid.occupied_threshold).sum()), int((cells < 0).sum())
    table = Table(title=f"{map_file}", show_header=False)
    table.add_row("cells", f"{width} x {height}")
    table.add_row("resolution", f"{grid.resolution:g} m")
    table.add_row("size", f"{width * grid.resolution:g} m x {height * grid.resolution:g} m")
    table.add_row("origin", f"({grid.origin.x:g}, {grid.origin.y:g}, {grid.origin.yaw:g})")
    for name, count in (("occupied", occupied), ("free", cells.size - occupied - unknown), ("unknown", unknown)):
        table.add_row(name, f"{count} ({count / cells.size:.1%})")
    console.print(table)


@app.command()
def parameters(param: Assignments = None, params_file: ParamsFile = None, ros_args: RosArgs = False) -> None:
    """Print all parameters with their meanings, as YAML that --params-file reads back."""
    print(to_yaml(_values(param, params_file)), end="")


@app.command("floor-plan")
def generate_floor_plan(
    file: Annotated[Path, typer.Argument(metavar="FILE.yaml", help="The map to write.")],
    kind: Annotated[str, typer.Option(help="office, corridor, maze, cave or warehouse.")] = "office",
    size: Annotated[tuple[float, float] | None, typer.Option(metavar="WIDTH HEIGHT", help="Size, m.")] = None,
    resolution: Annotated[float, typer.Option(help="Side of a cell, m.")] = 0.05,
    seed: Annotated[int, typer.Option(help="Names the plan: the same seed, the same cells.")] = 0,
) -> None:
    """Generate a floor plan and save it as a map."""
    from ..maps.floor_plans import floor_plan

    options = {} if size is None else {"size": size}
    file.parent.mkdir(parents=True, exist_ok=True)
    save_map(floor_plan(kind, seed=seed, resolution=resolution, **options), file)
    console.print(f"{file}", highlight=False)


_ROS = {"allow_extra_args": True, "ignore_unknown_options": True}
NodeName = Annotated[Node, typer.Argument(metavar="NODE", help="robot, laser, map, or all of them in one process.")]


@app.command(context_settings=_ROS)
def ros1(context: typer.Context, node: NodeName) -> None:
    """Run a node on ROS 1: NODE [MAP.yaml] [_NAME:=VALUE] [FROM:=TO]."""
    from ..ros.ros1 import run

    run(node.value, context.args)
    _leave()


@app.command(context_settings=_ROS)
def ros2(context: typer.Context, node: NodeName) -> None:
    """Run a node on ROS 2: NODE [MAP.yaml] [--ros-args -p NAME:=VALUE -r FROM:=TO --params-file FILE]."""
    from ..ros.ros2 import run

    run(node.value, context.args)
    _leave()


def _leave() -> NoReturn:
    """End the process, whose node is shut down: what ROS leaves to the interpreter to take apart can last for seconds."""
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(0)


def _values(assignments: list[str] | None, file: Path | None) -> dict[str, Any]:
    """Parameters from the file, and over them those of the command line."""
    values = read_file(file) if file is not None else {}
    assigned = dict(map(read_assignment, assignments or []))
    return {**{key: value for key, value in values.items() if key.rpartition(":")[2] not in assigned}, **assigned}


def _load(map_file: Path, values: dict[str, Any]) -> OccupancyGrid:
    return load_map(map_file, unknown=for_node(LaserParameters, values).unknown)


def _seed(seed: int | None, values: dict[str, Any]) -> int:
    return for_node(LaserParameters, values if seed is None else {**values, "seed": seed}).seed


@contextmanager
def _progress(duration: float) -> Iterator[Callable[[float], None]]:
    """A progress bar over so many simulated seconds; gives the function that moves it on."""
    columns = (TextColumn("simulating"), BarColumn(), TextColumn("{task.completed:.0f}/{task.total:.0f} s"))
    with Progress(*columns, TimeElapsedColumn(), TimeRemainingColumn(), console=errors, transient=True) as bar:
        task = bar.add_task("", total=duration)
        yield lambda seconds: bar.update(task, completed=seconds)
