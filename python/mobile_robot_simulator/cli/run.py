"""The command `run`: drive a robot through a map."""

from __future__ import annotations

from enum import Enum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ..recording.format import Format
from .console import console, print_note, print_table, progress_bar
from .options import (
    Assignments,
    FaultTexts,
    MapFile,
    ParamsFile,
    Resolution,
    RosArgs,
    Seed,
    Unit,
    check_positive,
    load_grid,
    pose_of,
    read_faults,
    read_values,
    seed_of,
)
from .signals import signals_as_interrupt

if TYPE_CHECKING:
    from .drive import Drive


SUMMARY, PICTURE = COMPANIONS = ("summary.json", "drive.png")
"""Files that `run` saves beside the recording."""


class DriverName(str, Enum):
    """Names of the built-in drivers."""

    wander = "wander"


def run(
    map_file: MapFile,
    duration: Annotated[float, typer.Option(help="Simulated time in seconds.")] = 60.0,
    start: Annotated[
        tuple[float, float, float] | None,
        typer.Option(metavar="X Y YAW", help="Start pose in the map frame. Without it and initial_pose: a random one."),
    ] = None,
    commands: Annotated[
        Path | None,
        typer.Option(
            help="CSV file of commands with the columns time, vx, vy, wz, or - for standard input. "
            "Each command applies until the next one."
        ),
    ] = None,
    driver: Annotated[DriverName, typer.Option(help="Built-in driver used without --commands.")] = DriverName.wander,
    radius: Annotated[
        float,
        typer.Option(
            help="Radius of the footprint in metres. Contact is counted; it stops the robot with -p contact:=stop."
        ),
    ] = 0.2,
    out: Annotated[Path, typer.Option(help="Folder for the recording, drive.png and summary.json.")] = Path("drive"),
    seed: Seed = None,
    format: Annotated[Format, typer.Option(help="Recording format: mcap or sqlite3 for ROS 2, bag for ROS 1.")] = "mcap",
    real_time: Annotated[
        bool, typer.Option("--real-time", help="Run at speed_factor times real time instead of as fast as possible.")
    ] = False,
    overwrite: Annotated[
        bool, typer.Option("--overwrite", help="Replace an existing recording, its summary and its picture.")
    ] = False,
    resolution: Resolution = None,
    unit: Unit = None,
    fault: FaultTexts = None,
    param: Assignments = None,
    params_file: ParamsFile = None,
    ros_args: RosArgs = False,
) -> None:
    """Drive a robot through a map. Saves a recording of all topics, a summary and, with Matplotlib, a picture.

    Ctrl-C, SIGTERM and SIGHUP end the drive early; what was driven is saved. The exit status is then 130, 143 or 129.
    """
    from ..drivers.script import Script
    from ..drivers.wander import Wander
    from ..parameter_files import read_fault_texts
    from ..recording.recorder import Recorder
    from .drive import Drive

    check_positive("--duration", duration)
    check_positive("--radius", radius)
    with signals_as_interrupt() as interruption:
        values = read_values(param, params_file)
        faults = read_faults(fault, read_fault_texts(params_file) if params_file is not None else ())
        grid = load_grid(map_file, values, resolution=resolution, unit=unit)
        script = Script.read(commands) if commands else None
        for note in script.notes(duration) if script else []:
            print_note(f"{commands}: {note}")
        drive = Drive(
            grid,
            script or Wander(radius),
            values,
            seed_of(seed, values),
            start=pose_of(start, "--start") if start else None,
            radius=radius,
            faults=faults,
        )
        with (
            progress_bar(duration) as advance,
            Recorder(out, format=format, overwrite=overwrite, companions=COMPANIONS) as recorder,
        ):
            drive.simulation.record_lazily(recorder.write)
            summary = drive.run(duration, real_time=real_time, progress=advance, ended=interruption.ignore_more)
            summary.save(recorder.companion(SUMMARY))
            no_picture = _draw(drive, recorder.companion(PICTURE))
        files = [("recording", f"{recorder.path}"), ("picture", no_picture or f"{out / PICTURE}")]
        print_table(f"{map_file}" + (" (interrupted)" if summary.interrupted else ""), [*summary.rows(), *files])
        if drive.in_unknown_cells > 0.1 * drive.odometry_messages and drive.simulation.laser.parameters.unknown == "free":
            console.print("Beams and robots pass through unknown cells. Use -p unknown:=occupied to treat them as walls.")
        if summary.interrupted:
            raise typer.Exit(interruption.exit_status)


def _draw(drive: Drive, file: Path) -> str | None:
    """Saves the picture of a drive. Returns None or, without Matplotlib, the reason why there is no picture."""
    try:
        drive.draw(file)
    except ImportError as error:
        return f"none; {error}"
    return None
